//! A robot model on disk.

use serde::{Deserialize, Serialize};
use tribo_logs::RobotLog;
use tribo_sim::{Effect, TorqueSide};

use crate::{FrictionSection, LimitsSection};

/// Schema name of model files.
pub(crate) const SCHEMA: &str = "tribo.model/1";

/// Model YAML, `schema: tribo.model/1`: the arm, the side of its torque sensors, friction, payload and further causes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelFile {
    /// `tribo.model/1`.
    pub schema: String,
    /// Name of a preset (see [`tribo_robot::presets`]), or the path of a URDF or MJCF, relative to this file.
    pub robot: String,
    /// Content of that URDF, as it was when the file was written by Tribo; goes before what the disk holds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub urdf: Option<String>,
    /// Content of that MJCF, with everything that it includes; likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mjcf: Option<String>,
    /// Link of the URDF or body of the MJCF at which the arm begins; the root, or the body that carries the first joint, if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base_link: Option<String>,
    /// Link of the URDF, body or site of the MJCF whose frame is the flange; the only end if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tip_link: Option<String>,
    /// Number of joints, for the reader; must match the robot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joints: Option<usize>,
    /// Side of the gears on which torques are meant.
    #[serde(default)]
    pub torque_side: TorqueSide,
    /// Gravity in base axes [m/s²].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity_m_s2: Option<[f64; 3]>,
    /// Reflected rotor inertia [kg m²], one per joint; the preset's if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotor_inertia_kg_m2: Option<Vec<f64>>,
    /// Limits in place of the robot's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<LimitsSection>,
    /// Configurations (rad) about which trials move, up to three; the robot's if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub poses_rad: Option<Vec<Vec<f64>>>,
    /// Friction; none if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<FrictionSection>,
    /// Body bolted to the flange.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub payload: Option<PayloadSection>,
    /// Causes on top of all that, as a diagnosis finds them.
    #[serde(default, skip_serializing_if = "Vec::is_empty", deserialize_with = "crate::effect_entries::read")]
    pub effects: Vec<Effect>,
}

/// `payload: {mass_kg, com_m, inertia_kg_m2}`, flange frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PayloadSection {
    /// Mass (kg).
    pub mass_kg: f64,
    /// Centre of mass (m).
    #[serde(default)]
    pub com_m: [f64; 3],
    /// Inertia about the centre of mass [kg m²]: xx xy xz yy yz zz.
    #[serde(default)]
    pub inertia_kg_m2: [f64; 6],
}

impl ModelFile {
    /// The bare robot of a name without friction: what logs without a model file are held against. Where every one of
    /// `logs` has torque on both sides of the gears, there is only the transmission between: rotors that weigh nothing.
    pub fn bare(robot: &str, torque_side: TorqueSide, logs: &[RobotLog]) -> Self {
        let between_gears = !logs.is_empty() && logs.iter().all(|log| log.tau_link_nm.is_some());
        let joints = logs.first().map_or(0, |log| log.joints());
        Self {
            schema: SCHEMA.to_owned(),
            robot: robot.to_owned(),
            urdf: None,
            mjcf: None,
            base_link: None,
            tip_link: None,
            joints: None,
            torque_side,
            gravity_m_s2: None,
            rotor_inertia_kg_m2: between_gears.then(|| vec![0.0; joints]),
            limits: None,
            poses_rad: None,
            friction: None,
            payload: None,
            effects: Vec::new(),
        }
    }

    /// The same arm as torque sensors behind its gears see it: rigid bodies alone, without rotors, friction and whatever else is the gears'.
    pub fn behind_gears(mut self) -> Self {
        self.torque_side = TorqueSide::Link;
        (self.rotor_inertia_kg_m2, self.friction) = (None, None);
        let of_bodies = |effect: &Effect| {
            matches!(effect, Effect::Payload { .. } | Effect::LinkInertial { .. } | Effect::BaseTilt { .. })
        };
        self.effects.retain(of_bodies);
        self
    }
}
