//! Which causes physics confuses, and what separates them.

use tribo_regression::{CauseLabel, Location, Nominal};

/// Pairs of causes that look alike, and the sentence that a report gives.
const PAIRS: [(CauseLabel, CauseLabel, &str); 22] = {
    use CauseLabel::{
        BaseTilt, Coulomb, CoulombAsymmetry, ExternalContact, JointElasticity, LinkInertial, LoadFriction, Payload,
        PositionSpring, Presliding, RotorInertia, Stribeck, ThermalFriction, TimeDelay, TorqueGain, TorqueOffset,
        TorqueRipple, Viscous,
    };
    [
        (
            Payload,
            LinkInertial,
            "a body at the flange and a heavier link load the joints alike; weigh or remove the payload",
        ),
        (RotorInertia, LinkInertial, "a joint feels the sum of rotor and link inertia; torques alone cannot split it"),
        (TorqueOffset, Coulomb, "motion in one direction only: dry friction is a constant there; move both ways"),
        (TorqueOffset, CoulombAsymmetry, "they differ only while the joint stands; add holds"),
        (TorqueOffset, PositionSpring, "on a small range a spring is a constant; travel further"),
        (TorqueOffset, LinkInertial, "a constant and a first moment differ only over several postures"),
        (TorqueOffset, BaseTilt, "a constant and a tilt differ only over several postures"),
        (TorqueOffset, ThermalFriction, "a drift and a constant differ only over a long session"),
        (Coulomb, LoadFriction, "the load hardly varies here; change payload or posture"),
        (Coulomb, Stribeck, "speeds are too much alike; cruise at several speeds"),
        (Coulomb, Viscous, "one cruising speed only; vary it"),
        (Stribeck, Presliding, "both act around reversals; cruise slowly over a long way"),
        (Viscous, Stribeck, "speeds are too much alike; cruise at several speeds"),
        (Viscous, ThermalFriction, "only a warm-up separates less viscous friction from warm friction"),
        (Coulomb, ThermalFriction, "only a warm-up separates less friction from warm friction"),
        (TorqueGain, LinkInertial, "gravity dominates this joint; add dynamics or change the payload"),
        (TorqueGain, Payload, "gravity dominates this joint; weigh the payload"),
        (
            TimeDelay,
            JointElasticity,
            "both go with the rate of the torque; a second encoder or fast motion separates them",
        ),
        (TimeDelay, Viscous, "accelerations are too small to tell a delay from viscous friction"),
        (ExternalContact, Payload, "a push that lasts is a weight; repeat the motion untouched"),
        (BaseTilt, LinkInertial, "gravity of another direction and a first moment differ only over several postures"),
        (TorqueRipple, PositionSpring, "on a small range a slow ripple is a spring; travel further"),
    ]
};

/// Why two causes are rivals, in one sentence.
pub(crate) fn why(a: CauseLabel, b: CauseLabel) -> String {
    PAIRS
        .iter()
        .find(|(x, y, _)| (*x, *y) == (a, b) || (*x, *y) == (b, a))
        .map_or_else(|| "on this motion their torques are nearly the same".to_owned(), |(_, _, why)| (*why).to_owned())
}

/// Whether the two give the same torque whatever the motion, so that the likelier story is told and the other listed: a body at the flange and on the last
/// link; what turns about the first axis with the rotor, with the first link, or with the second, thin along its own axis across the first.
pub(crate) fn same_by_physics<const N: usize>(a: (CauseLabel, Location), b: (CauseLabel, Location)) -> bool {
    let is = |x: (CauseLabel, Location), y: (CauseLabel, Location)| {
        (x == (CauseLabel::Payload, Location::Arm) && y == (CauseLabel::LinkInertial, Location::Link(N - 1)))
            || (x == (CauseLabel::RotorInertia, Location::Joint(0))
                && matches!(y, (CauseLabel::LinkInertial, Location::Link(0 | 1))))
    };
    is(a, b) || is(b, a)
}

/// Whether the two give the same torque in any motion that this model can follow: by physics, or a constant and friction that differs by
/// direction where dry friction jumps, which differ in a joint that stands, held by any friction there is.
pub(crate) fn same_torque<const N: usize>(
    nominal: &Nominal<N>,
    a: (CauseLabel, Location),
    b: (CauseLabel, Location),
) -> bool {
    let labels = (a.0.min(b.0), a.0.max(b.0));
    let constant = labels == (CauseLabel::CoulombAsymmetry, CauseLabel::TorqueOffset) && a.1 == b.1;
    same_by_physics::<N>(a, b) || (constant && nominal.friction_jumps())
}

#[cfg(test)]
mod tests {
    use tribo_friction::FrictionModel;
    use tribo_robot::presets;
    use tribo_sim::TorqueSide;

    use super::*;

    #[test]
    fn a_constant_and_one_sided_friction_are_one_torque_where_friction_jumps() {
        let nominal = |smoothing_rad_s| Nominal::<7> {
            arm: presets::panda(),
            friction: FrictionModel::none(),
            smoothing_rad_s,
            sticks: false,
            effects: Vec::new(),
            torque_side: TorqueSide::Motor,
        };
        let at = |label, joint| (label, Location::Joint(joint));
        let (offset, asymmetry) = (CauseLabel::TorqueOffset, CauseLabel::CoulombAsymmetry);
        assert!(same_torque(&nominal(3e-4), at(offset, 2), at(asymmetry, 2)));
        assert!(same_torque(&nominal(3e-4), at(asymmetry, 2), at(offset, 2)));
        assert!(!same_torque(&nominal(3e-4), at(offset, 2), at(asymmetry, 3)), "two joints");
        assert!(!same_torque(&nominal(5e-3), at(offset, 2), at(asymmetry, 2)), "a joint creeps within the sign");
        let last = (CauseLabel::LinkInertial, Location::Link(6));
        assert!(same_torque(&nominal(5e-3), (CauseLabel::Payload, Location::Arm), last));
    }
}
