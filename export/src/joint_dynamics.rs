//! Friction as robot descriptions know it.

use nalgebra::{DMatrix, DVector};
use tribo_friction::identify::minimize_in_box;
use tribo_friction::{JointEffects, JointFriction};

use super::loss::{beyond_velocity, not_cancelled, shapes};
use super::{ExportError, Format, Loss, TunedCompensator};

/// Coulomb and viscous friction of every joint, all that URDF and MJCF know:
///
/// ```text
/// tau_f = damping qd + friction sign(qd)
/// ```
///
/// of a law with a dry part: the dry friction left at the speed limit, and the slope, both the mean of the directions; of
/// the Gaz sigmoid, and of a joint with curves over speed: least squares over ± the speed limit, neither below zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct JointDynamics<const N: usize> {
    /// Coulomb friction (Nm).
    pub coulomb_nm: [f64; N],
    /// Viscous friction [Nm s/rad].
    pub viscous_nm_s_per_rad: [f64; N],
}

impl<const N: usize> JointDynamics<N> {
    /// The friction of a compensator.
    ///
    /// # Errors
    /// Friction below zero, which an effect of the model may leave.
    pub fn of(tuned: &TunedCompensator<N>, format: Format) -> Result<Self, ExportError> {
        let closest: [[f64; 2]; N] = std::array::from_fn(|j| match tuned.compensator.friction.joints[j] {
            JointFriction::GazSigmoid(_) => fitted(tuned, j),
            _ if tuned.compensator.effects[j].has_curves() => fitted(tuned, j),
            _ => [tuned.dry_limit_nm(j), tuned.viscous_nm_s_per_rad(j)],
        });
        for (joint, friction) in closest.iter().enumerate() {
            for (name, value) in [("Coulomb friction", friction[0]), ("viscous friction", friction[1])] {
                if value < 0.0 {
                    let what = format!("{name} is {value} with the effects of the model");
                    return Err(ExportError::Joint { joint, what, format: format.name(), why: "it takes 0 or above" });
                }
            }
        }
        Ok(Self { coulomb_nm: closest.map(|it| it[0]), viscous_nm_s_per_rad: closest.map(|it| it[1]) })
    }

    /// What is lost of the compensator; `springs` says whether the format has springs.
    pub fn losses(&self, tuned: &TunedCompensator<N>, springs: bool) -> Vec<Loss> {
        // A description is about the robot: where a compensator smooths the sign, the robot's friction has a step.
        let described = |j: usize, qd: f64| self.coulomb_nm[j].copysign(qd) + self.viscous_nm_s_per_rad[j] * qd;
        let sigmoid = matches!(tuned.compensator.friction.joints[0], JointFriction::GazSigmoid(_));
        let bent = tuned.compensator.effects.iter().any(JointEffects::has_curves);
        let instead = match (sigmoid, bent) {
            (true, _) => "Coulomb and viscous friction closest to it in least squares over the speed range",
            (false, false) => "Coulomb friction is what is left at the speed limit, the mean of both directions",
            (false, true) => {
                "Coulomb friction is what is left at the speed limit, the mean of both directions; of joints with a curve \
                 over speed, Coulomb and viscous friction are those closest in least squares over the speed range"
            }
        };
        let difference = tuned.largest_difference_nm(0.0, described);
        let mut losses: Vec<Loss> = Loss::of_torque(shapes(tuned), instead, difference).into_iter().collect();
        if matches!(tuned.compensator.friction.joints[0], JointFriction::Lugre(_)) {
            let reversal = self.coulomb_nm.map(|coulomb_nm| 2.0 * coulomb_nm);
            losses.extend(Loss::of_torque("bristles", "dry friction turns at once at a reversal", reversal.to_vec()));
        }
        losses.extend(beyond_velocity(tuned, springs));
        if !tuned.robot_alone {
            losses.push(Loss::new(
                format!("velocity source ({}), its threshold and the smoothing of the sign", tuned.source_name()),
                "left out, as they belong to the controller and not to the robot",
            ));
        } else if self.coulomb_nm.iter().chain(&self.viscous_nm_s_per_rad).all(|value| *value == 0.0) {
            losses.push(Loss::new("friction of the joints", "none, as nobody says how much they have"));
        }
        losses.extend(not_cancelled(tuned));
        if let Some(arm) = &tuned.arm {
            let rates = arm.limits.tau_rate_max_nm_s;
            losses.push(Loss::new(format!("torque rate limits {:?} Nm/s", rates.as_slice()), "left out"));
        }
        if tuned.joint_names.is_some() {
            losses.push(Loss::new(
                "geometry and link names of the original description",
                "one body per joint, link_1 and so on",
            ));
        }
        losses
    }
}

/// Coulomb (Nm) and viscous friction [Nm s/rad], neither below zero, closest to the odd part of a joint's sliding torque
/// in least squares over its speed range.
fn fitted<const N: usize>(tuned: &TunedCompensator<N>, joint: usize) -> [f64; 2] {
    const SAMPLES: usize = 1000;
    let (mut h, mut b) = (DMatrix::zeros(2, 2), DVector::zeros(2));
    for k in 0..SAMPLES {
        let qd = tuned.top_speed_rad_s(joint) * (k as f64 + 0.5) / SAMPLES as f64;
        let torque = |qd: f64| tuned.sliding_torque_nm(joint, qd, 0.0);
        let row = DVector::from_column_slice(&[1.0, qd]);
        h += &row * row.transpose();
        b += row * (0.5 * (torque(qd) - torque(-qd)));
    }
    let fit = minimize_in_box(&h, &b, &[0.0; 2], &[f64::INFINITY; 2]);
    [fit.x[0], fit.x[1]]
}
