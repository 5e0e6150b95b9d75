//! Benchmarks of any robot.

use tribo_campaign::AnyTune;

use crate::{BenchError, BenchReport, BenchSettings, RealTimeReport, RealTimeSettings, bench, real_time};

/// [`bench()`].
///
/// # Errors
/// Settings that the estimator cannot work with, or a loop that stops by itself.
pub fn any_bench(tune: &AnyTune, settings: BenchSettings, stage: impl FnMut(&str)) -> Result<BenchReport, BenchError> {
    match tune {
        AnyTune::Six(tune) => bench(tune, settings, stage),
        AnyTune::Seven(tune) => bench(tune, settings, stage),
    }
}

/// [`real_time`].
///
/// # Errors
/// Settings that the estimator cannot work with.
pub fn any_real_time(tune: &AnyTune, settings: &RealTimeSettings) -> Result<RealTimeReport, BenchError> {
    match tune {
        AnyTune::Six(tune) => real_time(tune, settings),
        AnyTune::Seven(tune) => real_time(tune, settings),
    }
}
