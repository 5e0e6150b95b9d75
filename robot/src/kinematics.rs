//! Forward kinematics, geometric Jacobian and its drift, all in base axes.

use nalgebra::{IsometryMatrix3, Matrix3, Rotation3, SMatrix, SVector, Translation3, Vector3, Vector6};

use crate::frame::Frame;
use crate::link_motion::LinkMotion;
use crate::product::cross;
use crate::{Arm, Pose};

/// Where every link is at one configuration, in base axes: the workspace shared by the kinematic algorithms.
#[derive(Clone, Copy, Debug)]
pub struct Kinematics<const N: usize> {
    frames: [Frame; N],
    /// Rotation `base_from_flange`.
    pub flange_rotation: Matrix3<f64>,
    /// Origin of the flange (m), in base axes.
    pub flange_origin: Vector3<f64>,
}

impl<const N: usize> Kinematics<N> {
    /// Forward kinematics: `base_from_k = base_from_{k−1} · placement_k · RotZ(q_k)`. q (rad).
    #[inline]
    pub fn at(arm: &Arm<N>, q: &SVector<f64, N>) -> Self {
        let arm = arm.mechanism.canonical();
        let turns = arm.turns(q);
        let mut frame = Frame::first(arm, turns[0]);
        let mut frames = [frame; N];
        for k in 1..N {
            frame = frame.next(&arm.joints[k], turns[k]);
            frames[k] = frame;
        }
        let (flange_rotation, flange_origin) = frame.flange(arm);
        Self { frames, flange_rotation, flange_origin }
    }

    /// `base_from_flange` as one transform.
    #[inline]
    pub fn base_from_flange(&self) -> Pose {
        pose(&self.flange_rotation, &self.flange_origin)
    }

    /// `base_from_link` of link k: its rotation, and the origin of its frame (m).
    #[inline]
    pub fn link(&self, arm: &Arm<N>, k: usize) -> (Matrix3<f64>, Vector3<f64>) {
        arm.mechanism.canonical().described(k, &self.frames[k].rotation(), &self.frames[k].origin())
    }

    /// Axis of joint k, in base axes.
    #[inline]
    pub fn axis(&self, k: usize) -> Vector3<f64> {
        self.frames[k].axis()
    }

    /// A point (m) on the axis of joint k, at rest in the links on both sides of it; base axes.
    #[inline]
    pub(crate) fn pivot(&self, k: usize) -> Vector3<f64> {
        self.frames[k].origin()
    }

    /// Geometric Jacobian of the flange origin, base axes, angular rows first: column k = `[z_k; z_k × (p − o_k)]`.
    #[inline]
    pub fn jacobian(&self) -> SMatrix<f64, 6, N> {
        let mut j = SMatrix::<f64, 6, N>::zeros();
        for k in 0..N {
            j.data.0[k] = jacobian_column(&self.axis(k), &self.pivot(k), &self.flange_origin);
        }
        j
    }

    /// `J̇ qd`: classical acceleration of the flange at qdd = 0, base axes, angular part first. qd [rad/s].
    #[inline]
    pub fn jdot_qd(&self, qd: &SVector<f64, N>) -> Vector6<f64> {
        let mut motion = LinkMotion::of_base(Vector3::zeros());
        for k in 0..N {
            motion.move_to(&self.pivot(k));
            motion.turn(&self.axis(k), qd[k]);
        }
        motion.move_to(&self.flange_origin);
        let LinkMotion { dw, a, .. } = motion;
        Vector6::new(dw.x, dw.y, dw.z, a.x, a.y, a.z)
    }

    /// Gravity torque (Nm): `g_k = −z_k · Σ_{i≥k} h_i × gravity`, h the first moments that are left when each link has given
    /// its mass to the one before: no lever needs a point.
    #[inline]
    pub fn gravity_torque(&self, arm: &Arm<N>) -> SVector<f64, N> {
        let mut tau = SVector::zeros();
        let mut moment = Vector3::zeros();
        for k in (0..N).rev() {
            let body = &arm.mechanism.canonical().bodies[k];
            moment += self.frames[k].turn(&Vector3::new(body.hx, body.hy, 0.0));
            tau[k] = -self.axis(k).dot(&cross(&moment, &arm.gravity_m_s2));
        }
        tau
    }
}

/// `[z; z × (p − o)]`: what joint k moves at the point p, its axis z going through o.
#[inline]
pub(crate) fn jacobian_column(axis: &Vector3<f64>, pivot: &Vector3<f64>, point: &Vector3<f64>) -> [f64; 6] {
    let l = cross(axis, &(point - pivot));
    [axis.x, axis.y, axis.z, l.x, l.y, l.z]
}

/// A transform of a rotation that is one.
#[inline]
pub(crate) fn pose(rotation: &Matrix3<f64>, origin: &Vector3<f64>) -> Pose {
    IsometryMatrix3::from_parts(Translation3::from(*origin), Rotation3::from_matrix_unchecked(*rotation))
}
