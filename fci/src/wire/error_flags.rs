//! Reasons for which the control unit stops a motion.

/// An error flag of the robot state; the discriminant is its place among the 41 flags of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "each is the flag that libfranka calls by this name")]
pub enum RobotError {
    JointPositionLimitsViolation = 0,
    JointVelocityViolation = 3,
    JointReflex = 6,
    CartesianReflex = 7,
    JointPositionMotionGeneratorStartPoseInvalid = 11,
    JointMotionGeneratorPositionLimitsViolation = 12,
    JointMotionGeneratorVelocityLimitsViolation = 13,
    JointMotionGeneratorVelocityDiscontinuity = 14,
    JointMotionGeneratorAccelerationDiscontinuity = 15,
    CartesianPositionMotionGeneratorStartPoseInvalid = 16,
    CartesianMotionGeneratorVelocityLimitsViolation = 18,
    CartesianMotionGeneratorVelocityDiscontinuity = 19,
    CartesianMotionGeneratorAccelerationDiscontinuity = 20,
    CartesianMotionGeneratorElbowSignInconsistent = 21,
    CartesianMotionGeneratorStartElbowInvalid = 22,
    CommunicationConstraintsViolation = 25,
    CartesianMotionGeneratorJointPositionLimitsViolation = 27,
    CartesianMotionGeneratorJointVelocityLimitsViolation = 28,
    CartesianMotionGeneratorJointVelocityDiscontinuity = 29,
    CartesianMotionGeneratorJointAccelerationDiscontinuity = 30,
    CartesianPositionMotionGeneratorInvalidFrame = 31,
    ControllerTorqueDiscontinuity = 32,
    TauJRangeViolation = 34,
}

impl RobotError {
    /// The name that libfranka prints.
    pub fn name(self) -> &'static str {
        franka::ERROR_NAMES[self as usize]
    }
}

/// The error flags of a state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ErrorFlags(u64);

impl ErrorFlags {
    /// The flags of one error.
    pub fn of(error: RobotError) -> Self {
        Self(1 << error as u64)
    }

    /// Whether no flag is set.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Both sets of flags.
    pub fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Names of the flags, as libfranka prints them.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        franka::ERROR_NAMES
            .into_iter()
            .enumerate()
            .filter(move |&(flag, _)| self.0 >> flag & 1 == 1)
            .map(|(_, name)| name)
    }

    /// One byte per flag, as on the wire.
    pub fn bytes(self) -> [u8; 41] {
        std::array::from_fn(|flag| u8::from(self.0 >> flag & 1 == 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The names as libfranka prints them, from the flag's place on the wire.
    #[test]
    fn each_flag_has_the_name_of_libfranka() {
        for (error, name) in [
            (RobotError::JointPositionLimitsViolation, "joint_position_limits_violation"),
            (RobotError::JointVelocityViolation, "joint_velocity_violation"),
            (RobotError::JointReflex, "joint_reflex"),
            (RobotError::CartesianReflex, "cartesian_reflex"),
            (RobotError::JointMotionGeneratorVelocityDiscontinuity, "joint_motion_generator_velocity_discontinuity"),
            (RobotError::CartesianMotionGeneratorStartElbowInvalid, "cartesian_motion_generator_start_elbow_invalid"),
            (RobotError::CommunicationConstraintsViolation, "communication_constraints_violation"),
            (
                RobotError::CartesianPositionMotionGeneratorInvalidFrame,
                "cartesian_position_motion_generator_invalid_frame_flag",
            ),
            (RobotError::ControllerTorqueDiscontinuity, "controller_torque_discontinuity"),
            (RobotError::TauJRangeViolation, "tau_J_range_violation"),
        ] {
            assert_eq!(error.name(), name);
            let flags = ErrorFlags::of(error).bytes();
            assert_eq!(flags.iter().position(|&byte| byte == 1), Some(error as usize));
            assert_eq!(flags.iter().map(|&byte| u32::from(byte)).sum::<u32>(), 1);
        }
    }
}
