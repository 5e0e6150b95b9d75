#![doc = include_str!("../README.md")]
//!
//! ```text
//! tau_f(qd) = Fv qd + Fc sign(qd)                                  Coulomb-viscous, roveda2022 eq. (27)
//! tau_f(qd) = Fv qd + (Fc + dF exp(−|qd/vs|^shape)) sign(qd)        Stribeck, roveda2022 eq. (28)
//! tau_f(qd, T) = tau_pol [α (T − T0) + β] + tau_str [γ (T − T0) + δ]  warm joints, simoni2017 eq. (6): [`thermal`]
//! ```
//!
//! Each law lives in one file of [`law`], answers two questions — its torque with a smooth sign (what a compensator or a
//! regressor uses) and its set-valued form (what the plant solves) — and names its parameters with their units.
//! [`Compensator`] turns a law into a torque from a noisy velocity; [`identify`] finds the parameters from logs.
//!
//! ```
//! use nalgebra::SVector;
//! use tribo_friction::{Compensator, FrictionModel, VelocitySource, law::CoulombViscous};
//!
//! let joint = CoulombViscous { coulomb_nm: 0.6, viscous_nm_s_per_rad: 1.0 };
//! let compensator = Compensator::new(FrictionModel::<7>::uniform(joint.into()), VelocitySource::Hybrid);
//! let standing = SVector::<f64, 7>::zeros();
//! let wanted = SVector::<f64, 7>::repeat(0.05);
//! // The measured velocity says nothing yet; the reference says which way the joint is about to move.
//! assert!(compensator.torque(&standing, &wanted)[0] > 0.6);
//! ```
//!
//! Leaves out: hysteresis with non-local memory (generalised Maxwell slip).

mod band;
mod compensator;
mod effects;
pub mod identify;
pub mod law;
mod model;
mod rest;
pub mod thermal;

pub use band::{BandError, FrictionBand, JointBand};
pub use compensator::{Bristles, Compensation, Compensator, CompensatorInput, VelocitySource};
pub use effects::{BristlePart, Curve, JointEffects, MAX_BRISTLES, MAX_CURVES, MAX_RIPPLES, Ripple};
pub use law::{JointFriction, SetValued};
pub use model::FrictionModel;
pub use rest::{JointRest, RemainingFriction, RestMemory, UNBOUNDED_NM2};
