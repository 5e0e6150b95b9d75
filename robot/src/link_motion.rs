//! Velocity and acceleration, carried outwards along an arm.

use nalgebra::Vector3;

use crate::product::cross;

/// Motion of a link at one of its points, base axes: ω [rad/s], ω̇ [rad/s²], classical acceleration a of the point [m/s²].
///
/// ```text
/// to a point at distance d:   a += ω̇ × d + ω × (ω × d)
/// over a joint of axis z:     ω̇ += ω × z qd,   ω += z qd          (and ω̇ += z qdd, for whoever has a qdd)
/// ```
#[derive(Clone, Copy, Debug)]
pub(crate) struct LinkMotion {
    pub w: Vector3<f64>,
    pub dw: Vector3<f64>,
    pub a: Vector3<f64>,
    at: Vector3<f64>,
}

impl LinkMotion {
    /// The base: at rest, its origin accelerated by `a`; −gravity puts the weight of every link into its acceleration.
    #[inline]
    pub fn of_base(a: Vector3<f64>) -> Self {
        Self { w: Vector3::zeros(), dw: Vector3::zeros(), a, at: Vector3::zeros() }
    }

    /// Goes to another point (m) of the same link.
    #[inline]
    pub fn move_to(&mut self, point: &Vector3<f64>) {
        let d = point - self.at;
        self.a += self.at_distance(&d);
        self.at = *point;
    }

    /// What the acceleration of a point at distance d (m) has more than that of this one.
    #[inline]
    pub fn at_distance(&self, d: &Vector3<f64>) -> Vector3<f64> {
        cross(&self.dw, d) + cross(&self.w, &cross(&self.w, d))
    }

    /// Goes over to the link that turns about an axis through this point with qd [rad/s].
    #[inline]
    pub fn turn(&mut self, axis: &Vector3<f64>, qd: f64) {
        let spin = axis * qd;
        self.dw += cross(&self.w, &spin);
        self.w += spin;
    }
}
