//! Time of a whole trial.

use std::time::Instant;

use serde::Serialize;

use super::BenchError;
use tribo_campaign::{ValidTune, run_numbered};

/// Time of a trial of the tuning campaign: loop, plant, cost and log, one thread.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TrialTimes {
    /// Time that it takes (s).
    pub trial_s: f64,
    /// Time that it lasts on the robot, over the time that it takes.
    pub realtime_factor: f64,
}

impl TrialTimes {
    /// The median of `repeats` uncompensated trials.
    ///
    /// # Errors
    /// An estimator that cannot be.
    pub fn of<const N: usize>(tune: &ValidTune<N>, repeats: usize) -> Result<Self, BenchError> {
        let mut times = Vec::with_capacity(repeats);
        for _ in 0..repeats.max(1) {
            let started = Instant::now();
            std::hint::black_box(run_numbered(tune, 0, &tune.space.zero())?);
            times.push(started.elapsed().as_secs_f64());
        }
        times.sort_by(f64::total_cmp);
        let trial_s = times[times.len() / 2];
        Ok(Self { trial_s, realtime_factor: tune.trial.reference.total_s() / trial_s })
    }
}
