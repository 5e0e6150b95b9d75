//! One suggestion of the strategy `bo`, fit included: `cargo bench -p tribo-bayesopt --bench suggestion`.
//!
//! On the friction-like functions of the peers after so many trials: ten given points, then random ones.

#[allow(dead_code, reason = "shared with tests")]
#[path = "../tests/optimiser/common/friction.rs"]
mod friction;
#[allow(dead_code, reason = "shared with tests")]
#[path = "../tests/optimiser/common/random_source.rs"]
mod random_source;

use divan::Bencher;
use random_source::RandomSource;
use tribo_bayesopt::{Domain, History, Outcome, Settings, suggest};

fn main() {
    divan::main();
}

fn suggestion(bencher: Bencher, value: fn(&[f64]) -> f64, dimension: usize, trials: usize) {
    let mut source = RandomSource::seed(1001);
    let mut history = History::new();
    for _ in 0..trials {
        let u = source.point(dimension);
        let cost = value(&u);
        history.push(u, Outcome::Value(cost));
    }
    let domain = Domain::unit_cube(dimension).expect("a box");
    let settings = Settings::bo(vec![0.0; dimension]);
    bencher.bench_local(|| suggest(&settings, &domain, &history, 1).expect("a suggestion"));
}

#[divan::bench(args = [20, 40, 60, 120], sample_count = 9, sample_size = 1)]
fn fourteen_parameters(bencher: Bencher, trials: usize) {
    suggestion(bencher, friction::fric14, 14, trials);
}

#[divan::bench(args = [20, 40, 60, 120], sample_count = 9, sample_size = 1)]
fn thirty_five_parameters(bencher: Bencher, trials: usize) {
    suggestion(bencher, friction::fric35, 35, trials);
}
