//! Which causes physics confuses, and what separates them.

use crate::diagnosis::{CauseLabel, Location};

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

/// Whether the two give the same torque whatever the motion, so that the likelier story is told and the other listed.
pub(crate) fn same_by_physics<const N: usize>(a: (CauseLabel, Location), b: (CauseLabel, Location)) -> bool {
    let is = |x: (CauseLabel, Location), y: (CauseLabel, Location)| {
        (x == (CauseLabel::Payload, Location::Arm) && y == (CauseLabel::LinkInertial, Location::Link(N - 1)))
            || (x == (CauseLabel::RotorInertia, Location::Joint(0))
                && y == (CauseLabel::LinkInertial, Location::Link(0)))
    };
    is(a, b) || is(b, a)
}
