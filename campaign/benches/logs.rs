//! Logs of growing length: `cargo bench -p tribo-campaign --bench logs`.
//!
//! A trial of so many seconds as a 1 kHz log: read from CSV and from Parquet, the wrench estimated on it. Items per second are
//! samples.

use divan::Bencher;
use divan::counter::ItemsCount;
use tribo_campaign::TuneConfig;
use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
use tribo_friction::FrictionModel;
use tribo_logs::{LogTarget, RobotLog, read_log, write_log};
use tribo_trial::{simulate_log, wrench_on_log};

fn main() {
    divan::main();
}

fn log(seconds: usize) -> RobotLog {
    let mut trial = TuneConfig::default().validate::<7>().expect("valid settings").trial;
    trial.reference.duration_s = seconds as f64 - trial.reference.pre_roll_s();
    let filter = WrenchEkf::new(WrenchEkfSettings::default());
    simulate_log(&trial, &FrictionModel::none(), filter, 1).expect("a trial that runs").1
}

#[divan::bench(args = [10, 30, 90], sample_count = 5, sample_size = 1)]
fn wrench(bencher: Bencher, seconds: usize) {
    let log = log(seconds);
    let tune = TuneConfig::default().validate::<7>().expect("valid settings");
    bencher
        .counter(ItemsCount::new(seconds * 1000))
        .bench_local(|| wrench_on_log(&log, &tune.oracle, 5e-3, &mut WrenchEkf::new(WrenchEkfSettings::default())));
}

#[divan::bench(args = [10, 30, 90], sample_count = 5, sample_size = 1)]
fn read_csv(bencher: Bencher, seconds: usize) {
    read(bencher, seconds, "log.csv");
}

#[divan::bench(args = [10, 30, 90], sample_count = 5, sample_size = 1)]
fn read_parquet(bencher: Bencher, seconds: usize) {
    read(bencher, seconds, "log.parquet");
}

fn read(bencher: Bencher, seconds: usize, name: &str) {
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().join(name);
    let target = LogTarget::of_path(&path).expect("a known ending");
    write_log(&path, &log(seconds), target).expect("a disk");
    bencher.counter(ItemsCount::new(seconds * 1000)).bench_local(|| read_log(&path).expect("a log"));
}
