//! Logs of an arm that follows a prescribed motion.
//!
//! ```text
//! tau = (1 + g) (M q̈ + C q̇ + g(q) + Ir q̈ + friction + effects − Jᵀ [moment; force on the robot] + extra) + noise
//! ```
//!
//! The motion is given and the torque follows by inverse dynamics: no controller, no drift, any rate, hours in seconds.
//! [`record`] makes one log, [`Recorder`] also adds torques that no [`crate::Effect`] describes and records sessions: one
//! cycle every few minutes while the arm keeps working and warms up.
//!
//! ```
//! use tribo_robot::presets;
//! use tribo_sim::excitation::{Envelope, Excitation};
//! use tribo_sim::{Effect, Recording, Truth, record};
//!
//! let payload = Effect::Payload { mass_kg: 0.7, com_m: [0.0, 0.0, 0.05], inertia_kg_m2: [0.0; 6] };
//! let truth = Truth { effects: vec![payload], ..Truth::panda_coulomb_viscous() };
//! let motion = Excitation::Multisine.draw(&Envelope::of(&presets::panda()), 10.0, 1);
//! let log = record(&truth, 0.005, motion.as_ref(), &Recording::default(), 1)?;
//! assert_eq!((log.joints(), log.rows()), (7, 5001));
//! # Ok::<(), tribo_sim::RecordingError>(())
//! ```

mod internal;
mod internal_motion;
mod recorder;
mod settings;
#[cfg(test)]
mod tests;
mod true_torque;
mod velocity_filter;

pub use recorder::{ExtraTorque, Recorder, Session, record};
pub use settings::{Recording, RecordingError};
