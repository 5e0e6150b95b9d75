//! One cell of a study: the unit that is computed, written and lost as a whole.

/// What a cell computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// The costs that the campaigns beside it are compared with.
    References,
    /// A campaign of the strategy of this number.
    Campaign(usize),
}

/// A place in the grid, by index into its axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// Case.
    pub case: usize,
    /// Estimator.
    pub estimator: usize,
    /// Pose.
    pub pose: usize,
    /// Seed.
    pub seed: u64,
    /// What is computed.
    pub work: Work,
}
