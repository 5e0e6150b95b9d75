//! Forward kinematics, geometric Jacobian and its drift, all in base axes.

use nalgebra::{IsometryMatrix3, Matrix3, Rotation3, SMatrix, SVector, Translation3, Vector3, Vector6};

use crate::link_motion::LinkMotion;
use crate::sines::{sines, turned_about_z};
use crate::{Arm, Pose};

/// Where every link is at one configuration, in base axes: the workspace shared by the kinematic algorithms.
#[derive(Clone, Copy, Debug)]
pub struct Kinematics<const N: usize> {
    /// Rotation `base_from_link` of each link.
    pub rotations: [Matrix3<f64>; N],
    /// Origin of each link frame (m), in base axes.
    pub origins: [Vector3<f64>; N],
    /// Rotation `base_from_flange`.
    pub flange_rotation: Matrix3<f64>,
    /// Origin of the flange (m), in base axes.
    pub flange_origin: Vector3<f64>,
}

impl<const N: usize> Kinematics<N> {
    /// Forward kinematics: `base_from_k = base_from_{k−1} · placement_k · RotZ(q_k)`. q (rad).
    #[inline]
    pub fn at(arm: &Arm<N>, q: &SVector<f64, N>) -> Self {
        let (mut r, mut o) = (Matrix3::identity(), Vector3::zeros());
        // Filled where it is returned: copies are what a tick has too many of.
        let mut kinematics = Self { rotations: [r; N], origins: [o; N], flange_rotation: r, flange_origin: o };
        let sines = sines(q);
        for k in 0..N {
            let placement = &arm.placements[k];
            o += r * placement.translation;
            r = turned_about_z(&(r * placement.rotation), sines[k]);
            kinematics.rotations[k] = r;
            kinematics.origins[k] = o;
        }
        kinematics.flange_rotation = r * arm.link_from_flange_rotation;
        kinematics.flange_origin = o + r * arm.link_from_flange_translation;
        kinematics
    }

    /// `base_from_flange` as one transform.
    #[inline]
    pub fn base_from_flange(&self) -> Pose {
        IsometryMatrix3::from_parts(
            Translation3::from(self.flange_origin),
            Rotation3::from_matrix_unchecked(self.flange_rotation),
        )
    }

    /// Axis of joint k, in base axes.
    #[inline]
    pub fn axis(&self, k: usize) -> Vector3<f64> {
        self.rotations[k].column(2).into_owned()
    }

    /// Geometric Jacobian of the flange origin, base axes, angular rows first: column k = `[z_k; z_k × (p − o_k)]`.
    #[inline]
    pub fn jacobian(&self) -> SMatrix<f64, 6, N> {
        let mut j = SMatrix::<f64, 6, N>::zeros();
        for k in 0..N {
            let z = self.axis(k);
            let l = z.cross(&(self.flange_origin - self.origins[k]));
            j.set_column(k, &Vector6::new(z.x, z.y, z.z, l.x, l.y, l.z));
        }
        j
    }

    /// `J̇ qd`: classical acceleration of the flange at qdd = 0, base axes, angular part first. qd [rad/s].
    #[inline]
    pub fn jdot_qd(&self, qd: &SVector<f64, N>) -> Vector6<f64> {
        let mut motion = LinkMotion::of_base(Vector3::zeros());
        for k in 0..N {
            motion.move_to(&self.origins[k]);
            motion.turn(&self.axis(k), qd[k]);
        }
        motion.move_to(&self.flange_origin);
        let LinkMotion { dw, a, .. } = motion;
        Vector6::new(dw.x, dw.y, dw.z, a.x, a.y, a.z)
    }

    /// Gravity torque (Nm): `g_k = −z_k · Σ_{i≥k} m_i (c_i − o_k) × gravity`.
    #[inline]
    pub fn gravity_torque(&self, arm: &Arm<N>) -> SVector<f64, N> {
        let mut tau = SVector::zeros();
        let (mut mass, mut moment) = (0.0, Vector3::zeros());
        for k in (0..N).rev() {
            let link = &arm.links[k];
            mass += link.mass_kg;
            moment += (self.origins[k] + self.rotations[k] * link.com_m) * link.mass_kg;
            tau[k] = -self.axis(k).dot(&(moment - self.origins[k] * mass).cross(&arm.gravity_m_s2));
        }
        tau
    }
}
