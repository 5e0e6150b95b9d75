//! The two versions of the interface.

use franka::wire::robot::{v5, v10};

/// Version of the Franka Control Interface that a robot speaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FciVersion {
    /// Panda (Franka Emika Robot), libfranka 0.8 and 0.9.
    V5,
    /// Franka Research 3, libfranka 0.18 and later.
    V10,
}

impl FciVersion {
    /// The number in the Connect message.
    pub fn number(self) -> u16 {
        match self {
            Self::V5 => v5::ROBOT_VERSION,
            Self::V10 => franka::wire::ROBOT_VERSION,
        }
    }

    /// Bytes of the command that a client sends each period.
    pub fn command_bytes(self) -> usize {
        match self {
            Self::V5 => size_of::<v5::RobotCommand>(),
            Self::V10 => size_of::<v10::RobotCommand>(),
        }
    }
}
