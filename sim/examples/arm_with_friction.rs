//! An arm with dry friction, stepped at 1 kHz: it sticks, breaks loose, and comes to rest.
//!
//! `cargo run --release -p tribo-sim --example arm_with_friction`

use nalgebra::SVector;
use tribo_friction::FrictionModel;
use tribo_friction::law::CoulombViscous;
use tribo_robot::{Plant, gravity_torque, presets};
use tribo_sim::{BoxFrictionPlant, Sensors, Truth};

fn main() {
    let (arm, start) = (presets::panda(), presets::panda_ready_pose());
    let joint = CoulombViscous { coulomb_nm: 0.6, viscous_nm_s_per_rad: 1.0 };
    let truth = Truth::new(arm.clone(), FrictionModel::uniform(joint.into()));
    let mut plant = BoxFrictionPlant::new(truth, Sensors::default(), start, 1);

    // Joint 6 is driven by a torque that grows by 0.5 Nm/s for two seconds, then by none. The others carry their weight.
    println!("time s   drive Nm   friction Nm   speed rad/s   moved rad");
    for tick in 0..3000 {
        let time_s = f64::from(tick) * 1e-3;
        let drive_nm = if time_s < 2.0 { 0.5 * time_s } else { 0.0 };
        let frame = plant.sample();
        let mut tau = gravity_torque(&arm, plant.q());
        tau[6] += drive_nm;
        plant.actuate(&tau);
        if tick % 400 == 0 {
            let moved: SVector<f64, 7> = frame.q - start;
            let (friction_nm, qd) = (plant.friction_torque()[6], plant.qd()[6]);
            println!("{time_s:6.1}   {drive_nm:8.2}   {friction_nm:11.2}   {qd:11.4}   {:9.4}", moved[6]);
        }
    }
    println!("at rest: {}", plant.qd()[6] == 0.0);
}
