//! Faults between the joints and the loop.

use std::collections::VecDeque;

use tribo_friction::VelocitySource;
use tribo_robot::SensorFrame;
use tribo_runtime::TickFault;
use tribo_trial::AbortReason;

use crate::story::{AT, Ending, tell, trial};

/// J of the undisturbed trial is 3.0.
const UNDISTURBED: f64 = 3.0;

/// The tuning trial with true compensation, frames tampered with from [`AT`] on.
fn with(mut tamper: impl FnMut(u64, &mut SensorFrame<7>)) -> Ending {
    let (trial, friction) = trial();
    let frames = |tick: u64, mut frame: SensorFrame<7>| {
        if tick >= AT {
            tamper(tick - AT, &mut frame);
        }
        frame
    };
    let ending = tell(&trial, &friction, frames, |_| 1.0);
    println!("{ending:?}");
    ending
}

/// The loop itself stopped, at once, and the arm came to rest where it was.
fn stopped_at_once(ending: &Ending, fault: TickFault, within_s: f64) {
    assert_eq!(ending.fault, Some(fault), "{ending:?}");
    assert!(ending.after_s <= within_s && ending.at_rest && ending.went_on_rad < 0.1, "{ending:?}");
}

#[test]
fn nothing_broken() {
    let ending = with(|_, _| ());
    assert!(ending.reason.is_none() && (ending.cost - UNDISTURBED).abs() < 0.1, "{ending:?}");
}

#[test]
fn an_encoder_is_silent_for_20_ms() {
    let mut held = None;
    let ending = with(|since, frame| {
        if since == 0 {
            held = Some((frame.q, frame.qd));
        }
        if let (Some((q, qd)), true) = (held, since < 20) {
            (frame.q, frame.qd) = (q, qd);
        }
    });
    // The arm hardly notices; the wrench does when the sensor comes back, and J is spoiled.
    assert!(ending.reason.is_none() && ending.fastest_rad_s < 0.2 && ending.cost < 100.0, "{ending:?}");
}

#[test]
fn an_encoder_is_silent_for_good() {
    for joints in [vec![3], vec![0, 1, 2, 3, 4, 5, 6]] {
        let mut held = None;
        let ending = with(|since, frame| {
            if since == 0 {
                held = Some((frame.q, frame.qd));
            }
            for &j in &joints {
                let (q, qd) = held.expect("taken at the first");
                (frame.q[j], frame.qd[j]) = (q[j], qd[j]);
            }
        });
        assert!(
            matches!(ending.fault, Some(TickFault::SensorFrozen { joint }) if joints.contains(&joint)),
            "{ending:?}"
        );
        assert!(ending.after_s < 0.03 && ending.fastest_rad_s < 0.5, "{ending:?}");
        assert!(ending.at_rest && ending.went_on_rad < 0.1, "{ending:?}");
        // Not the parameters' fault.
        assert_eq!(ending.reason, Some(AbortReason::Stopped));
    }
}

#[test]
fn an_encoder_jumps() {
    for jump in [0.01, -0.1, 2.0 * std::f64::consts::PI / 16.0] {
        let ending = with(|_, frame| frame.q[3] += jump);
        stopped_at_once(&ending, TickFault::SensorJumped { joint: 3 }, 0.0);
        assert_eq!(ending.reason, Some(AbortReason::Stopped));
    }
    // One of 2 mrad is within what the arm could have done: it is followed, as a push of 2 mrad times the stiffness would be.
    let ending = with(|_, frame| frame.q[3] += 2e-3);
    assert!(ending.fault.is_none() && ending.fastest_rad_s < 0.5, "{ending:?}");
}

#[test]
fn a_value_is_not_a_number() {
    for bad in [f64::NAN, f64::INFINITY] {
        let ending = with(|_, frame| frame.q[5] = bad);
        stopped_at_once(&ending, TickFault::SensorNotFinite { joint: 5 }, 0.0);
        assert_eq!(ending.reason, Some(AbortReason::NotFinite));
    }
}

/// Samples that are 3 ms old are within the loop's margin. From some age on the arm oscillates; then somebody stops it.
#[test]
fn samples_come_late() {
    let delayed = |ms: usize| {
        let mut queue = VecDeque::new();
        with(move |_, frame| {
            queue.push_back((frame.q, frame.qd));
            if queue.len() > ms {
                if let Some((q, qd)) = queue.pop_front() {
                    (frame.q, frame.qd) = (q, qd);
                }
            } else if let Some((q, qd)) = queue.front() {
                (frame.q, frame.qd) = (*q, *qd);
            }
        })
    };
    let few = delayed(3);
    assert!(few.reason.is_none() && few.cost < 5.0 * UNDISTURBED && few.fastest_rad_s < 0.2, "{few:?}");
    let many = delayed(100);
    assert!(many.reason.is_some() && many.after_s < 5.0 && many.went_on_rad < 0.5, "{many:?}");
}

#[test]
fn samples_come_twice() {
    let mut last: Option<SensorFrame<7>> = None;
    let ending = with(|since, frame| {
        if let (Some(before), true) = (last, since % 5 == 4) {
            *frame = before;
        }
        last = Some(*frame);
    });
    assert!(ending.reason.is_none() && ending.cost < 2.0 * UNDISTURBED, "{ending:?}");
}

#[test]
fn the_clock_jumps() {
    for jump_s in [-1.0, -0.01, 0.5, 1e9] {
        let ending = with(|_, frame| frame.time_s += jump_s);
        stopped_at_once(&ending, TickFault::ClockJumped, 0.0);
        assert_eq!(ending.reason, Some(AbortReason::Stopped));
    }
}

#[test]
fn the_encoders_are_ten_times_as_noisy() {
    let (mut trial, friction) = trial();
    trial.sensors = trial.sensors.scaled_noise(10.0);
    let ending = tell(&trial, &friction, |_, frame| frame, |_| 1.0);
    println!("{ending:?}");
    assert!(ending.fault.is_none() && ending.fastest_rad_s < 0.5, "{ending:?}");
    // The hybrid velocity believes such noise, and the compensator hammers on it: withdrawn before the arm has moved.
    let reason = ending.reason.expect("a reason").to_string();
    assert!(reason.starts_with("over-compensation") && ending.at_rest && ending.went_on_rad < 1e-3, "{ending:?}");
    // Trusted, and without a limit on an acceleration that is mostly noise, the arm follows its path all the same.
    (trial.guard, trial.velocity) = (None, VelocitySource::Reference);
    trial.limits.acceleration_m_s2 *= 10.0;
    trial.limits.acceleration_rad_s2 *= 10.0;
    let ending = tell(&trial, &friction, |_, frame| frame, |_| 1.0);
    println!("{ending:?}");
    assert!(ending.reason.is_none() && ending.cost > UNDISTURBED && ending.fastest_rad_s < 0.5, "{ending:?}");
}

/// A driver that counts one joint backwards: where this is a position the arm cannot have, the first frame says so; else the
/// arm runs away from it, and is stopped while it has hardly begun.
#[test]
fn one_joint_counts_backwards() {
    for joint in 0..7 {
        let (trial, friction) = trial();
        let backwards = |_, mut frame: SensorFrame<7>| {
            frame.q[joint] = -frame.q[joint];
            frame.qd[joint] = -frame.qd[joint];
            frame
        };
        let ending = tell(&trial, &friction, backwards, |_| 1.0);
        println!("joint {joint}: {ending:?}");
        if joint == 3 || joint == 5 {
            assert_eq!(ending.fault, Some(TickFault::JointLimit { joint }), "{ending:?}");
            assert!(ending.after_s <= -0.001 * AT as f64);
        }
        assert!(ending.reason.is_some() && ending.fastest_rad_s < 2.7, "joint {joint}: {ending:?}");
    }
}
