#![doc = include_str!("../README.md")]
//!
//! [`diagnose()`] holds logs against a [`tribo_regression::Nominal`] model and answers with a [`Diagnosis`]: verdict, findings with intervals and rivals,
//! the next experiment (steps and files: `STEPS.md` of this crate). It asks all causes of [`tribo_regression::CauseLabel`] what they explain of the
//! residual (`tribo-regression`), one by one or as families with a posterior (`tribo-posterior`).
//!
//! ```
//! use tribo_diagnose::{DiagnoseSettings, diagnose};
//! use tribo_regression::{CauseLabel, Nominal};
//! use tribo_robot::presets;
//! use tribo_sim::excitation::{Envelope, Excitation};
//! use tribo_sim::{Effect, Recording, TorqueSide, Truth, record};
//! let known = Truth::panda_coulomb_viscous();
//! let payload = Effect::Payload { mass_kg: 0.5, com_m: [0.0, 0.0, 0.06], inertia_kg_m2: [0.0; 6] };
//! let truth = Truth { effects: vec![payload], ..known.clone() };
//! let motion = Excitation::Multisine.draw(&Envelope::of(&presets::panda()), 20.0, 1);
//! let log = record(&truth, 0.005, motion.as_ref(), &Recording::default(), 1)?;
//! let nominal = Nominal { smoothing_rad_s: 0.005, ..Nominal::new(known.arm, known.friction, TorqueSide::Motor) };
//! let diagnosis = diagnose(&[log], &nominal, &[], &DiagnoseSettings::default(), &|_, _| true)?;
//! assert_eq!(diagnosis.findings[0].label, CauseLabel::Payload);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Leaves out: arms with other than six or seven revolute joints; causes that are not in [`tribo_regression::CauseLabel`], which it calls unknown.

mod cause_by_cause;
mod conclusion;
mod confusable;
mod diagnosable;
mod diagnosis;
mod engine;
mod evaluated;
mod families;
mod finding;
mod held_out;
mod judged;
mod next_experiment;
mod parameters;
mod plots;
mod pruning;
pub mod recognise;
mod remarks;
pub mod report;
mod rivals;
mod search;
mod settings;
mod significance;
mod stamps;
mod torque_sides;
mod validation;

pub use diagnosable::{Diagnosable, diagnose, diagnose_with_reference};
pub use diagnosis::{
    Alternative, CrossJointPattern, Diagnosis, Finding, JointMisfit, Parameter, Plot, Rejected, Series, Unseen,
    Validation, Verdict,
};
pub use next_experiment::NextExperiment;
pub use settings::DiagnoseSettings;
