#![doc = include_str!("../README.md")]
//!
//! [`ControlLoop::tick`] is one period of the 1 kHz loop. It drives any [`tribo_robot::Plant`] with any
//! [`tribo_robot::WrenchEstimator`], allocates nothing, never panics, and reads no clock: time comes with the sensor
//! frame. What goes wrong is a [`TickFault`], after which the loop sends the safe torque until it is built anew.
//! [`RealTimeLoop`] puts it on a [`Clock`]: deadlines, what happens when one is missed, histograms of the times, records to
//! another thread through a ring.
//!
//! ```
//! use tribo_control::{GuardSettings, ImpedanceSettings, SinusoidReference};
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
//!     guard: Some(GuardSettings::default()),
//!     dt_s: 1e-3,
//! };
//! let mut control = ControlLoop::new(arm, q, settings, WrenchEkf::new(WrenchEkfSettings::default()));
//! for _ in 0..100 {
//!     let record = control.tick(&mut plant);
//!     assert!(record.fault.is_none());
//! }
//! ```

mod clock;
mod control_loop;
mod fault;
mod frame_watch;
mod latency;
mod measured_wrench;
mod overrun;
mod process_image;
mod real_time_loop;
mod record;
mod record_ring;
mod thread_rights;

pub use clock::{Clock, MonotonicClock};
pub use control_loop::{ControlLoop, LoopSettings};
pub use fault::TickFault;
pub use latency::LatencyHistogram;
pub use measured_wrench::{LONGEST_GAP_PERIODS, MeasuredWrench, SETTLE_S};
pub use overrun::{Delivery, OverrunGuard, OverrunPolicy};
pub use process_image::ProcessImage;
pub use real_time_loop::{LoopTiming, RealTimeLoop};
pub use record::TickRecord;
pub use record_ring::{RecordDrain, RecordSink, record_ring};
pub use thread_rights::{Refusal, allowed_cores, lock_memory, run_on_cores, take_fifo_priority};
