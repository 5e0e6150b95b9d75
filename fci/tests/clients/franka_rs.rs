//! Motions, torques, settings, reflexes by `franka-rs`, versions 5 and 10, in lockstep.

use franka::{
    CartesianVelocities, ControllerMode, FrankaError, JointPositions, JointVelocities, MAX_CUTOFF_FREQUENCY, Robot,
    Torques,
};
use nalgebra::SVector;
use tribo_fci::{FciVersion, Pace};
use tribo_robot::{Kinematics, presets};
use tribo_sim::Truth;

use crate::served::{served, served_with};

const BOTH: [FciVersion; 2] = [FciVersion::V5, FciVersion::V10];

#[test]
fn the_state_is_that_of_an_arm_at_rest_in_the_ready_pose() {
    for version in BOTH {
        let server = served(version, Pace::Lockstep, 1);
        let robot = server.robot();
        assert_eq!(robot.server_version(), version.number());
        let state = robot.read_once().unwrap();
        let q = presets::panda_ready_pose();
        assert!((SVector::from(state.q) - q).amax() < 1e-4);
        assert_eq!(state.robot_mode, franka::robot_state::RobotMode::Idle);
        assert!(!state.current_errors.any());
        let flange = Kinematics::at(&presets::panda(), &q).base_from_flange().to_homogeneous();
        assert!(flange.iter().zip(state.O_T_EE).all(|(ours, theirs)| (ours - theirs).abs() < 1e-3));
    }
}

/// A torque loop with a spring to the start: the same bits twice, and one period of the plant for each command.
#[test]
fn torque_control_in_lockstep_gives_the_same_bits_twice() {
    for version in BOTH {
        let run = || {
            let server = served(version, Pace::Lockstep, 7);
            let robot = server.robot();
            let (mut start, mut ticks, mut seen) = (None, 0, Vec::new());
            let control = |state: &franka::RobotState, _: franka::Duration| {
                let start = *start.get_or_insert(state.q);
                ticks += 1;
                seen.push(state.q.map(f64::to_bits));
                let push = 4.0 * (0.01 * f64::from(ticks)).sin();
                let tau = std::array::from_fn(|j| 80.0 * (start[j] - state.q[j]) - 6.0 * state.dq[j] + push);
                let mut torques = Torques::new(tau);
                torques.motion_finished = ticks == 700;
                torques
            };
            robot.control_torques(control, true, MAX_CUTOFF_FREQUENCY).unwrap();
            drop(robot);
            (seen, server.end())
        };
        let ((first, plant), (second, _)) = (run(), run());
        assert_eq!(first.len(), 700);
        assert_eq!(first, second);
        // Stopping takes 500 periods, of which the last command has the first.
        assert_eq!((plant.time_s() * 1e3).round() as usize, 699 + 500);
        assert!(plant.qd().amax() < 1e-3, "the arm stands at the end");
    }
}

/// libfranka's cosine of the joint motion example, under both controllers of the unit.
#[test]
fn joint_positions_and_velocities_are_followed() {
    for version in BOTH {
        for controller in [ControllerMode::JointImpedance, ControllerMode::CartesianImpedance] {
            let server = served(version, Pace::Lockstep, 3);
            let robot = server.robot();
            let start = robot.read_once().unwrap().q_d;
            let (mut time, mut worst) = (0.0, 0.0_f64);
            let motion = |state: &franka::RobotState, period: franka::Duration| {
                time += period.as_secs_f64();
                let delta = std::f64::consts::PI / 16.0 * (1.0 - (std::f64::consts::PI / 2.5 * time).cos());
                let q = std::array::from_fn(|j| start[j] + if [3, 4, 6].contains(&j) { delta } else { 0.0 });
                worst = worst.max((0..7).map(|j| (state.q[j] - state.q_d[j]).abs()).fold(0.0, f64::max));
                let mut positions = JointPositions::new(q);
                positions.motion_finished = time >= 5.0;
                positions
            };
            robot.control_joint_positions(motion, controller, true, MAX_CUTOFF_FREQUENCY).unwrap();
            let end = robot.read_once().unwrap();
            assert!((0..7).all(|j| (end.q[j] - start[j]).abs() < 0.02), "{version:?} {controller:?} {:?}", end.q);
            assert!(worst < 0.05, "{version:?} {controller:?} lags by {worst} rad");
        }
        let server = served(version, Pace::Lockstep, 3);
        let robot = server.robot();
        let start = robot.read_once().unwrap().q;
        let mut time = 0.0;
        let motion = |_: &franka::RobotState, period: franka::Duration| {
            time += period.as_secs_f64();
            let mut qd = [0.0; 7];
            qd[5] = 0.2 * (1.0 - (std::f64::consts::TAU * time / 2.0).cos());
            let mut velocities = JointVelocities::new(qd);
            velocities.motion_finished = time >= 2.0;
            velocities
        };
        robot.control_joint_velocities(motion, ControllerMode::JointImpedance, true, MAX_CUTOFF_FREQUENCY).unwrap();
        let moved = robot.read_once().unwrap().q[5] - start[5];
        assert!((moved - 0.4).abs() < 0.01, "moved by {moved} rad");
    }
}

/// The pose follows the integral of the commanded twist, in both controllers' joint and Cartesian springs.
#[test]
fn cartesian_velocities_move_the_tool() {
    for version in BOTH {
        for controller in [ControllerMode::JointImpedance, ControllerMode::CartesianImpedance] {
            let server = served(version, Pace::Lockstep, 5);
            let robot = server.robot();
            let start = robot.read_once().unwrap().O_T_EE;
            let mut time = 0.0;
            let motion = |_: &franka::RobotState, period: franka::Duration| {
                time += period.as_secs_f64();
                let v = 0.05 * (1.0 - (std::f64::consts::TAU * time / 2.0).cos());
                let mut twist = CartesianVelocities::new([v, 0.0, -v, 0.0, 0.0, 0.0]);
                twist.motion_finished = time >= 2.0;
                twist
            };
            robot.control_cartesian_velocities(motion, controller, true, MAX_CUTOFF_FREQUENCY).unwrap();
            let end = robot.read_once().unwrap().O_T_EE;
            let moved: Vec<f64> = (12..15).map(|i| end[i] - start[i]).collect();
            let wanted = [0.1, 0.0, -0.1];
            assert!(
                moved.iter().zip(wanted).all(|(m, w)| (m - w).abs() < 0.01),
                "{version:?} {controller:?} {moved:?}"
            );
        }
    }
}

fn push(robot: &Robot, tau_nm: f64, ticks: u32) -> Result<(), FrankaError> {
    let mut tick = 0;
    let control = |state: &franka::RobotState, _: franka::Duration| {
        tick += 1;
        let mut tau = std::array::from_fn(|j| -5.0 * state.dq[j]);
        tau[0] = tau_nm.min(0.5 * f64::from(tick));
        let mut torques = Torques::new(tau);
        torques.motion_finished = tick == ticks;
        torques
    };
    robot.control_torques(control, true, MAX_CUTOFF_FREQUENCY)
}

/// What libfranka prints: the limit by its name, then a refusal until recovery, then motion again.
#[test]
fn violations_end_in_a_reflex_with_libfrankas_names_and_recovery() {
    for version in BOTH {
        let server = served(version, Pace::Lockstep, 9);
        let robot = server.robot();
        let jump = |_: &franka::RobotState, _: franka::Duration| Torques::new([30.0; 7]);
        let error = robot.control_torques(jump, false, MAX_CUTOFF_FREQUENCY).unwrap_err().to_string();
        assert!(error.contains("controller_torque_discontinuity"), "{error}");
        assert!(error.contains("motion aborted by reflex"), "{error}");
        assert!(push(&robot, 1.0, 5).is_err(), "no motion in a reflex");
        let state = robot.read_once().unwrap();
        assert_eq!(state.robot_mode, franka::robot_state::RobotMode::Reflex);
        robot.automatic_error_recovery().unwrap();
        push(&robot, 1.0, 50).unwrap();

        // A thirtieth of the default: friction and inertia already count as a collision.
        robot.set_collision_behavior_simple([0.5; 7], [0.7; 7], [100.0; 6], [100.0; 6]).unwrap();
        let error = push(&robot, 15.0, 600).unwrap_err().to_string();
        assert!(error.contains("joint_reflex"), "{error}");
        robot.automatic_error_recovery().unwrap();
        robot.set_collision_behavior_simple([90.0; 7], [90.0; 7], [200.0; 6], [200.0; 6]).unwrap();
        let error = push(&robot, 40.0, 5000).unwrap_err().to_string();
        assert!(
            error.contains("joint_velocity_violation") || error.contains("joint_position_limits_violation"),
            "{error}"
        );

        let jump = |state: &franka::RobotState, _: franka::Duration| JointPositions::new(state.q.map(|q| q + 0.3));
        robot.automatic_error_recovery().unwrap();
        let mode = ControllerMode::JointImpedance;
        let error = robot.control_joint_positions(jump, mode, false, MAX_CUTOFF_FREQUENCY).unwrap_err().to_string();
        assert!(error.contains("joint_position_motion_generator_start_pose_invalid"), "{error}");
    }
}

/// Settings that are not allowed are refused; a load is carried and told, and takes its weight out of the external force.
#[test]
fn settings_reach_the_unit() {
    for version in BOTH {
        let arm = if version == FciVersion::V5 { presets::panda() } else { presets::fr3() };
        let load = tribo_robot::Payload {
            mass_kg: 1.5,
            com_m: nalgebra::Vector3::new(0.0, 0.0, 0.05),
            inertia_kg_m2: nalgebra::Matrix3::identity() * 1e-3,
        };
        let truth = Truth::new(arm.clone(), tribo_friction::FrictionModel::none());
        let loaded = Truth { arm: arm.with_payload(&load), ..truth };
        let server = served_with(version, Pace::Lockstep, loaded, 11);
        let robot = server.robot();
        assert!(robot.set_joint_impedance([-1.0; 7]).is_err());
        assert!(robot.set_cartesian_impedance([1e6; 6]).is_err());
        assert!(robot.set_ee([0.0; 16]).is_err());
        assert!(robot.set_load(-1.0, [0.0; 3], [0.0; 9]).is_err());
        robot.set_joint_impedance([2000.0; 7]).unwrap();
        robot.set_guiding_mode([true; 6], true).unwrap();
        let mut tool = [0.0; 16];
        for i in [0, 5, 10, 15] {
            tool[i] = 1.0;
        }
        tool[14] = 0.2;
        let before = robot.read_once().unwrap().O_T_EE;
        robot.set_ee(tool).unwrap();
        robot.set_k(tool).unwrap();
        robot.set_load(0.5, [0.0, 0.0, 0.1], [1e-3, 0.0, 0.0, 0.0, 1e-3, 0.0, 0.0, 0.0, 1e-3]).unwrap();
        // States that were under way when the settings came are older than these.
        let shows = |state: &franka::RobotState| {
            (state.m_load - 0.5).abs() < 1e-6 && (state.O_T_EE[14] - before[14]).abs() > 0.1
        };
        let mut states = (0..100).map(|_| robot.read_once().unwrap());
        let state = states.find(shows).expect("a load of 0.5 kg, and a tool, within a hundred states");
        assert!((state.O_T_EE[14] - before[14] + 0.2).abs() < 1e-4, "the flange looks down");
        if version == FciVersion::V5 {
            robot.set_filters(100.0, 100.0, 100.0, 100.0, 100.0).unwrap();
            assert!(!robot.virtual_wall(0).unwrap().active);
        }
    }
}

/// The second client finds the port of a busy robot closed to it, and the robot when the first has gone.
#[test]
fn clients_come_and_go() {
    let server = served(FciVersion::V5, Pace::Lockstep, 13);
    for _ in 0..20 {
        let robot = server.robot();
        assert!(
            franka::network::Network::connect(&server.address.to_string(), 1337, franka::wire::HeaderLayout::Robot)
                .is_ok()
        );
        assert!(push(&robot, 1.0, 20).is_ok());
    }
    // Gone in the middle of a motion.
    let robot = server.robot();
    let control = |_: &franka::RobotState, _: franka::Duration| -> Torques { std::panic::panic_any("gone") };
    let torn = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| robot.control_torques(control, true, 1000.0)));
    assert!(torn.is_err());
    drop(robot);
    assert!(push(&server.robot(), 1.0, 20).is_ok());
}

/// In real time no rate is asserted; what is, is that a client that falls silent is dropped by the book of lost commands.
#[test]
fn a_client_that_falls_silent_in_real_time_ends_in_a_reflex() {
    let server = served(FciVersion::V10, Pace::RealTime, 15);
    let robot = server.robot();
    let mut tick = 0;
    let control = |state: &franka::RobotState, _: franka::Duration| {
        tick += 1;
        if tick == 100 {
            std::thread::sleep(std::time::Duration::from_millis(300));
        }
        let _ = state;
        Torques::new([0.0; 7])
    };
    let error = robot.control_torques(control, true, MAX_CUTOFF_FREQUENCY).unwrap_err().to_string();
    assert!(error.contains("communication_constraints_violation"), "{error}");
    robot.automatic_error_recovery().unwrap();
}

/// Stalls of 2 to 100 ms: a motion goes on or ends by the book, the arm stays within its limits, and the next motion works.
#[test]
fn stalls_block_nobody() {
    let server = served(FciVersion::V10, Pace::RealTime, 17);
    let (mut went_on, mut ended) = (0, 0);
    for stall_ms in [2, 3, 5, 8, 12, 18, 30, 50, 70, 100] {
        let robot = server.robot();
        let mut tick = 0;
        let mut fastest = 0.0_f64;
        let control = |state: &franka::RobotState, _: franka::Duration| {
            tick += 1;
            if tick % 60 == 0 {
                std::thread::sleep(std::time::Duration::from_millis(stall_ms));
            }
            fastest = state.dq.iter().fold(fastest, |most, dq| most.max(dq.abs()));
            let mut torques = Torques::new([0.0; 7]);
            torques.motion_finished = tick >= 200;
            torques
        };
        match robot.control_torques(control, true, MAX_CUTOFF_FREQUENCY) {
            Ok(()) => went_on += 1,
            Err(error) => {
                assert!(error.to_string().contains("communication_constraints_violation"), "{stall_ms} ms: {error}");
                robot.automatic_error_recovery().unwrap();
                ended += 1;
            }
        }
        assert!(fastest < 0.1, "{stall_ms} ms: {fastest} rad/s");
    }
    // Twenty lost commands in a row are the limit.
    assert!(went_on >= 1 && ended >= 1, "{went_on} went on, {ended} ended");
    assert!(push(&server.robot(), 1.0, 20).is_ok());
}
