//! When somebody pushed the arm.

/// When somebody pushed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PushWindow {
    /// The log.
    pub log: usize,
    /// Start (s), in time of the log.
    pub start_s: f64,
    /// End (s).
    pub end_s: f64,
}
