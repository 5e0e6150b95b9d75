//! What a format cannot say of a compensator.

use std::fmt;

use serde::Serialize;
use tribo_friction::JointEffects;

use super::TunedCompensator;
use tribo_model::{FrictionSection, LawName};

/// Something of the compensator that is not in an exported file, and what stands in its place.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Loss {
    /// What is lost.
    pub lost: String,
    /// What the file has instead.
    pub instead: String,
    /// The largest torque (Nm) by which the file is off for it, joint by joint from the base, where it is a torque.
    pub largest_nm: Option<Vec<f64>>,
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.lost, self.instead)?;
        if let Some(largest_nm) = &self.largest_nm {
            let each: Vec<String> = largest_nm.iter().map(|torque| rounded_up(*torque)).collect();
            write!(f, "; off by up to [{}] Nm", each.join(", "))?;
        }
        Ok(())
    }
}

/// A bound in a message: three decimals, never rounded down.
fn rounded_up(torque_nm: f64) -> String {
    format!("{}", (torque_nm * 1e3 - 1e-9).ceil().max(0.0) / 1e3)
}

impl Loss {
    /// A loss that is no torque.
    pub(super) fn new(lost: impl Into<String>, instead: impl Into<String>) -> Self {
        Self { lost: lost.into(), instead: instead.into(), largest_nm: None }
    }

    /// A loss of so much torque (Nm) per joint; none where all are zero.
    pub(super) fn of_torque(lost: impl Into<String>, instead: impl Into<String>, largest_nm: Vec<f64>) -> Option<Self> {
        let any = largest_nm.iter().any(|torque| *torque > 0.0);
        any.then(|| Self { largest_nm: Some(largest_nm), ..Self::new(lost, instead) })
    }
}

/// Names of what makes the sliding torque of these joints more than Coulomb and viscous friction.
pub(super) fn shapes<const N: usize>(tuned: &TunedCompensator<N>) -> String {
    let law = FrictionSection::of(&tuned.compensator.friction, 0.0).law;
    let any = |has: &dyn Fn(&JointEffects) -> bool| tuned.compensator.effects.iter().any(has);
    let named = [
        (law == LawName::Stribeck || any(&|it| it.breakaway_minus_coulomb_nm != 0.0), "Stribeck curve"),
        (law == LawName::Asymmetric || any(&|it| it.asymmetry_nm != 0.0), "difference of directions"),
        (law == LawName::GazSigmoid, "sigmoid"),
        (any(&|it| it.has_curves()), "curve over speed"),
    ];
    let present: Vec<&str> = named.into_iter().filter_map(|(present, name)| present.then_some(name)).collect();
    if present.is_empty() { "shape of the curve".to_owned() } else { present.join(" and ") }
}

/// Losses of a target that knows friction as a function of the velocity alone: torques that go with position, load or
/// history. `springs` says whether the target has springs.
pub(super) fn beyond_velocity<const N: usize>(tuned: &TunedCompensator<N>, springs: bool) -> Vec<Loss> {
    let effects = &tuned.compensator.effects;
    let each = |bound: &dyn Fn(usize, &JointEffects) -> f64| (0..N).map(|j| bound(j, &effects[j]).abs()).collect();
    let limits = tuned.arm.as_ref().map(|arm| arm.limits);
    let mut losses = vec![
        Loss::of_torque("torque offset", "left out", each(&|_, it| it.offset_nm)),
        Loss::of_torque(
            "friction that grows with the load",
            "left out",
            each(&|j, it| it.load_coefficient * limits.map_or(0.0, |limits| limits.tau_max_nm[j])),
        ),
        Loss::of_torque(
            "torque ripple",
            "left out",
            each(&|_, it| it.ripples.iter().map(|ripple| ripple.amplitude_nm.abs()).sum()),
        ),
    ];
    if !springs {
        let stretch = |j: usize, rest: f64| {
            limits.map_or(0.0, |limits| (limits.q_min_rad[j] - rest).abs().max((limits.q_max_rad[j] - rest).abs()))
        };
        let spring = |j: usize, it: &JointEffects| it.spring_nm_per_rad * stretch(j, it.spring_rest_rad);
        losses.push(Loss::of_torque("position spring", "left out", each(&spring)));
    }
    // Right after a reversal bristles still pull the old way; those of parts below zero pull against the others.
    let presliding = |j: usize, it: &JointEffects| {
        let whole = if it.presliding_distance_rad > 0.0 { tuned.dry_limit_nm(j) } else { 0.0 };
        let sum = |sign: f64| it.bristles.iter().map(|part| (sign * part.amplitude_nm).max(0.0)).sum::<f64>();
        2.0 * (whole + sum(1.0)).max(sum(-1.0))
    };
    losses.push(Loss::of_torque("presliding", "dry friction turns at once at a reversal", each(&presliding)));
    losses.into_iter().flatten().collect()
}

/// What no export has, because the compensator itself does not cancel it.
pub(super) fn not_cancelled<const N: usize>(tuned: &TunedCompensator<N>) -> Vec<Loss> {
    tuned
        .not_cancelled
        .iter()
        .map(|left| {
            let joint = left.effect.joint().map_or(String::new(), |joint| format!(" of joint {joint}"));
            Loss::new(
                format!("{}{joint}", left.effect.cause()),
                format!("not cancelled by Tribo either, as {}", left.why),
            )
        })
        .collect()
}

/// That a file about friction alone has no arm in it, where the believed one is not the bare robot.
pub(super) fn controller_arm<const N: usize>(tuned: &TunedCompensator<N>) -> Option<Loss> {
    tuned.extended_arm.then(|| {
        Loss::new(
            "payload, gravity, link and rotor inertia of the model",
            "belong to the gravity and inertia terms of your controller",
        )
    })
}
