//! What the arms of Universal Robots' e-Series share.

use nalgebra::{SVector, Vector3};
use std::f64::consts::PI;

use super::{Link, links};
use crate::{Arm, JointNames, Limits, LinkInertia, Mechanism, StandardDh};

/// Names of the joints in the vendor's description.
const JOINTS: [&str; 6] =
    ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"];

/// Numbers of one arm.
pub(super) struct Numbers {
    pub name: &'static str,
    /// Standard DH rows (a (m), d (m), alpha (rad)).
    pub dh: [(f64, f64, f64); 6],
    /// Links in the frame at the **far** end of each, as the standard convention has it.
    pub links: [Link; 6],
    /// Speed limits [rad/s].
    pub qd_max_rad_s: [f64; 6],
    /// Torque limits (Nm).
    pub tau_max_nm: [f64; 6],
    /// Rotor inertia reflected through the gears [kg m²].
    pub rotor_inertia_kg_m2: [f64; 6],
}

/// The arm without payload, base axes of its controller (x to the side of the cable), flange as its controller reports it. Joints
/// turn a whole turn either way, the elbow half of one, as planners use it. The vendor publishes no torque rate; assumption:
/// 1000 Nm/s, as the Panda's.
pub(super) fn arm(numbers: &Numbers) -> Arm<6> {
    let rows = numbers.dh.map(|(a_m, d_m, alpha_rad)| StandardDh { a_m, d_m, alpha_rad });
    let far = links(&numbers.links);
    let flange = rows[5].near_from_far();
    Arm {
        name: numbers.name.to_owned(),
        joint_names: JOINTS.into_iter().map(str::to_owned).collect::<JointNames>(),
        mechanism: Mechanism {
            placements: StandardDh::placements(&rows),
            links: std::array::from_fn(|k| moved(&far[k], &rows[k])),
            link_from_flange_rotation: flange.rotation,
            link_from_flange_translation: flange.translation,
        }
        .into(),
        rotor_inertia_kg_m2: SVector::from(numbers.rotor_inertia_kg_m2),
        limits: Limits {
            q_min_rad: SVector::from([-2.0 * PI, -2.0 * PI, -PI, -2.0 * PI, -2.0 * PI, -2.0 * PI]),
            q_max_rad: SVector::from([2.0 * PI, 2.0 * PI, PI, 2.0 * PI, 2.0 * PI, 2.0 * PI]),
            qd_max_rad_s: SVector::from(numbers.qd_max_rad_s),
            tau_max_nm: SVector::from(numbers.tau_max_nm),
            tau_rate_max_nm_s: SVector::repeat(1000.0),
        },
        gravity_m_s2: Vector3::new(0.0, 0.0, -9.81),
    }
}

/// A link of the far frame in the frame that its joint moves.
fn moved(link: &LinkInertia, row: &StandardDh) -> LinkInertia {
    let near_from_far = row.near_from_far();
    link.placed(&near_from_far.rotation, &near_from_far.translation)
}
