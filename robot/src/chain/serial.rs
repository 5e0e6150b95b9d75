//! A serial arm as a description has it.

use nalgebra::{SVector, Vector3};

use super::ChainRemark;
use super::assumed;
use super::frame::Frame;
use super::joint::ChainJoint;
use crate::{Arm, JointPlacement, Limits, LinkInertia, Mechanism};

/// Torque rate (Nm/s) of joints of which nobody says better; the Panda's.
const TORQUE_RATE_NM_S: f64 = 1000.0;

/// The serial arm of a description: 6 or 7 joints.
#[derive(Clone, Debug, PartialEq)]
pub struct SerialChain {
    pub(crate) name: String,
    pub(crate) base_link: String,
    pub(crate) joints: Vec<ChainJoint>,
    pub(crate) placements: Vec<JointPlacement>,
    pub(crate) links: Vec<LinkInertia>,
    pub(crate) link_from_flange: Frame,
    /// Gravity [m/s²] in base axes.
    pub(crate) gravity_m_s2: Vector3<f64>,
    pub(crate) remarks: Vec<ChainRemark>,
}

/// The arm of a description and what it says of the friction of the joints.
#[derive(Clone, Debug, PartialEq)]
pub struct DescribedArm<const N: usize> {
    /// The arm, with the name that the description gives it.
    pub arm: Arm<N>,
    /// Names of the joints, from the base.
    pub joint_names: [String; N],
    /// Coulomb friction (Nm): `friction` of URDF, `frictionloss` of MJCF.
    pub coulomb_nm: [f64; N],
    /// Viscous friction [Nm s/rad]: `damping` of both.
    pub viscous_nm_s_per_rad: [f64; N],
}

impl SerialChain {
    /// Name of the link that the arm begins at; wrenches in base axes are in its axes.
    pub fn base_link(&self) -> &str {
        &self.base_link
    }

    /// Names of the joints, from the base.
    pub fn joint_names(&self) -> Vec<String> {
        self.joints.iter().map(|joint| joint.name.clone()).collect()
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.joints.len()
    }

    /// What was decided where the description leaves it open, and what it does not say.
    pub fn remarks(&self) -> Vec<ChainRemark> {
        let without = |known: fn(&ChainJoint) -> bool| -> Option<Vec<String>> {
            let joints: Vec<String> = self.joints.iter().filter(|it| !known(it)).map(|it| it.name.clone()).collect();
            (!joints.is_empty()).then_some(joints)
        };
        let torque = without(|joint| joint.torque_nm.is_some()).map(|joints| ChainRemark::NoTorqueLimit { joints });
        let speed = without(|joint| joint.speed_rad_s.is_some()).map(|joints| ChainRemark::NoSpeedLimit { joints });
        self.remarks.iter().cloned().chain(torque).chain(speed).collect()
    }

    /// The arm, if it has N joints.
    ///
    /// Assumptions where the description says nothing: speed limits π rad/s, torque rates 1000 Nm/s, and torque limits
    ///
    /// ```text
    /// max over q of  |g_j(q)| + M_jj(q) · 10 rad/s²  +  Coulomb_j + viscous_j · speed limit
    /// ```
    pub fn arm<const N: usize>(&self) -> Option<DescribedArm<N>> {
        let joints: &[ChainJoint; N] = self.joints.as_slice().try_into().ok()?;
        let each = |value: &dyn Fn(&ChainJoint) -> f64| SVector::from_fn(|j, _| value(&joints[j]));
        let mut arm = Arm {
            name: self.name.clone(),
            joint_names: joints.iter().map(|joint| joint.name.clone()).collect(),
            mechanism: Mechanism {
                placements: self.placements.as_slice().try_into().ok()?,
                links: self.links.as_slice().try_into().ok()?,
                link_from_flange_rotation: self.link_from_flange.rotation,
                link_from_flange_translation: self.link_from_flange.translation,
            }
            .into(),
            rotor_inertia_kg_m2: each(&|joint| joint.rotor_inertia_kg_m2),
            limits: Limits {
                q_min_rad: each(&|joint| joint.range_rad[0]),
                q_max_rad: each(&|joint| joint.range_rad[1]),
                qd_max_rad_s: each(&|joint| joint.speed_rad_s.unwrap_or(assumed::SPEED_RAD_S)),
                tau_max_nm: each(&|joint| joint.torque_nm.unwrap_or(f64::INFINITY)),
                tau_rate_max_nm_s: SVector::repeat(TORQUE_RATE_NM_S),
            },
            gravity_m_s2: self.gravity_m_s2,
        };
        if joints.iter().any(|joint| joint.torque_nm.is_none()) {
            let least = assumed::torque_limits_nm(&arm);
            for (j, joint) in joints.iter().enumerate() {
                let friction = joint.coulomb_nm + joint.viscous_nm_s_per_rad * arm.limits.qd_max_rad_s[j];
                arm.limits.tau_max_nm[j] =
                    joint.torque_nm.unwrap_or_else(|| (least[j] + friction).min(assumed::LARGEST_NM));
            }
        }
        Some(DescribedArm {
            arm,
            joint_names: std::array::from_fn(|j| joints[j].name.clone()),
            coulomb_nm: std::array::from_fn(|j| joints[j].coulomb_nm),
            viscous_nm_s_per_rad: std::array::from_fn(|j| joints[j].viscous_nm_s_per_rad),
        })
    }
}
