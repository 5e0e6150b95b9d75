//! Contact and collision.

use nalgebra::{SVector, Vector6};

/// Thresholds on the external torque (Nm) and on the wrench at the stiffness frame (N, then Nm), for joints and axes that
/// accelerate and for the rest: a *contact* is told in the state, a *collision* stops the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollisionThresholds {
    /// Contact while accelerating (Nm).
    pub contact_torque_accelerating_nm: [f64; 7],
    /// Collision while accelerating (Nm).
    pub collision_torque_accelerating_nm: [f64; 7],
    /// Contact (Nm).
    pub contact_torque_nm: [f64; 7],
    /// Collision (Nm).
    pub collision_torque_nm: [f64; 7],
    /// Contact while accelerating (N, Nm).
    pub contact_force_accelerating: [f64; 6],
    /// Collision while accelerating (N, Nm).
    pub collision_force_accelerating: [f64; 6],
    /// Contact (N, Nm).
    pub contact_force: [f64; 6],
    /// Collision (N, Nm).
    pub collision_force: [f64; 6],
}

impl Default for CollisionThresholds {
    /// The thresholds that libfranka's examples set.
    fn default() -> Self {
        let torque = [20.0, 20.0, 18.0, 18.0, 16.0, 14.0, 12.0];
        let force = [20.0, 20.0, 20.0, 25.0, 25.0, 25.0];
        Self {
            contact_torque_accelerating_nm: torque,
            collision_torque_accelerating_nm: torque,
            contact_torque_nm: torque,
            collision_torque_nm: torque,
            contact_force_accelerating: force,
            collision_force_accelerating: force,
            contact_force: force,
            collision_force: force,
        }
    }
}

/// What the thresholds say of one state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Touch {
    pub(super) joint_contact: [bool; 7],
    pub(super) joint_collision: [bool; 7],
    pub(super) cartesian_contact: [bool; 6],
    pub(super) cartesian_collision: [bool; 6],
}

impl CollisionThresholds {
    /// Whether all are positive or zero numbers and no contact needs more than its collision.
    pub fn is_valid(&self) -> bool {
        let ordered =
            |lower: &[f64], upper: &[f64]| lower.iter().zip(upper).all(|(l, u)| *l >= 0.0 && l <= u && u.is_finite());
        ordered(&self.contact_torque_nm, &self.collision_torque_nm)
            && ordered(&self.contact_torque_accelerating_nm, &self.collision_torque_accelerating_nm)
            && ordered(&self.contact_force, &self.collision_force)
            && ordered(&self.contact_force_accelerating, &self.collision_force_accelerating)
    }

    /// Flags of an external torque (Nm) and wrench (N, Nm); `accelerating` tells whether the commanded motion is.
    pub(super) fn touch(&self, torque_nm: &SVector<f64, 7>, wrench: &Vector6<f64>, accelerating: bool) -> Touch {
        let pick = |nominal, faster| if accelerating { faster } else { nominal };
        let contact_nm = pick(&self.contact_torque_nm, &self.contact_torque_accelerating_nm);
        let collision_nm = pick(&self.collision_torque_nm, &self.collision_torque_accelerating_nm);
        let axes = |nominal, faster| if accelerating { faster } else { nominal };
        let contact = axes(&self.contact_force, &self.contact_force_accelerating);
        let collision = axes(&self.collision_force, &self.collision_force_accelerating);
        Touch {
            joint_contact: std::array::from_fn(|j| torque_nm[j].abs() > contact_nm[j]),
            joint_collision: std::array::from_fn(|j| torque_nm[j].abs() > collision_nm[j]),
            cartesian_contact: std::array::from_fn(|i| wrench[i].abs() > contact[i]),
            cartesian_collision: std::array::from_fn(|i| wrench[i].abs() > collision[i]),
        }
    }
}
