//! Why a fit to estimated wrenches is not to be had.

/// Why friction could not be identified.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum GlsError {
    /// Fewer samples than needed.
    #[error("friction identification needs at least {need} samples of free motion, got {got}")]
    TooFewSamples {
        /// Samples needed.
        need: usize,
        /// Samples given.
        got: usize,
    },
    /// A sample holds NaN or infinity.
    #[error("sample {index} of the identification log is not finite")]
    NotFinite {
        /// Index of the first such sample, of all logs.
        index: usize,
    },
}
