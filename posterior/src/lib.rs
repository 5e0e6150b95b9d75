#![doc = include_str!("../README.md")]
//!
//! ```text
//! y = X θ + e,   θ ~ N(0, s² Λ⁻¹) within families of one scale s each,   e ~ N(0, κ σ²) per joint
//! ```
//!
//! y is the residual of a log against its nominal model in the band, X the filtered columns of all causes; gains make the problem
//! bilinear, links stay bodies by a barrier on their pseudo-inertia. A family is in the model where it makes the log likelier by
//! [`LEAST_NATS`]. The steps and their files are in `diagnose/STEPS.md`.

mod arm_scale;
mod band;
mod baseline;
mod body;
mod columns;
mod distance;
mod extremes;
mod fit;
mod found_arm;
#[cfg(test)]
mod gaussian;
mod joint_columns;
mod joint_term;
mod motion;
mod posture;
mod prior;
mod problem;
mod selection;
mod sign_width;
mod simulated;
mod spd;
mod split;
mod standstill;
mod sticking;
mod tempering;
mod unseen;
pub mod written;

pub use band::{Bands, Deviation, HeldOut};
pub use baseline::{Baselines, PlainFits};
pub use columns::{Columns, PARTS, push_weights};
pub use distance::{MotionSpace, distance};
pub use extremes::extremes;
pub use fit::{Fit, Start, plain_state, posterior};
pub use found_arm::{set_arm, torque_of_changes};
pub use joint_term::{JointTerm, RIPPLES};
pub use motion::Motion;
pub use prior::{ArmScale, CURVE_WIDTHS, Family, PRESLIDING_RAD};
pub use problem::{Place, Problem, State};
pub use selection::{LEAST_NATS, Selection, is_payload, select};
pub use sign_width::sharper_sign;
pub use simulated::soft_friction;
pub use split::THIRDS;
pub use sticking::sticking;
pub use tempering::{correlation_time, kappa, repetition};
pub use unseen::{Unseen, deviations, unknown_variance};
pub use written::ripple;
