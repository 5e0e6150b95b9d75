//! A connection to the control unit.

use std::sync::atomic::AtomicBool;

use franka::robot::RobotOptions;
use franka::{FrankaError, RealtimeConfig, Robot, RobotState};
use nalgebra::SVector;
use tribo_robot::Arm;

use super::TorquePlant;
use super::approach::{MinimumJerk, duration_s};
use crate::FciVersion;

/// Thresholds of contact and collision during a trial: joints (Nm), then force (N) and moment (Nm). What friction leaves in
/// the unit's external torque is far below, what a person feels as a push is above.
const COLLISION: ([f64; 7], [f64; 6]) =
    ([40.0, 40.0, 36.0, 36.0, 32.0, 28.0, 24.0], [60.0, 60.0, 60.0, 20.0, 20.0, 20.0]);
/// An arm that is nearer to the start than this (rad) stands there.
const THERE_RAD: f64 = 1e-3;

/// What the robot or the network says.
#[derive(Debug, thiserror::Error)]
pub enum RobotError {
    /// In libfranka's words.
    #[error("{0}")]
    Franka(#[from] FrankaError),
    /// The robot is not ready.
    #[error("the robot is in mode {mode}{reasons}; unlock it, clear what stopped it, and try again")]
    NotReady {
        /// Its mode.
        mode: String,
        /// Names of the error flags, in brackets.
        reasons: String,
    },
    /// The start is not reachable.
    #[error("the start of the motion is outside the limits of joint {joint}")]
    StartOutside {
        /// The first such joint.
        joint: usize,
    },
}

/// A connection to a Franka: Panda or FR3, whichever answers.
#[derive(Debug)]
pub struct Connection {
    robot: Robot,
}

impl Connection {
    /// Connects to `host` (or `host:port`), and takes the robot out of a reflex. `real_time` raises this thread to the
    /// highest priority and fails without a real-time kernel, as libfranka does.
    ///
    /// # Errors
    ///
    /// [`RobotError`]: nobody answers, another version, a robot that is not ready.
    pub fn open(host: &str, real_time: bool) -> Result<Self, RobotError> {
        let config = if real_time { RealtimeConfig::Enforce } else { RealtimeConfig::Ignore };
        let robot = Robot::with_options(host, RobotOptions::new(config))?;
        let connection = Self { robot };
        if connection.state()?.robot_mode == franka::robot_state::RobotMode::Reflex {
            connection.robot.automatic_error_recovery()?;
        }
        let state = connection.state()?;
        if state.robot_mode != franka::robot_state::RobotMode::Idle {
            let mode = format!("{:?}", state.robot_mode);
            let reasons = if state.current_errors.any() { format!(" {}", state.current_errors) } else { String::new() };
            return Err(RobotError::NotReady { mode, reasons });
        }
        Ok(connection)
    }

    /// Connects to hear what the robot sends, whatever its mode is: somebody guides it by hand, its stop is pressed. Nothing is commanded
    /// and no reflex is recovered.
    ///
    /// # Errors
    ///
    /// [`RobotError::Franka`]: nobody answers, another version.
    pub fn listen(host: &str) -> Result<Self, RobotError> {
        Ok(Self { robot: Robot::with_options(host, RobotOptions::new(RealtimeConfig::Ignore))? })
    }

    /// The version that the robot speaks.
    pub fn version(&self) -> FciVersion {
        match self.robot.fci_version() {
            franka::wire::robot::codec::FciVersion::V5 => FciVersion::V5,
            franka::wire::robot::codec::FciVersion::V10 => FciVersion::V10,
        }
    }

    /// The state now.
    ///
    /// # Errors
    ///
    /// [`RobotError::Franka`] where the connection is lost.
    pub fn state(&self) -> Result<RobotState, RobotError> {
        Ok(self.robot.read_once()?)
    }

    /// Hears every state that the robot sends, one each millisecond, until `heard` says false. Nothing is commanded.
    ///
    /// # Errors
    ///
    /// [`RobotError::Franka`] where the connection is lost.
    pub fn watch(&self, heard: impl FnMut(&RobotState) -> bool) -> Result<(), RobotError> {
        Ok(self.robot.read(heard)?)
    }

    /// Moves the arm to `q` (rad) by a minimum-jerk motion of the unit's joint impedance controller, at no more than a fifth of
    /// the joints' speed limits; an arm that stands there stays untouched.
    ///
    /// # Errors
    ///
    /// [`RobotError`]: a start outside the limits, a reflex on the way.
    pub fn approach(&self, arm: &Arm<7>, q: &SVector<f64, 7>) -> Result<(), RobotError> {
        if let Some(joint) = arm.first_joint_outside_limits(q) {
            return Err(RobotError::StartOutside { joint });
        }
        let here = SVector::from(self.state()?.q);
        if (q - here).amax() < THERE_RAD {
            return Ok(());
        }
        let mut motion = None;
        let mut time_s = 0.0;
        let command = |state: &RobotState, period: franka::Duration| {
            let motion = motion.get_or_insert_with(|| {
                let from = SVector::from(state.q_d);
                let duration_s = duration_s(&from, q, &arm.limits.qd_max_rad_s);
                MinimumJerk { from, to: *q, duration_s }
            });
            time_s += period.as_secs_f64();
            let mut positions = franka::JointPositions::new(motion.at(time_s).into());
            positions.motion_finished = time_s >= motion.duration_s;
            positions
        };
        let controller = franka::ControllerMode::JointImpedance;
        self.robot.control_joint_positions(command, controller, true, franka::MAX_CUTOFF_FREQUENCY)?;
        Ok(())
    }

    /// Starts torque control: from now on the robot wants a command each millisecond. Once `stop` is true the plant gives no
    /// more samples.
    ///
    /// # Errors
    ///
    /// [`RobotError::Franka`]: the robot refuses, or the connection is lost.
    pub fn torque_plant<'a>(&'a self, arm: &Arm<7>, stop: &'a AtomicBool) -> Result<TorquePlant<'a>, RobotError> {
        let (torque, force) = COLLISION;
        self.robot.set_collision_behavior_simple(torque, torque, force, force)?;
        Ok(TorquePlant::new(self.robot.start_torque_control()?, arm.clone(), stop))
    }
}
