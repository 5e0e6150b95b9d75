//! What travels between a client and the control unit, in plain numbers; [`franka::wire`] has the bytes.

mod answer;
mod command;
mod error_flags;
mod request;
mod state;
mod version;

pub use answer::{Answer, MoveEnd, Refusal};
pub use command::CyclicCommand;
pub use error_flags::{ErrorFlags, RobotError};
pub use request::{MotionRequest, Request, Setting};
pub use state::{ControllerMode, GeneratorMode, RobotMode, RobotState, STATE_BYTES_MAX};
pub use version::FciVersion;
