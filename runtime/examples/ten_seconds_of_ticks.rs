//! The whole loop on a simulated arm: sense, estimate, control, limit, actuate, with and without friction compensation.
//!
//! `cargo run --release -p tribo-runtime --example ten_seconds_of_ticks`
//!
//! Your robot is a type that implements `tribo_robot::Plant`: `sense` reads a frame, `actuate` sends torques.

use tribo_control::{GuardSettings, ImpedanceSettings, PAPER_PHASES_RAD, SinusoidReference};
use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
use tribo_friction::{Compensator, FrictionModel, VelocitySource};
use tribo_robot::{Kinematics, presets};
use tribo_runtime::{ControlLoop, LoopSettings};
use tribo_sim::{BoxFrictionPlant, Sensors, Truth};

/// Mean force (N) that the estimator reports in free motion; whatever it is, it is friction.
fn force_in_free_motion_n(compensated: FrictionModel<7>) -> Result<f64, Box<dyn std::error::Error>> {
    let (truth, start) = (Truth::panda_coulomb_viscous(), presets::panda_ready_pose());
    let arm = truth.arm.clone();
    let settings = LoopSettings {
        impedance: ImpedanceSettings::default(),
        reference: SinusoidReference::paper(Kinematics::at(&arm, &start).base_from_flange(), PAPER_PHASES_RAD),
        compensator: Compensator::new(compensated, VelocitySource::Hybrid),
        guard: Some(GuardSettings::default()),
        dt_s: 1e-3,
    };
    let mut plant = BoxFrictionPlant::new(truth, Sensors::default(), start, 1);
    let mut control = ControlLoop::new(arm, start, settings, WrenchEkf::new(WrenchEkfSettings::default()));
    let mut sum_n = 0.0;
    for _ in 0..10_000 {
        let record = control.tick(&mut plant);
        if let Some(fault) = record.fault {
            return Err(fault.into());
        }
        sum_n += record.estimate.wrench_base.force_n.norm();
    }
    Ok(sum_n / 10_000.0)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let true_friction = Truth::panda_coulomb_viscous().friction;
    println!("no compensation         {:.2} N", force_in_free_motion_n(FrictionModel::none())?);
    println!("half of the friction    {:.2} N", force_in_free_motion_n(true_friction.scaled(0.5))?);
    println!("all of the friction     {:.2} N", force_in_free_motion_n(true_friction)?);
    Ok(())
}
