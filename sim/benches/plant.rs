//! One control period of the simulated arm: `cargo bench -p tribo-sim --bench plant`.
//!
//! The arm is held against gravity and shaken, so that joints stick and slip.

use divan::Bencher;
use divan::counter::ItemsCount;
use nalgebra::SVector;
use tribo_robot::{Plant, gravity_torque, presets};
use tribo_sim::{BoxFrictionPlant, DEFAULT_SUB_STEPS, Sensors, Truth, TypicalFriction};

/// Periods per measurement; divan shows the time of all, and the items per second are periods.
const PERIODS: usize = 1000;

fn main() {
    divan::main();
}

fn periods<const N: usize>(bencher: Bencher, truth: Truth<N>, start: SVector<f64, N>, sub_steps: usize) {
    let held = gravity_torque(&truth.arm, &start);
    let plant = BoxFrictionPlant::new(truth, Sensors::default(), start, 1).with_sub_steps(sub_steps);
    bencher.counter(ItemsCount::new(PERIODS)).with_inputs(|| plant.clone()).bench_local_values(|mut plant| {
        for k in 0..PERIODS {
            let shake = SVector::from_fn(|j, _| 3.0 * (0.02 * k as f64 + j as f64).sin());
            plant.actuate(&(held + shake));
        }
        plant
    });
}

#[divan::bench(args = [1, 2, 5, 10, 20])]
fn sub_steps(bencher: Bencher, sub_steps: usize) {
    periods(bencher, Truth::panda_coulomb_viscous(), presets::panda_ready_pose(), sub_steps);
}

#[divan::bench(args = ["frictionless", "coulomb_viscous", "stribeck", "lugre", "gaz"])]
fn truth(bencher: Bencher, name: &str) {
    let truth = match name {
        "frictionless" => Truth::panda_frictionless(),
        "stribeck" => Truth::panda_stribeck(),
        "lugre" => Truth::panda_lugre(),
        "gaz" => Truth::panda_gaz(),
        _ => Truth::panda_coulomb_viscous(),
    };
    periods(bencher, truth, presets::panda_ready_pose(), DEFAULT_SUB_STEPS);
}

#[divan::bench]
fn six_joints(bencher: Bencher) {
    let truth = Truth::new(presets::ur10e(), TypicalFriction::ur10e().coulomb_viscous());
    let start = SVector::from([0.0, -1.57, 1.57, -1.57, -1.57, 0.0]);
    periods(bencher, truth, start, DEFAULT_SUB_STEPS);
}
