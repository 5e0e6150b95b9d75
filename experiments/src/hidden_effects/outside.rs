//! Torques that no cause of the vocabulary describes.

use std::f64::consts::TAU;

use nalgebra::SVector;
use tribo_friction::law::smooth_sign;
use tribo_regression::Nominal;
use tribo_robot::rnea;
use tribo_sim::ExtraTorque;
use tribo_sim::excitation::JointTrajectory;

use super::chance::Chance;

/// Names of all of them.
pub const OUTSIDE_NAMES: [&str; 10] = [
    "quadratic_viscous",
    "position_friction",
    "random_walk",
    "slow_sine",
    "neighbour_velocity",
    "disturbance",
    "cubic_spring",
    "dead_zone",
    "hysteretic_spring",
    "offset_drift",
];

/// Knots of the random walk, one second apart (further on it stands still).
const KNOTS: usize = 128;
/// Step on which hysteresis is followed (s).
const STEP_S: f64 = 2e-3;

/// One torque outside the vocabulary, on one joint, of amplitude `size`:
///
/// ```text
/// quadratic_viscous    a qd|qd|                          position_friction   a cos(q + φ) s
/// random_walk          a w(t), steps of 1 s              slow_sine           a sin(2π f t + φ), f .02–.2 Hz
/// neighbour_velocity   a qd of the next joint            disturbance         a sin(2π f t + φ), f 1–5 Hz
/// cubic_spring         a (q − rest)³                     dead_zone           measured torque is 0 within ±a
/// hysteretic_spring    a × four Jenkins elements         offset_drift        a (1 − exp(−t/T))
/// ```
#[derive(Clone, Debug)]
pub struct Outside {
    /// Which one.
    pub name: &'static str,
    /// Joint.
    pub joint: usize,
    /// Amplitude a, in the unit of the formula.
    pub size: f64,
    /// Frequency (Hz), time constant (s) or rest position (rad), as the formula has it.
    shape: f64,
    phase_rad: f64,
    walk: Vec<f64>,
}

impl Outside {
    pub(super) fn draw(name: &'static str, chance: &mut Chance) -> Self {
        let joint = match name {
            "dead_zone" => chance.pick(&[0, 2, 4, 5, 6]),
            "position_friction" | "quadratic_viscous" => chance.pick(&[0, 1, 2, 3, 4, 5, 6]),
            _ => chance.pick(&[0, 1, 2, 3, 4, 5]),
        };
        let shape = match name {
            "slow_sine" => chance.log_between(0.02, 0.2),
            "disturbance" => chance.between(1.0, 5.0),
            "offset_drift" => chance.between(8.0, 40.0),
            _ => tribo_robot::presets::panda_ready_pose()[joint] + chance.between(-0.1, 0.1),
        };
        let mut level = 0.0;
        let walk = (0..KNOTS)
            .map(|_| {
                level += chance.between(-1.0, 1.0);
                level
            })
            .collect();
        Self { name, joint, size: 1.0, shape, phase_rad: chance.between(0.0, TAU), walk }
    }

    /// The same with another amplitude.
    pub fn sized(&self, size: f64) -> Self {
        Self { size, ..self.clone() }
    }

    /// The torque along a motion.
    pub(super) fn torque<'a>(
        &'a self,
        nominal: &'a Nominal<7>,
        motion: &dyn JointTrajectory<7>,
    ) -> Box<ExtraTorque<'a, 7>> {
        let (j, a, phase) = (self.joint, self.size, self.phase_rad);
        let on = move |tau: f64| {
            let mut torque = SVector::<f64, 7>::zeros();
            torque[j] = tau;
            torque
        };
        let (shape, smoothing) = (self.shape, nominal.smoothing_rad_s);
        match self.name {
            "quadratic_viscous" => Box::new(move |_, _, qd, _| on(a * qd[j] * qd[j].abs())),
            "position_friction" => {
                Box::new(move |_, q, qd, _| on(a * (2.0 * q[j] + phase).cos() * smooth_sign(qd[j], smoothing)))
            }
            "random_walk" => Box::new(move |t, _, _, _| on(a * between(&self.walk, t))),
            "slow_sine" | "disturbance" => Box::new(move |t, _, _, _| on(a * (TAU * shape * t + phase).sin())),
            "neighbour_velocity" => Box::new(move |_, _, qd, _| on(a * qd[j + 1])),
            "cubic_spring" => Box::new(move |_, q, _, _| on(a * (q[j] - shape).powi(3))),
            "dead_zone" => Box::new(move |_, q, qd, qdd| {
                let torque = rnea(&nominal.arm, q, qd, qdd) + nominal.friction.torque(qd, smoothing);
                on(-torque[j].clamp(-a, a))
            }),
            "hysteretic_spring" => {
                let follow = hysteresis(j, motion);
                Box::new(move |t, _, _, _| on(a * between(&follow, t / STEP_S)))
            }
            _ => Box::new(move |t, _, _, _| on(a * (1.0 - (-t / shape).exp()))),
        }
    }
}

/// Linear between the values at 0, 1, 2, …; constant outside.
fn between(values: &[f64], x: f64) -> f64 {
    let x = x.max(0.0);
    let last = values.last().copied().unwrap_or(0.0);
    let at = |k: usize| values.get(k).copied().unwrap_or(last);
    let k = x.floor() as usize;
    at(k) + (at(k + 1) - at(k)) * x.fract()
}

/// Mean of four Jenkins elements (spring in series with a slider) yielding at .05, .12, .25 and .5 rad, every `STEP_S`.
fn hysteresis(joint: usize, motion: &dyn JointTrajectory<7>) -> Vec<f64> {
    let yields = [0.05, 0.12, 0.25, 0.5];
    let mut stretch = [0.0_f64; 4];
    let mut last = motion.at(0.0).q[joint];
    (0..=(motion.duration_s() / STEP_S) as usize)
        .map(|k| {
            let q = motion.at(k as f64 * STEP_S).q[joint];
            for (stretch, limit) in stretch.iter_mut().zip(yields) {
                *stretch = (*stretch + q - last).clamp(-limit, limit);
            }
            last = q;
            stretch.iter().zip(yields).map(|(stretch, limit)| stretch / limit).sum::<f64>() / 4.0
        })
        .collect()
}
