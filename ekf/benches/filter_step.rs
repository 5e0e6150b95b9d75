//! One step of the wrench filter on an arm that sways: `cargo bench -p tribo-ekf --bench filter_step`.

#[allow(dead_code, reason = "of the prescribed arm only its samples are needed")]
#[path = "../../residual/tests/estimators/common/prescribed.rs"]
mod prescribed;

use divan::Bencher;
use prescribed::{Sample, samples, sway};
use tribo_ekf::{FrictionAwareEkf, WrenchEkf, WrenchEkfSettings};
use tribo_friction::law::CoulombViscous;
use tribo_friction::{FrictionBand, FrictionModel, JointBand};
use tribo_robot::{Wrench, WrenchEstimator};

/// Steps of a second; divan shows the time of all, and per step as items.
const STEPS: usize = 1000;

fn main() {
    divan::main();
}

fn pushed() -> Vec<Sample> {
    let friction = FrictionModel::uniform(CoulombViscous { coulomb_nm: 0.5, viscous_nm_s_per_rad: 0.8 }.into());
    samples(sway, &|_| Wrench::from_force_moment(&[5.0, -3.0, 8.0, 0.2, 0.1, -0.3]), &friction, STEPS)
}

fn steps<E: WrenchEstimator<7>>(bencher: Bencher, mut estimator: E) {
    let samples = pushed();
    bencher.counter(divan::counter::ItemsCount::new(STEPS)).bench_local(|| {
        estimator.reset(&samples[0].frame, &samples[0].terms);
        samples[1..].iter().map(|sample| estimator.step(&sample.input()).wrench_base.force_n.x).sum::<f64>()
    });
}

#[divan::bench]
fn wrench_ekf_1000_steps(bencher: Bencher) {
    steps(bencher, WrenchEkf::new(WrenchEkfSettings::default()));
}

#[divan::bench]
fn friction_aware_ekf_1000_steps(bencher: Bencher) {
    let band = FrictionBand::new([JointBand::coulomb_viscous(0.5, 0.8, 3e-3, 0.1); 7]).expect("a valid band");
    steps(bencher, FrictionAwareEkf::new(WrenchEkfSettings::default(), band, 1.0));
}
