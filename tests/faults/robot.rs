//! Faults of the arm, of what the controller believes of it, and of those who stand beside it.

use tribo_control::{PAPER_PHASES_RAD, SinusoidReference};
use tribo_friction::{FrictionModel, VelocitySource};
use tribo_robot::{Kinematics, presets};
use tribo_runtime::TickFault;
use tribo_sim::WrenchPulses;
use tribo_tests::Joints;
use tribo_trial::{AbortReason, Trial};

use crate::story::{AT, Ending, tell, trial};

fn undisturbed_sensors(trial: &Trial<7>, friction: &FrictionModel<7>) -> Ending {
    let ending = tell(trial, friction, |_, frame| frame, |_| 1.0);
    println!("{ending:?}");
    ending
}

/// A trial about another pose.
fn about(start: Joints) -> (Trial<7>, FrictionModel<7>) {
    let (mut trial, friction) = trial();
    trial.start = start;
    let centre = Kinematics::at(&trial.model, &start).base_from_flange();
    trial.reference = SinusoidReference::paper(centre, PAPER_PHASES_RAD);
    (trial, friction)
}

/// Drives that give a sixth of the torque they should: they cannot hold the arm, and somebody notices.
#[test]
fn the_drives_saturate() {
    let (mut trial, friction) = trial();
    trial.model.limits.tau_max_nm /= 6.0;
    let ending = undisturbed_sensors(&trial, &friction);
    assert_eq!(ending.reason, Some(AbortReason::TorqueSaturation), "{ending:?}");
    assert!(ending.fastest_rad_s < 1.0, "{ending:?}");
}

/// Arm stretched out, and wrist in line: the damped inverse keeps every torque finite.
#[test]
fn the_pose_is_singular() {
    for q in [[0.0, 0.3, 0.0, -0.1, 0.0, 1.8, 0.0], [0.0, -0.785, 0.0, -2.356, 0.0, 0.02, 0.785]] {
        let (trial, friction) = about(Joints::from(q));
        let ending = undisturbed_sensors(&trial, &friction);
        assert!(ending.fastest_rad_s < 2.7 && (ending.reason.is_none() || ending.went_on_rad < 0.3), "{ending:?}");
    }
}

/// A third of a degree from the limit of joint 6: the motion would go past it, and does not.
#[test]
fn the_pose_is_at_a_limit() {
    let (arm, mut q) = (presets::panda(), presets::panda_ready_pose());
    q[6] = arm.limits.q_max_rad[6] - 0.005;
    let (trial, friction) = about(q);
    let ending = undisturbed_sensors(&trial, &friction);
    assert!(matches!(ending.fault, Some(TickFault::JointLimit { .. })), "{ending:?}");
    assert!(ending.at_rest && ending.went_on_rad < 0.05, "{ending:?}");
}

#[test]
fn the_compensator_is_far_too_strong() {
    for scale in [1.75, 2.5, 3.0] {
        let (mut trial, friction) = trial();
        trial.velocity = VelocitySource::Measured;
        let ending = undisturbed_sensors(&trial, &friction.scaled(scale));
        let words = ending.reason.map(|reason| reason.to_string()).unwrap_or_default();
        assert!(words.starts_with("over-compensation"), "{ending:?}");
        assert!(ending.fault.is_none() && ending.at_rest && ending.fastest_rad_s < 0.5, "{ending:?}");
    }
}

/// The links of an FR3 in the controller of a Panda.
#[test]
fn the_model_is_that_of_another_arm() {
    let (mut trial, friction) = trial();
    trial.model = trial.model.altered(|mechanism| mechanism.links = presets::fr3().links);
    let ending = undisturbed_sensors(&trial, &friction);
    assert!(ending.fault.is_none() && ending.fastest_rad_s < 1.0, "{ending:?}");
    assert!(ending.cost > 6.0, "nobody would notice: {ending:?}");
    assert!(ending.reason.is_none() || ending.at_rest, "{ending:?}");
}

/// 50 N are 2 cm at 2500 N/m: the arm gives way and comes back, and no reason to stop is a fault of the loop.
#[test]
fn somebody_pushes() {
    for velocity in [VelocitySource::Hybrid, VelocitySource::Measured] {
        let (mut trial, friction) = trial();
        trial.velocity = velocity;
        trial.pulses = WrenchPulses::each_axis(50.0, 5.0, 5.0, 2.0, 1.5);
        let guarded = undisturbed_sensors(&trial, &friction);
        assert!(guarded.fault.is_none() && guarded.fastest_rad_s < 1.5, "{guarded:?}");
        assert!(guarded.reason.is_none() || guarded.at_rest, "{guarded:?}");
        trial.guard = None;
        let trusted = undisturbed_sensors(&trial, &friction);
        assert!(trusted.fault.is_none() && trusted.fastest_rad_s < 1.5, "{trusted:?}");
    }
}

/// From then on no torque reaches the arm: it falls, and the trial says so before it has fallen far.
#[test]
fn the_power_fails() {
    let (trial, friction) = trial();
    let ending = tell(&trial, &friction, |_, frame| frame, |tick| if tick < AT { 1.0 } else { 0.0 });
    println!("{ending:?}");
    assert!(ending.reason.is_some() && (0.0..0.5).contains(&ending.after_s), "{ending:?}");
    assert!(ending.fastest_rad_s < 1.0, "{ending:?}");
}
