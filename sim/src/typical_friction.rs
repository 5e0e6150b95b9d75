//! How much friction the joints of an arm have.

use tribo_friction::FrictionModel;
use tribo_friction::law::{CoulombViscous, Lugre, Stribeck};

/// Friction parameters of the joints of one arm, of which the named truths are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TypicalFriction<const N: usize> {
    /// Dry and viscous friction of each joint.
    pub coulomb_viscous: [CoulombViscous; N],
    /// Stribeck friction of each joint.
    pub stribeck: [Stribeck; N],
}

/// Presliding distance of bristle friction (rad).
const PRESLIDING_RAD: f64 = 5e-4;
/// Largest Coulomb friction of a Panda's joint (Nm).
const PANDA_COULOMB_NM: f64 = 0.9;
/// Largest viscous friction of a Panda's joint [Nm s/rad].
const PANDA_VISCOUS_NM_S: f64 = 1.4;

impl<const N: usize> TypicalFriction<N> {
    /// Of joints of which only Coulomb (Nm) and viscous friction [Nm s/rad] are known. The Stribeck curve is assumed to be
    /// shaped like the Panda's: 5/6 of the Coulomb friction, 0.55 of it more at rest, 1/v_s = 7.5 s/rad, shape 1.7.
    pub fn new(coulomb_nm: [f64; N], viscous_nm_s_per_rad: [f64; N]) -> Self {
        let coulomb_viscous = std::array::from_fn(|j| CoulombViscous {
            coulomb_nm: coulomb_nm[j],
            viscous_nm_s_per_rad: viscous_nm_s_per_rad[j],
        });
        let stribeck = coulomb_viscous.map(|law: CoulombViscous| Stribeck {
            coulomb_nm: 5.0 / 6.0 * law.coulomb_nm,
            viscous_nm_s_per_rad: law.viscous_nm_s_per_rad,
            breakaway_minus_coulomb_nm: 0.55 * law.coulomb_nm,
            inverse_stribeck_velocity_s_per_rad: 7.5,
            shape: 1.7,
        });
        Self { coulomb_viscous, stribeck }
    }

    /// How many times the largest of a Panda's joints each joint has (Coulomb 0.9 Nm, viscous 1.4 Nm s/rad), at least 1.
    pub fn times_panda(&self) -> [f64; N] {
        self.coulomb_viscous
            .map(|law| (law.coulomb_nm / PANDA_COULOMB_NM).max(law.viscous_nm_s_per_rad / PANDA_VISCOUS_NM_S).max(1.0))
    }

    /// Coulomb and viscous friction.
    pub fn coulomb_viscous(&self) -> FrictionModel<N> {
        FrictionModel { joints: self.coulomb_viscous.map(Into::into) }
    }

    /// Stribeck friction.
    pub fn stribeck(&self) -> FrictionModel<N> {
        FrictionModel { joints: self.stribeck.map(Into::into) }
    }

    /// Bristle friction: the Coulomb and viscous values and a presliding distance of 5e-4 rad.
    pub fn lugre(&self) -> FrictionModel<N> {
        let joints = self.coulomb_viscous.map(|CoulombViscous { coulomb_nm, viscous_nm_s_per_rad }| {
            Lugre { coulomb_nm, viscous_nm_s_per_rad, presliding_distance_rad: PRESLIDING_RAD }.into()
        });
        FrictionModel { joints }
    }
}

impl TypicalFriction<6> {
    /// UR3e: see [`Self::ur10e`].
    pub fn ur3e() -> Self {
        let values = [1.12, 1.12, 0.56, 0.24, 0.24, 0.24];
        Self::new(values, values)
    }

    /// UR5e: see [`Self::ur10e`].
    pub fn ur5e() -> Self {
        let values = [3.0, 3.0, 3.0, 0.56, 0.56, 0.56];
        Self::new(values, values)
    }

    /// xArm 6. Source: `<dynamics>` in xarm_ros `xarm_description/urdf`, where joints 3 to 5 have what those of the same size
    /// have in the xArm 7.
    pub fn xarm6() -> Self {
        Self::new([1.0; 6], [10.0, 10.0, 5.0, 5.0, 5.0, 2.0])
    }

    /// UR10e. The vendor publishes none. Assumption: 2 % of the torque limit dry, and as much per rad/s: the order of
    /// magnitude of strain-wave gears of this size, in proportion to the Panda's.
    pub fn ur10e() -> Self {
        let values = [6.6, 6.6, 3.0, 1.1, 1.1, 1.1];
        Self::new(values, values)
    }
}

impl TypicalFriction<7> {
    /// Panda, motor side: the arm of the examples, of the size that identifications report.
    pub fn panda() -> Self {
        let coulomb = [0.60, 0.90, 0.55, 0.80, 0.40, 0.30, 0.35];
        let viscous = [1.0, 1.4, 0.8, 1.1, 0.5, 0.4, 0.3];
        let coulomb_of_curve = [0.5, 0.75, 0.45, 0.65, 0.33, 0.25, 0.28];
        let breakaway = [0.35, 0.5, 0.3, 0.4, 0.2, 0.15, 0.15];
        let inverse_velocity = [6.0, 6.5, 7.0, 7.5, 8.0, 8.5, 9.0];
        let shape = [1.4, 1.5, 1.6, 1.7, 1.8, 1.9, 2.0];
        let stribeck = std::array::from_fn(|j| Stribeck {
            coulomb_nm: coulomb_of_curve[j],
            viscous_nm_s_per_rad: viscous[j],
            breakaway_minus_coulomb_nm: breakaway[j],
            inverse_stribeck_velocity_s_per_rad: inverse_velocity[j],
            shape: shape[j],
        });
        Self { stribeck, ..Self::new(coulomb, viscous) }
    }

    /// FR3. Source: `frictionloss` and `damping` in mujoco_menagerie `franka_fr3/fr3.xml`.
    pub fn fr3() -> Self {
        Self::new([1.137, 1.137, 1.137, 1.137, 0.763, 0.44, 0.248], [0.21; 7])
    }

    /// xArm 7. Source: `<dynamics>` in xarm_ros `xarm_description/urdf`.
    pub fn xarm7() -> Self {
        Self::new([1.0; 7], [10.0, 10.0, 5.0, 5.0, 5.0, 2.0, 2.0])
    }

    /// Kinova Gen3. Source: `tribo diagnose` on the public logs of experiment 06; joint 1 with its load dependence taken
    /// out (2.6 Nm, 2.2 Nm s/rad). Joint 5 showed no viscous friction; joint 6's is assumed, which has the same actuator.
    pub fn kinova_gen3() -> Self {
        Self::new([2.8, 2.6, 2.2, 2.8, 1.1, 1.3, 1.3], [2.6, 2.2, 2.3, 1.8, 1.9, 1.2, 1.2])
    }

    /// iiwa 14. Viscous: `damping` in drake_models `iiwa14_no_collision.urdf`. Dry friction is published by nobody;
    /// assumption: 1 % of the torque limit, in proportion to the Panda's.
    pub fn iiwa14() -> Self {
        Self::new([3.2, 3.2, 1.76, 1.76, 1.1, 0.4, 0.4], [0.5; 7])
    }
}

/// Typical friction of a preset with as many joints as it happens to have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyTypicalFriction {
    /// Six joints.
    Six(TypicalFriction<6>),
    /// Seven joints.
    Seven(TypicalFriction<7>),
}

impl AnyTypicalFriction {
    /// That of the preset of a name; `None` if there is none.
    pub fn find(name: &str) -> Option<Self> {
        Some(match name {
            "panda" => Self::Seven(TypicalFriction::panda()),
            "fr3" => Self::Seven(TypicalFriction::fr3()),
            "ur3e" => Self::Six(TypicalFriction::ur3e()),
            "ur5e" => Self::Six(TypicalFriction::ur5e()),
            "ur10e" => Self::Six(TypicalFriction::ur10e()),
            "xarm6" => Self::Six(TypicalFriction::xarm6()),
            "xarm7" => Self::Seven(TypicalFriction::xarm7()),
            "kinova_gen3" => Self::Seven(TypicalFriction::kinova_gen3()),
            "iiwa14" => Self::Seven(TypicalFriction::iiwa14()),
            _ => return None,
        })
    }

    /// The friction, if it is of N joints.
    pub fn with_joints<const N: usize>(&self) -> Option<&TypicalFriction<N>> {
        let friction: &dyn std::any::Any = match self {
            Self::Six(friction) => friction,
            Self::Seven(friction) => friction,
        };
        friction.downcast_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_robot::presets;

    #[test]
    fn every_preset_has_friction_well_below_its_torque_limits() {
        for name in presets::NAMES {
            let friction = AnyTypicalFriction::find(name).expect(name);
            match (presets::find(name), friction) {
                (Some(presets::AnyPreset::Six(preset)), AnyTypicalFriction::Six(friction)) => check(&preset, &friction),
                (Some(presets::AnyPreset::Seven(preset)), AnyTypicalFriction::Seven(friction)) => {
                    check(&preset, &friction);
                }
                other => panic!("{name}: {other:?}"),
            }
        }
        assert_eq!(TypicalFriction::panda().times_panda(), [1.0; 7]);
    }

    fn check<const N: usize>(preset: &presets::Preset<N>, friction: &TypicalFriction<N>) {
        let laws = friction.coulomb_viscous.iter().zip(&friction.stribeck).zip(preset.arm.limits.tau_max_nm.iter());
        for ((law, curve), most) in laws {
            assert!(law.coulomb_nm > 0.0 && law.coulomb_nm < 0.2 * most, "{}: {law:?}", preset.arm.name);
            let at_rest = curve.coulomb_nm + curve.breakaway_minus_coulomb_nm;
            assert!(at_rest > law.coulomb_nm && at_rest < 1.6 * law.coulomb_nm, "{}: {curve:?}", preset.arm.name);
        }
    }
}
