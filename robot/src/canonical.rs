//! The arm as its algorithms want it.

use nalgebra::{Matrix3, SVector, Vector3};

use crate::Mechanism;
use crate::product::multiply_add;
use crate::sines::four;

/// Sine and cosine of an angle.
pub(crate) type Turn = (f64, f64);

/// Sines and cosines smaller than this are what the rounding of a right angle or of parallel axes leaves.
const ROUNDING: f64 = 1e-15;

/// Link frames and inertias of an arm, chosen so that as many numbers as possible are zero.
///
/// ```text
/// parent_from_link(q) = Trans(p) RotX(alpha) RotZ(q + offset),      p = (a, 0, b) where alpha is a right angle
/// ```
///
/// A link's frame may turn about its own axis z and slide along it: no joint angle changes but by a constant. Any rotation is
/// RotZ RotX RotZ, of which the first is turned into the frame before and the last into the offset. Of axes at a right angle, the rule in
/// real arms, the origin slides to the foot of the common normal with the axis before; of others the foot may be far away.
///
/// What lies on the axis of a joint is at rest relative to both links, so that mass, `m c_z` and `∫ z² dm` can be given to the parent
/// without any torque noticing (gautier1990). Seven numbers of a link are left, and no mass but that of the base.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Canonical<const N: usize> {
    /// `base_from_link` of the first link at q + offset = 0.
    pub base_rotation: Matrix3<f64>,
    pub base_translation: Vector3<f64>,
    /// How each joint sits on the link before it; the first one's is not used.
    pub joints: [Joint; N],
    pub bodies: [Body; N],
    offset_sines: SVector<f64, N>,
    offset_cosines: SVector<f64, N>,
    /// Our frames in those of the mechanism: turned about z, and slid along it (m).
    described_from_ours: [(Turn, f64); N],
    pub link_from_flange_rotation: Matrix3<f64>,
    pub link_from_flange_translation: Vector3<f64>,
}

/// `Trans(p) RotX(alpha)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Joint {
    /// alpha = 90° and p = (a, 0, b): the turn is an exchange of axes.
    pub square: bool,
    pub sin: f64,
    pub cos: f64,
    pub p: Vector3<f64>,
}

/// What joint torques tell of a link: `h = ∫ r dm` across the axis and the second moments `∫ r rᵀ dm` but for zz.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Body {
    pub hx: f64,
    pub hy: f64,
    pub xx: f64,
    pub xy: f64,
    pub xz: f64,
    pub yy: f64,
    pub yz: f64,
}

impl<const N: usize> Canonical<N> {
    /// Frames and inertias of a mechanism, base to tool.
    #[inline(never)]
    pub fn of(arm: &Mechanism<N>) -> Self {
        let mut joints = [Joint { square: false, sin: 0.0, cos: 1.0, p: Vector3::zeros() }; N];
        // Each placement is RotZ(before) Trans(p) RotX(alpha) RotZ(after).
        let (mut before, mut after) = ([(0.0, 1.0); N], [(0.0, 1.0); N]);
        let mut slides_m = [0.0; N];
        for k in 1..N {
            let placement = &arm.placements[k];
            let (turn, sin, cos) = tilt(&placement.rotation, &placement.translation);
            let to_ours = about_z(turn).transpose();
            let rest = about_x((sin, cos)).transpose() * to_ours * placement.rotation;
            (before[k], after[k]) = (turn, (rest[(1, 0)], rest[(0, 0)]));

            let mut p = to_ours * placement.translation - Vector3::z() * slides_m[k - 1];
            let square = cos == 0.0;
            if square {
                slides_m[k] = p.y;
                p.y = 0.0;
            }
            joints[k] = Joint { square, sin, cos, p };
        }

        // The last link's frame is free to turn: it takes its own offset away.
        let turns: [Turn; N] =
            std::array::from_fn(|k| if k + 1 < N { before[k + 1] } else { (-after[k].0, after[k].1) });
        let described_from_ours: [(Turn, f64); N] = std::array::from_fn(|k| (turns[k], slides_m[k]));
        let offset = |k: usize| turned(after[k], turns[k]);
        let last = about_z(turns[N - 1]).transpose();
        Self {
            base_rotation: arm.placements[0].rotation,
            base_translation: arm.placements[0].translation,
            bodies: bodies(arm, &joints, &described_from_ours),
            joints,
            offset_sines: SVector::from_fn(|k, _| offset(k).0),
            offset_cosines: SVector::from_fn(|k, _| offset(k).1),
            described_from_ours,
            link_from_flange_rotation: last * arm.link_from_flange_rotation,
            link_from_flange_translation: last * arm.link_from_flange_translation - Vector3::z() * slides_m[N - 1],
        }
    }

    /// Sine and cosine of every `q + offset`. q (rad).
    #[inline]
    pub fn turns(&self, q: &SVector<f64, N>) -> [Turn; N] {
        let mut turns = [(0.0, 1.0); N];
        for start in (0..N).step_by(4) {
            let (sin, cos) = four(q, start).sin_cos();
            let (s, c) = (four(&self.offset_sines, start), four(&self.offset_cosines, start));
            let (sin, cos) = (sin.mul_add(c, cos * s).to_array(), cos.mul_add(c, -(sin * s)).to_array());
            for k in start..N.min(start + 4) {
                turns[k] = (sin[k - start], cos[k - start]);
            }
        }
        turns
    }

    /// Rotation and origin of link k's frame as the mechanism has it, from those of its frame here.
    #[inline]
    pub fn described(&self, k: usize, rotation: &Matrix3<f64>, origin: &Vector3<f64>) -> (Matrix3<f64>, Vector3<f64>) {
        let (turn, slide) = self.described_from_ours[k];
        (rotation * about_z(turn).transpose(), origin - rotation.column(2) * slide)
    }
}

/// `(u, sin alpha, cos alpha)` of a rotation `RotZ(u) RotX(alpha) RotZ(v)`. Of parallel axes u is free, and turns x along `translation`.
fn tilt(rotation: &Matrix3<f64>, translation: &Vector3<f64>) -> (Turn, f64, f64) {
    let (x, y, cos) = (rotation[(0, 2)], rotation[(1, 2)], rotation[(2, 2)]);
    let sin = x.hypot(y);
    let distance = translation.x.hypot(translation.y);
    match (sin > ROUNDING, distance > 0.0) {
        (true, _) if cos.abs() < ROUNDING => ((x / sin, -y / sin), 1.0, 0.0),
        (true, _) => ((x / sin, -y / sin), sin, cos),
        (false, true) => ((translation.y / distance, translation.x / distance), 0.0, cos.signum()),
        (false, false) => ((0.0, 1.0), 0.0, cos.signum()),
    }
}

/// Base parameters of every link, from the tip: each gives what lies on its axis to the link before it.
fn bodies<const N: usize>(
    arm: &Mechanism<N>,
    joints: &[Joint; N],
    described_from_ours: &[(Turn, f64); N],
) -> [Body; N] {
    let mut bodies = [Body::default(); N];
    let (mut mass, mut h, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
    for k in (0..N).rev() {
        let (turn, slide) = described_from_ours[k];
        let link = arm.links[k].placed(&about_z(turn).transpose(), &(Vector3::z() * -slide));
        mass += link.mass_kg;
        h += link.com_m * link.mass_kg;
        // ∫ r rᵀ dm = tr(I_o)/2 − I_o
        let inertia = link.inertia_about_origin();
        second += Matrix3::from_diagonal_element(0.5 * inertia.trace()) - inertia;
        let s = |r: usize, c: usize| second[(r, c)];
        bodies[k] = Body { hx: h.x, hy: h.y, xx: s(0, 0), xy: s(0, 1), xz: s(0, 2), yy: s(1, 1), yz: s(1, 2) };

        let Joint { sin, cos, p, .. } = joints[k];
        let axis = Vector3::new(0.0, -sin, cos);
        let across = p * axis.transpose() * h.z;
        second = p * p.transpose() * mass + across + across.transpose() + axis * axis.transpose() * s(2, 2);
        h = p * mass + axis * h.z;
    }
    bodies
}

fn about_z((sin, cos): Turn) -> Matrix3<f64> {
    Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
}

fn about_x((sin, cos): Turn) -> Matrix3<f64> {
    Matrix3::new(1.0, 0.0, 0.0, 0.0, cos, -sin, 0.0, sin, cos)
}

/// Sine and cosine of the sum of two angles.
fn turned((s1, c1): Turn, (s2, c2): Turn) -> Turn {
    (multiply_add(s1, c2, c1 * s2), multiply_add(c1, c2, -(s1 * s2)))
}
