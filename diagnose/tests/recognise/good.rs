//! Logs with nothing wrong but what a diagnosis looks for.

use nalgebra::SVector;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use tribo_friction::FrictionModel;
use tribo_logs::RobotLog;
use tribo_regression::Nominal;
use tribo_robot::presets;
use tribo_sim::excitation::{Envelope, Excitation};
use tribo_sim::{AnyTypicalFriction, Effect, Recording, TorqueSide, Truth, record};

/// A log and the model that it is held against.
pub struct Good<const N: usize> {
    pub log: RobotLog,
    pub nominal: Nominal<N>,
    pub description: String,
}

/// Width of the smooth sign (rad/s).
const SMOOTHING_RAD_S: f64 = 0.005;

/// Arm, motion, sensors, friction and up to two hidden effects, all from the seed.
pub fn good<const N: usize>(name: &str, seed: u64) -> Good<N> {
    let kinds = Excitation::ALL;
    drawn(name, seed, kinds[seed as usize % kinds.len()], true)
}

/// The same with a motion of all joints that shows everything, and nothing hidden.
pub fn lively<const N: usize>(name: &str, seed: u64) -> Good<N> {
    drawn(name, seed, [Excitation::Multisine, Excitation::Cruise][seed as usize % 2], false)
}

fn drawn<const N: usize>(name: &str, seed: u64, kind: Excitation, hide: bool) -> Good<N> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let preset = presets::find(name).expect(name);
    let preset = preset.with_joints::<N>().expect(name);
    let friction = AnyTypicalFriction::find(name).expect(name);
    let friction = friction.with_joints::<N>().expect(name);
    let law: FrictionModel<N> = match rng.random_range(0..3) {
        0 => friction.coulomb_viscous(),
        1 => friction.stribeck(),
        _ => friction.lugre(),
    };
    let law = law.scaled(rng.random_range(0.3..1.5));
    let torque_side = [TorqueSide::Motor, TorqueSide::Link][rng.random_range(0..2usize)];
    let duration_s = rng.random_range(8.0..24.0);
    let recording = Recording {
        rate_hz: [100.0, 200.0, 500.0][rng.random_range(0..3usize)],
        torque_side,
        encoder_sd_rad: 10f64.powf(rng.random_range(-5.5..-4.3)),
        torque_sd_nm: rng.random_range(0.02..0.15),
        repeated_fraction: if rng.random_range(0.0..1.0) < 0.1 { 0.03 } else { 0.0 },
        ..Recording::default()
    };
    let mut truth = Truth::new(preset.arm.clone(), law);
    if hide {
        let count = rng.random_range(0..3);
        truth.effects = (0..count).map(|_| effect::<N>(&mut rng, &preset.arm.limits.tau_max_nm, duration_s)).collect();
    }
    let pose = preset.poses_rad[rng.random_range(0..3usize)];
    let envelope = Envelope::around(&preset.arm, pose).slower_than(rng.random_range(0.5..1.5));
    let motion = kind.draw(&envelope, duration_s, rng.random());
    let log = record(&truth, SMOOTHING_RAD_S, motion.as_ref(), &recording, rng.random()).expect(name);
    let arm = match torque_side {
        TorqueSide::Motor => preset.arm.clone(),
        TorqueSide::Link => preset.arm.clone().link_side(),
    };
    let description = format!("{name} {seed}: {kind:?}, {duration_s:.0} s, {torque_side:?}, {:?}", truth.effects);
    let nominal = Nominal { smoothing_rad_s: SMOOTHING_RAD_S, ..Nominal::new(arm, law, torque_side) };
    Good { log, nominal, description }
}

/// One of the causes that a diagnosis names, of a size that happens.
fn effect<const N: usize>(rng: &mut Pcg64, limit_nm: &SVector<f64, N>, duration_s: f64) -> Effect {
    let joint = rng.random_range(0..N);
    let limit = limit_nm[joint];
    let side = if rng.random_range(0..2) == 0 { 1.0 } else { -1.0 };
    match rng.random_range(0..12) {
        0 => Effect::Payload {
            mass_kg: rng.random_range(0.3..3.0),
            com_m: [rng.random_range(-0.05..0.05), 0.02, rng.random_range(0.02..0.15)],
            inertia_kg_m2: [1e-3, 0.0, 0.0, 1e-3, 0.0, 1e-3],
        },
        1 => Effect::BaseTilt { angle_rad: rng.random_range(0.02..0.12), axis: [side, 0.0, 0.0] },
        2 => Effect::TorqueGain { joint, gain_error: side * rng.random_range(0.03..0.25) },
        3 => Effect::TorqueOffset { joint, offset_nm: side * rng.random_range(0.01..0.03) * limit },
        4 => Effect::LoadFriction { joint, load_coefficient: rng.random_range(0.02..0.15) },
        5 => Effect::TorqueRipple {
            joint,
            cycles_per_rev: 100.0,
            amplitude_nm: rng.random_range(0.002..0.01) * limit,
            phase_rad: 0.3,
        },
        6 => Effect::PositionSpring { joint, stiffness_nm_per_rad: rng.random_range(1.0..10.0), rest_rad: 0.0 },
        7 => Effect::LinkInertial {
            link: rng.random_range(1..N),
            delta_mass_kg: rng.random_range(0.1..0.8),
            delta_first_moment_kg_m: [0.05, 0.02, 0.01],
            delta_inertia_kg_m2: [5e-3, 0.0, 0.0, 5e-3, 0.0, 5e-3],
        },
        8 => Effect::RotorInertia { joint, delta_rotor_inertia_kg_m2: rng.random_range(0.05..0.5) },
        9 => Effect::FrictionCurve { joint, amplitude_nm: rng.random_range(0.005..0.02) * limit, width_rad_s: 0.3 },
        10 => Effect::ExternalContact {
            force_n: [rng.random_range(5.0..40.0), 0.0, side * 20.0],
            moment_nm: [0.0, 1.0, 0.0],
            start_s: 0.3 * duration_s,
            end_s: 0.6 * duration_s,
        },
        _ => Effect::TimeDelay { delay_s: rng.random_range(1e-3..8e-3) },
    }
}
