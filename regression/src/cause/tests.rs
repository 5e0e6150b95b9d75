//! Every cause predicts the torque that the simulator gives its effect.

use tribo_logs::RobotLog;
use tribo_robot::presets;
use tribo_sim::excitation::{Envelope, Excitation};
use tribo_sim::{Effect, Recording, TorqueSide, Truth, record};

use crate::Nominal;
use crate::noise_level::rms;
use crate::regression_data::RegressionData;

const SMOOTHING_RAD_S: f64 = 0.01;

fn log_of(effects: Vec<Effect>, motion: Excitation) -> RobotLog {
    let truth = Truth { effects, ..Truth::panda_coulomb_viscous() };
    let path = motion.draw(&Envelope::of(&presets::panda()), 25.0, 5);
    let recording = Recording { rate_hz: 250.0, ..Recording::default() }.noise_free();
    record(&truth, SMOOTHING_RAD_S, path.as_ref(), &recording, 1).unwrap()
}

fn nominal() -> Nominal<7> {
    Nominal {
        smoothing_rad_s: SMOOTHING_RAD_S,
        ..Nominal::new(presets::panda(), Truth::panda_coulomb_viscous().friction, TorqueSide::Motor)
    }
}

/// Share of the effect's torque in the band that the candidate's column, at the true parameters, does not predict.
fn missed(effect: &Effect, motion: Excitation, band_hz: f64) -> f64 {
    let data = RegressionData::of_logs(&[log_of(vec![effect.clone()], motion)], &nominal(), Some(band_hz)).unwrap();
    let torque = data.effect_torque(effect).unwrap();
    let column = data.filter(&torque);
    let (mut left, mut whole) = (0.0, 0.0);
    for j in 0..7 {
        let residual = &data.residual_nm[j];
        let predicted = column.rows[j].as_deref().cloned().unwrap_or_else(|| vec![0.0; residual.len()]);
        let difference: Vec<f64> = residual.iter().zip(&predicted).map(|(a, b)| a - b).collect();
        left += rms(&difference).powi(2);
        whole += rms(residual).powi(2);
    }
    (left / whole).sqrt()
}

#[test]
fn every_column_is_the_torque_of_its_effect() {
    let joint = 3;
    let zero = [0.0; 6];
    let (inertia_kg_m2, com_m) = ([2e-3, 0.0, 0.0, 2e-3, 0.0, 1e-3], [0.01, -0.02, 0.06]);
    // Share missed: of effects that are small differences of large torques, more.
    let effects = [
        (Effect::Coulomb { joint, delta_coulomb_nm: 0.2 }, 0.01),
        (Effect::Viscous { joint, delta_viscous_nm_s_per_rad: 0.3 }, 0.01),
        (Effect::Stribeck { joint, breakaway_minus_coulomb_nm: 0.3, stribeck_velocity_rad_s: 0.06 }, 0.01),
        (Effect::CoulombAsymmetry { joint, asymmetry_nm: 0.1 }, 0.01),
        (Effect::TorqueOffset { joint, offset_nm: 0.2 }, 0.01),
        (Effect::TorqueGain { joint, gain_error: 0.05 }, 0.01),
        (Effect::ThermalFriction { joint, drop_fraction: 0.4, time_constant_s: 15.0 }, 0.01),
        (Effect::LoadFriction { joint, load_coefficient: 0.03 }, 0.01),
        (Effect::Payload { mass_kg: 0.5, com_m, inertia_kg_m2 }, 0.01),
        (Effect::BaseTilt { angle_rad: 0.02, axis: [0.6, 0.8, 0.0] }, 0.01),
        (
            Effect::LinkInertial {
                link: 4,
                delta_mass_kg: 0.2,
                delta_first_moment_kg_m: [0.01, 0.02, -0.01],
                delta_inertia_kg_m2: zero,
            },
            0.01,
        ),
        (Effect::RotorInertia { joint, delta_rotor_inertia_kg_m2: 0.1 }, 0.01),
        (Effect::TorqueRipple { joint, cycles_per_rev: 40.0, amplitude_nm: 0.1, phase_rad: 0.7 }, 0.01),
        (Effect::Presliding { joint, presliding_distance_rad: 2e-3, amplitude_nm: None }, 0.02),
        (Effect::JointElasticity { joint, stiffness_nm_per_rad: 9e3, damping_nm_s_per_rad: 7.0 }, 0.03),
        (Effect::JointElasticity { joint: 1, stiffness_nm_per_rad: 30e3, damping_nm_s_per_rad: 11.0 }, 0.03),
        (Effect::JointElasticity { joint: 1, stiffness_nm_per_rad: 5e3, damping_nm_s_per_rad: 5.0 }, 0.07),
        (Effect::TimeDelay { delay_s: 2e-3 }, 0.05),
        (Effect::PositionSpring { joint, stiffness_nm_per_rad: 0.5, rest_rad: -1.5 }, 0.01),
    ];
    for (effect, bound) in &effects {
        for motion in [Excitation::Multisine, Excitation::SmallFast] {
            let missed = missed(effect, motion, 13.0);
            assert!(missed < *bound, "{effect:?} along {motion:?}: {missed} of its torque is missed");
        }
    }
}
