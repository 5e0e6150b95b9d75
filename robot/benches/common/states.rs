//! The bare Panda and the thousand states that dynamics libraries are timed on.

use nalgebra::SVector;
use tribo_robot::{Arm, presets};

use crate::reference_stream::ReferenceStream;

/// One state with an acceleration and a torque.
#[derive(Clone, Copy, Debug)]
pub struct State {
    pub q: SVector<f64, 7>,
    pub qd: SVector<f64, 7>,
    pub qdd: SVector<f64, 7>,
    pub tau: SVector<f64, 7>,
}

/// The Panda without rotor inertia.
pub fn bare_panda() -> Arm<7> {
    Arm { rotor_inertia_kg_m2: SVector::zeros(), ..presets::panda() }
}

/// `n` states: q, q̇, q̈ (up to 10 rad/s²), torque, each uniform within the arm's limits.
pub fn states(n: usize) -> Vec<State> {
    let (arm, mut source) = (bare_panda(), ReferenceStream::new(1));
    let limits = &arm.limits;
    let mut vector = |low: SVector<f64, 7>, high: SVector<f64, 7>| {
        let mut x = SVector::<f64, 7>::zeros();
        for i in 0..7 {
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
