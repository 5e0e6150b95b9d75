//! What there is to export.

use tribo_friction::law::CoulombViscous;
use tribo_friction::{Compensator, JointEffects, JointFriction, VelocitySource};
use tribo_robot::Arm;

use super::ExportError;
use tribo_model::{ControllerModel, FieldError, Model, ModelFile, NotCancelled, Robot, TunedFile};

/// A tuned compensator with everything that its file says of the robot.
#[derive(Clone, Debug, PartialEq)]
pub struct TunedCompensator<const N: usize> {
    /// Law, effects on top of it, velocity source.
    pub compensator: Compensator<N>,
    /// Name of the robot.
    pub robot: String,
    /// One sentence on where the numbers come from.
    pub origin: String,
    /// The arm that the controller believes in; none where the file does not say.
    pub arm: Option<Arm<N>>,
    /// Whether that is more than the bare robot: a payload, a tilt, inertia.
    pub extended_arm: bool,
    /// The robot's first pose (rad), within its limits.
    pub pose_rad: Option<[f64; N]>,
    /// Names of the joints, where a description gives them.
    pub joint_names: Option<[String; N]>,
    /// What the compensator leaves out itself.
    pub not_cancelled: Vec<NotCancelled>,
    /// Whether there is no compensator at all: a robot, and the friction that its joints are taken to have.
    pub robot_alone: bool,
}

impl<const N: usize> TunedCompensator<N> {
    /// What is in a file.
    ///
    /// # Errors
    /// A field that is out of range.
    pub fn of(tuned: &TunedFile) -> Result<Self, FieldError> {
        let model = tuned.controller_model::<N>()?;
        let robot = model.as_ref().map(|model| model.robot.clone()).or_else(|| Robot::preset(&tuned.robot));
        let controller_model = model.as_ref().map(ControllerModel::by_controller);
        let mut compensator = tuned.compensator::<N>()?;
        if let Some(controller_model) = &controller_model {
            compensator = compensator.with_effects(controller_model.effects);
        }
        let extended_arm = controller_model.as_ref().zip(robot.as_ref()).is_some_and(|(it, robot)| it.arm != robot.arm);
        let pose_rad = robot.as_ref().map(|robot| robot.poses_rad[0].into());
        let (arm, not_cancelled) = match controller_model {
            Some(controller_model) => (Some(controller_model.arm), controller_model.not_cancelled),
            None => (robot.map(|robot| robot.arm), Vec::new()),
        };
        Ok(Self {
            compensator,
            robot: tuned.robot.clone(),
            origin: origin(tuned),
            arm,
            extended_arm,
            pose_rad,
            joint_names: tuned.model.as_ref().and_then(|model| model.joint_names()),
            not_cancelled,
            robot_alone: false,
        })
    }

    /// The robot of a model file: its bare arm, and the friction that the file gives, else the robot's own.
    ///
    /// # Errors
    /// A field that is out of range.
    pub fn of_robot(file: &ModelFile) -> Result<Self, FieldError> {
        let Model { robot, friction, .. } = file.validate::<N>()?;
        let friction = if file.friction.is_some() { friction } else { robot.known_friction() };
        Ok(Self {
            compensator: Compensator::new(friction, VelocitySource::Measured),
            robot: robot.arm.name.clone(),
            origin: format!("Tribo {}, of {}, without a campaign", env!("CARGO_PKG_VERSION"), file.robot),
            pose_rad: Some(robot.poses_rad[0].into()),
            joint_names: file.joint_names(),
            arm: Some(robot.arm),
            extended_arm: false,
            not_cancelled: Vec::new(),
            robot_alone: true,
        })
    }

    /// The arm.
    ///
    /// # Errors
    /// The file does not say which.
    pub(super) fn known_arm(&self) -> Result<&Arm<N>, ExportError> {
        self.arm.as_ref().ok_or_else(|| ExportError::UnknownArm { robot: self.robot.clone() })
    }

    /// The joints' names, `joint_1` … where nobody gave any.
    pub(super) fn names(&self) -> [String; N] {
        self.joint_names.clone().unwrap_or_else(|| std::array::from_fn(|j| format!("joint_{}", j + 1)))
    }

    /// Whether the compensator has torques on top of its law.
    pub(super) fn has_effects(&self) -> bool {
        self.compensator.effects.iter().any(|effects| !effects.is_none())
    }

    /// Torque (Nm) of one joint sliding at qd [rad/s]: law and effects that depend on the velocity alone.
    pub(super) fn sliding_torque_nm(&self, joint: usize, qd: f64, smoothing_rad_s: f64) -> f64 {
        let effects = JointEffects {
            offset_nm: 0.0,
            ripples: Default::default(),
            spring_nm_per_rad: 0.0,
            ..self.compensator.effects[joint]
        };
        self.compensator.friction.joints[joint].torque(qd, smoothing_rad_s)
            + effects.steady_torque_nm(0.0, qd, 0.0, smoothing_rad_s)
    }

    /// Dry friction (Nm) of one joint that is left at high speed, mean of both directions; 0 of a sigmoid, which has none.
    pub(super) fn dry_limit_nm(&self, joint: usize) -> f64 {
        let law_nm = match self.compensator.friction.joints[joint] {
            JointFriction::CoulombViscous(law) => law.coulomb_nm,
            JointFriction::Stribeck(law) => law.dry_limit(self.top_speed_rad_s(joint)),
            JointFriction::Lugre(law) => law.coulomb_nm,
            JointFriction::Asymmetric(law) => 0.5 * (law.coulomb_positive_nm + law.coulomb_negative_nm),
            JointFriction::GazSigmoid(_) => 0.0,
        };
        law_nm + self.compensator.effects[joint].coulomb_nm
    }

    /// Viscous friction [Nm s/rad] of one joint, mean of both directions.
    pub(super) fn viscous_nm_s_per_rad(&self, joint: usize) -> f64 {
        let law = match self.compensator.friction.joints[joint] {
            JointFriction::CoulombViscous(CoulombViscous { viscous_nm_s_per_rad, .. }) => viscous_nm_s_per_rad,
            JointFriction::Stribeck(law) => law.viscous_nm_s_per_rad,
            JointFriction::Lugre(law) => law.viscous_nm_s_per_rad,
            JointFriction::Asymmetric(law) => {
                0.5 * (law.viscous_positive_nm_s_per_rad + law.viscous_negative_nm_s_per_rad)
            }
            JointFriction::GazSigmoid(_) => 0.0,
        };
        law + self.compensator.effects[joint].viscous_nm_s_per_rad
    }

    /// Speed limit of one joint [rad/s]; infinite where the arm is not known.
    pub(super) fn top_speed_rad_s(&self, joint: usize) -> f64 {
        self.arm.as_ref().map_or(f64::INFINITY, |arm| arm.limits.qd_max_rad_s[joint])
    }

    /// Largest difference (Nm) of each joint's sliding torque to `other`(joint, qd) between ± its speed limit, of which
    /// both are samples: 400 speeds a constant factor apart from a billionth of it, and 400 a constant step apart.
    pub(super) fn largest_difference_nm(&self, smoothing_rad_s: f64, other: impl Fn(usize, f64) -> f64) -> Vec<f64> {
        const SAMPLES: i32 = 400;
        let largest = |joint: usize| {
            let top = self.top_speed_rad_s(joint);
            let fraction = |k: i32| f64::from(k) / f64::from(SAMPLES);
            let speeds = (1..=SAMPLES).flat_map(|k| [fraction(k), 1e-9_f64.powf(1.0 - fraction(k))]);
            let off = |qd: f64| (self.sliding_torque_nm(joint, qd, smoothing_rad_s) - other(joint, qd)).abs();
            let worst = speeds.flat_map(|part| [part * top, -part * top]).map(off).fold(0.0, f64::max);
            // Rounding of the last bits is no difference.
            if worst < 1e-12 { 0.0 } else { worst }
        };
        (0..N).map(largest).collect()
    }

    /// What the velocity source is, in words.
    pub(super) fn source_name(&self) -> &'static str {
        match self.compensator.source {
            VelocitySource::Measured => "measured",
            VelocitySource::Reference => "reference",
            VelocitySource::Hybrid => "hybrid",
        }
    }
}

/// Where the numbers come from, in words.
fn origin(tuned: &TunedFile) -> String {
    let costs = match (tuned.cost, tuned.uncompensated_cost) {
        (Some(cost), Some(without)) => format!("cost {cost:.3} with this compensation, {without:.3} without"),
        (Some(cost), None) => format!("cost {cost:.3}"),
        (None, _) => "not tried yet".to_owned(),
    };
    format!("Tribo {}, trial {}, seed {}: {costs}", tuned.tribo_version, tuned.trial, tuned.seed)
}
