//! The tick: sense, estimate, decide, limit, actuate, record.
//!
//! [`ControlLoop::tick`] is one period of the 1 kHz loop. It drives any [`tribo_robot::Plant`] with any
//! [`tribo_robot::WrenchEstimator`], allocates nothing, never panics, and reads no clock: time comes with the sensor
//! frame. What goes wrong is a [`TickFault`], after which the loop sends the safe torque until it is built anew.
//!
//! ```
//! use tribo_control::{ImpedanceSettings, SinusoidReference};
//! use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
//! use tribo_friction::{Compensator, FrictionModel, VelocitySource, law::CoulombViscous};
//! use tribo_robot::{Kinematics, presets};
//! use tribo_runtime::{ControlLoop, LoopSettings};
//! use tribo_sim::{BoxFrictionPlant, Sensors, Truth};
//!
//! let (arm, q) = (presets::panda(), presets::panda_ready_pose());
//! let mut plant = BoxFrictionPlant::new(Truth::panda_coulomb_viscous(), Sensors::default(), q, 1);
//! let none = FrictionModel::uniform(CoulombViscous::default().into());
//! let settings = LoopSettings {
//!     impedance: ImpedanceSettings::default(),
//!     reference: SinusoidReference::fixed(Kinematics::at(&arm, &q).base_from_flange()),
//!     compensator: Compensator::new(none, VelocitySource::Hybrid),
//!     dt_s: 1e-3,
//! };
//! let mut control = ControlLoop::new(arm, q, settings, WrenchEkf::new(WrenchEkfSettings::default()));
//! for _ in 0..100 {
//!     let record = control.tick(&mut plant);
//!     assert!(record.fault.is_none());
//! }
//! ```

mod control_loop;
mod fault;
mod record;

pub use control_loop::{ControlLoop, LoopSettings};
pub use fault::TickFault;
pub use record::TickRecord;
