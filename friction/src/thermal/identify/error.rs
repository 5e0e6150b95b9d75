//! Why logs give no thermal model.

use thiserror::Error;

use crate::thermal::ThermalError;

/// Why logs give no thermal model.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ThermalFitError {
    /// A setting or a fitted number lies outside its range.
    #[error(transparent)]
    OutOfRange(#[from] ThermalError),
    /// A number of a session is not finite, or its times do not grow.
    #[error("session {session}, sample {sample}: {problem}")]
    BadSample {
        /// The session, from 0.
        session: usize,
        /// The sample, from 0.
        sample: usize,
        /// What is wrong.
        problem: &'static str,
    },
    /// Too little sliding.
    #[error("{got} samples above {threshold_rad_s} rad/s; {need} are needed")]
    TooFewSamples {
        /// Samples that slide.
        got: usize,
        /// Fewest.
        need: usize,
        /// Speed from which a sample counts (rad/s).
        threshold_rad_s: f64,
    },
    /// All rooms equally warm and no capacity given: α/s, γ/s, K/s, C/s fit for any s.
    #[error(
        "the unit of temperature is undetermined: log sessions in rooms that differ by {need_k} K and more (they differ \
         by {got_k:.1} K), or state the joint's heat capacity"
    )]
    ScaleUnknown {
        /// Largest difference between two rooms (K).
        got_k: f64,
        /// Least that is needed (K).
        need_k: f64,
    },
    /// A parameter that the data hardly see.
    #[error("{parameter} is undetermined: standard deviation {sd:.2e}, at most {allowed:.2e} is accepted; {remedy}")]
    Undetermined {
        /// The parameter.
        parameter: &'static str,
        /// Its standard deviation (of its logarithm for K and C).
        sd: f64,
        /// Largest that is accepted.
        allowed: f64,
        /// What would help.
        remedy: &'static str,
    },
    /// The best value lies at the end of its range.
    #[error("{parameter} runs to the end of its range, {value:.3e}: the model does not describe these logs")]
    AtBound {
        /// The parameter.
        parameter: &'static str,
        /// The end of its range.
        value: f64,
    },
}
