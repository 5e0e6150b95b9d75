//! What came and what became of it.

/// Numbers of messages since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Messages that came.
    pub received: u64,
    /// Those that moved the estimator.
    pub used: u64,
    /// Those of other publishers: they lack joints of the arm.
    pub incomplete: u64,
    /// Those whose stamp is not later than that before.
    pub not_later: u64,
    /// Those that cannot be used for another reason.
    pub unusable: u64,
    /// Those that never came, by the stamps of their neighbours.
    pub lost: u64,
    /// Gaps in the stamps after which the estimator began anew.
    pub gaps: u64,
    /// Times that the stamps jumped back, after which the estimator began anew.
    pub restarts: u64,
    /// Samples that the estimator could not use.
    pub faults: u64,
    /// Wrenches that went out.
    pub published: u64,
    /// Wrenches that the network did not take.
    pub unsent: u64,
}
