//! Experiments that anyone can rerun, one per paper.

mod quantity;
mod roveda2022;
mod seeded;
mod thermal;

pub use quantity::{Quantity, QuantitySummary, SeedRun, summarize_quantities};
pub use roveda2022::{CaseConfig, CellResult, Roveda2022, RowSummary, StrategyConfig, summarize};
pub use seeded::SeededExperiment;
pub use thermal::{
    DutyCycleStudy, ObserverTrace, PolishingTrace, Simoni2017, Simoni2019, Simoni2019Trace, Table4Row,
    ThermalExperimentError,
};
