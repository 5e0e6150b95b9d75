//! Rigid-body algorithms, one call: `cargo bench -p tribo-robot --bench dynamics`.
//!
//! The thousand states of the peers (bare Panda), and with six joints (UR10e) states drawn in the same way, to see the growth. On a
//! computer that does other things too, the column `fastest` is the one to compare.

mod common {
    pub mod states;
}
#[allow(dead_code, reason = "of the stream only uniform numbers are needed")]
#[path = "../../residual/tests/estimators/common/reference_stream.rs"]
mod reference_stream;

use std::cell::Cell;
use std::hint::black_box;

use common::states::{State, bare_panda, states, states_of};
use divan::Bencher;
use tribo_robot::{
    Arm, ControlTerms, Kinematics, bias_torque, forward_dynamics, gravity_torque, inverse_dynamics_regressor,
    mass_matrix, presets, rnea,
};

fn main() {
    divan::main();
}

/// Times `call` on one state after the other.
fn each<const N: usize, R>(bencher: Bencher, states: &[State<N>], call: impl Fn(&State<N>) -> R + Sync) {
    let next = Cell::new(0);
    let mut input = || {
        let k = next.replace((next.get() + 1) % states.len());
        states[k]
    };
    bencher.with_inputs(&mut input).bench_local_refs(|state| call(black_box(state)));
}

macro_rules! algorithms {
    ($module:ident, $joints:literal, $arm:expr, $states:expr) => {
        mod $module {
            use super::*;

            fn rig() -> (Arm<$joints>, Vec<State<$joints>>) {
                ($arm, $states)
            }

            #[divan::bench(sample_count = 500, sample_size = 10)]
            fn rnea(bencher: Bencher) {
                let (arm, states) = rig();
                each(bencher, &states, |s| super::rnea(&arm, &s.q, &s.qd, &s.qdd));
            }

            #[divan::bench(sample_count = 500, sample_size = 10)]
            fn crba(bencher: Bencher) {
                let (arm, states) = rig();
                each(bencher, &states, |s| mass_matrix(&arm, &s.q));
            }

            #[divan::bench(sample_count = 500, sample_size = 10)]
            fn aba(bencher: Bencher) {
                let (arm, states) = rig();
                each(bencher, &states, |s| forward_dynamics(&arm, &s.q, &s.qd, &s.tau));
            }

            #[divan::bench(sample_count = 500, sample_size = 10)]
            fn bias(bencher: Bencher) {
                let (arm, states) = rig();
                each(bencher, &states, |s| bias_torque(&arm, &s.q, &s.qd));
            }

            #[divan::bench(sample_count = 500, sample_size = 10)]
            fn gravity(bencher: Bencher) {
                let (arm, states) = rig();
                each(bencher, &states, |s| gravity_torque(&arm, &s.q));
            }

            #[divan::bench(sample_count = 500, sample_size = 10)]
            fn pose_and_jacobian(bencher: Bencher) {
                let (arm, states) = rig();
                each(bencher, &states, |s| {
                    let kinematics = Kinematics::at(&arm, &s.q);
                    (kinematics.base_from_flange(), kinematics.jacobian())
                });
            }

            #[divan::bench(sample_count = 500, sample_size = 10)]
            fn pose_jacobian_and_drift(bencher: Bencher) {
                let (arm, states) = rig();
                each(bencher, &states, |s| {
                    let kinematics = Kinematics::at(&arm, &s.q);
                    (kinematics.base_from_flange(), kinematics.jacobian(), kinematics.jdot_qd(&s.qd))
                });
            }

            #[divan::bench(sample_count = 500, sample_size = 10)]
            fn control_terms(bencher: Bencher) {
                let (arm, states) = rig();
                each(bencher, &states, |s| ControlTerms::at(&arm, &s.q, &s.qd));
            }

            #[divan::bench(sample_count = 500, sample_size = 10)]
            fn regressor(bencher: Bencher) {
                let (arm, states) = rig();
                each(bencher, &states, |s| inverse_dynamics_regressor(&arm, &s.q, &s.qd, &s.qdd));
            }
        }
    };
}

algorithms!(seven_joints, 7, bare_panda(), states(1000));
algorithms!(six_joints, 6, presets::ur10e(), states_of(&presets::ur10e(), 1000));
