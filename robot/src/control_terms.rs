//! Everything a task-space controller and a task-space estimator need at one state, computed once per tick.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3, Vector6};

use crate::inertia::{steiner, turned};
use crate::link_motion::LinkMotion;
use crate::product::cross;
use crate::{Arm, Kinematics, Pose};

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
    /// Everything is in base axes, so that nothing has to be turned from link to link, as [`crate::rnea`] and
    /// [`crate::mass_matrix`] do:
    ///
    /// ```text
    /// outwards, qdd = 0, no gravity:  ω̇ += ω × z qd,  ω += z qd,  a = acceleration of the link's origin
    ///                                 f = m (a + ω̇ × r + ω × (ω × r)),   n = I_c ω̇ + ω × I_c ω,   r = c − o
    /// inwards, about the base origin: F += f,  N += n + c × f,           C qd = z · (N − o × F)
    ///                                 composite body m, h = Σ m c, I_o:  g = −z · ((h − m o) × gravity)
    ///                                 [n; f]_k = [I_o z + h × l; m l + z × h],   l = o × z
    ///                                 M_ik = z_i · n_k + l_i · f_k,      i ≤ k
    /// ```
    #[inline]
    pub fn at(arm: &Arm<N>, q: &SVector<f64, N>, qd: &SVector<f64, N>) -> Self {
        let kinematics = Kinematics::at(arm, q);
        let mut bodies = [Body::default(); N];
        let mut motion = LinkMotion::of_base(Vector3::zeros());
        for k in 0..N {
            let origin = kinematics.origins[k];
            motion.move_to(&origin);
            motion.turn(&kinematics.axis(k), qd[k]);

            let link = &arm.links[k];
            let rotation = &kinematics.rotations[k];
            let r = rotation * link.com_m;
            let com = origin + r;
            let inertia = turned(rotation, &link.inertia_kg_m2);
            let LinkMotion { w, dw, a, .. } = motion;
            let force = (a + motion.at_distance(&r)) * link.mass_kg;
            let moment = inertia * dw + cross(&w, &(inertia * w)) + cross(&com, &force);
            let first_moment = com * link.mass_kg;
            let inertia = inertia + steiner(&first_moment, &com);
            bodies[k] = Body { mass_kg: link.mass_kg, first_moment, inertia, force, moment };
        }
        motion.move_to(&kinematics.flange_origin);
        let LinkMotion { dw, a, .. } = motion;

        let mut terms = Self {
            base_from_flange: kinematics.base_from_flange(),
            jacobian: SMatrix::zeros(),
            jdot_qd: Vector6::new(dw.x, dw.y, dw.z, a.x, a.y, a.z),
            mass_matrix: SMatrix::zeros(),
            coriolis_nm: SVector::zeros(),
            gravity_nm: SVector::zeros(),
        };
        let moments: [Vector3<f64>; N] = std::array::from_fn(|k| cross(&kinematics.origins[k], &kinematics.axis(k)));
        let mut outboard = Body::default();
        for k in (0..N).rev() {
            outboard.weld(&bodies[k]);
            let (origin, z, l) = (&kinematics.origins[k], kinematics.axis(k), &moments[k]);
            terms.coriolis_nm[k] = z.dot(&outboard.moment) + l.dot(&outboard.force);
            let lever = outboard.first_moment - origin * outboard.mass_kg;
            terms.gravity_nm[k] = -z.dot(&cross(&lever, &arm.gravity_m_s2));
            let moment = outboard.inertia * z + cross(&outboard.first_moment, l);
            let force = l * outboard.mass_kg + cross(&z, &outboard.first_moment);
            for i in 0..=k {
                let m = kinematics.axis(i).dot(&moment) + moments[i].dot(&force);
                terms.mass_matrix[(i, k)] = m;
                terms.mass_matrix[(k, i)] = m;
            }
            terms.mass_matrix[(k, k)] += arm.rotor_inertia_kg_m2[k];
            let linear = l + cross(&z, &kinematics.flange_origin);
            terms.jacobian.set_column(k, &Vector6::new(z.x, z.y, z.z, linear.x, linear.y, linear.z));
        }
        terms
    }

    /// Bias torque C qd + g (Nm).
    #[inline]
    pub fn bias_nm(&self) -> SVector<f64, N> {
        self.coriolis_nm + self.gravity_nm
    }
}

/// A rigid body, or several welded together, and the wrench that moves it; base axes, about the base origin.
#[derive(Clone, Copy, Default)]
struct Body {
    mass_kg: f64,
    /// h = Σ m c.
    first_moment: Vector3<f64>,
    /// I_o.
    inertia: Matrix3<f64>,
    force: Vector3<f64>,
    moment: Vector3<f64>,
}

impl Body {
    #[inline]
    fn weld(&mut self, other: &Self) {
        self.mass_kg += other.mass_kg;
        self.first_moment += other.first_moment;
        self.inertia += other.inertia;
        self.force += other.force;
        self.moment += other.moment;
    }
}
