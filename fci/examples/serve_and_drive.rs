//! A simulated Panda serves the Franka Control Interface; a torque loop of ours connects and holds it like a soft spring.
//!
//! `cargo run --release -p tribo-fci --example serve_and_drive`

use std::net::{IpAddr, Ipv4Addr};
use std::sync::atomic::{AtomicBool, Ordering};

use tribo_fci::{Connection, ControlUnit, FciVersion, Pace, Server, ServerSettings};
use tribo_robot::{Plant, gravity_torque, presets};
use tribo_sim::{BoxFrictionPlant, Sensors, TorqueSide, Truth};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The robot: friction behind torque sensors on the link side, in lockstep, at any free port.
    let (arm, start) = (presets::panda(), presets::panda_ready_pose());
    let sensors = Sensors { torque_side: TorqueSide::Link, ..Sensors::default() };
    let plant = BoxFrictionPlant::new(Truth::panda_coulomb_viscous(), sensors, start, 1);
    let unit = ControlUnit::new(FciVersion::V5, arm.clone(), plant)?;
    let address = IpAddr::V4(Ipv4Addr::LOCALHOST);
    let settings = ServerSettings { version: FciVersion::V5, address, port: Some(0), pace: Pace::Lockstep };
    let mut server = Server::bind(settings, unit, Vec::new())?;
    let host = server.address()?.to_string();
    let stop = AtomicBool::new(false);

    std::thread::scope(|scope| {
        let serving = scope.spawn(|| server.run(&stop, |_| {}));
        let driven = drive(&host, &arm);
        stop.store(true, Ordering::Relaxed);
        serving.join().map_err(|_| "the server's thread died")??;
        driven
    })
}

/// One second of a spring that pulls joint 0 by 0.2 rad.
fn drive(host: &str, arm: &tribo_robot::Arm<7>) -> Result<(), Box<dyn std::error::Error>> {
    let connection = Connection::open(host, false)?;
    println!("connected: {:?}", connection.version());
    let never = AtomicBool::new(false);
    let mut robot = connection.torque_plant(arm, &never)?;
    let mut goal = robot.sense()?.q;
    goal[0] += 0.2;
    for _ in 0..1000 {
        let frame = robot.sense()?;
        let spring = (goal - frame.q) * 100.0 - frame.qd * 20.0;
        robot.actuate(&(spring + gravity_torque(arm, &frame.q)));
    }
    robot.finish()?;
    let state = connection.state()?;
    println!("joint 0 at {:.2} rad, friction holds it {:.2} rad from its goal", state.q[0], goal[0] - state.q[0]);
    Ok(())
}
