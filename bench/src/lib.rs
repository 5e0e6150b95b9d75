#![doc = include_str!("../README.md")]
//!
//! What a tick costs (a million of them, one by one), what it is made of, and what surrounds it: dynamics, estimators, a trial, a
//! step of the optimiser. [`real_time`] runs the loop on the clock instead. All readings of clocks: nothing here is reproducible
//! or logged.

mod any_tune;
mod dynamics;
mod estimators;
mod interference;
mod optimiser;
mod real_time;
mod records;
mod report;
mod stopwatch;
mod tick;
mod trial;
mod verdict;

pub use any_tune::{any_bench, any_real_time};
pub use dynamics::DynamicsTimes;
pub use estimators::EstimatorTimes;
pub use interference::Interference;
pub use optimiser::OptimiserTimes;
pub use real_time::{AfterFault, RealTimeReport, RealTimeSettings, Stall, real_time};
pub use report::{BenchReport, BenchSettings, bench};
pub use tick::{TickTimes, tick_times};
pub use trial::TrialTimes;
pub use tribo_runtime::OverrunPolicy;
pub use verdict::{Fitness, Percentiles, Rights, Verdict};

use hdrhistogram::CreationError;
use tribo_bayesopt::BayesoptError;
use tribo_runtime::TickFault;
use tribo_trial::EstimatorError;

/// Why there is no figure.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// A histogram that cannot be.
    #[error(transparent)]
    Histogram(#[from] CreationError),
    /// An estimator that cannot be.
    #[error(transparent)]
    Estimator(#[from] EstimatorError),
    /// The optimiser had no answer.
    #[error(transparent)]
    Optimiser(#[from] BayesoptError),
    /// The loop stopped by itself.
    #[error("the loop stopped: {0}")]
    Loop(#[from] TickFault),
    /// A thread died.
    #[error("a thread of the measurement has died")]
    Thread,
}
