//! Time of the rigid-body algorithms.

use std::hint::black_box;

use nalgebra::SVector;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::Serialize;
use tribo_robot::{Arm, ControlTerms, Kinematics, bias_torque, forward_dynamics, mass_matrix, rnea};

use super::stopwatch::per_call_ns;

/// States per pass, uniform within the limits of the arm.
const STATES: usize = 1000;
/// Accelerations are drawn up to this (rad/s²).
const ACCELERATION_RAD_S2: f64 = 10.0;

/// Time per call (ns) of the arm's algorithms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DynamicsTimes {
    /// Inverse dynamics.
    pub rnea_ns: f64,
    /// Mass matrix.
    pub crba_ns: f64,
    /// Forward dynamics.
    pub aba_ns: f64,
    /// Bias torque.
    pub bias_ns: f64,
    /// Pose, Jacobian and its drift.
    pub jacobian_ns: f64,
    /// All that a tick needs at one state.
    pub control_terms_ns: f64,
}

/// q (rad), q̇ (rad/s), q̈ (rad/s²) and torque (Nm).
type State<const N: usize> = [SVector<f64, N>; 4];

impl DynamicsTimes {
    /// Measures them.
    pub fn of<const N: usize>(arm: &Arm<N>) -> Self {
        let states = states(arm);
        Self {
            rnea_ns: time_ns(&states, |[q, qd, qdd, _]| rnea(arm, q, qd, qdd)),
            crba_ns: time_ns(&states, |[q, ..]| mass_matrix(arm, q)),
            aba_ns: time_ns(&states, |[q, qd, _, tau]| forward_dynamics(arm, q, qd, tau)),
            bias_ns: time_ns(&states, |[q, qd, ..]| bias_torque(arm, q, qd)),
            jacobian_ns: time_ns(&states, |[q, qd, ..]| {
                let kinematics = Kinematics::at(arm, q);
                (kinematics.base_from_flange(), kinematics.jacobian(), kinematics.jdot_qd(qd))
            }),
            control_terms_ns: time_ns(&states, |[q, qd, ..]| ControlTerms::at(arm, q, qd)),
        }
    }
}

fn states<const N: usize>(arm: &Arm<N>) -> Vec<State<N>> {
    let mut random = Pcg64::seed_from_u64(1);
    let mut within = |low: SVector<f64, N>, high: SVector<f64, N>| {
        SVector::<f64, N>::from_fn(|j, _| random.random_range(low[j]..=high[j]))
    };
    let limits = &arm.limits;
    let [speed, acceleration, torque] = [limits.qd_max_rad_s, SVector::repeat(ACCELERATION_RAD_S2), limits.tau_max_nm];
    let mut draw = |_| {
        let q = within(limits.q_min_rad, limits.q_max_rad);
        [q, within(-speed, speed), within(-acceleration, acceleration), within(-torque, torque)]
    };
    (0..STATES).map(&mut draw).collect()
}

fn time_ns<const N: usize, R>(states: &[State<N>], call: impl Fn(&State<N>) -> R) -> f64 {
    per_call_ns(states.len(), || {
        for state in states {
            black_box(call(black_box(state)));
        }
    })
}
