//! Periods per second over the wire: `cargo bench -p tribo-fci`.
//!
//! Lockstep: how fast a program under test runs that waits for nothing but the robot. Real time: share of the commands that
//! arrive in their period, on a machine that does nothing else; `TRIBO_REAL_TIME_S` sets how long (s), 0 leaves it out.

use std::net::{IpAddr, Ipv4Addr};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use tribo_fci::{Connection, ControlUnit, FciVersion, Pace, Server, ServerSettings, model};
use tribo_robot::{Plant, gravity_torque, presets};
use tribo_sim::{BoxFrictionPlant, Sensors, TorqueSide, Truth};

/// Periods of a lockstep run.
const PERIODS: u64 = 100_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for version in [FciVersion::V5, FciVersion::V10] {
        let (seconds, _) = run(version, Pace::Lockstep, PERIODS)?;
        println!("lockstep, version {}: {:.0} periods/s", version.number(), PERIODS as f64 / seconds);
    }
    let seconds: u64 = std::env::var("TRIBO_REAL_TIME_S").ok().and_then(|text| text.parse().ok()).unwrap_or(10);
    if seconds > 0 {
        for version in [FciVersion::V5, FciVersion::V10] {
            let periods = 1000 * seconds;
            let (wall_s, lost) = run(version, Pace::RealTime, periods)?;
            let share = 100.0 * (1.0 - lost as f64 / periods as f64);
            println!(
                "real time, version {}: {share:.3} % of {periods} states answered, {wall_s:.2} s",
                version.number()
            );
        }
    }
    Ok(())
}

/// Wall time (s) of so many periods of a client that holds still, and the states that it missed.
fn run(version: FciVersion, pace: Pace, periods: u64) -> Result<(f64, u64), Box<dyn std::error::Error>> {
    let arm = if version == FciVersion::V5 { presets::panda() } else { presets::fr3() };
    let truth = Truth { arm: arm.clone(), ..Truth::panda_coulomb_viscous() };
    let sensors = Sensors { torque_side: TorqueSide::Link, ..Sensors::default() };
    let plant = BoxFrictionPlant::new(truth, sensors, presets::panda_ready_pose(), 1);
    let unit = ControlUnit::new(version, arm.clone(), plant)?;
    let settings = ServerSettings { version, address: IpAddr::V4(Ipv4Addr::LOCALHOST), port: Some(0), pace };
    let model = if version == FciVersion::V10 { model::urdf(&arm).into_bytes() } else { Vec::new() };
    let mut server = Server::bind(settings, unit, model)?;
    let host = server.address()?.to_string();
    let stop = Arc::new(AtomicBool::new(false));
    let stopped = Arc::clone(&stop);
    let thread = std::thread::spawn(move || server.run(&stopped, |_| {}));
    let result = client(&host, &arm, periods);
    stop.store(true, Ordering::Relaxed);
    thread.join().map_err(|_| "the server's thread died")??;
    result
}

fn client(host: &str, arm: &tribo_robot::Arm<7>, periods: u64) -> Result<(f64, u64), Box<dyn std::error::Error>> {
    let connection = Connection::open(host, false)?;
    let never = AtomicBool::new(false);
    let mut plant = connection.torque_plant(arm, &never)?;
    let began = Instant::now();
    for _ in 0..periods {
        let Ok(frame) = plant.sense() else { break };
        plant.actuate(&(gravity_torque(arm, &frame.q) - frame.qd * 2.0));
    }
    let (seconds, lost) = (began.elapsed().as_secs_f64(), plant.lost_periods());
    plant.finish()?;
    Ok((seconds, lost))
}
