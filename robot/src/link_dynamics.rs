//! Motion and force, carried from link to link in the links' own frames.

use nalgebra::Vector3;

use crate::canonical::{Body, Joint, Turn};
use crate::product::multiply_add;

/// Motion of a link at its origin, in its own axes: ω [rad/s], ω̇ [rad/s²], classical acceleration a [m/s²].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    pub w: Vector3<f64>,
    pub dw: Vector3<f64>,
    pub a: Vector3<f64>,
}

/// `A = [ω̇]× + [ω]×²`: a point of the link at distance r from its origin has the acceleration `a + A r`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gradient {
    /// ω's components squared.
    square: Vector3<f64>,
    xy: f64,
    yx: f64,
    xz: f64,
    zx: f64,
    yz: f64,
    zy: f64,
}

/// Force (N) and moment (Nm) about the origin of a link, in its own axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    pub force: Vector3<f64>,
    pub moment: Vector3<f64>,
}

impl Motion {
    /// Of the first link, whose base is accelerated by `a` (in the axes of the link): −gravity gives every link its weight.
    #[inline]
    pub fn first(a: Vector3<f64>, qd: f64, qdd: f64) -> Self {
        Self { w: Vector3::new(0.0, 0.0, qd), dw: Vector3::new(0.0, 0.0, qdd), a }
    }

    #[inline]
    pub fn gradient(&self) -> Gradient {
        let (w, dw) = (&self.w, &self.dw);
        Gradient {
            square: w.component_mul(w),
            xy: multiply_add(w.x, w.y, -dw.z),
            yx: multiply_add(w.x, w.y, dw.z),
            xz: multiply_add(w.x, w.z, dw.y),
            zx: multiply_add(w.x, w.z, -dw.y),
            yz: multiply_add(w.y, w.z, -dw.x),
            zy: multiply_add(w.y, w.z, dw.x),
        }
    }

    /// Acceleration of the point r.
    #[inline]
    pub fn acceleration(&self, gradient: &Gradient, r: &Vector3<f64>) -> Vector3<f64> {
        let (g, s, a) = (gradient, &gradient.square, &self.a);
        Vector3::new(
            multiply_add(-(s.y + s.z), r.x, multiply_add(g.xz, r.z, multiply_add(g.xy, r.y, a.x))),
            multiply_add(g.yx, r.x, multiply_add(g.yz, r.z, multiply_add(-(s.x + s.z), r.y, a.y))),
            multiply_add(g.zx, r.x, multiply_add(-(s.x + s.y), r.z, multiply_add(g.zy, r.y, a.z))),
        )
    }

    /// Of the next link: `ω' = Rᵀ ω + z qd`, `ω̇' = Rᵀ ω̇ + (Rᵀ ω) × z qd + z qdd`, `a' = Rᵀ (a + A p)`.
    #[inline]
    pub fn next(&self, gradient: &Gradient, joint: &Joint, turn: Turn, qd: f64, qdd: f64) -> Self {
        let a = joint.outwards(&self.acceleration(gradient, &joint.p), turn);
        let (w, dw) = (joint.outwards(&self.w, turn), joint.outwards(&self.dw, turn));
        Self {
            w: Vector3::new(w.x, w.y, w.z + qd),
            dw: Vector3::new(multiply_add(w.y, qd, dw.x), multiply_add(-w.x, qd, dw.y), dw.z + qdd),
            a,
        }
    }
}

impl Body {
    /// What moves the body: `f = A h`, `n = h × a + vee(A Σ − Σ Aᵀ)`, Σ its second moments.
    #[inline]
    pub fn effort(&self, motion: &Motion, gradient: &Gradient) -> Effort {
        let (b, g, s, a) = (self, gradient, &gradient.square, &motion.a);
        let force = Vector3::new(
            multiply_add(-(s.y + s.z), b.hx, g.xy * b.hy),
            multiply_add(g.yx, b.hx, -(s.x + s.z) * b.hy),
            multiply_add(g.zx, b.hx, g.zy * b.hy),
        );
        let x = multiply_add(g.zx, b.xy, multiply_add(g.zy, b.yy, multiply_add(s.z - s.y, b.yz, -(g.yx * b.xz))));
        let y = multiply_add(s.x - s.z, b.xz, multiply_add(g.xy, b.yz, multiply_add(-g.zx, b.xx, -(g.zy * b.xy))));
        let z = multiply_add(g.yx, b.xx, multiply_add(-g.xy, b.yy, multiply_add(s.y - s.x, b.xy, g.yz * b.xz)));
        let moment = Vector3::new(
            multiply_add(b.hy, a.z, x),
            multiply_add(-b.hx, a.z, y),
            multiply_add(b.hx, a.y, multiply_add(-b.hy, a.x, multiply_add(-g.xz, b.yz, z))),
        );
        Effort { force, moment }
    }
}

impl Effort {
    pub const NONE: Self = Self { force: Vector3::new(0.0, 0.0, 0.0), moment: Vector3::new(0.0, 0.0, 0.0) };

    #[inline]
    pub fn plus(&self, other: &Self) -> Self {
        Self { force: self.force + other.force, moment: self.moment + other.moment }
    }

    /// The same about the origin of the link before, in its axes: `f' = R f`, `n' = R n + p × f'`.
    #[inline]
    pub fn inwards(&self, joint: &Joint, turn: Turn) -> Self {
        let (f, n, p) = (joint.inwards(&self.force, turn), joint.inwards(&self.moment, turn), &joint.p);
        let mut moment = Vector3::new(
            multiply_add(-p.z, f.y, n.x),
            multiply_add(p.z, f.x, multiply_add(-p.x, f.z, n.y)),
            multiply_add(p.x, f.y, n.z),
        );
        if !joint.square {
            moment.x = multiply_add(p.y, f.z, moment.x);
            moment.z = multiply_add(-p.y, f.x, moment.z);
        }
        Self { force: f, moment }
    }
}

impl Joint {
    /// Axes of the link → axes of the link before: `RotX(alpha) RotZ(q) v`.
    #[inline]
    pub fn inwards(&self, v: &Vector3<f64>, (sin, cos): Turn) -> Vector3<f64> {
        let (x, y) = (multiply_add(cos, v.x, -(sin * v.y)), multiply_add(sin, v.x, cos * v.y));
        if self.square {
            return Vector3::new(x, -v.z, y);
        }
        let (s, c) = (self.sin, self.cos);
        Vector3::new(x, multiply_add(c, y, -(s * v.z)), multiply_add(s, y, c * v.z))
    }

    /// Axes of the link before → axes of the link.
    #[inline]
    pub fn outwards(&self, v: &Vector3<f64>, turn: Turn) -> Vector3<f64> {
        let (y, z) = if self.square {
            (v.z, -v.y)
        } else {
            let (s, c) = (self.sin, self.cos);
            (multiply_add(c, v.y, s * v.z), multiply_add(c, v.z, -(s * v.y)))
        };
        unturned(&Vector3::new(v.x, y, z), turn)
    }
}

/// `RotZ(q)ᵀ v`.
#[inline]
pub(crate) fn unturned(v: &Vector3<f64>, (sin, cos): Turn) -> Vector3<f64> {
    Vector3::new(multiply_add(cos, v.x, sin * v.y), multiply_add(cos, v.y, -(sin * v.x)), v.z)
}
