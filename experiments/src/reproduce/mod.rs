//! Experiments that anyone can rerun, one per paper.

mod roveda2022;
pub mod uhlmann2023;

pub use roveda2022::{CaseConfig, CellResult, Roveda2022, RowSummary, StrategyConfig, summarize};
