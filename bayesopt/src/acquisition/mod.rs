//! Acquisition functions: how much a new trial promises.

mod acquisition_function;
mod ei;
mod log_ei;
mod normal;
mod sum_log_ei;

pub use acquisition_function::{AcquisitionFunction, OfFinished, OneOutput};
pub use ei::expected_improvement;
pub use log_ei::log_expected_improvement;
pub use normal::{log_normal_cdf, normal_cdf, normal_pdf};
pub use sum_log_ei::{Part, SumLogEi};

use serde::{Deserialize, Serialize};

/// Which acquisition is maximised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Acquisition {
    /// Expected improvement; underflows to 0 far from the incumbent.
    Ei,
    /// Its logarithm, finite everywhere.
    LogEi,
}

/// An acquisition value with its slopes in the posterior mean and deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AcquisitionSlope {
    /// The acquisition; larger is better.
    pub value: f64,
    /// ∂value/∂mean.
    pub d_mean: f64,
    /// ∂value/∂sd.
    pub d_sd: f64,
}

impl Acquisition {
    /// The acquisition at posterior (`mean`, `sd` > 0) over the incumbent target `best`; minimisation.
    pub fn evaluate(self, mean: f64, sd: f64, best: f64) -> AcquisitionSlope {
        match self {
            Self::Ei => expected_improvement(mean, sd, best),
            Self::LogEi => log_expected_improvement(mean, sd, best),
        }
    }
}

/// The acquisition of one suggestion: `a(mean, sd_factor · sd)` over the incumbent target `best`.
///
/// A posterior at the most probable hyper-parameters is surer of itself than one that averages over them, the more so the
/// more coordinates there are; `sd_factor > 1` makes up for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criterion {
    /// What is maximised.
    pub acquisition: Acquisition,
    /// Target of the incumbent.
    pub best: f64,
    /// Factor on the posterior deviation, > 0.
    pub sd_factor: f64,
}

impl Criterion {
    /// The acquisition and its slopes at the posterior (`mean`, `sd`).
    pub fn evaluate(&self, mean: f64, sd: f64) -> AcquisitionSlope {
        let at = self.acquisition.evaluate(mean, self.sd_factor * sd, self.best);
        AcquisitionSlope { d_sd: self.sd_factor * at.d_sd, ..at }
    }
}
