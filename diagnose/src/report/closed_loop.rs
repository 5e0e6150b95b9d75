//! What the findings are worth in the loop.

/// A closed loop on a plant that obeys the extended model; the controller believes the nominal, then the extended one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosedLoop {
    /// Cost J before and after [N + Nm].
    pub cost: [f64; 2],
    /// RMS position error before and after (mm).
    pub tracking_rms_mm: [f64; 2],
}
