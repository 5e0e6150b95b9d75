//! From the tree to the arm.

use nalgebra::{SVector, Vector3};
use urdf_rs::JointType;

use super::UrdfError;
use super::body::welded;
use super::frame::{Frame, chained, same};
use super::joint::{ChainJoint, axis_from_z, origin, unsupported};
use super::tree::Tree;
use crate::{Arm, JointPlacement, Limits, LinkInertia};

/// Torque rate (Nm/s) of joints of which nobody says better; the Panda's.
const TORQUE_RATE_NM_S: f64 = 1000.0;
/// Standard gravity of the presets [m/s²].
const GRAVITY_M_S2: f64 = 9.81;

/// The serial arm in a URDF: 6 or 7 joints.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfChain {
    name: String,
    base_link: String,
    joints: Vec<ChainJoint>,
    placements: Vec<JointPlacement>,
    links: Vec<LinkInertia>,
    link_from_flange: Frame,
}

/// The arm of a URDF and what it says of the friction of the joints.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfArm<const N: usize> {
    /// The arm; its name is that of the robot in the URDF, its rotors have no inertia.
    pub arm: Arm<N>,
    /// Names of the joints, from the base.
    pub joint_names: [String; N],
    /// `friction` of `<dynamics>` (Nm).
    pub coulomb_nm: [f64; N],
    /// `damping` of `<dynamics>` [Nm s/rad].
    pub viscous_nm_s_per_rad: [f64; N],
}

impl UrdfChain {
    /// Reads the text of a URDF. `base` and `tip` name links; without, the arm goes from the root to the only end.
    ///
    /// # Errors
    /// What cannot be read or is not supported, with the joint or link to blame.
    pub fn parse(text: &str, base: Option<&str>, tip: Option<&str>) -> Result<Self, UrdfError> {
        let tree = Tree::parse(text)?;
        let path = tree.path(base, tip)?;
        let (mut joints, mut placements, mut links) = (Vec::new(), Vec::new(), Vec::new());
        // The frame of the link that the path has come to, in the frame of the body that it belongs to.
        let mut body_from_link = same();
        let chain = path.joints.iter().copied().collect();
        for &k in &path.joints {
            let joint = &tree.robot.joints[k];
            if let Some(kind) = unsupported(&joint.joint_type) {
                return Err(UrdfError::Kind { joint: joint.name.clone(), kind });
            }
            let body_from_joint = chained(&body_from_link, &origin(joint)?);
            if joint.joint_type == JointType::Fixed {
                body_from_link = body_from_joint;
                continue;
            }
            // The new body's frame is the joint's with its axis turned onto z.
            joints.push(ChainJoint::of(joint)?);
            let joint_from_body = Frame { rotation: axis_from_z(joint)?, translation: Vector3::zeros() };
            placements.push(chained(&body_from_joint, &joint_from_body));
            body_from_link = Frame { rotation: joint_from_body.rotation.transpose(), ..joint_from_body };
            let body = welded(&tree, &joint.child.link, body_from_link, &chain)?;
            if body.mass_kg <= 0.0 {
                return Err(UrdfError::NoInertia { joint: joint.name.clone(), link: joint.child.link.clone() });
            }
            links.push(body);
        }
        if !(6..=7).contains(&joints.len()) {
            return Err(UrdfError::Joints { found: joints.len(), base: path.base, tip: path.tip });
        }
        Ok(Self {
            name: tree.robot.name,
            base_link: path.base,
            joints,
            placements,
            links,
            link_from_flange: body_from_link,
        })
    }

    /// Name of the link that the arm begins at; wrenches in base axes are in its axes.
    pub fn base_link(&self) -> &str {
        &self.base_link
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.joints.len()
    }

    /// The arm, if it has N joints.
    pub fn arm<const N: usize>(&self) -> Option<UrdfArm<N>> {
        let joints: &[ChainJoint; N] = self.joints.as_slice().try_into().ok()?;
        let each = |value: &dyn Fn(&ChainJoint) -> f64| SVector::from_fn(|j, _| value(&joints[j]));
        let arm = Arm {
            name: self.name.clone(),
            placements: self.placements.as_slice().try_into().ok()?,
            links: self.links.as_slice().try_into().ok()?,
            link_from_flange_rotation: self.link_from_flange.rotation,
            link_from_flange_translation: self.link_from_flange.translation,
            rotor_inertia_kg_m2: SVector::zeros(),
            limits: Limits {
                q_min_rad: each(&|joint| joint.range_rad[0]),
                q_max_rad: each(&|joint| joint.range_rad[1]),
                qd_max_rad_s: each(&|joint| joint.speed_rad_s),
                tau_max_nm: each(&|joint| joint.torque_nm),
                tau_rate_max_nm_s: SVector::repeat(TORQUE_RATE_NM_S),
            },
            gravity_m_s2: Vector3::new(0.0, 0.0, -GRAVITY_M_S2),
        };
        Some(UrdfArm {
            arm,
            joint_names: std::array::from_fn(|j| joints[j].name.clone()),
            coulomb_nm: std::array::from_fn(|j| joints[j].coulomb_nm),
            viscous_nm_s_per_rad: std::array::from_fn(|j| joints[j].viscous_nm_s_per_rad),
        })
    }
}
