//! The torque that prescribed motion takes.

use nalgebra::SVector;
use tribo_robot::{Arm, Kinematics, Wrench, rnea};

use super::ExtraTorque;
use super::internal::Internal;
use crate::Truth;
use crate::excitation::{JointState, JointTrajectory};
use crate::hidden::{Hidden, joint_torque_nm};

/// Inverse dynamics of the truth along one motion.
///
/// ```text
/// one encoder:   motor = prescribed,  link = motor − δ;      two encoders:   link = prescribed,  motor = link + δ
/// tau = rnea(link) + Jᵀ h + Ir motor q̈ + friction(motor q̇) + further effects + extra
/// ```
///
/// h is the wrench by the robot on the environment. A gap shifts angles only: speed and acceleration inside it, and
/// friction's response to them, are left out.
pub(super) struct TrueTorque<'a, const N: usize> {
    pub truth: &'a Truth<N>,
    pub hidden: Hidden<N>,
    /// The true arm without rotor inertia.
    pub link_arm: Arm<N>,
    /// Rotor inertia that the torque signal sees [kg m²].
    pub rotor_inertia: SVector<f64, N>,
    pub trajectory: &'a dyn JointTrajectory<N>,
    pub smoothing_rad_s: f64,
    pub dual_encoder: bool,
    pub contact_edge_s: f64,
    /// Time of the log less time of the motion (s).
    pub log_offset_s: f64,
    pub extra: Option<&'a ExtraTorque<'a, N>>,
}

impl<const N: usize> TrueTorque<'_, N> {
    /// Torque through the gears' output (Nm): rigid body without rotor inertia, and contact.
    pub fn link_torque(&self, time_s: f64, link: &JointState<N>) -> SVector<f64, N> {
        let mut tau = rnea(&self.link_arm, &link.q, &link.qd, &link.qdd);
        if !self.hidden.contacts.is_empty() {
            let wrench = self.hidden.contact_at(time_s + self.log_offset_s, self.contact_edge_s);
            if wrench != Wrench::default() {
                let jacobian = Kinematics::at(&self.link_arm, &link.q).jacobian();
                tau += jacobian.transpose() * wrench.to_vector();
            }
        }
        tau
    }

    /// Where motor and link are at `time_s` (s): motor, link.
    pub fn both_sides(&self, time_s: f64, internal: &Internal<N>) -> (JointState<N>, JointState<N>) {
        let given = self.trajectory.at(time_s);
        let shifted = |side: f64| JointState {
            q: given.q + (internal.deflection + internal.gap) * side,
            qd: given.qd + internal.deflection_rate * side,
            qdd: given.qdd + internal.deflection_acceleration * side,
        };
        if self.dual_encoder { (shifted(1.0), given) } else { (given, shifted(-1.0)) }
    }

    /// Motor angle (rad) at `time_s` (s).
    pub fn motor_angle(&self, time_s: f64, internal: &Internal<N>) -> SVector<f64, N> {
        self.both_sides(time_s, internal).0.q
    }

    /// Torque (Nm) at `time_s` (s), gain included, as a perfect sensor without delay gives it.
    pub fn at(&self, time_s: f64, internal: &Internal<N>) -> SVector<f64, N> {
        let (motor, link) = self.both_sides(time_s, internal);
        let log_s = time_s + self.log_offset_s;
        let load = if self.hidden.joints.iter().any(|effects| effects.load_coefficient != 0.0) {
            rnea(&self.link_arm, &link.q, &link.qd, &link.qdd)
        } else {
            SVector::zeros()
        };
        let warm_up = self.truth.warm_up.map_or(1.0, |warm_up| warm_up.scale(log_s.max(0.0)));
        let worked_s = log_s + self.truth.warm_up.map_or(0.0, |warm_up| warm_up.operated_s);
        let mut tau = self.link_torque(time_s, &link) + self.rotor_inertia.component_mul(&motor.qdd);
        for j in 0..N {
            let scale = warm_up * self.hidden.thermal[j].map_or(1.0, |thermal| thermal.scale(worked_s));
            tau[j] += joint_torque_nm(
                &self.truth.friction.joints[j],
                &self.hidden.joints[j],
                [motor.q[j], motor.qd[j]],
                &internal.bristles[j],
                scale,
                load[j],
                self.smoothing_rad_s,
            );
        }
        for lead in &self.hidden.leads {
            tau[lead.joint] += lead.torque_nm(motor.qd[lead.joint], motor.qdd[lead.joint], self.smoothing_rad_s);
        }
        if let Some(extra) = self.extra {
            tau += extra(log_s, &motor.q, &motor.qd, &motor.qdd);
        }
        tau.component_mul(&self.hidden.gain)
    }
}
