//! Commands over TCP.

use franka::wire::f64s_to_f64;
use franka::wire::robot::{v5, v10};
use nalgebra::{Matrix3, Vector3};
use tribo_robot::Payload;
use zerocopy::{FromBytes, Immutable, KnownLayout, Unaligned};

use super::{ControllerMode, FciVersion, GeneratorMode};
use crate::unit::{CollisionThresholds, pose_of};

/// A motion that a client wants to start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MotionRequest {
    /// Who makes the torque.
    pub controller: ControllerMode,
    /// What the client commands.
    pub generator: GeneratorMode,
}

/// A setting of the control unit.
#[derive(Clone, Debug, PartialEq)]
pub enum Setting {
    /// Thresholds of contact and collision.
    Collision(Box<CollisionThresholds>),
    /// Stiffness (Nm/rad) of the joint impedance controller.
    JointStiffness([f64; 7]),
    /// Stiffness of the Cartesian impedance controller: N/m, then Nm/rad.
    CartesianStiffness([f64; 6]),
    /// Axes free in hand guiding; the simulated arm has no hand on it, so nothing follows.
    GuidingMode,
    /// `end_effector_from_stiffness_frame`, 4 × 4, column by column.
    StiffnessFrame([f64; 16]),
    /// `nominal_end_effector_from_end_effector`, 4 × 4, column by column.
    EndEffector([f64; 16]),
    /// What the flange carries beyond the end effector.
    Load(Payload),
    /// Cut-off frequencies of filters that the control unit has not had since version 3 of its software: checked, no effect.
    Filters([f64; 5]),
}

/// A request of a client.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// First message: the client's version and the port where it wants its states.
    Connect {
        /// Version of the interface.
        version: u16,
        /// UDP port of the client.
        udp_port: u16,
    },
    /// Start of a motion.
    Move(MotionRequest),
    /// End of the motion.
    StopMove,
    /// Size and place of a virtual wall (version 5).
    GetCartesianLimit,
    /// A setting.
    Set(Setting),
    /// Way out of a reflex.
    AutomaticErrorRecovery,
    /// The dynamics as a shared object (version 5): architecture and operating system as on the wire.
    LoadModelLibrary {
        /// 0 is 64-bit x86.
        architecture: u8,
        /// 0 is Linux.
        system: u8,
    },
    /// The dynamics as URDF (version 10).
    GetRobotModel,
    /// A known command whose content is not allowed.
    Invalid,
}

impl Request {
    /// Reads the payload of command number `command`; `None` if the number is unknown or the payload too short for it.
    pub fn decode(version: FciVersion, command: u32, payload: &[u8]) -> Option<Self> {
        use v5::Command as Five;
        use v10::Command as Ten;
        let number = match version {
            FciVersion::V5 => Five::from_u32(command)?,
            // One list of names for both: version 10 lacks three of them and has one more.
            FciVersion::V10 => match Ten::from_u32(command)? {
                Ten::Connect => Five::Connect,
                Ten::Move => Five::Move,
                Ten::StopMove => Five::StopMove,
                Ten::SetCollisionBehavior => Five::SetCollisionBehavior,
                Ten::SetJointImpedance => Five::SetJointImpedance,
                Ten::SetCartesianImpedance => Five::SetCartesianImpedance,
                Ten::SetGuidingMode => Five::SetGuidingMode,
                Ten::SetEEToK => Five::SetEEToK,
                Ten::SetNEToEE => Five::SetNEToEE,
                Ten::SetLoad => Five::SetLoad,
                Ten::AutomaticErrorRecovery => Five::AutomaticErrorRecovery,
                Ten::GetRobotModel => return Some(Self::GetRobotModel),
            },
        };
        Some(match number {
            Five::Connect => {
                let request: v5::ConnectRequest = read(payload)?;
                Self::Connect { version: request.version.get(), udp_port: request.udp_port.get() }
            }
            Five::Move => motion(version, payload)?.map_or(Self::Invalid, Self::Move),
            Five::StopMove => Self::StopMove,
            Five::GetCartesianLimit => {
                read::<v5::GetCartesianLimitRequest>(payload)?;
                Self::GetCartesianLimit
            }
            Five::AutomaticErrorRecovery => Self::AutomaticErrorRecovery,
            Five::LoadModelLibrary => {
                let request: v5::LoadModelLibraryRequest = read(payload)?;
                Self::LoadModelLibrary { architecture: request.architecture, system: request.system }
            }
            setter => setting(setter, payload)?.map_or(Self::Invalid, Self::Set),
        })
    }
}

/// The whole content of a request; what a longer message has beyond it is not read.
fn read<T: FromBytes + KnownLayout + Immutable + Unaligned>(payload: &[u8]) -> Option<T> {
    T::read_from_prefix(payload).ok().map(|(request, _)| request)
}

/// `Some(None)`: a motion that does not exist.
fn motion(version: FciVersion, payload: &[u8]) -> Option<Option<MotionRequest>> {
    let (controller, generator, asynchronous) = match version {
        FciVersion::V5 => {
            let request: v5::MoveRequest = read(payload)?;
            (request.controller_mode.get(), request.motion_generator_mode.get(), 0)
        }
        FciVersion::V10 => {
            let request: v10::MoveRequest = read(payload)?;
            (request.controller_mode.get(), request.motion_generator_mode.get(), request.use_async_motion_generator)
        }
    };
    let controller = match controller {
        0 => ControllerMode::JointImpedance,
        1 => ControllerMode::CartesianImpedance,
        2 => ControllerMode::External,
        _ => return Some(None),
    };
    let generator = match generator {
        0 => GeneratorMode::JointPosition,
        1 => GeneratorMode::JointVelocity,
        2 => GeneratorMode::CartesianPose,
        3 => GeneratorMode::CartesianVelocity,
        4 if version == FciVersion::V10 && controller == ControllerMode::External => GeneratorMode::None,
        _ => return Some(None),
    };
    // The planner for targets at a low rate is not simulated.
    Some((asynchronous == 0).then_some(MotionRequest { controller, generator }))
}

/// `Some(None)`: a value that is not allowed.
fn setting(command: v5::Command, payload: &[u8]) -> Option<Option<Setting>> {
    use v5::Command;
    let setting = match command {
        Command::SetCollisionBehavior => {
            let request: v5::SetCollisionBehaviorRequest = read(payload)?;
            let thresholds = CollisionThresholds {
                contact_torque_accelerating_nm: f64s_to_f64(&request.lower_torque_thresholds_acceleration),
                collision_torque_accelerating_nm: f64s_to_f64(&request.upper_torque_thresholds_acceleration),
                contact_torque_nm: f64s_to_f64(&request.lower_torque_thresholds_nominal),
                collision_torque_nm: f64s_to_f64(&request.upper_torque_thresholds_nominal),
                contact_force_accelerating: f64s_to_f64(&request.lower_force_thresholds_acceleration),
                collision_force_accelerating: f64s_to_f64(&request.upper_force_thresholds_acceleration),
                contact_force: f64s_to_f64(&request.lower_force_thresholds_nominal),
                collision_force: f64s_to_f64(&request.upper_force_thresholds_nominal),
            };
            thresholds.is_valid().then(|| Setting::Collision(Box::new(thresholds)))
        }
        Command::SetJointImpedance => {
            let request: v5::SetJointImpedanceRequest = read(payload)?;
            let stiffness: [f64; 7] = f64s_to_f64(&request.K_theta);
            within(&stiffness, 0.0, 14_250.0).then_some(Setting::JointStiffness(stiffness))
        }
        Command::SetCartesianImpedance => {
            let request: v5::SetCartesianImpedanceRequest = read(payload)?;
            let stiffness: [f64; 6] = f64s_to_f64(&request.K_x);
            let allowed = within(&stiffness[..3], 10.0, 3000.0) && within(&stiffness[3..], 1.0, 300.0);
            allowed.then_some(Setting::CartesianStiffness(stiffness))
        }
        Command::SetGuidingMode => {
            let _: v5::SetGuidingModeRequest = read(payload)?;
            Some(Setting::GuidingMode)
        }
        Command::SetEEToK => {
            let request: v5::SetEEToKRequest = read(payload)?;
            let pose = f64s_to_f64(&request.EE_T_K);
            pose_of(&pose).map(|_| Setting::StiffnessFrame(pose))
        }
        Command::SetNEToEE => {
            let request: v5::SetNEToEERequest = read(payload)?;
            let pose = f64s_to_f64(&request.NE_T_EE);
            pose_of(&pose).map(|_| Setting::EndEffector(pose))
        }
        Command::SetLoad => {
            let request: v5::SetLoadRequest = read(payload)?;
            let load = Payload {
                mass_kg: request.m_load.get(),
                com_m: Vector3::from(f64s_to_f64(&request.F_x_Cload)),
                inertia_kg_m2: Matrix3::from_column_slice(&f64s_to_f64::<9>(&request.I_load)),
            };
            is_body(&load).then_some(Setting::Load(load))
        }
        Command::SetFilters => {
            let request: v5::SetFiltersRequest = read(payload)?;
            let frequencies = [
                request.joint_position_filter_frequency.get(),
                request.joint_velocity_filter_frequency.get(),
                request.cartesian_position_filter_frequency.get(),
                request.cartesian_velocity_filter_frequency.get(),
                request.controller_filter_frequency.get(),
            ];
            within(&frequencies, 0.0, 1000.0).then_some(Setting::Filters(frequencies))
        }
        _ => return None,
    };
    Some(setting)
}

/// Whether all values are between those limits; NaN is not.
fn within(values: &[f64], least: f64, greatest: f64) -> bool {
    values.iter().all(|value| (least..=greatest).contains(value))
}

/// A mass of up to 100 kg within 10 m, with an inertia that a body can have.
fn is_body(load: &Payload) -> bool {
    let inertia = load.inertia_kg_m2;
    let finite = inertia.iter().all(|value| value.is_finite()) && (inertia - inertia.transpose()).amax() <= 1e-6;
    finite
        && (0.0..=100.0).contains(&load.mass_kg)
        && within(load.com_m.as_slice(), -10.0, 10.0)
        && inertia.symmetric_eigenvalues().min() >= -1e-9
}
