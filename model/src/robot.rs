//! The robot of a campaign.

use nalgebra::SVector;
use tribo_friction::FrictionModel;
use tribo_robot::presets::{AnyPreset, Preset};
use tribo_robot::{Arm, DescribedArm, Kinematics, presets, well_conditioned_poses};
use tribo_sim::{AnyTypicalFriction, TypicalFriction};

/// An arm, where to try it, and how much friction its joints are taken to have.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot<const N: usize> {
    /// The bare arm.
    pub arm: Arm<N>,
    /// Configurations (rad) about which the tool moves, by the number of the pose.
    pub poses_rad: [SVector<f64, N>; 3],
    /// Friction of its joints, as the named truths have it; none where nobody says.
    pub friction: Option<TypicalFriction<N>>,
}

/// Number of poses.
pub const POSES: usize = 3;
/// Largest torque limit of a Panda's joint (Nm).
const PANDA_TORQUE_NM: f64 = 87.0;

impl<const N: usize> Robot<N> {
    /// The preset of a name, if there is one with N joints.
    #[inline(never)]
    pub fn preset(name: &str) -> Option<Self> {
        let preset = presets::find(name)?;
        let Preset { arm, poses_rad, .. } = preset.with_joints::<N>()?.clone();
        let friction = AnyTypicalFriction::find(name).and_then(|friction| friction.with_joints::<N>().copied());
        Some(Self { arm, poses_rad, friction })
    }

    /// The arm of a URDF or MJCF: poses well away from its singularities, the friction that it gives unless all is zero.
    #[inline(never)]
    pub fn of_description(described: DescribedArm<N>) -> Self {
        let DescribedArm { arm, coulomb_nm, viscous_nm_s_per_rad, .. } = described;
        let known = coulomb_nm.iter().chain(&viscous_nm_s_per_rad).any(|value| *value > 0.0);
        let poses_rad = well_conditioned_poses(&arm);
        Self { arm, poses_rad, friction: known.then(|| TypicalFriction::new(coulomb_nm, viscous_nm_s_per_rad)) }
    }

    /// Coulomb and viscous friction that the joints are taken to have; none where nobody says.
    pub fn known_friction(&self) -> FrictionModel<N> {
        self.friction.as_ref().map_or_else(FrictionModel::none, TypicalFriction::coulomb_viscous)
    }

    /// How many times a Panda's friction each joint is taken to have: as its friction goes, else as its torque limit (over 87 Nm); at
    /// least 1.
    pub fn friction_times_panda(&self) -> [f64; N] {
        match &self.friction {
            Some(friction) => friction.times_panda(),
            None => std::array::from_fn(|j| (self.arm.limits.tau_max_nm[j] / PANDA_TORQUE_NM).max(1.0)),
        }
    }

    /// How many times as far as a Panda's the tool moves in a trial: as many as its reach, to a hundredth, so that the joints turn as far; at least
    /// once, since shorter ways are those that dry friction swallows.
    ///
    /// ```text
    /// reach = Σ |p_k+1 − p_k|        origins of the joints from the second on, then the flange
    /// ```
    pub fn path_times_panda(&self) -> f64 {
        let panda_m = reach_m(&presets::panda(), &presets::panda_ready_pose());
        ((100.0 * reach_m(&self.arm, &self.poses_rad[0]) / panda_m).round() / 100.0).max(1.0)
    }
}

fn reach_m<const N: usize>(arm: &Arm<N>, q: &SVector<f64, N>) -> f64 {
    let kinematics = Kinematics::at(arm, q);
    let flange = kinematics.base_from_flange().translation.vector;
    let origins: Vec<_> = (1..N).map(|k| kinematics.link(arm, k).1).chain([flange]).collect();
    origins.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
}

impl Robot<7> {
    /// The Panda.
    pub fn panda() -> Self {
        let preset = presets::panda_preset();
        Self { arm: preset.arm, poses_rad: preset.poses_rad, friction: Some(TypicalFriction::panda()) }
    }
}

/// Number of joints of a preset; none if there is no such preset.
pub fn joints_of_preset(name: &str) -> Option<usize> {
    presets::find(name).map(|preset: AnyPreset| preset.joints())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tool_of_a_longer_arm_moves_further_in_proportion_and_none_less_than_a_pandas() {
        assert_eq!(Robot::panda().path_times_panda(), 1.0);
        assert_eq!(Robot::<6>::preset("ur10e").unwrap().path_times_panda(), 1.62);
        for factor in [0.5, 1.0, 1.37, 2.0] {
            let Robot { arm, poses_rad, friction } = Robot::panda();
            let arm = arm.altered(|mechanism| {
                mechanism.placements.iter_mut().for_each(|placement| placement.translation *= factor);
                mechanism.link_from_flange_translation *= factor;
            });
            assert_eq!(Robot { arm, poses_rad, friction }.path_times_panda(), f64::max(factor, 1.0));
        }
    }
}
