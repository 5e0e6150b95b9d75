//! Friction parameters of the CRISP controllers.

use tribo_friction::law::GazSigmoid;
use tribo_friction::{Compensator, JointFriction, VelocitySource};

use super::loss::{beyond_velocity, controller_arm, not_cancelled};
use super::parameter_file::ParameterFile;
use super::{ExportError, Exported, Format, Loss, TunedCompensator};

/// The controller that is meant where nobody names one, as the demonstrations of CRISP call it.
const CONTROLLER: &str = "cartesian_impedance_controller";
/// Least share of one direction in the friction of both; with less, the sigmoid would turn far away from rest.
const LEAST_SHARE: f64 = 1e-3;

/// Parameters `use_friction` and `friction.fp1`, `fp2`, `fp3` of `crisp_controllers` (utiasDSL, `cartesian_controller.yaml`
/// and `friction_model.hpp`), whose friction torque is the sigmoid of gaz2019 at the measured velocity:
///
/// ```text
/// tau_f = fp1/(1 + exp(−fp2 (qd + fp3))) − fp1/(1 + exp(−fp2 fp3))
/// ```
///
/// The Gaz law goes over as it is. Dry friction does too, `F tanh(qd/v) = 2F/(1 + exp(−2 qd/v)) − F`: fp1 = F₊ + F₋,
/// fp2 = 2/v, fp3 = ln(F₋/F₊)/fp2, by direction. Viscous friction and the Stribeck curve have no place.
pub(super) fn export<const N: usize>(tuned: &TunedCompensator<N>, name: Option<&str>) -> Result<Exported, ExportError> {
    tuned.known_arm()?;
    // The controller believes the measured velocity, as ours with that source does; then its sign needs as much smoothing.
    let measured = Compensator::new(tuned.compensator.friction, VelocitySource::Measured).smoothing_rad_s;
    let own = tuned.compensator.smoothing_rad_s;
    let smoothing = own.max(measured);
    let mut sigmoids = Vec::new();
    for joint in 0..N {
        sigmoids.push(sigmoid(tuned, joint, smoothing)?);
    }
    let off = tuned.largest_difference_nm(smoothing, |j, qd| sigmoids[j].torque(qd));
    let torque = |j: usize| tuned.sliding_torque_nm(j, tuned.top_speed_rad_s(j), 0.0);
    if let Some(joint) = (0..N).find(|&j| torque(j) != 0.0).filter(|_| sigmoids.iter().all(|it| it.phi1_nm == 0.0)) {
        let what = format!("friction without a dry part ({} Nm at the speed limit)", torque(joint));
        return Err(no_words(joint, what, "nothing would be left: a sigmoid is dry friction"));
    }

    let gaz = matches!(tuned.compensator.friction.joints[0], JointFriction::GazSigmoid(_));
    let (lost, instead) = match gaz {
        true => ("effects of the model on top of the sigmoid", "the sigmoid alone"),
        false => ("viscous friction and the shape of the curve", "dry friction as it is at the speed limit"),
    };
    let mut losses: Vec<Loss> = Loss::of_torque(lost, instead, off).into_iter().collect();
    let smoother =
        tuned.largest_difference_nm(own, |j, qd| tuned.sliding_torque_nm(j, qd, if gaz { own } else { smoothing }));
    losses.extend(Loss::of_torque(
        format!("smoothing of the sign over {own} rad/s"),
        format!("over {smoothing} rad/s, as a measured velocity needs"),
        smoother,
    ));
    if tuned.compensator.source != VelocitySource::Measured {
        losses.push(Loss::new(
            format!("velocity source {}", tuned.source_name()),
            "the controller takes the measured velocity, filtered by its filter.dq",
        ));
    }
    losses.extend(beyond_velocity(tuned, false));
    losses.extend(not_cancelled(tuned));
    losses.extend(controller_arm(tuned));

    let remarks = [
        format!("Friction of {} for crisp_controllers, to be merged into the parameters of your controller.", tuned.robot),
        format!("{}.", tuned.origin),
        "fp1 (Nm), fp2 (s/rad), fp3 (rad/s), one value per joint from the base; read when the controller is configured.".to_owned(),
    ];
    let mut file = ParameterFile::new(name.unwrap_or(CONTROLLER), &remarks, &losses)?;
    file.value("use_friction", "true");
    file.open("friction");
    file.array("fp1", sigmoids.iter().map(|it| it.phi1_nm));
    file.array("fp2", sigmoids.iter().map(|it| it.phi2_s_per_rad));
    file.array("fp3", sigmoids.iter().map(|it| it.phi3_rad_s));
    Ok(Exported { text: file.into_text(), losses })
}

/// The sigmoid of one joint's dry friction.
fn sigmoid<const N: usize>(
    tuned: &TunedCompensator<N>,
    joint: usize,
    smoothing_rad_s: f64,
) -> Result<GazSigmoid, ExportError> {
    let half_difference_nm = match tuned.compensator.friction.joints[joint] {
        JointFriction::GazSigmoid(law) => return Ok(law),
        JointFriction::Asymmetric(law) => 0.5 * (law.coulomb_positive_nm - law.coulomb_negative_nm),
        _ => 0.0,
    } + tuned.compensator.effects[joint].asymmetry_nm;
    let both_nm = 2.0 * tuned.dry_limit_nm(joint);
    if both_nm < 0.0 {
        let what = format!("Coulomb friction is {} Nm with the effects of the model", 0.5 * both_nm);
        return Err(no_words(joint, what, "it takes 0 or above"));
    }
    let phi2_s_per_rad = 2.0 / smoothing_rad_s;
    if both_nm == 0.0 {
        return Ok(GazSigmoid { phi1_nm: 0.0, phi2_s_per_rad, phi3_rad_s: 0.0 });
    }
    let forwards = (0.5 + half_difference_nm / both_nm).clamp(LEAST_SHARE, 1.0 - LEAST_SHARE);
    let phi3_rad_s = ((1.0 - forwards) / forwards).ln() / phi2_s_per_rad;
    Ok(GazSigmoid { phi1_nm: both_nm, phi2_s_per_rad, phi3_rad_s })
}

fn no_words(joint: usize, what: String, why: &'static str) -> ExportError {
    ExportError::Joint { joint, what, format: Format::Crisp.name(), why }
}
