//! Logs with something in them that the nominal model lacks, and what a diagnosis makes of them.
//!
//! ```text
//! seed → motion, sensors, nominal model, hidden cause → log;   (log, nominal model) → diagnosis;   diagnosis vs cause → judgement
//! ```
//!
//! [`HiddenCase`] draws everything from one seed; [`Judgement`] compares an answer with what was hidden; [`Tally`] counts
//! judgements per cause and strength.
//!
//! ```
//! use tribo_regression::CauseLabel;
//! use tribo_experiments::hidden_effects::{HiddenCase, Kind, Strength, World};
//!
//! let case = HiddenCase::draw(7, Kind::Single(CauseLabel::Coulomb, Strength::Strong), World::Identified)?;
//! assert_eq!(case.hidden.len(), 1);
//! assert!(case.strength > 3.0); // RMS of the hidden torque over the torque noise in the band
//! # Ok::<(), tribo_sim::RecordingError>(())
//! ```

mod calibration;
mod case;
mod chance;
mod claim;
mod drawn_effect;
mod interval;
mod judge;
mod kind;
mod outside;
mod parameter_error;
mod run;
mod scenario;
mod tally;
mod world;

pub use calibration::{Calibrated, NOISE_BAND_HZ};
pub use case::HiddenCase;
pub use interval::wilson95;
pub use judge::Judgement;
pub use kind::{Kind, Strength};
pub use outside::{OUTSIDE_NAMES, Outside};
pub use parameter_error::parameter_errors;
pub use run::{CaseError, CaseFilter, Outcome, judged};
pub use scenario::Scenario;
pub use tally::Tally;
pub use world::{Reality, World};
