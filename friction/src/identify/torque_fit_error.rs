//! What can be wrong with the data of a fit.

/// Why a joint's friction could not be fitted.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TorqueFitError {
    /// Fewer samples than needed.
    #[error("friction of a joint needs at least {need} samples, got {got}")]
    TooFewSamples {
        /// Samples needed.
        need: usize,
        /// Samples given.
        got: usize,
    },
    /// The joint hardly moved, or in one direction only: the columns cannot be told apart.
    #[error(
        "the joint's motion cannot separate Coulomb friction, viscous friction and offset (condition {condition:.1e})"
    )]
    NotSeparable {
        /// Condition number of the scaled normal matrix.
        condition: f64,
    },
}
