//! What the caller of a diagnosis chooses.

/// What the caller chooses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DiagnoseSettings {
    /// Seed of flips and bootstrap.
    pub seed: u64,
    /// Band of the residual (Hz); `None` chooses it from the noise of the log.
    pub band_hz: Option<f64>,
}
