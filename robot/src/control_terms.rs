//! Everything a task-space controller and a task-space estimator need at one state, computed once per tick.

use nalgebra::{SMatrix, SVector, Vector3, Vector6};

use crate::crba::{Composite, assemble};
use crate::frame::Frame;
use crate::kinematics::{jacobian_column, pose};
use crate::link_dynamics::{Effort, Motion, unturned};
use crate::product::multiply_add;
use crate::{Arm, Pose};

/// Model terms at (q, qd): pose, J, J̇ qd, M, C qd, g. Base axes, angular part first, SI units.
#[derive(Clone, Copy, Debug)]
pub struct ControlTerms<const N: usize> {
    /// `base_from_flange`.
    pub base_from_flange: Pose,
    /// Geometric Jacobian of the flange origin.
    pub jacobian: SMatrix<f64, 6, N>,
    /// Drift J̇ qd [rad/s²; m/s²].
    pub jdot_qd: Vector6<f64>,
    /// Mass matrix with rotor inertia [kg m²].
    pub mass_matrix: SMatrix<f64, N, N>,
    /// Coriolis and centrifugal torque C(q, qd) qd (Nm).
    pub coriolis_nm: SVector<f64, N>,
    /// Gravity torque g(q) (Nm).
    pub gravity_nm: SVector<f64, N>,
}

impl<const N: usize> ControlTerms<N> {
    /// Evaluates all terms at q (rad), qd [rad/s], in one pass outwards and one inwards.
    ///
    /// The passes are those of [`crate::rnea`] at qdd = 0 without gravity and of [`crate::mass_matrix`], in link frames, so that
    /// sines and frames are worked out once:
    ///
    /// ```text
    /// outwards:  base_from_k,  ω, ω̇, a of the link,  gravity in its axes
    /// inwards:   C qd = z · n,     g = h × z · gravity, h of the composite body,     M from the composite bodies
    /// flange:    J̇ qd = base_from_link [ω̇; a + A r]
    /// ```
    #[inline]
    pub fn at(arm: &Arm<N>, q: &SVector<f64, N>, qd: &SVector<f64, N>) -> Self {
        let (rotor_inertia_kg_m2, gravity) = (&arm.rotor_inertia_kg_m2, &arm.gravity_m_s2);
        let arm = arm.mechanism.canonical();
        let turns = arm.turns(q);
        let mut frame = Frame::first(arm, turns[0]);
        let mut gravity = unturned(&arm.base_rotation.tr_mul(gravity), turns[0]);
        let mut axes = [(frame.axis(), frame.origin()); N];
        let mut weights = [(gravity.x, gravity.y); N];
        for k in 1..N {
            frame = frame.next(&arm.joints[k], turns[k]);
            gravity = arm.joints[k].outwards(&gravity, turns[k]);
            axes[k] = (frame.axis(), frame.origin());
            weights[k] = (gravity.x, gravity.y);
        }

        let mut efforts = [Effort::NONE; N];
        let mut motion = Motion::first(Vector3::zeros(), qd[0], 0.0);
        let mut gradient = motion.gradient();
        for k in 0..N {
            if k > 0 {
                motion = motion.next(&gradient, &arm.joints[k], turns[k], qd[k], 0.0);
                gradient = motion.gradient();
            }
            efforts[k] = arm.bodies[k].effort(&motion, &gradient);
        }
        let (flange_rotation, flange_origin) = frame.flange(arm);
        let acceleration = motion.acceleration(&gradient, &arm.link_from_flange_translation);
        let [dw, a] = [motion.dw, acceleration].map(|v| frame.turn(&v));

        let mut terms = Self {
            base_from_flange: pose(&flange_rotation, &flange_origin),
            jacobian: SMatrix::zeros(),
            jdot_qd: Vector6::new(dw.x, dw.y, dw.z, a.x, a.y, a.z),
            mass_matrix: SMatrix::zeros(),
            coriolis_nm: SVector::zeros(),
            gravity_nm: SVector::zeros(),
        };
        let mut composites = [Composite::default(); N];
        let (mut composite, mut outboard) = (Composite::default(), Effort::NONE);
        for k in (0..N).rev() {
            outboard = outboard.plus(&efforts[k]);
            composite.weld(&arm.bodies[k]);
            composites[k] = composite;
            terms.coriolis_nm[k] = outboard.moment.z;
            terms.gravity_nm[k] = multiply_add(composite.h.y, weights[k].0, -(composite.h.x * weights[k].1));
            terms.jacobian.data.0[k] = jacobian_column(&axes[k].0, &axes[k].1, &flange_origin);
            if k > 0 {
                outboard = outboard.inwards(&arm.joints[k], turns[k]);
                composite = composite.inwards(&arm.joints[k], turns[k]);
            }
        }
        assemble(&mut terms.mass_matrix, arm, &turns, &composites, rotor_inertia_kg_m2);
        terms
    }

    /// Bias torque C qd + g (Nm).
    #[inline]
    pub fn bias_nm(&self) -> SVector<f64, N> {
        self.coriolis_nm + self.gravity_nm
    }
}
