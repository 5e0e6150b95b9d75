//! What a commanded motion asks of the arm in this period, and whether it may.

use nalgebra::{SVector, Vector3, Vector6};
use tribo_control::DampedPseudoInverse;
use tribo_robot::{Arm, ControlTerms, Kinematics, Pose, so3};

use super::desired::{Desired, PERIOD_S};
use super::frames::{Frames, end_effector_jacobian, pose_of};
use super::limits::MotionLimits;
use crate::wire::{CyclicCommand, GeneratorMode, RobotError};

/// Share of an acceleration limit that a command may exceed: positions travel as floats.
const ACCELERATION_TOLERANCE: f64 = 1.1;
/// The same of a jerk limit: one step of a float in a position is 100 rad/s³.
const JERK_TOLERANCE: f64 = 2.0;
/// Newton steps of the inverse kinematics, and the error at which they end (m, rad).
const IK_STEPS: usize = 5;
const IK_ERROR: f64 = 1e-9;
/// Error that the inverse kinematics may leave (m, rad): beyond it the arm cannot follow.
const IK_LOST: f64 = 1e-4;

/// Turns commands into desired motions.
pub(super) struct Generator<'a> {
    pub(super) mode: GeneratorMode,
    pub(super) arm: &'a Arm<7>,
    pub(super) frames: &'a Frames,
    pub(super) limits: &'a MotionLimits,
    /// Whether no command has come before.
    pub(super) first: bool,
}

impl Generator<'_> {
    /// The desired motion after `last` by this command, within the limits; else the error that libfranka tells.
    pub(super) fn follow(&self, last: &Desired, command: &CyclicCommand) -> Result<Desired, RobotError> {
        match self.mode {
            GeneratorMode::None => Ok(*last),
            GeneratorMode::JointPosition => {
                let q = SVector::from(command.q_rad);
                let qd = (q - last.q) / PERIOD_S;
                let start = RobotError::JointPositionMotionGeneratorStartPoseInvalid;
                if self.first && !(0..7).all(|j| qd[j].abs() <= self.limits.qd_rad_s[j]) {
                    return Err(start);
                }
                self.joints(last, q, qd)
            }
            GeneratorMode::JointVelocity => {
                let qd = SVector::from(command.qd_rad_s);
                self.joints(last, last.q + qd * PERIOD_S, qd)
            }
            GeneratorMode::CartesianPose => {
                let pose = pose_of(&command.pose).ok_or(RobotError::CartesianPositionMotionGeneratorInvalidFrame)?;
                let twist = twist_between(&last.pose, &pose);
                let start = RobotError::CartesianPositionMotionGeneratorStartPoseInvalid;
                let [linear, angular] = parts(&twist);
                if self.first && !(linear <= self.limits.translation[0] && angular <= self.limits.rotation[0]) {
                    return Err(start);
                }
                self.cartesian(last, pose, twist, command.elbow)
            }
            GeneratorMode::CartesianVelocity => {
                let twist = Vector6::from(command.twist);
                self.cartesian(last, moved(&last.pose, &twist), twist, command.elbow)
            }
        }
    }

    /// What follows a lost command: constant acceleration, as the real unit assumes.
    pub(super) fn extrapolate(&self, last: &Desired) -> Desired {
        match self.mode {
            GeneratorMode::None => *last,
            GeneratorMode::JointPosition | GeneratorMode::JointVelocity => {
                let qd = last.qd + last.qdd * PERIOD_S;
                let q = last.q + qd * PERIOD_S;
                self.with_pose(last, q, qd, last.qdd)
            }
            GeneratorMode::CartesianPose | GeneratorMode::CartesianVelocity => {
                let twist = last.twist + last.acceleration * PERIOD_S;
                self.cartesian(last, moved(&last.pose, &twist), twist, None).unwrap_or(*last)
            }
        }
    }

    fn joints(&self, last: &Desired, q: SVector<f64, 7>, qd: SVector<f64, 7>) -> Result<Desired, RobotError> {
        let qdd = (qd - last.qd) / PERIOD_S;
        let jerk = (qdd - last.qdd) / PERIOD_S;
        self.check_joints(&last.q, &q, &qd, &qdd, &jerk, &JOINT_ERRORS)?;
        Ok(self.with_pose(last, q, qd, qdd))
    }

    /// The same joint motion with the motion of the end effector that it makes.
    fn with_pose(&self, last: &Desired, q: SVector<f64, 7>, qd: SVector<f64, 7>, qdd: SVector<f64, 7>) -> Desired {
        let pose = Kinematics::at(self.arm, &q).base_from_flange() * self.frames.flange_from_end_effector();
        let twist = twist_between(&last.pose, &pose);
        Desired { q, qd, qdd, pose, twist, acceleration: (twist - last.twist) / PERIOD_S }
    }

    fn cartesian(
        &self,
        last: &Desired,
        pose: Pose,
        twist: Vector6<f64>,
        elbow: Option<[f64; 2]>,
    ) -> Result<Desired, RobotError> {
        let acceleration = (twist - last.twist) / PERIOD_S;
        let jerk = (acceleration - last.acceleration) / PERIOD_S;
        let moderate = |x: &Vector6<f64>, order: usize, tolerance: f64| {
            let [linear, angular] = parts(x);
            linear <= tolerance * self.limits.translation[order] && angular <= tolerance * self.limits.rotation[order]
        };
        if !moderate(&twist, 0, 1.0) {
            return Err(RobotError::CartesianMotionGeneratorVelocityLimitsViolation);
        }
        if !moderate(&acceleration, 1, ACCELERATION_TOLERANCE) {
            return Err(RobotError::CartesianMotionGeneratorVelocityDiscontinuity);
        }
        if !moderate(&jerk, 2, JERK_TOLERANCE) {
            return Err(RobotError::CartesianMotionGeneratorAccelerationDiscontinuity);
        }
        if let Some([angle, sign]) = elbow {
            if sign * last.q[3].signum() < 0.0 {
                return Err(RobotError::CartesianMotionGeneratorElbowSignInconsistent);
            }
            if !within((angle - last.q[2]).abs(), self.limits.qd_rad_s[2] * PERIOD_S) {
                return Err(RobotError::CartesianMotionGeneratorStartElbowInvalid);
            }
        }
        let too_fast = RobotError::CartesianMotionGeneratorJointVelocityLimitsViolation;
        let q = self.inverse_kinematics(&last.q, &pose, elbow).ok_or(too_fast)?;
        let qd = (q - last.q) / PERIOD_S;
        let qdd = (qd - last.qd) / PERIOD_S;
        let joint_jerk = (qdd - last.qdd) / PERIOD_S;
        self.check_joints(&last.q, &q, &qd, &qdd, &joint_jerk, &CARTESIAN_ERRORS)?;
        Ok(Desired { q, qd, qdd, pose, twist, acceleration })
    }

    /// Joint positions (rad) near `q` with the end effector at `pose`, by Newton steps of smallest norm; with an elbow,
    /// joint 3 goes there in the null space. `None` where the pose is not reached.
    fn inverse_kinematics(&self, q: &SVector<f64, 7>, pose: &Pose, elbow: Option<[f64; 2]>) -> Option<SVector<f64, 7>> {
        let mut q = *q;
        for _ in 0..IK_STEPS {
            let terms = ControlTerms::at(self.arm, &q, &SVector::zeros());
            let end_effector = terms.base_from_flange * self.frames.flange_from_end_effector();
            let error = twist_between(&end_effector, pose) * PERIOD_S;
            let elbow_error = elbow.map_or(0.0, |[angle, _]| angle - q[2]);
            if error.amax() < IK_ERROR && elbow_error.abs() < IK_ERROR {
                return Some(q);
            }
            let jacobian = end_effector_jacobian(&terms, &end_effector);
            let inverse = DampedPseudoInverse::default().factor(&jacobian)?;
            q += inverse.apply(&error);
            if elbow_error != 0.0 {
                // The null-space motion that moves joint 3 by one radian.
                let turn = inverse.project_to_null_space(&SVector::ith(2, 1.0));
                if turn[2] > 1e-3 {
                    q += turn * ((elbow_error - inverse.apply(&error)[2]) / turn[2]);
                }
            }
        }
        let end_effector = Kinematics::at(self.arm, &q).base_from_flange() * self.frames.flange_from_end_effector();
        ((twist_between(&end_effector, pose) * PERIOD_S).amax() < IK_LOST).then_some(q)
    }

    fn check_joints(
        &self,
        last_q: &SVector<f64, 7>,
        q: &SVector<f64, 7>,
        qd: &SVector<f64, 7>,
        qdd: &SVector<f64, 7>,
        jerk: &SVector<f64, 7>,
        errors: &[RobotError; 4],
    ) -> Result<(), RobotError> {
        let limits = self.limits;
        if !limits.allow_position(q) {
            return Err(errors[0]);
        }
        for j in 0..7 {
            let [least, greatest] = limits.velocity_range(j, last_q[j]);
            if !(least..=greatest).contains(&qd[j]) {
                return Err(errors[1]);
            }
            if !within(qdd[j].abs(), ACCELERATION_TOLERANCE * limits.qdd_rad_s2[j]) {
                return Err(errors[2]);
            }
            if !within(jerk[j].abs(), JERK_TOLERANCE * limits.qddd_rad_s3[j]) {
                return Err(errors[3]);
            }
        }
        Ok(())
    }
}

/// Errors of joint motions: position, velocity, acceleration, jerk.
const JOINT_ERRORS: [RobotError; 4] = [
    RobotError::JointMotionGeneratorPositionLimitsViolation,
    RobotError::JointMotionGeneratorVelocityLimitsViolation,
    RobotError::JointMotionGeneratorVelocityDiscontinuity,
    RobotError::JointMotionGeneratorAccelerationDiscontinuity,
];

/// The same of the joint motion that a Cartesian one asks for.
const CARTESIAN_ERRORS: [RobotError; 4] = [
    RobotError::CartesianMotionGeneratorJointPositionLimitsViolation,
    RobotError::CartesianMotionGeneratorJointVelocityLimitsViolation,
    RobotError::CartesianMotionGeneratorJointVelocityDiscontinuity,
    RobotError::CartesianMotionGeneratorJointAccelerationDiscontinuity,
];

/// Whether a size is a number and no more than that.
fn within(size: f64, most: f64) -> bool {
    size <= most
}

/// Norms of the linear and of the angular part.
fn parts(twist: &Vector6<f64>) -> [f64; 2] {
    [twist.fixed_rows::<3>(0).norm(), twist.fixed_rows::<3>(3).norm()]
}

/// Constant twist (linear part first) that takes one pose to the other in a period.
fn twist_between(from: &Pose, to: &Pose) -> Vector6<f64> {
    let shift = (to.translation.vector - from.translation.vector) / PERIOD_S;
    let turn = so3::log(&(to.rotation.matrix() * from.rotation.matrix().transpose())) / PERIOD_S;
    Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
}

/// The pose after a period at this twist.
fn moved(pose: &Pose, twist: &Vector6<f64>) -> Pose {
    let (linear, angular): (Vector3<f64>, Vector3<f64>) =
        (twist.fixed_rows::<3>(0).into_owned(), twist.fixed_rows::<3>(3).into_owned());
    let rotation = so3::renormalized(&(so3::exp(&(angular * PERIOD_S)) * pose.rotation.matrix()));
    let mut moved = *pose;
    moved.translation.vector += linear * PERIOD_S;
    moved.rotation = nalgebra::Rotation3::from_matrix_unchecked(rotation);
    moved
}
