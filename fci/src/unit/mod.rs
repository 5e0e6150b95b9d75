//! The control unit: what stands between a client's commands and the arm.

mod collision;
mod control_unit;
mod desired;
mod external_torque;
mod frames;
mod generator;
mod impedance;
mod limits;
mod motion;

pub use collision::CollisionThresholds;
pub use control_unit::ControlUnit;
pub use frames::pose_of;
pub use limits::{MotionLimits, VelocityEnvelope};
