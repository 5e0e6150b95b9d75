//! What can go wrong.

use crate::ResidualError;

/// Why there is no diagnosis.
#[derive(Debug, thiserror::Error)]
pub enum DiagnoseError {
    /// No log was given.
    #[error("no log to diagnose")]
    NoLog,
    /// A log does not fit the arm.
    #[error("log {log} has {got} joints, the model {expected}")]
    JointCount {
        /// Index of the log.
        log: usize,
        /// Its joints.
        got: usize,
        /// Joints of the model.
        expected: usize,
    },
    /// The signal chain refused a log.
    #[error(transparent)]
    Residual(#[from] ResidualError),
    /// Too little is left after filtering.
    #[error("{got} samples are left after filtering, a diagnosis needs {need}: the log is too short for its band")]
    TooShort {
        /// Samples left.
        got: usize,
        /// Samples needed.
        need: usize,
    },
    /// The caller stopped it.
    #[error("stopped")]
    Cancelled,
}
