#![doc = include_str!("../README.md")]
//!
//! ```text
//! M(q) q̈ + C(q, q̇) q̇ + g(q) + Ir q̈ + tau_f + Jᵀ h = tau_motor,     tau_f ∈ friction(q̇)
//! ```
//!
//! [`BoxFrictionPlant`] steps this at velocity level with true stick (Moreau's scheme): no regularised sign, stable at any
//! step length. [`Truth`] says which arm and which friction; [`Sensors`] what a controller gets to see of it;
//! [`WrenchPulses`] who pushes the tool. [`Effect`] lists every cause that can be hidden in a truth.
//!
//! The other way round, [`record`] takes a motion of [`excitation`] as given and returns the log that a real arm would
//! leave, by inverse dynamics: logs for diagnosis, without a controller. [`QuasiStaticArm`] goes from pose to pose on
//! gears that yield, with an encoder on either side of each.
//!
//! ```
//! use tribo_robot::{Plant, presets};
//! use tribo_sim::{BoxFrictionPlant, Sensors, Truth};
//!
//! let truth = Truth::panda_coulomb_viscous();
//! let mut plant = BoxFrictionPlant::new(truth, Sensors::default(), presets::panda_ready_pose(), 1);
//! let gravity = tribo_robot::gravity_torque(&presets::panda(), plant.q());
//! plant.actuate(&gravity);
//! assert_eq!(plant.qd().amax(), 0.0); // friction holds the arm exactly still
//! ```

mod contact;
mod delay_line;
mod effect;
mod effect_check;
pub mod excitation;
mod flexible_joints;
mod friction_map;
mod gap;
mod hidden;
mod not_simulated;
mod oscillator;
mod plant;
mod plant_effects;
mod projected_gauss_seidel;
mod quasi_static;
mod recording;
mod sensors;
mod soft_friction;
mod truth;
mod typical_friction;
mod warm_joint;
mod warm_up;

pub use contact::{Pulse, WrenchPulses};
pub use effect::Effect;
pub use effect_check::EffectError;
pub use not_simulated::not_simulated;
pub use oscillator::oscillator_step;
pub use plant::{BoxFrictionPlant, DEFAULT_SUB_STEPS};
pub use quasi_static::{QuasiStaticArm, Transmission};
pub use recording::{ExtraTorque, Recorder, Recording, RecordingError, Session, record};
pub use sensors::Sensors;
pub use soft_friction::{SOFT_FRICTION_LEAD_S, SoftFriction};
pub use truth::{DryFriction, TorqueSide, Truth, panda_gaz_joints};
pub use typical_friction::{AnyTypicalFriction, TypicalFriction};
pub use warm_joint::{JointWarmth, WarmJoint};
pub use warm_up::WarmUp;
