//! How much of what a rigid model misses is friction?
//!
//! `cargo run --release -p tribo-regression --example residual_of_a_log`
//!
//! The log is recorded from a simulated Panda; a log of yours comes from `tribo_logs::read_log`.

use tribo_regression::{FrictionReport, FrictionSettings, ResidualSettings, TorqueResidual};
use tribo_robot::presets;
use tribo_sim::excitation::{Envelope, Excitation};
use tribo_sim::{Recording, Truth, record};

/// Width of the smooth sign of the recorded friction (rad/s).
const SMOOTHING_RAD_S: f64 = 0.005;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let truth = Truth::panda_coulomb_viscous();
    let motion = Excitation::Multisine.draw(&Envelope::of(&presets::panda()), 30.0, 1);
    let log = record(&truth, SMOOTHING_RAD_S, motion.as_ref(), &Recording::default(), 1)?;

    let residual = TorqueResidual::of_log(&log, &truth.arm, &ResidualSettings::default())?;
    let report = FrictionReport::of(&residual, None, &FrictionSettings::default());
    println!("joint   RMS of the rigid model's residual   the same less fitted friction, unseen blocks   dry friction");
    for joint in &report.joints {
        let (fit, unseen) = (joint.fit?, joint.held_out?);
        println!(
            "{:<7} {:<35.3} {:<46.3} {:.3} Nm",
            joint.joint, joint.rms_rigid_nm, unseen.rms_fit_test_nm, fit.coulomb_nm
        );
    }
    Ok(())
}
