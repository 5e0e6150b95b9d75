//! Wrench from double encoders: the identification and the circle of uhlmann2023, on a simulated arm.

mod cell;
mod config;
mod run;

pub use cell::Measurements;
pub use config::{Uhlmann2023, Variant};
pub use run::{Circle, VariantResult, VariantSummary, summarize};
