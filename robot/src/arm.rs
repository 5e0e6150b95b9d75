//! The constant description of a serial arm.

use std::ops::Deref;

use nalgebra::{SVector, Vector3};

use crate::{JointNames, LinkInertia, Mechanism, Payload, PreparedMechanism};

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
    /// Joints, links and flange; the arm derefs to it, and [`Arm::altered`] replaces it.
    pub mechanism: PreparedMechanism<N>,
    /// Rotor inertia reflected through the gears [kg m²]; zero describes the link side of the gears.
    pub rotor_inertia_kg_m2: SVector<f64, N>,
    /// Limits of the joints.
    pub limits: Limits<N>,
    /// Gravity [m/s²] in base axes, e.g. (0, 0, −9.81).
    pub gravity_m_s2: Vector3<f64>,
}

impl<const N: usize> Deref for Arm<N> {
    type Target = Mechanism<N>;

    #[inline]
    fn deref(&self) -> &Mechanism<N> {
        &self.mechanism
    }
}

impl<const N: usize> Arm<N> {
    /// The same arm with joints, links or flange changed.
    pub fn altered(mut self, change: impl FnOnce(&mut Mechanism<N>)) -> Self {
        let mut mechanism = Mechanism::clone(&self.mechanism);
        change(&mut mechanism);
        self.mechanism = mechanism.into();
        self
    }

    /// The same arm seen from the link side of its gears: no rotor inertia.
    pub fn link_side(mut self) -> Self {
        self.rotor_inertia_kg_m2 = SVector::zeros();
        self
    }

    /// The same arm with a rigid body bolted to its flange (`payload` in the flange frame).
    pub fn with_payload(self, payload: &Payload) -> Self {
        let Payload { mass_kg, com_m, inertia_kg_m2 } = *payload;
        let body = LinkInertia { mass_kg, com_m, inertia_kg_m2 }
            .placed(&self.link_from_flange_rotation, &self.link_from_flange_translation);
        self.altered(|mechanism| mechanism.links[N - 1] = mechanism.links[N - 1].combined(&body))
    }

    /// The same arm with every link's mass, first moment and inertia scaled by `1 + relative[k]`.
    pub fn with_link_scale_errors(self, relative: &SVector<f64, N>) -> Self {
        self.altered(|mechanism| {
            for (link, error) in mechanism.links.iter_mut().zip(relative.iter()) {
                link.mass_kg *= 1.0 + error;
                link.inertia_kg_m2 *= 1.0 + error;
            }
        })
    }

    /// Whether q lies inside the joint limits, and the first joint that does not.
    #[inline]
    pub fn first_joint_outside_limits(&self, q: &SVector<f64, N>) -> Option<usize> {
        (0..N).find(|&j| !(q[j] >= self.limits.q_min_rad[j] && q[j] <= self.limits.q_max_rad[j]))
    }
}
