//! A Franka that Tribo drives: the other end of the wire, on `franka-rs`.

mod approach;
mod connection;
mod torque_plant;

pub use connection::{Connection, RobotError as ConnectionError};
pub use franka::RobotState as HeardState;
pub use torque_plant::{TorquePlant, sensor_frame};
