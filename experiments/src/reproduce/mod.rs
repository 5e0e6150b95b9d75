//! Experiments that anyone can rerun, one per paper or question.

mod roveda2022;
mod wrench_pulses;

pub use roveda2022::{CaseConfig, CellResult, Roveda2022, RowSummary, StrategyConfig, summarize};
pub use wrench_pulses::{PushCase, PushRow, PushedTool};
