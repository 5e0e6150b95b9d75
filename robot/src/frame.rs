//! A link's frame in base axes.

use nalgebra::{Matrix3, Vector3};
use wide::f64x4;

use crate::canonical::{Canonical, Joint, Turn};

/// `base_from_link`: axes and origin (m), each a vector of the processor with one lane to spare.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    x: f64x4,
    y: f64x4,
    z: f64x4,
    origin: f64x4,
}

impl Frame {
    /// The frame of the first link.
    #[inline]
    pub fn first<const N: usize>(arm: &Canonical<N>, turn: Turn) -> Self {
        let [x, y, z] = arm.base_rotation.data.0.map(padded);
        Self { x, y, z, origin: padded(arm.base_translation.data.0[0]) }.turned(turn)
    }

    /// `base_from_flange`, from the frame of the last link.
    #[inline]
    pub fn flange<const N: usize>(&self, arm: &Canonical<N>) -> (Matrix3<f64>, Vector3<f64>) {
        let axes = arm.link_from_flange_rotation.data.0.map(|axis| self.turn(&Vector3::from(axis)));
        (Matrix3::from_columns(&axes), self.origin() + self.turn(&arm.link_from_flange_translation))
    }

    /// `self · RotZ(q)`.
    #[inline]
    fn turned(&self, (sin, cos): Turn) -> Self {
        let (s, c) = (f64x4::splat(sin), f64x4::splat(cos));
        Self { x: c.mul_add(self.x, s * self.y), y: c.mul_sub(self.y, s * self.x), ..*self }
    }

    /// The frame of the next link.
    #[inline]
    pub fn next(&self, joint: &Joint, turn: Turn) -> Self {
        let Self { x, y, z, origin } = *self;
        let [px, py, pz] = joint.p.data.0[0].map(f64x4::splat);
        let origin = px.mul_add(x, pz.mul_add(z, origin));
        let tilted = if joint.square {
            Self { x, y: z, z: -y, origin }
        } else {
            let (s, c) = (f64x4::splat(joint.sin), f64x4::splat(joint.cos));
            Self { x, y: c.mul_add(y, s * z), z: c.mul_sub(z, s * y), origin: py.mul_add(y, origin) }
        };
        tilted.turned(turn)
    }

    #[inline]
    pub fn rotation(&self) -> Matrix3<f64> {
        Matrix3::from_columns(&[vector(self.x), vector(self.y), vector(self.z)])
    }

    #[inline]
    pub fn origin(&self) -> Vector3<f64> {
        vector(self.origin)
    }

    #[inline]
    pub fn axis(&self) -> Vector3<f64> {
        vector(self.z)
    }

    /// A vector of the link in base axes.
    #[inline]
    pub fn turn(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let [x, y, z] = v.data.0[0].map(f64x4::splat);
        vector(x.mul_add(self.x, y.mul_add(self.y, z * self.z)))
    }
}

#[inline]
fn padded([x, y, z]: [f64; 3]) -> f64x4 {
    f64x4::from([x, y, z, 0.0])
}

#[inline]
fn vector(v: f64x4) -> Vector3<f64> {
    let [x, y, z, _] = v.to_array();
    Vector3::new(x, y, z)
}
