//! Is this computer fast enough for a loop of 1 kHz? The same figures as `tribo bench`, of fewer ticks.
//!
//! `cargo run --release -p tribo-bench --example is_it_fast_enough`

use tribo_bench::{Verdict, tick_times};
use tribo_campaign::TuneConfig;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let tune = TuneConfig::default().validate::<7>()?;
    let times = tick_times(&tune, 30_000, &[])?;
    let verdict = Verdict::of_ticks(&times.tick, tune.trial.dt_s * 1e6);
    println!("30000 ticks in {:.2} s, simulated arm and all", times.wall_s);
    println!("records lost: {}", times.records_lost);
    println!("{:?}: {}", verdict.answer, verdict.because);
    Ok(())
}
