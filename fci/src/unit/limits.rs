//! How fast a commanded motion may be.

use franka::rate_limiting::{self as fr3, fer};
use nalgebra::SVector;
use tribo_robot::Arm;

use crate::wire::FciVersion;

/// Speed limit of a joint of the FR3 by its position:
///
/// ```text
/// q̇ ≤ min(v_max, max(0, −v₀ + √(2 a (q_max − q)))),   the same towards q_min
/// ```
///
/// Source: libfranka `rate_limiting.h`, whose clients read the numbers from the robot's URDF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityEnvelope {
    /// v_max (rad/s).
    pub max_rad_s: f64,
    /// v₀ (rad/s).
    pub offset_rad_s: f64,
    /// a (rad/s²).
    pub deceleration_rad_s2: f64,
    /// q_min and q_max (rad).
    pub range_rad: [f64; 2],
}

impl VelocityEnvelope {
    /// Least and greatest velocity (rad/s) at q (rad).
    pub fn at(&self, q: f64) -> [f64; 2] {
        let towards = |distance: f64| {
            let braking = (2.0 * self.deceleration_rad_s2 * distance).max(0.0).sqrt();
            (braking - self.offset_rad_s).clamp(0.0, self.max_rad_s)
        };
        [-towards(q - self.range_rad[0]), towards(self.range_rad[1] - q)]
    }
}

/// v_max, v₀ and a of the FR3's joints, and its position limits for motion generators. Source: libfranka `rate_limiting.h`.
const FR3_ENVELOPES: [(f64, f64, f64); 7] = [
    (2.62, 0.30, 6.0),
    (2.62, 0.20, 2.585),
    (2.62, 0.20, 3.5),
    (2.62, 0.30, 4.0),
    (5.26, 0.35, 17.0),
    (4.18, 0.35, 5.5),
    (5.26, 0.35, 17.0),
];

/// Limits of commanded motions, as libfranka's rate limiter states them; what it leaves out is in the arm's own limits.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionLimits {
    /// Joint positions (rad).
    pub q_rad: [[f64; 2]; 7],
    /// Greatest joint velocities (rad/s) wherever the joint is.
    pub qd_rad_s: [f64; 7],
    /// Their envelope near the ends of travel (FR3).
    pub envelopes: Option<[VelocityEnvelope; 7]>,
    /// Joint accelerations (rad/s²).
    pub qdd_rad_s2: [f64; 7],
    /// Joint jerks (rad/s³).
    pub qddd_rad_s3: [f64; 7],
    /// Translation of the end effector: velocity, acceleration, jerk (m/s, m/s², m/s³).
    pub translation: [f64; 3],
    /// Rotation of the end effector: velocity, acceleration, jerk (rad/s, rad/s², rad/s³).
    pub rotation: [f64; 3],
    /// Rate of commanded torques (Nm/s).
    pub torque_rate_nm_s: f64,
}

impl MotionLimits {
    /// Limits of the robot that speaks this version.
    pub fn of(version: FciVersion, arm: &Arm<7>) -> Self {
        let (lower, upper) = (arm.limits.q_min_rad, arm.limits.q_max_rad);
        match version {
            FciVersion::V5 => Self {
                q_rad: std::array::from_fn(|j| [lower[j], upper[j]]),
                qd_rad_s: arm.limits.qd_max_rad_s.into(),
                envelopes: None,
                qdd_rad_s2: fer::MAX_JOINT_ACCELERATION,
                qddd_rad_s3: fer::MAX_JOINT_JERK,
                translation: [1.7, fer::MAX_TRANSLATIONAL_ACCELERATION, fer::MAX_TRANSLATIONAL_JERK],
                rotation: [2.5, fer::MAX_ROTATIONAL_ACCELERATION, fer::MAX_ROTATIONAL_JERK],
                torque_rate_nm_s: 1000.0,
            },
            FciVersion::V10 => {
                let (lower, upper) = fr3::JOINT_POSITION_LIMITS;
                let q_rad = std::array::from_fn(|j| [lower[j], upper[j]]);
                let envelopes = std::array::from_fn(|j| {
                    let (max_rad_s, offset_rad_s, deceleration_rad_s2) = FR3_ENVELOPES[j];
                    VelocityEnvelope { max_rad_s, offset_rad_s, deceleration_rad_s2, range_rad: q_rad[j] }
                });
                Self {
                    q_rad,
                    qd_rad_s: FR3_ENVELOPES.map(|(max, ..)| max),
                    envelopes: Some(envelopes),
                    qdd_rad_s2: fr3::MAX_JOINT_ACCELERATION,
                    qddd_rad_s3: fr3::MAX_JOINT_JERK,
                    translation: [
                        fr3::MAX_TRANSLATIONAL_VELOCITY,
                        fr3::MAX_TRANSLATIONAL_ACCELERATION,
                        fr3::MAX_TRANSLATIONAL_JERK,
                    ],
                    rotation: [
                        fr3::MAX_ROTATIONAL_VELOCITY,
                        fr3::MAX_ROTATIONAL_ACCELERATION,
                        fr3::MAX_ROTATIONAL_JERK,
                    ],
                    torque_rate_nm_s: 1000.0,
                }
            }
        }
    }

    /// Least and greatest velocity (rad/s) of joint j at q (rad).
    pub(super) fn velocity_range(&self, j: usize, q: f64) -> [f64; 2] {
        let flat = [-self.qd_rad_s[j], self.qd_rad_s[j]];
        self.envelopes.map_or(flat, |envelopes| envelopes[j].at(q))
    }

    /// Whether all joints are within their position limits; q (rad).
    pub(super) fn allow_position(&self, q: &SVector<f64, 7>) -> bool {
        (0..7).all(|j| (self.q_rad[j][0]..=self.q_rad[j][1]).contains(&q[j]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_robot::presets;

    /// libfranka's own limiter (through `franka-rs`) allows 1 mrad/s less at every position.
    #[test]
    fn the_envelope_is_that_of_libfrankas_rate_limiter() {
        let limits = MotionLimits::of(FciVersion::V10, &presets::fr3());
        for step in 0..=50 {
            let share = f64::from(step) / 50.0;
            let q: [f64; 7] =
                std::array::from_fn(|j| limits.q_rad[j][0] + share * (limits.q_rad[j][1] - limits.q_rad[j][0]));
            let upper = fr3::compute_upper_limits_joint_velocity(&q);
            let lower = fr3::compute_lower_limits_joint_velocity(&q);
            for j in 0..7 {
                let [least, greatest] = limits.velocity_range(j, q[j]);
                assert!((greatest - upper[j] - 1e-3).abs() < 1e-12, "joint {j} at {}: {greatest} {}", q[j], upper[j]);
                assert!((least - lower[j] + 1e-3).abs() < 1e-12, "joint {j} at {}: {least} {}", q[j], lower[j]);
            }
        }
    }
}
