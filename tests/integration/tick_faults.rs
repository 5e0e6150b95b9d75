//! Whatever the sensors say, the loop answers with a torque that may be sent.
//!
//! A tampered plant lies from tick [`AT`] on. Every tick of every story must return a finite command within the torque
//! limits and within 1 Nm of the last one; the first reason is latched; afterwards the command is the safe torque
//! g(q) − d qd. Tolerance: 1e-9 Nm, rounding of the limiter's additions.

use tribo_control::{PAPER_PHASES_RAD, SinusoidReference};
use tribo_friction::VelocitySource;
use tribo_robot::{SensorFrame, gravity_torque, presets};
use tribo_runtime::{TickFault, TickRecord};
use tribo_sim::{BoxFrictionPlant, Sensors, Truth};
use tribo_tests::{DT_S, Joints, TamperedPlant, panda_loop, ready_flange};

/// First tick with a tampered frame, when the arm is moving at full amplitude.
const AT: u64 = 4000;
/// Ticks in all.
const TICKS: u64 = 5000;
const ROUNDING_NM: f64 = 1e-9;
/// Braking constant d of the safe torque.
const BRAKE_NM_S_PER_RAD: f64 = 5.0;

/// Runs the moving Panda with `tamper(ticks since AT, frame)` from tick AT on, asserting what must hold at every tick.
fn records(at: u64, tamper: impl Fn(u64, &mut SensorFrame<7>)) -> Vec<TickRecord<7>> {
    let truth = Truth::panda_coulomb_viscous();
    let plant = BoxFrictionPlant::new(truth.clone(), Sensors::default(), presets::panda_ready_pose(), 1);
    let mut plant = TamperedPlant::new(plant, |tick, mut frame| {
        if tick >= at {
            tamper(tick - at, &mut frame);
        }
        frame
    });
    let reference = SinusoidReference::paper(ready_flange(), PAPER_PHASES_RAD);
    let mut control = panda_loop(reference, truth.friction, VelocitySource::Hybrid);
    let limits = presets::panda().limits;
    let mut records: Vec<TickRecord<7>> = Vec::new();
    for tick in 0..TICKS {
        let record = *control.tick(&mut plant);
        for j in 0..7 {
            let tau = record.command[j];
            assert!(tau.is_finite() && tau.abs() <= limits.tau_max_nm[j], "tick {tick} joint {j}: {tau} Nm");
            if let Some(last) = records.last() {
                let step = (tau - last.command[j]).abs();
                assert!(step <= limits.tau_rate_max_nm_s[j] * DT_S + ROUNDING_NM, "tick {tick} joint {j}: {step} Nm");
            }
        }
        assert!(record.estimate.wrench_base.to_vector().iter().all(|h| h.is_finite()), "tick {tick}");
        assert!(tick >= at || record.fault.is_none(), "tick {tick}: fault before the tampering");
        records.push(record);
    }
    records
}

/// The fault at the tampered tick, which must stay to the end, answered by `g(q) − d qd` as fast as the rate limit lets it.
fn latched_fault(at: u64, tamper: impl Fn(u64, &mut SensorFrame<7>)) -> TickFault {
    let records = records(at, tamper);
    let first = records[at as usize].fault.expect("a fault at the tampered tick");
    assert!(records[at as usize..].iter().all(|record| record.fault == Some(first)), "{first} must be latched");
    let arm = presets::panda();
    // The last configuration that was finite; before any, the one the loop was built for.
    let mut q = presets::panda_ready_pose();
    let mut last: Option<[Joints; 2]> = None;
    for (tick, record) in records.iter().enumerate() {
        let frame = &record.frame;
        if frame.q.iter().all(|x| x.is_finite()) {
            q = frame.q;
        }
        let gravity = if tick as u64 >= at { gravity_torque(&arm, &q) } else { record.torque.gravity };
        if tick as u64 >= at {
            let expected = Joints::from_fn(|j, _| {
                let brake = if frame.qd[j].is_finite() { BRAKE_NM_S_PER_RAD * frame.qd[j] } else { 0.0 };
                let step = arm.limits.tau_rate_max_nm_s[j] * DT_S;
                let limit = arm.limits.tau_max_nm[j];
                let wanted = (gravity[j] - brake).clamp(-limit, limit);
                let Some([last_sent, last]) = last else { return wanted };
                let (of_sent, sent) = (0.999 * step, wanted - gravity[j]);
                let sent = sent.clamp(last_sent[j] - of_sent, last_sent[j] + of_sent);
                (sent + gravity[j]).clamp(last[j] - step, last[j] + step)
            });
            assert!((record.command - expected).amax() < ROUNDING_NM, "tick {tick}: not the safe torque");
            assert_eq!(record.torque.total(), Joints::zeros(), "tick {tick}: the controller still speaks");
        }
        last = Some([record.command - gravity, record.command]);
    }
    first
}

#[test]
fn a_value_that_is_not_finite_is_named() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for joint in [0, 3, 6] {
            let fault = TickFault::SensorNotFinite { joint };
            assert_eq!(latched_fault(AT, |_, frame| frame.q[joint] = bad), fault);
            assert_eq!(latched_fault(AT, |_, frame| frame.qd[joint] = bad), fault);
        }
    }
}

/// From the very first tick, before there is any state to fall back to.
#[test]
fn the_first_tick_may_already_be_broken() {
    let fault = latched_fault(0, |_, frame| {
        frame.q = Joints::repeat(f64::NAN);
        frame.qd = Joints::repeat(f64::INFINITY);
    });
    assert_eq!(fault, TickFault::SensorNotFinite { joint: 0 });
}

/// One bad sample is enough, and what comes after it is only an echo: the first reason stays.
#[test]
fn the_first_reason_is_latched() {
    let once = latched_fault(AT, |since, frame| {
        if since == 0 {
            frame.q[2] = f64::NAN;
        }
    });
    assert_eq!(once, TickFault::SensorNotFinite { joint: 2 });
    let changing = latched_fault(AT, |since, frame| match since {
        0 => frame.qd[5] = 3.0,
        1 => frame.q[1] = f64::NAN,
        _ => frame.q[4] = 9.0,
    });
    assert_eq!(changing, TickFault::JointSpeed { joint: 5 });
}

#[test]
fn positions_and_speeds_beyond_their_limits_are_named() {
    let limits = presets::panda().limits;
    for joint in 0..7 {
        let limit = TickFault::JointLimit { joint };
        assert_eq!(latched_fault(AT, |_, frame| frame.q[joint] = limits.q_min_rad[joint] - 1e-6), limit);
        assert_eq!(latched_fault(AT, |_, frame| frame.q[joint] = limits.q_max_rad[joint] + 1e-6), limit);
        let speed = TickFault::JointSpeed { joint };
        assert_eq!(latched_fault(AT, |_, frame| frame.qd[joint] = limits.qd_max_rad_s[joint] + 1e-6), speed);
        assert_eq!(latched_fault(AT, |_, frame| frame.qd[joint] = -limits.qd_max_rad_s[joint] - 1e-6), speed);
    }
    // Finite, and absurd.
    assert_eq!(latched_fault(AT, |_, frame| frame.q[0] = 1e300), TickFault::JointLimit { joint: 0 });
    assert_eq!(latched_fault(AT, |_, frame| frame.qd[0] = -1e300), TickFault::JointSpeed { joint: 0 });
}

/// A clock that is not a number has jumped; from the very first tick on it gives a reference that is no number either, hence a torque
/// that is none: caught before it is sent.
#[test]
fn a_broken_clock_is_caught() {
    assert_eq!(latched_fault(AT, |_, frame| frame.time_s = f64::NAN), TickFault::ClockJumped);
    assert_eq!(latched_fault(0, |_, frame| frame.time_s = f64::NAN), TickFault::TorqueNotFinite);
}

/// The loop is sensorless: the torque signal may be anything.
#[test]
fn a_broken_torque_sensor_is_nobodys_fault() {
    let records = records(AT, |_, frame| frame.tau = Joints::repeat(f64::NAN));
    assert!(records.iter().all(|record| record.fault.is_none()));
}
