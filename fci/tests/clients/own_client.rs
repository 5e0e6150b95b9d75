//! The client of this crate: approach, torque control, landing, again and again.

use std::sync::atomic::AtomicBool;

use tribo_fci::{Connection, FciVersion, Pace};
use tribo_robot::{Plant, gravity_torque, presets};
use tribo_sim::{Effect, Truth};

use crate::served::served_with;

/// A spring that no model knows pulls at a joint while nobody commands: each torque motion begins where the last has left the arm, and
/// a stiff loop holds it all the same.
#[test]
fn a_motion_begins_where_the_last_one_left_the_arm() {
    let mut truth = Truth::panda_coulomb_viscous();
    truth.effects.push(Effect::PositionSpring { joint: 3, stiffness_nm_per_rad: 3.7, rest_rad: -0.28 });
    let server = served_with(FciVersion::V5, Pace::Lockstep, truth, 3);
    let (arm, start) = (presets::panda(), presets::panda_ready_pose());
    let host = server.address.to_string();
    let never = AtomicBool::new(false);
    for round in 0..3 {
        let connection = Connection::open(&host, false).unwrap();
        connection.approach(&arm, &start).unwrap();
        let mut robot = connection.torque_plant(&arm, &never).unwrap();
        for tick in 0..500 {
            let frame = robot.sense().unwrap();
            assert!(frame.qd.amax() < 0.5, "round {round}, tick {tick}: {} rad/s", frame.qd.amax());
            let hold = (start - frame.q).map(|error| 1000.0 * error) - frame.qd * 60.0;
            robot.actuate(&(hold + gravity_torque(&arm, &frame.q)));
        }
        robot.finish().unwrap();
    }
}
