//! Answers over TCP.

use franka::wire::robot::{v5, v10};

use super::FciVersion;

/// Why a request is not carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Not in the present mode of the robot.
    NotPossible,
    /// A value is not allowed.
    InvalidArgument,
}

/// How a motion ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoveEnd {
    /// The client said that it was finished.
    Finished,
    /// StopMove.
    Stopped,
    /// An error flag of the state says why.
    Reflex,
}

/// Status byte of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Done.
    Success,
    /// The motion has started; its end is answered once more.
    MotionStarted,
    /// The motion has ended.
    MoveEnded(MoveEnd),
    /// The motion was not started.
    MoveRefused(Refusal),
    /// Anything else was not done.
    Refused(Refusal),
    /// No model library for this client.
    NoModelLibrary,
}

impl Answer {
    /// The byte in this version.
    pub fn status(self, version: FciVersion) -> u8 {
        use FciVersion::{V5, V10};
        match (self, version) {
            (Self::Success | Self::MoveEnded(MoveEnd::Finished), _) => 0,
            (Self::MotionStarted, V5) => v5::MoveStatus::MotionStarted.to_u8(),
            (Self::MotionStarted, V10) => v10::service_types::MoveStatus::MotionStarted.to_u8(),
            (Self::MoveEnded(MoveEnd::Stopped), V5) => v5::MoveStatus::Preempted.to_u8(),
            (Self::MoveEnded(MoveEnd::Stopped), V10) => v10::service_types::MoveStatus::Preempted.to_u8(),
            (Self::MoveEnded(MoveEnd::Reflex), V5) => v5::MoveStatus::ReflexAborted.to_u8(),
            (Self::MoveEnded(MoveEnd::Reflex), V10) => v10::service_types::MoveStatus::ReflexAborted.to_u8(),
            (Self::MoveRefused(Refusal::NotPossible), V5) => v5::MoveStatus::CommandNotPossibleRejected.to_u8(),
            (Self::MoveRefused(Refusal::NotPossible), V10) => {
                v10::service_types::MoveStatus::CommandNotPossibleRejected.to_u8()
            }
            (Self::MoveRefused(Refusal::InvalidArgument), V5) => v5::MoveStatus::InvalidArgumentRejected.to_u8(),
            (Self::MoveRefused(Refusal::InvalidArgument), V10) => {
                v10::service_types::MoveStatus::InvalidArgumentRejected.to_u8()
            }
            // All other answers share their first numbers in both versions.
            (Self::Refused(Refusal::NotPossible) | Self::NoModelLibrary, _) => 1,
            (Self::Refused(Refusal::InvalidArgument), _) => 2,
        }
    }
}
