//! Which robot a model file is about.

use std::path::Path;

use tribo_robot::mjcf::{self, MjcfError};
use tribo_robot::{ChainRemark, DescriptionError, SerialChain, parse_description, presets};

use crate::limits_section::per_joint;
use crate::{ConfigError, Robot};
use crate::{FieldError, FileError, ModelFile, read_text};
use crate::{POSES, joints_of_preset};

/// What a field `robot` may hold.
fn allowed_robots() -> String {
    format!("{} or the path of a URDF or MJCF", presets::NAMES.join(", "))
}

impl ModelFile {
    /// Whether the robot is described by a file, and not a preset.
    fn is_described(&self) -> bool {
        joints_of_preset(&self.robot).is_none()
    }

    /// Content of the description, once it has been read.
    fn description(&self) -> Option<&String> {
        self.urdf.as_ref().or(self.mjcf.as_ref())
    }

    /// Reads the URDF or MJCF that `robot` names, relative to `directory`, into the field `urdf` or `mjcf`, unless it is there
    /// already. What an MJCF includes is looked for in its own directory.
    ///
    /// # Errors
    /// [`FileError::Description`] of a file that cannot be used, a range error of a name that is neither preset nor file.
    pub fn resolve(&mut self, directory: &Path) -> Result<(), ConfigError> {
        if self.description().is_some() || !self.is_described() {
            return Ok(());
        }
        let path = directory.join(&self.robot);
        if !path.is_file() {
            return Err(FieldError::new("robot", &self.robot, allowed_robots()).into());
        }
        let mut text = read_text(&path)?;
        let refuse = |source: DescriptionError| FileError::Description { path: path.clone(), source: Box::new(source) };
        if mjcf::is_mjcf(&text) {
            text =
                with_includes(&text, path.parent().unwrap_or(Path::new(""))).map_err(|error| refuse(error.into()))?;
        }
        self.chain(&text).map_err(refuse)?;
        let place = if mjcf::is_mjcf(&text) { &mut self.mjcf } else { &mut self.urdf };
        *place = Some(text);
        Ok(())
    }

    fn chain(&self, description: &str) -> Result<SerialChain, DescriptionError> {
        parse_description(description, self.base_link.as_deref(), self.tip_link.as_deref())
    }

    /// The chain of a robot that is no preset.
    fn read_chain(&self) -> Result<SerialChain, FieldError> {
        let Some(text) = self.description() else {
            return Err(FieldError::new("robot", &self.robot, allowed_robots()));
        };
        self.chain(text).map_err(|error| {
            FieldError::new("robot", &self.robot, format!("a description that can be used, where {error}"))
        })
    }

    /// What was decided where the description of the robot leaves it open, but for limits that this file gives; nothing of a preset.
    pub fn remarks(&self) -> Vec<ChainRemark> {
        let chain = self.description().filter(|_| self.is_described()).and_then(|text| self.chain(text).ok());
        let mut remarks = chain.map_or_else(Vec::new, |chain| chain.remarks());
        let limits = self.limits.clone().unwrap_or_default();
        remarks.retain(|remark| match remark {
            ChainRemark::NoTorqueLimit { .. } => limits.tau_max_nm.is_none(),
            ChainRemark::NoSpeedLimit { .. } => limits.qd_max_rad_s.is_none(),
            _ => true,
        });
        remarks
    }

    /// Names of the joints of a robot that is described by a file, from the base.
    pub fn joint_names<const N: usize>(&self) -> Option<[String; N]> {
        let text = self.description().filter(|_| self.is_described())?;
        Some(self.chain(text).ok()?.arm::<N>()?.joint_names)
    }

    /// The same of any number of joints; none of a preset, whose joints logs and messages may call anything.
    pub fn names_of_joints(&self) -> Vec<String> {
        let chain = self.description().filter(|_| self.is_described()).and_then(|text| self.chain(text).ok());
        chain.map_or_else(Vec::new, |chain| chain.joint_names())
    }

    /// The frame in whose axes the arm's wrenches are: the base link of a robot description; of a preset the name that its maker's description gives
    /// it (of a Universal Robot `base`, whose `base_link` is turned by half a turn).
    pub fn base_frame(&self) -> Option<String> {
        let preset = match self.robot.as_str() {
            "panda" => Some("panda_link0"),
            "fr3" => Some("fr3_link0"),
            "ur3e" | "ur5e" | "ur10e" => Some("base"),
            "xarm6" | "xarm7" => Some("link_base"),
            "kinova_gen3" => Some("base_link"),
            "iiwa14" => Some("iiwa_link_0"),
            _ => None,
        };
        let urdf = || Some(self.chain(self.description()?).ok()?.base_link().to_owned());
        preset.map(str::to_owned).or_else(urdf)
    }

    /// Number of joints of the robot.
    ///
    /// # Errors
    /// A robot that is not there.
    pub fn arm_joints(&self) -> Result<usize, FieldError> {
        match joints_of_preset(&self.robot) {
            Some(joints) => Ok(joints),
            None => Ok(self.read_chain()?.joints()),
        }
    }

    /// The robot with the rotor inertia, limits and poses that the file gives.
    pub(crate) fn to_robot<const N: usize>(&self) -> Result<Robot<N>, FieldError> {
        let joints = self.arm_joints()?;
        for (field, value) in [("base_link", &self.base_link), ("tip_link", &self.tip_link)] {
            if let Some(value) = value.as_ref().filter(|_| !self.is_described()) {
                return Err(FieldError::new(field, value, "only where robot is a URDF or MJCF"));
            }
        }
        let wrong =
            || FieldError::new("robot", format!("{} with {joints} joints", self.robot), format!("a robot with {N}"));
        let mut robot = match Robot::preset(&self.robot) {
            Some(robot) => robot,
            None if self.is_described() => {
                self.read_chain()?.arm::<N>().map(Robot::of_description).ok_or_else(wrong)?
            }
            None => return Err(wrong()),
        };
        if let Some(stated) = self.joints.filter(|stated| *stated != N) {
            return Err(FieldError::new("joints", stated, N.to_string()));
        }
        if let Some(limits) = &self.limits {
            limits.put_over(&mut robot.arm.limits)?;
        }
        if let Some(inertia) = &self.rotor_inertia_kg_m2 {
            let inertia = per_joint::<N>("rotor_inertia_kg_m2", inertia, 0.0, 1e3)?;
            // No inertia at all describes the link side; its motors have what the preset says.
            if inertia.amax() > 0.0 {
                robot.arm.rotor_inertia_kg_m2 = inertia;
            }
        }
        if let Some(poses) = &self.poses_rad {
            if !(1..=POSES).contains(&poses.len()) {
                return Err(FieldError::new(
                    "poses_rad",
                    format!("{} entries", poses.len()),
                    format!("1 to {POSES} entries"),
                ));
            }
            for (k, pose) in poses.iter().enumerate() {
                let field = format!("poses_rad[{k}]");
                let q = per_joint::<N>(&field, pose, -1e3, 1e3)?;
                if let Some(j) = robot.arm.first_joint_outside_limits(&q) {
                    let limits = &robot.arm.limits;
                    let allowed = format!("{} to {} in joint {j}", limits.q_min_rad[j], limits.q_max_rad[j]);
                    return Err(FieldError::new(field, q[j], allowed));
                }
                robot.poses_rad[k] = q;
            }
        }
        Ok(robot)
    }

    /// The part of the file that says which robot it is, and nothing of what is on it or in its joints.
    pub fn robot_alone(&self) -> Self {
        Self {
            torque_side: Default::default(),
            gravity_m_s2: None,
            friction: None,
            payload: None,
            effects: Vec::new(),
            ..self.clone()
        }
    }
}

/// One text of an MJCF and what it includes from its directory.
fn with_includes(text: &str, directory: &Path) -> Result<String, MjcfError> {
    mjcf::with_includes(text, &mut |file| {
        let path = directory.join(file);
        read_text(&path).map_err(|error| match error {
            FileError::Io { source, .. } => source.to_string(),
            other => other.to_string(),
        })
    })
}
