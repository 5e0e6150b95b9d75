//! The bare Panda and the thousand states that dynamics libraries are timed on.

use nalgebra::SVector;
use tribo_robot::{Arm, presets};

use crate::reference_stream::ReferenceStream;

/// One state with an acceleration and a torque.
#[derive(Clone, Copy, Debug)]
pub struct State<const N: usize> {
    pub q: SVector<f64, N>,
    pub qd: SVector<f64, N>,
    pub qdd: SVector<f64, N>,
    pub tau: SVector<f64, N>,
}

/// The Panda without rotor inertia.
pub fn bare_panda() -> Arm<7> {
    Arm { rotor_inertia_kg_m2: SVector::zeros(), ..presets::panda() }
}

/// `n` states of the Panda.
pub fn states(n: usize) -> Vec<State<7>> {
    states_of(&bare_panda(), n)
}

/// `n` states: q, q̇, q̈ (up to 10 rad/s²), torque, each uniform within the arm's limits.
pub fn states_of<const N: usize>(arm: &Arm<N>, n: usize) -> Vec<State<N>> {
    let (limits, mut source) = (&arm.limits, ReferenceStream::new(1));
    let mut vector = |low: SVector<f64, N>, high: SVector<f64, N>| {
        let mut x = SVector::<f64, N>::zeros();
        for i in 0..N {
            x[i] = source.range(low[i], high[i]);
        }
        x
    };
    let (speed, acceleration, torque) = (limits.qd_max_rad_s, SVector::repeat(10.0), limits.tau_max_nm);
    let mut draw = || State {
        q: vector(limits.q_min_rad, limits.q_max_rad),
        qd: vector(-speed, speed),
        qdd: vector(-acceleration, acceleration),
        tau: vector(-torque, torque),
    };
    (0..n).map(|_| draw()).collect()
}
