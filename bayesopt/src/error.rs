//! Every way in which this crate refuses to answer.

use thiserror::Error;

/// Why a domain, a history, a model or a suggestion could not be made; the data is in the variant.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BayesoptError {
    /// A domain needs at least one coordinate.
    #[error("the domain has no coordinates")]
    EmptyDomain,
    /// Names, lower and upper bounds must have one length.
    #[error("the domain has {names} names, {lower} lower and {upper} upper bounds")]
    BoundCount {
        /// Number of names given.
        names: usize,
        /// Number of lower bounds given.
        lower: usize,
        /// Number of upper bounds given.
        upper: usize,
    },
    /// A bound must be finite and `lower < upper`, with a finite width.
    #[error("coordinate {name}: need finite lower < upper, got [{lower}, {upper}]")]
    BadBounds {
        /// Name of the coordinate.
        name: String,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
    /// Two coordinates carry one name.
    #[error("coordinate name {name} is used twice")]
    DuplicateName {
        /// The repeated name.
        name: String,
    },
    /// A point has the wrong number of coordinates.
    #[error("a point has {got} coordinates, the domain has {need}")]
    DimensionMismatch {
        /// Coordinates of the domain.
        need: usize,
        /// Coordinates of the point.
        got: usize,
    },
    /// A coordinate of a point is NaN or infinite.
    #[error("coordinate {index} of a point is {value}")]
    NonFiniteCoordinate {
        /// Index of the coordinate.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A setting is outside its allowed range.
    #[error("setting {field} = {value}: allowed is {allowed}")]
    BadSetting {
        /// Field of the settings.
        field: &'static str,
        /// What was given.
        value: f64,
        /// The allowed range, in words.
        allowed: &'static str,
    },
    /// The Gaussian process needs more samples.
    #[error("a Gaussian process needs {need} samples, got {got}")]
    TooFewSamples {
        /// Fewest samples that can be used.
        need: usize,
        /// Samples at hand.
        got: usize,
    },
    /// Cholesky met a pivot <= 0 and the largest jitter of the policy did not help.
    #[error("pivot {index} of the kernel matrix is not positive, even with the largest jitter")]
    NonPositivePivot {
        /// Index of the pivot.
        index: usize,
    },
    /// A target handed to the Gaussian process is NaN or infinite.
    #[error("target {index} is {value}")]
    NonFiniteTarget {
        /// Index of the target.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A trial was told that was never asked for, or that has already an outcome.
    #[error("trial {trial} is not pending")]
    NotPending {
        /// The trial.
        trial: usize,
    },
}
