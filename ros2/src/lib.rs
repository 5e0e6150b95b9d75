#![doc = include_str!("../README.md")]
//!
//! ```text
//! JointState --joints by name, dt from stamps--> SensorFrame --WrenchEstimator--> wrench --> WrenchStamped, covariance
//!            `--> recording (MCAP)                 counts, ages of the wrenches --> DiagnosticArray, once a second
//! ```
//!
//! A wrench is exerted by the robot on the environment, at the flange, in base axes, SI units. Stamps are nanoseconds since 1970.
//! Leaves out: services, parameters, actions and the node graph of ROS (`ros2 topic` sees the topics, `ros2 node` no node).
//!
//! ```
//! use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
//! use tribo_friction::{Compensator, FrictionModel, VelocitySource};
//! use tribo_logs::JointState;
//! use tribo_robot::{gravity_torque, presets};
//! use tribo_ros2::{ArmJoints, WrenchStream};
//! use tribo_runtime::MeasuredWrench;
//!
//! let (arm, q) = (presets::panda(), presets::panda_ready_pose());
//! let frictionless = Compensator::new(FrictionModel::none(), VelocitySource::Measured);
//! let ekf = WrenchEkf::new(WrenchEkfSettings::default());
//! let names = (1..=7).map(|j| format!("panda_joint{j}")).collect();
//! let mut message = JointState { names, position: q.as_slice().to_vec(), velocity: vec![0.0; 7], ..JointState::default() };
//! message.effort = gravity_torque(&arm, &q).as_slice().to_vec();
//! let mut stream = WrenchStream::new(MeasuredWrench::new(arm, frictionless, ekf), ArmJoints::new(None));
//! for k in 1..1000 {
//!     message.stamp_ns = k * 1_000_000;
//!     if let Some(wrench) = stream.take(&message, None)?.wrench {
//!         assert!(wrench.estimate.wrench_base.force_n.norm() < 1e-6);
//!     }
//! }
//! # Ok::<(), tribo_ros2::Unusable>(())
//! ```

mod ages;
mod arm_joints;
mod counts;
mod health;
mod listen;
mod listen_error;
pub mod message;
mod node;
mod raw;
mod recording;
mod sloped_velocity;
mod stamps;
mod topic_reader;
mod unusable;
mod wrench_stream;

pub use ages::Ages;
pub use arm_joints::ArmJoints;
pub use counts::Counts;
pub use listen::{Heard, ListenSettings, Listened, Update, listen};
pub use listen_error::ListenError;
pub use node::{Node, NodeSettings, TopicNames};
pub use unusable::Unusable;
pub use wrench_stream::{StampedWrench, Taken, WrenchStream};
