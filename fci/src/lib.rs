#![doc = include_str!("../README.md")]
//!
//! [`ControlUnit`] is the unit without a network: motions, controllers, limits, reflexes, one call per period.
//! [`Server`] puts it on TCP and UDP for one client at a time, in real time or in *lockstep*, where the arm moves one period
//! for each command and no clock counts. The bytes are those of [`franka::wire`].
//!
//! What the real unit has and this one does not: hand guiding, the planner for asynchronous targets, virtual walls,
//! self-collision checks, the hand's mass, accelerometers (they read zero).

mod client;
mod gripper;
pub mod model;
mod server;
mod unit;
mod wire;

pub use client::{Connection, ConnectionError, HeardState, TorquePlant, sensor_frame};
pub use gripper::GripperServer;
pub use server::{Pace, ServeError, Server, ServerEvent, ServerSettings};
pub use unit::{CollisionThresholds, ControlUnit, MotionLimits, VelocityEnvelope, pose_of};
pub use wire::{
    Answer, ControllerMode, CyclicCommand, ErrorFlags, FciVersion, GeneratorMode, MotionRequest, MoveEnd, Refusal,
    Request, RobotError, RobotMode, RobotState, STATE_BYTES_MAX, Setting,
};
