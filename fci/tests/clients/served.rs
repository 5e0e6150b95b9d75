//! A simulated robot that serves.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use franka::robot::RobotOptions;
use franka::{RealtimeConfig, Robot};
use tribo_fci::{ControlUnit, FciVersion, Pace, Server, ServerSettings, model};
use tribo_robot::presets;
use tribo_sim::{BoxFrictionPlant, Sensors, TorqueSide, Truth};

/// A server in a thread of its own, ended when it goes out of scope.
pub struct Served {
    pub address: SocketAddr,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<BoxFrictionPlant<7>>>,
}

/// A robot with typical friction; `seed` feeds its sensors.
pub fn served(version: FciVersion, pace: Pace, seed: u64) -> Served {
    served_with(version, pace, friction_of(version), seed)
}

/// A robot with typical friction at this address, on the interface's own port unless another is given.
pub fn served_at(version: FciVersion, pace: Pace, address: Ipv4Addr, port: Option<u16>) -> Served {
    serve(ServerSettings { version, address: IpAddr::V4(address), port, pace }, friction_of(version), 1)
}

/// A robot with this truth.
pub fn served_with(version: FciVersion, pace: Pace, truth: Truth<7>, seed: u64) -> Served {
    serve(ServerSettings { version, address: IpAddr::V4(Ipv4Addr::LOCALHOST), port: Some(0), pace }, truth, seed)
}

fn friction_of(version: FciVersion) -> Truth<7> {
    let arm = if version == FciVersion::V5 { presets::panda() } else { presets::fr3() };
    Truth { arm, ..Truth::panda_coulomb_viscous() }
}

fn serve(settings: ServerSettings, truth: Truth<7>, seed: u64) -> Served {
    let arm = truth.arm.clone();
    let sensors = Sensors { torque_side: TorqueSide::Link, ..Sensors::default() };
    let plant = BoxFrictionPlant::new(truth, sensors, presets::panda_ready_pose(), seed);
    let unit = ControlUnit::new(settings.version, arm.clone(), plant).unwrap();
    let model = match settings.version {
        // Only a client at the interface's own port asks for it, and compiling takes a while.
        FciVersion::V5 => settings.port.map_or_else(|| model::library(&arm).unwrap(), |_| Vec::new()),
        FciVersion::V10 => model::urdf(&arm).into_bytes(),
    };
    let mut server = Server::bind(settings, unit, model).unwrap();
    let address = server.address().unwrap();
    let stop = Arc::new(AtomicBool::new(false));
    let stopped = Arc::clone(&stop);
    let thread = std::thread::spawn(move || {
        server.run(&stopped, |_| {}).unwrap();
        server.unit().plant().clone()
    });
    Served { address, stop, thread: Some(thread) }
}

impl Served {
    /// A `franka-rs` client.
    pub fn robot(&self) -> Robot {
        Robot::with_options(&self.address.to_string(), RobotOptions::new(RealtimeConfig::Ignore)).unwrap()
    }

    /// Ends the server; the plant as it was left.
    pub fn end(mut self) -> BoxFrictionPlant<7> {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap()
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
