//! What can go wrong inside a tick.

use nalgebra::SVector;
use tribo_robot::{Arm, SensorFrame};

/// Why the loop stopped trusting its controller. Each is answered by the safe torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TickFault {
    /// A sensor value is NaN or infinite.
    #[error("sensor of joint {joint} is not finite")]
    SensorNotFinite {
        /// The first such joint.
        joint: usize,
    },
    /// A joint is outside its position limits.
    #[error("joint {joint} is outside its position limits")]
    JointLimit {
        /// The first such joint.
        joint: usize,
    },
    /// A joint is faster than its speed limit.
    #[error("joint {joint} exceeds its speed limit")]
    JointSpeed {
        /// The first such joint.
        joint: usize,
    },
    /// A joint position changed faster than the arm could move.
    #[error("sensor of joint {joint} jumped")]
    SensorJumped {
        /// The first such joint.
        joint: usize,
    },
    /// A sensor repeats the same bits although its joint is meant to move.
    #[error("sensor of joint {joint} is frozen")]
    SensorFrozen {
        /// The first such joint.
        joint: usize,
    },
    /// The time of the frames went back, or on by more than 0.1 s.
    #[error("the clock of the sensors jumped")]
    ClockJumped,
    /// The control law gave a torque that is not finite.
    #[error("the control law gave a torque that is not finite")]
    TorqueNotFinite,
    /// The robot gives no more samples.
    #[error("the robot gives no more samples")]
    PlantLost,
    /// Somebody who watches the loop stopped it.
    #[error("stopped from outside")]
    Stopped,
    /// More deadlines in a row were missed than the overrun policy bears.
    #[error("too many deadlines in a row were missed")]
    DeadlineMissed,
}

impl TickFault {
    /// The first thing wrong with a sensor frame, if any.
    #[inline]
    pub fn of_frame<const N: usize>(arm: &Arm<N>, frame: &SensorFrame<N>) -> Option<Self> {
        let not_finite = |x: &SVector<f64, N>| x.iter().position(|value| !value.is_finite());
        if let Some(joint) = not_finite(&frame.q).or_else(|| not_finite(&frame.qd)) {
            return Some(Self::SensorNotFinite { joint });
        }
        if let Some(joint) = arm.first_joint_outside_limits(&frame.q) {
            return Some(Self::JointLimit { joint });
        }
        let too_fast = (0..N).find(|&joint| frame.qd[joint].abs() > arm.limits.qd_max_rad_s[joint]);
        too_fast.map(|joint| Self::JointSpeed { joint })
    }
}
