//! Experiments that anyone can rerun, one per paper or question.

mod error;
mod linderoth2013;
mod overcompensation;
mod quantity;
mod roveda2022;
mod seeded;
pub mod shipped;
mod thermal;
pub mod uhlmann2023;
mod wrench_pulses;

pub use error::ExperimentError;
pub use linderoth2013::{AssemblyTrace, Linderoth2013};
pub use overcompensation::{OverCompensation, ScaleRow};
pub use quantity::{Quantity, QuantitySummary, SeedRun, summarize_quantities};
pub use roveda2022::{CaseConfig, CellResult, Roveda2022, RowSummary, StrategyConfig, summarize};
pub use seeded::SeededExperiment;
pub use thermal::{DutyCycleStudy, ObserverTrace, PolishingTrace, Simoni2017, Simoni2019, Simoni2019Trace, Table4Row};
pub use wrench_pulses::{PushCase, PushRow, PushedTool, Reading};
