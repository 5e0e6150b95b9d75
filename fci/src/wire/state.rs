//! The state of the robot, sent each period.

use franka::wire::robot::{v5, v10};
use nalgebra::{Matrix3, Matrix4, SVector, Vector3, Vector6};
use tribo_robot::Pose;
use zerocopy::IntoBytes;
use zerocopy::little_endian::{F32, F64, U64};

use super::{ErrorFlags, FciVersion};

/// Bytes of the longer of the two states.
pub const STATE_BYTES_MAX: usize = size_of::<v5::RobotState>();

/// What the robot is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RobotMode {
    /// Standing, ready.
    #[default]
    Idle,
    /// In a motion.
    Move,
    /// Stopped for a reason that the error flags tell, until AutomaticErrorRecovery.
    Reflex,
}

/// Who makes the torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControllerMode {
    /// The unit, with a spring and damper in each joint.
    JointImpedance,
    /// The unit, with springs and dampers at the end effector.
    CartesianImpedance,
    /// The client.
    External,
}

/// What the client commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GeneratorMode {
    /// Joint positions.
    JointPosition,
    /// Joint velocities.
    JointVelocity,
    /// Pose of the end effector.
    CartesianPose,
    /// Twist of the end effector.
    CartesianVelocity,
    /// Torques alone (version 10).
    None,
}

/// One state: what libfranka's `RobotState` has, SI units, base axes where nothing else is said.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "each field is that of libfranka's RobotState, named in the comment behind it")]
pub struct RobotState {
    /// Number of the state; milliseconds of the robot's clock.
    pub message_id: u64,
    pub end_effector: Pose,                  // O_T_EE
    pub end_effector_desired: Pose,          // O_T_EE_d, O_T_EE_c
    pub flange_from_nominal: Pose,           // F_T_NE
    pub nominal_from_end_effector: Pose,     // NE_T_EE
    pub end_effector_from_stiffness: Pose,   // EE_T_K
    pub load_kg: f64,                        // m_load
    pub load_inertia_kg_m2: Matrix3<f64>,    // I_load
    pub load_com_m: Vector3<f64>,            // F_x_Cload
    pub torque_nm: SVector<f64, 7>,          // tau_J: link side, with gravity
    pub torque_desired_nm: SVector<f64, 7>,  // tau_J_d: without gravity
    pub torque_rate_nm_s: SVector<f64, 7>,   // dtau_J
    pub q_rad: SVector<f64, 7>,              // q
    pub q_desired_rad: SVector<f64, 7>,      // q_d
    pub qd_rad_s: SVector<f64, 7>,           // dq
    pub qd_desired_rad_s: SVector<f64, 7>,   // dq_d
    pub qdd_desired_rad_s2: SVector<f64, 7>, // ddq_d
    pub joint_contact: [bool; 7],
    pub cartesian_contact: [bool; 6],
    pub joint_collision: [bool; 7],
    pub cartesian_collision: [bool; 6],
    pub external_torque_nm: SVector<f64, 7>, // tau_ext_hat_filtered
    /// O_F_ext_hat_K: force, then moment, by the robot on the environment, at the stiffness frame.
    pub wrench_base: Vector6<f64>,
    /// K_F_ext_hat_K: the same in the axes of the stiffness frame.
    pub wrench_stiffness_frame: Vector6<f64>,
    /// O_dP_EE_d, O_dP_EE_c: m/s, then rad/s.
    pub twist_desired: Vector6<f64>,
    /// O_ddP_EE_c: m/s², then rad/s².
    pub acceleration_desired: Vector6<f64>,
    pub gravity_m_s2: Vector3<f64>, // O_ddP_O
    pub motor_rad: SVector<f64, 7>, // theta
    pub generator: Option<GeneratorMode>,
    pub controller: Option<ControllerMode>,
    pub errors: ErrorFlags,        // current_errors
    pub reflex_reason: ErrorFlags, // last_motion_errors
    pub mode: RobotMode,
    pub command_success_rate: f64,
}

impl RobotState {
    /// Position of joint 3 (rad) and sign of joint 4.
    fn elbow(q: &SVector<f64, 7>) -> [f64; 2] {
        [q[2], if q[3] < 0.0 { -1.0 } else { 1.0 }]
    }

    /// Writes the state as this version has it; returns the number of bytes.
    pub fn encode(&self, version: FciVersion, bytes: &mut [u8; STATE_BYTES_MAX]) -> usize {
        match version {
            FciVersion::V5 => {
                bytes.copy_from_slice(self.version_5().as_bytes());
                STATE_BYTES_MAX
            }
            FciVersion::V10 => {
                let state = self.version_10();
                let length = state.as_bytes().len();
                bytes[..length].copy_from_slice(state.as_bytes());
                length
            }
        }
    }

    fn version_5(&self) -> v5::RobotState {
        let flags7 = |flags: &[bool; 7]| flags.map(|flag| F64::new(f64::from(u8::from(flag))));
        let flags6 = |flags: &[bool; 6]| flags.map(|flag| F64::new(f64::from(u8::from(flag))));
        let identity = pose(&Pose::identity());
        let elbow_desired = doubles(Self::elbow(&self.q_desired_rad));
        v5::RobotState {
            message_id: U64::new(self.message_id),
            O_T_EE: pose(&self.end_effector),
            O_T_EE_d: pose(&self.end_effector_desired),
            F_T_EE: pose(&(self.flange_from_nominal * self.nominal_from_end_effector)),
            EE_T_K: pose(&self.end_effector_from_stiffness),
            F_T_NE: pose(&self.flange_from_nominal),
            NE_T_EE: pose(&self.nominal_from_end_effector),
            m_ee: F64::new(0.0),
            I_ee: [F64::new(0.0); 9],
            F_x_Cee: [F64::new(0.0); 3],
            m_load: F64::new(self.load_kg),
            I_load: doubles(self.load_inertia_kg_m2.as_slice().try_into().unwrap_or([0.0; 9])),
            F_x_Cload: doubles(self.load_com_m.into()),
            elbow: doubles(Self::elbow(&self.q_rad)),
            elbow_d: elbow_desired,
            tau_J: doubles(self.torque_nm.into()),
            tau_J_d: doubles(self.torque_desired_nm.into()),
            dtau_J: doubles(self.torque_rate_nm_s.into()),
            q: doubles(self.q_rad.into()),
            q_d: doubles(self.q_desired_rad.into()),
            dq: doubles(self.qd_rad_s.into()),
            dq_d: doubles(self.qd_desired_rad_s.into()),
            ddq_d: doubles(self.qdd_desired_rad_s2.into()),
            joint_contact: flags7(&self.joint_contact),
            cartesian_contact: flags6(&self.cartesian_contact),
            joint_collision: flags7(&self.joint_collision),
            cartesian_collision: flags6(&self.cartesian_collision),
            tau_ext_hat_filtered: doubles(self.external_torque_nm.into()),
            O_F_ext_hat_K: doubles(self.wrench_base.into()),
            K_F_ext_hat_K: doubles(self.wrench_stiffness_frame.into()),
            O_dP_EE_d: doubles(self.twist_desired.into()),
            O_ddP_O: doubles(self.gravity_m_s2.into()),
            elbow_c: elbow_desired,
            delbow_c: doubles([self.qd_desired_rad_s[2], 0.0]),
            ddelbow_c: doubles([self.qdd_desired_rad_s2[2], 0.0]),
            O_T_EE_c: if self.generator.is_some() { pose(&self.end_effector_desired) } else { identity },
            O_dP_EE_c: doubles(self.twist_desired.into()),
            O_ddP_EE_c: doubles(self.acceleration_desired.into()),
            theta: doubles(self.motor_rad.into()),
            dtheta: doubles(self.qd_rad_s.into()),
            motion_generator_mode: self.generator_byte(),
            controller_mode: self.controller_byte(),
            errors: self.errors.bytes(),
            reflex_reason: self.reflex_reason.bytes(),
            robot_mode: self.mode_byte(),
            control_command_success_rate: F64::new(self.command_success_rate),
        }
    }

    /// The fields of version 5 as floats; accelerometers read nothing.
    fn version_10(&self) -> v10::RobotState {
        let five = self.version_5();
        v10::RobotState {
            message_id: five.message_id,
            O_T_EE: floats(five.O_T_EE),
            O_T_EE_d: floats(five.O_T_EE_d),
            F_T_EE: floats(five.F_T_EE),
            EE_T_K: floats(five.EE_T_K),
            F_T_NE: floats(five.F_T_NE),
            NE_T_EE: floats(five.NE_T_EE),
            m_ee: float(five.m_ee),
            I_ee: floats(five.I_ee),
            F_x_Cee: floats(five.F_x_Cee),
            m_load: float(five.m_load),
            I_load: floats(five.I_load),
            F_x_Cload: floats(five.F_x_Cload),
            elbow: floats(five.elbow),
            elbow_d: floats(five.elbow_d),
            tau_J: floats(five.tau_J),
            tau_J_d: floats(five.tau_J_d),
            dtau_J: floats(five.dtau_J),
            q: floats(five.q),
            q_d: floats(five.q_d),
            dq: floats(five.dq),
            dq_d: floats(five.dq_d),
            ddq_d: floats(five.ddq_d),
            joint_contact: floats(five.joint_contact),
            cartesian_contact: floats(five.cartesian_contact),
            joint_collision: floats(five.joint_collision),
            cartesian_collision: floats(five.cartesian_collision),
            tau_ext_hat_filtered: floats(five.tau_ext_hat_filtered),
            O_F_ext_hat_K: floats(five.O_F_ext_hat_K),
            K_F_ext_hat_K: floats(five.K_F_ext_hat_K),
            O_dP_EE_d: floats(five.O_dP_EE_d),
            O_ddP_O: floats(five.O_ddP_O),
            elbow_c: floats(five.elbow_c),
            delbow_c: floats(five.delbow_c),
            ddelbow_c: floats(five.ddelbow_c),
            O_T_EE_c: floats(five.O_T_EE_c),
            O_dP_EE_c: floats(five.O_dP_EE_c),
            O_ddP_EE_c: floats(five.O_ddP_EE_c),
            theta: floats(five.theta),
            dtheta: floats(five.dtheta),
            accelerometer_top: [[F32::new(0.0); 3]; 6],
            accelerometer_bottom: [[F32::new(0.0); 3]; 6],
            motion_generator_mode: five.motion_generator_mode,
            controller_mode: five.controller_mode,
            errors: five.errors,
            reflex_reason: five.reflex_reason,
            robot_mode: five.robot_mode,
            control_command_success_rate: float(five.control_command_success_rate),
        }
    }

    fn generator_byte(&self) -> u8 {
        use v10::MotionGeneratorMode as Mode;
        match self.generator {
            None => Mode::Idle,
            Some(GeneratorMode::JointPosition) => Mode::JointPosition,
            Some(GeneratorMode::JointVelocity) => Mode::JointVelocity,
            Some(GeneratorMode::CartesianPose) => Mode::CartesianPosition,
            Some(GeneratorMode::CartesianVelocity) => Mode::CartesianVelocity,
            Some(GeneratorMode::None) => Mode::None,
        }
        .to_u8()
    }

    fn controller_byte(&self) -> u8 {
        use v10::ControllerMode as Mode;
        match self.controller {
            None => Mode::Other,
            Some(ControllerMode::JointImpedance) => Mode::JointImpedance,
            Some(ControllerMode::CartesianImpedance) => Mode::CartesianImpedance,
            Some(ControllerMode::External) => Mode::ExternalController,
        }
        .to_u8()
    }

    fn mode_byte(&self) -> u8 {
        match self.mode {
            RobotMode::Idle => v10::RobotMode::Idle,
            RobotMode::Move => v10::RobotMode::Move,
            RobotMode::Reflex => v10::RobotMode::Reflex,
        }
        .to_u8()
    }
}

fn doubles<const N: usize>(values: [f64; N]) -> [F64; N] {
    values.map(F64::new)
}

fn float(value: F64) -> F32 {
    F32::new(value.get() as f32)
}

fn floats<const N: usize>(values: [F64; N]) -> [F32; N] {
    values.map(float)
}

/// 4 × 4, column by column.
fn pose(pose: &Pose) -> [F64; 16] {
    let matrix: Matrix4<f64> = pose.to_homogeneous();
    std::array::from_fn(|i| F64::new(matrix.as_slice()[i]))
}
