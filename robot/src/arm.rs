//! The constant description of a serial arm.

use nalgebra::{Matrix3, SVector, Vector3};

use crate::{JointNames, LinkInertia, Payload};

/// One row of a modified Denavit–Hartenberg table (craig1989).
///
/// ```text
/// T(k−1, k) = RotX(alpha) TransX(a) RotZ(q_k) TransZ(d)
/// ```
///
/// `a_m`, `d_m` in metres, `alpha_rad` in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModifiedDh {
    /// Link length a (m), along the previous x axis.
    pub a_m: f64,
    /// Link offset d (m), along the joint axis.
    pub d_m: f64,
    /// Link twist alpha (rad), about the previous x axis.
    pub alpha_rad: f64,
}

/// One row of a standard Denavit–Hartenberg table (denavit1955, as paul1981 writes it).
///
/// ```text
/// T(k−1, k) = RotZ(q_k) TransZ(d) TransX(a) RotX(alpha)
/// ```
///
/// Its frames sit at the **far** end of their links; ours sit at the joint that moves the link, the near end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandardDh {
    /// Link length a (m), along the x axis of the far frame.
    pub a_m: f64,
    /// Link offset d (m), along the joint axis.
    pub d_m: f64,
    /// Link twist alpha (rad), about the x axis of the far frame.
    pub alpha_rad: f64,
}

impl StandardDh {
    /// The far frame in the near one: `TransZ(d) TransX(a) RotX(alpha)`.
    pub fn near_from_far(&self) -> JointPlacement {
        let turn = JointPlacement::from(ModifiedDh { a_m: 0.0, d_m: 0.0, alpha_rad: self.alpha_rad });
        JointPlacement { rotation: turn.rotation, translation: Vector3::new(self.a_m, 0.0, self.d_m) }
    }

    /// Placements of the joints of a table: each sits at the far end of the link before.
    pub fn placements<const N: usize>(rows: &[Self; N]) -> [JointPlacement; N] {
        let base = JointPlacement { rotation: Matrix3::identity(), translation: Vector3::zeros() };
        std::array::from_fn(|k| if k == 0 { base } else { rows[k - 1].near_from_far() })
    }
}

/// Where a joint sits on its parent: `parent_from_joint(q) = (rotation · RotZ(q), translation)`.
///
/// More general than a DH row (a URDF joint fits too, once its axis is turned onto z).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointPlacement {
    /// Rotation of the joint frame at q = 0, expressed in the parent link frame.
    pub rotation: Matrix3<f64>,
    /// Origin of the joint frame (m), expressed in the parent link frame.
    pub translation: Vector3<f64>,
}

impl From<ModifiedDh> for JointPlacement {
    fn from(dh: ModifiedDh) -> Self {
        // Right angles are the rule in real arms; keep their cosine an exact zero.
        let (mut s, mut c) = dh.alpha_rad.sin_cos();
        if c.abs() < 1e-15 {
            (s, c) = (s.signum(), 0.0);
        }
        Self {
            rotation: Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c),
            translation: Vector3::new(dh.a_m, -s * dh.d_m, c * dh.d_m),
        }
    }
}

/// Limits of the joints, each an N-vector in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits<const N: usize> {
    /// Lower joint limits (rad).
    pub q_min_rad: SVector<f64, N>,
    /// Upper joint limits (rad).
    pub q_max_rad: SVector<f64, N>,
    /// Joint speed limits [rad/s].
    pub qd_max_rad_s: SVector<f64, N>,
    /// Joint torque limits (Nm).
    pub tau_max_nm: SVector<f64, N>,
    /// Joint torque-rate limits [Nm/s].
    pub tau_rate_max_nm_s: SVector<f64, N>,
}

/// A serial arm with N revolute joints about the local z axes. Constant after construction.
///
/// Link k is the body moved by joint k (k = 0..N−1); the flange is fixed to the last link.
#[derive(Clone, Debug, PartialEq)]
pub struct Arm<const N: usize> {
    /// Name of the preset or file, for messages.
    pub name: String,
    /// What people call its joints; of a preset, what its maker's description does.
    pub joint_names: JointNames,
    /// Placement of each joint on its parent link.
    pub placements: [JointPlacement; N],
    /// Inertia of each link in its own frame, payload included in the last.
    pub links: [LinkInertia; N],
    /// Rotation of the flange in the last link frame.
    pub link_from_flange_rotation: Matrix3<f64>,
    /// Origin of the flange (m) in the last link frame.
    pub link_from_flange_translation: Vector3<f64>,
    /// Rotor inertia reflected through the gears [kg m²]; zero describes the link side of the gears.
    pub rotor_inertia_kg_m2: SVector<f64, N>,
    /// Limits of the joints.
    pub limits: Limits<N>,
    /// Gravity [m/s²] in base axes, e.g. (0, 0, −9.81).
    pub gravity_m_s2: Vector3<f64>,
}

impl<const N: usize> Arm<N> {
    /// The same arm seen from the link side of its gears: no rotor inertia.
    pub fn link_side(mut self) -> Self {
        self.rotor_inertia_kg_m2 = SVector::zeros();
        self
    }

    /// The same arm with a rigid body bolted to its flange (`payload` in the flange frame).
    pub fn with_payload(mut self, payload: &Payload) -> Self {
        let Payload { mass_kg, com_m, inertia_kg_m2 } = *payload;
        let body = LinkInertia { mass_kg, com_m, inertia_kg_m2 }
            .placed(&self.link_from_flange_rotation, &self.link_from_flange_translation);
        self.links[N - 1] = self.links[N - 1].combined(&body);
        self
    }

    /// The same arm with every link's mass, first moment and inertia scaled by `1 + relative[k]`.
    pub fn with_link_scale_errors(mut self, relative: &SVector<f64, N>) -> Self {
        for (link, error) in self.links.iter_mut().zip(relative.iter()) {
            link.mass_kg *= 1.0 + error;
            link.inertia_kg_m2 *= 1.0 + error;
        }
        self
    }

    /// Whether q lies inside the joint limits, and the first joint that does not.
    #[inline]
    pub fn first_joint_outside_limits(&self, q: &SVector<f64, N>) -> Option<usize> {
        (0..N).find(|&j| !(q[j] >= self.limits.q_min_rad[j] && q[j] <= self.limits.q_max_rad[j]))
    }
}
