//! Where joints sit on the links before them.

use nalgebra::{Matrix3, Vector3};

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
