//! The command of one period.

use franka::wire::f64s_to_f64;
use franka::wire::robot::{v5, v10};
use zerocopy::FromBytes;

use super::FciVersion;

/// What a client asks of the robot for one period (UDP). Only the fields of the running motion mean anything.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CyclicCommand {
    /// Number of the state that this answers.
    pub message_id: u64,
    /// Joint positions (rad).
    pub q_rad: [f64; 7],
    /// Joint velocities (rad/s).
    pub qd_rad_s: [f64; 7],
    /// `base_from_end_effector`, 4 × 4, column by column (m).
    pub pose: [f64; 16],
    /// Twist of the end effector in base axes: m/s, then rad/s.
    pub twist: [f64; 6],
    /// Position of joint 3 (rad) and sign of joint 4, where the client gives them.
    pub elbow: Option<[f64; 2]>,
    /// Joint torques without gravity (Nm).
    pub torque_nm: [f64; 7],
    /// Whether this is the last command of the motion.
    pub finished: bool,
}

impl CyclicCommand {
    /// Reads a datagram; `None` if it is not as long as a command of this version.
    pub fn decode(version: FciVersion, bytes: &[u8]) -> Option<Self> {
        // Version 10 is version 5 with one flag more, so the shorter layout reads both.
        let (command, torque_finished) = match version {
            FciVersion::V5 => (v5::RobotCommand::read_from_bytes(bytes).ok()?, 0),
            FciVersion::V10 => {
                let flag = v10::RobotCommand::read_from_bytes(bytes).ok()?.control.torque_command_finished;
                (v5::RobotCommand::read_from_prefix(bytes).ok()?.0, flag)
            }
        };
        let motion = command.motion;
        Some(Self {
            message_id: command.message_id.get(),
            q_rad: f64s_to_f64(&motion.q_c),
            qd_rad_s: f64s_to_f64(&motion.dq_c),
            pose: f64s_to_f64(&motion.O_T_EE_c),
            twist: f64s_to_f64(&motion.O_dP_EE_c),
            elbow: (motion.valid_elbow != 0).then(|| f64s_to_f64(&motion.elbow_c)),
            torque_nm: f64s_to_f64(&command.control.tau_J_d),
            finished: motion.motion_generation_finished != 0 || torque_finished != 0,
        })
    }
}
