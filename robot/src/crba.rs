//! Composite rigid-body algorithm.

use nalgebra::{SMatrix, SVector, Vector3};
use wide::f64x4;

use crate::Arm;
use crate::canonical::{Body, Canonical, Joint, Turn};
use crate::product::multiply_add;

/// Joint-space mass matrix M(q) + diag(Ir) [kg m²] (featherstone2008, table 6.2), link frames. Symmetric positive definite.
#[inline]
pub fn mass_matrix<const N: usize>(arm: &Arm<N>, q: &SVector<f64, N>) -> SMatrix<f64, N, N> {
    let arm_frames = arm.mechanism.canonical();
    let turns = arm_frames.turns(q);
    let mut composites = [Composite::default(); N];
    let mut composite = Composite::default();
    for k in (0..N).rev() {
        composite.weld(&arm_frames.bodies[k]);
        composites[k] = composite;
        if k > 0 {
            composite = composite.inwards(&arm_frames.joints[k], turns[k]);
        }
    }
    let mut m = SMatrix::zeros();
    assemble(&mut m, arm_frames, &turns, &composites, &arm.rotor_inertia_kg_m2);
    m
}

/// All links outboard of a joint as one body, in the frame of the first: `h = ∫ r dm` and second moments. Its mass is the base's.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Composite {
    pub h: Vector3<f64>,
    xx: f64,
    xy: f64,
    xz: f64,
    yy: f64,
    yz: f64,
    zz: f64,
}

impl Composite {
    #[inline]
    pub fn weld(&mut self, link: &Body) {
        self.h.x += link.hx;
        self.h.y += link.hy;
        self.xx += link.xx;
        self.xy += link.xy;
        self.xz += link.xz;
        self.yy += link.yy;
        self.yz += link.yz;
    }

    /// In the frame of the link before: `h' = R h`, `Σ' = R Σ Rᵀ + p h'ᵀ + h' pᵀ`.
    #[inline]
    pub fn inwards(&self, joint: &Joint, (sin, cos): Turn) -> Self {
        let h = joint.inwards(&self.h, (sin, cos));
        let (xx, xy, yy) = turned(self.xx, self.xy, self.yy, (sin, cos));
        let (xz, yz) = (multiply_add(cos, self.xz, -(sin * self.yz)), multiply_add(sin, self.xz, cos * self.yz));
        let (xy, xz, yy, yz, zz) = if joint.square {
            (-xz, xy, self.zz, -yz, yy)
        } else {
            let (s, c) = (joint.sin, joint.cos);
            let (yy, yz, zz) = turned(yy, yz, self.zz, (s, c));
            (multiply_add(c, xy, -(s * xz)), multiply_add(s, xy, c * xz), yy, yz, zz)
        };
        let p = &joint.p;
        Self {
            h,
            xx: multiply_add(2.0 * p.x, h.x, xx),
            xy: multiply_add(p.x, h.y, multiply_add(p.y, h.x, xy)),
            xz: multiply_add(p.x, h.z, multiply_add(p.z, h.x, xz)),
            yy: multiply_add(2.0 * p.y, h.y, yy),
            yz: multiply_add(p.z, h.y, multiply_add(p.y, h.z, yz)),
            zz: multiply_add(2.0 * p.z, h.z, zz),
        }
    }
}

/// The symmetric 2×2 matrix `R [a b; b d] Rᵀ` as its entries a, b, d. The trace stays.
#[inline]
fn turned(a: f64, b: f64, d: f64, (sin, cos): Turn) -> (f64, f64, f64) {
    let (u, v) = (multiply_add(cos, a, -(sin * b)), multiply_add(cos, b, -(sin * d)));
    let first = multiply_add(cos, u, -(sin * v));
    (first, multiply_add(sin, u, cos * v), (a + d) - first)
}

/// M from the composite bodies.
///
/// Column k is the torque of a unit acceleration of joint k, all others at rest: the composite body needs force `z × h` and
/// moment `I_o z` in frame k, carried down to the base. Four columns go down together.
#[inline]
pub(crate) fn assemble<const N: usize>(
    m: &mut SMatrix<f64, N, N>,
    arm: &Canonical<N>,
    turns: &[Turn; N],
    composites: &[Composite; N],
    rotor_inertia_kg_m2: &SVector<f64, N>,
) {
    for first in (0..N).step_by(4) {
        let mut columns = FourEfforts { force: [f64x4::ZERO; 3], moment: [f64x4::ZERO; 3] };
        for i in (0..N.min(first + 4)).rev() {
            if i >= first {
                columns.begin(i - first, &composites[i]);
            }
            let row = columns.moment[2].to_array();
            for (entry, value) in m.data.0[i][first..].iter_mut().zip(row) {
                *entry = value;
            }
            if i > 0 {
                columns = columns.inwards(&arm.joints[i], turns[i]);
            }
        }
    }
    for k in 0..N {
        for i in 0..k {
            m.data.0[k][i] = m.data.0[i][k];
        }
        m.data.0[k][k] += rotor_inertia_kg_m2[k];
    }
}

/// Forces and moments of four columns, one in each lane, about the origin of one link; see [`crate::link_dynamics::Effort`].
#[derive(Clone, Copy)]
struct FourEfforts {
    force: [f64x4; 3],
    moment: [f64x4; 3],
}

impl FourEfforts {
    /// A column begins in its lane, which is zero so far.
    #[inline]
    fn begin(&mut self, lane: usize, body: &Composite) {
        const LANES: [[f64; 4]; 4] =
            [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
        let here = f64x4::from(LANES[lane]);
        let add = |to: &mut f64x4, value: f64| *to = here.mul_add(f64x4::splat(value), *to);
        add(&mut self.force[0], -body.h.y);
        add(&mut self.force[1], body.h.x);
        add(&mut self.moment[0], -body.xz);
        add(&mut self.moment[1], -body.yz);
        add(&mut self.moment[2], body.xx + body.yy);
    }

    #[inline]
    fn inwards(&self, joint: &Joint, (sin, cos): Turn) -> Self {
        let (sin, cos) = (f64x4::splat(sin), f64x4::splat(cos));
        let turn = |[x, y, z]: [f64x4; 3]| [cos.mul_sub(x, sin * y), sin.mul_add(x, cos * y), z];
        let [px, py, pz] = joint.p.data.0[0].map(f64x4::splat);
        let lever = |f: &[f64x4; 3], n: [f64x4; 3]| {
            [pz.mul_neg_add(f[1], n[0]), pz.mul_add(f[0], px.mul_neg_add(f[2], n[1])), px.mul_add(f[1], n[2])]
        };
        let (force, moment) = (turn(self.force), turn(self.moment));
        if joint.square {
            let tilt = |[x, y, z]: [f64x4; 3]| [x, -z, y];
            let force = tilt(force);
            return Self { force, moment: lever(&force, tilt(moment)) };
        }
        let (s, c) = (f64x4::splat(joint.sin), f64x4::splat(joint.cos));
        let tilt = |[x, y, z]: [f64x4; 3]| [x, c.mul_sub(y, s * z), s.mul_add(y, c * z)];
        let force = tilt(force);
        let [x, y, z] = lever(&force, tilt(moment));
        Self { force, moment: [py.mul_add(force[2], x), y, py.mul_neg_add(force[0], z)] }
    }
}
