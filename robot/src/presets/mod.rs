//! Arms whose numbers are published, each with its source.
//!
//! | name | joints | arm |
//! |---|---|---|
//! | `panda` | 7 | Franka Emika Panda (FER) |
//! | `fr3` | 7 | Franka Research 3 |
//! | `ur3e`, `ur5e`, `ur10e` | 6 | Universal Robots UR3e, UR5e, UR10e |
//! | `xarm6` | 6 | UFACTORY xArm 6 |
//! | `xarm7` | 7 | UFACTORY xArm 7 |
//! | `kinova_gen3` | 7 | Kinova Gen3 with vision module |
//! | `iiwa14` | 7 | KUKA LBR iiwa 14 R820 |

use std::any::Any;

use nalgebra::{Matrix3, SVector, Vector3};

use crate::{Arm, LinkInertia};

mod e_series;
mod fr3;
mod iiwa14;
mod kinova_gen3;
mod panda;
mod ur10e;
mod ur3e;
mod ur5e;
mod xarm6;
mod xarm7;

pub use fr3::fr3;
pub use iiwa14::iiwa14;
pub use kinova_gen3::kinova_gen3;
pub use panda::{PANDA_JOINT_STIFFNESS_NM_PER_RAD, panda, panda_ready_pose, preset as panda_preset};
pub use ur3e::ur3e;
pub use ur5e::ur5e;
pub use ur10e::ur10e;
pub use xarm6::xarm6;
pub use xarm7::xarm7;

/// Names of the presets, as files and commands spell them.
pub const NAMES: [&str; 9] = ["panda", "fr3", "ur3e", "ur5e", "ur10e", "xarm6", "xarm7", "kinova_gen3", "iiwa14"];

/// An arm and where to try it.
#[derive(Clone, Debug, PartialEq)]
pub struct Preset<const N: usize> {
    /// The arm without payload.
    pub arm: Arm<N>,
    /// Three configurations (rad) away from singularities and limits, the first being the arm's ready pose.
    pub poses_rad: [SVector<f64, N>; 3],
    /// Stiffness between motor and link of each joint [Nm/rad].
    pub joint_stiffness_nm_per_rad: [f64; N],
}

/// A preset with as many joints as it happens to have.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "one at a time, looked up and taken apart")]
pub enum AnyPreset {
    /// Six joints.
    Six(Preset<6>),
    /// Seven joints.
    Seven(Preset<7>),
}

/// The preset of a name; `None` if there is none.
pub fn find(name: &str) -> Option<AnyPreset> {
    Some(match name {
        "panda" => AnyPreset::Seven(panda::preset()),
        "fr3" => AnyPreset::Seven(fr3::preset()),
        "ur3e" => AnyPreset::Six(ur3e::preset()),
        "ur5e" => AnyPreset::Six(ur5e::preset()),
        "ur10e" => AnyPreset::Six(ur10e::preset()),
        "xarm6" => AnyPreset::Six(xarm6::preset()),
        "xarm7" => AnyPreset::Seven(xarm7::preset()),
        "kinova_gen3" => AnyPreset::Seven(kinova_gen3::preset()),
        "iiwa14" => AnyPreset::Seven(iiwa14::preset()),
        _ => return None,
    })
}

impl AnyPreset {
    /// Number of joints.
    pub fn joints(&self) -> usize {
        match self {
            Self::Six(_) => 6,
            Self::Seven(_) => 7,
        }
    }

    /// The preset, if it has N joints.
    pub fn with_joints<const N: usize>(&self) -> Option<&Preset<N>> {
        let preset: &dyn Any = match self {
            Self::Six(preset) => preset,
            Self::Seven(preset) => preset,
        };
        preset.downcast_ref()
    }
}

/// Stiffness (Nm/rad) between motor and link of every joint: that of the preset of the arm's name. Of arms that are no
/// preset nobody knows; assumption: 1e4, the order of magnitude of the strain-wave gears of all presets.
pub fn joint_stiffness_nm_per_rad<const N: usize>(arm: &Arm<N>) -> [f64; N] {
    let preset = find(&arm.name);
    preset.as_ref().and_then(AnyPreset::with_joints::<N>).map_or([1e4; N], |preset| preset.joint_stiffness_nm_per_rad)
}

/// (mass (kg), CoM (m), inertia about the CoM as xx xy xz yy yz zz [kg m²]), in the link frame.
type Link = (f64, [f64; 3], [f64; 6]);

/// The inertias of a table.
fn links<const N: usize>(table: &[Link; N]) -> [LinkInertia; N] {
    table.map(|(mass_kg, com, [xx, xy, xz, yy, yz, zz])| LinkInertia {
        mass_kg,
        com_m: Vector3::from(com),
        inertia_kg_m2: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
    })
}

/// Rotation by quarter turns about x, exact.
fn quarter_turns_x(turns: i32) -> Matrix3<f64> {
    let (s, c) = match turns.rem_euclid(4) {
        0 => (0.0, 1.0),
        1 => (1.0, 0.0),
        2 => (0.0, -1.0),
        _ => (-1.0, 0.0),
    };
    Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_found_with_its_own_number_of_joints_only() {
        for name in NAMES {
            let preset = find(name).expect(name);
            assert_eq!(preset.with_joints::<6>().is_some(), preset.joints() == 6, "{name}");
            assert_eq!(preset.with_joints::<7>().is_some(), preset.joints() == 7, "{name}");
            let called = match &preset {
                AnyPreset::Six(preset) => &preset.arm.name,
                AnyPreset::Seven(preset) => &preset.arm.name,
            };
            assert_eq!(called, name);
        }
        assert_eq!(find("ur5"), None);
    }
}
