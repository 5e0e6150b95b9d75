//! Inertia of a rigid body and of a payload.

use nalgebra::{Matrix3, SVector, Vector3};

/// Rigid-body inertia of one link: mass, centre of mass in the link frame, rotational inertia about the centre of mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkInertia {
    /// Mass (kg).
    pub mass_kg: f64,
    /// Centre of mass (m), in the link frame.
    pub com_m: Vector3<f64>,
    /// Inertia about the centre of mass [kg m²], in the axes of the link frame.
    pub inertia_kg_m2: Matrix3<f64>,
}

/// A rigid body bolted to the flange, in the flange frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Payload {
    /// Mass (kg).
    pub mass_kg: f64,
    /// Centre of mass (m), in the flange frame.
    pub com_m: Vector3<f64>,
    /// Inertia about the centre of mass [kg m²], in the axes of the flange frame.
    pub inertia_kg_m2: Matrix3<f64>,
}

impl LinkInertia {
    /// Inertia tensor about the link origin [kg m²] (Steiner): `I_o = I_c − m [c]×[c]×`.
    #[inline]
    pub fn inertia_about_origin(&self) -> Matrix3<f64> {
        self.inertia_kg_m2 + steiner(&(self.com_m * self.mass_kg), &self.com_m)
    }

    /// The ten parameters in which the dynamics are linear: `[m, m c (3), I_o: xx xy xz yy yz zz]`.
    pub fn parameters(&self) -> SVector<f64, 10> {
        let h = self.com_m * self.mass_kg;
        let i = self.inertia_about_origin();
        SVector::from([self.mass_kg, h.x, h.y, h.z, i[(0, 0)], i[(0, 1)], i[(0, 2)], i[(1, 1)], i[(1, 2)], i[(2, 2)]])
    }

    /// The same body in another frame, in which the axes of this one are the columns of `rotation` and its origin is at
    /// `translation` (m).
    pub fn placed(&self, rotation: &Matrix3<f64>, translation: &Vector3<f64>) -> Self {
        Self {
            mass_kg: self.mass_kg,
            com_m: rotation * self.com_m + translation,
            inertia_kg_m2: rotation * self.inertia_kg_m2 * rotation.transpose(),
        }
    }

    /// Both bodies welded together, about their common centre of mass. Same frame for both.
    pub fn combined(&self, other: &Self) -> Self {
        let mass_kg = self.mass_kg + other.mass_kg;
        if mass_kg <= 0.0 {
            return *self;
        }
        let com_m = (self.com_m * self.mass_kg + other.com_m * other.mass_kg) / mass_kg;
        let c = com_m.cross_matrix();
        let inertia_kg_m2 = self.inertia_about_origin() + other.inertia_about_origin() + c * c * mass_kg;
        Self { mass_kg, com_m, inertia_kg_m2 }
    }
}

/// `−[h]×[c]× = (h·c) I − c hᵀ` where h = m c: what a body's mass adds to its inertia about a point at distance c.
#[inline]
fn steiner(h: &Vector3<f64>, c: &Vector3<f64>) -> Matrix3<f64> {
    let (xx, yy, zz) = (h.x * c.x, h.y * c.y, h.z * c.z);
    let (xy, xz, yz) = (-h.x * c.y, -h.x * c.z, -h.y * c.z);
    Matrix3::new(yy + zz, xy, xz, xy, xx + zz, yz, xz, yz, xx + yy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_point_masses_make_a_dumbbell() {
        let point =
            |x: f64| LinkInertia { mass_kg: 2.0, com_m: Vector3::new(x, 0.0, 0.0), inertia_kg_m2: Matrix3::zeros() };
        let both = point(0.5).combined(&point(-0.5));
        assert!(both.com_m.norm() < 1e-15);
        // m r² about y and z, nothing about the rod itself.
        assert!((both.inertia_kg_m2 - Matrix3::from_diagonal(&Vector3::new(0.0, 1.0, 1.0))).amax() < 1e-15);
    }
}
