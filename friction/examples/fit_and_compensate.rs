//! Friction of one joint from its log, and a compensator with it.
//!
//! `cargo run --release -p tribo-friction --example fit_and_compensate`
//!
//! Replace [`log_of_a_joint`] by velocities and torque residuals of yours: measured torque less that of the rigid model.

use nalgebra::SVector;
use tribo_friction::identify::fit_joint_torque;
use tribo_friction::law::{CoulombViscous, smooth_sign};
use tribo_friction::{Compensator, FrictionModel, VelocitySource};

/// Width of the smooth sign (rad/s), above the noise of the velocity.
const SMOOTHING_RAD_S: f64 = 0.005;

/// A joint that moves both ways: 0.8 Nm of dry friction, 1.5 Nm s/rad, an offset of 0.1 Nm, and a disturbance of 0.05 Nm.
fn log_of_a_joint() -> (Vec<f64>, Vec<f64>) {
    let of_time = |k: u32| {
        let t_s = f64::from(k) * 1e-3;
        let qd = 0.6 * (1.7 * t_s).sin() + 0.2 * (4.1 * t_s).cos();
        (qd, 0.8 * smooth_sign(qd, SMOOTHING_RAD_S) + 1.5 * qd + 0.1 + 0.05 * (37.0 * t_s).sin())
    };
    (0..20_000).map(of_time).unzip()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (qd, residual_nm) = log_of_a_joint();
    let fit = fit_joint_torque(&qd, &residual_nm, SMOOTHING_RAD_S)?;
    println!("Coulomb  {:.3} Nm", fit.coulomb_nm);
    println!("viscous  {:.3} Nm s/rad", fit.viscous_nm_s_per_rad);
    println!("offset   {:.3} Nm", fit.offset_nm);

    // The law in a compensator of six such joints. Near rest a measured velocity is noise: `Hybrid` takes the reference's there.
    let law = CoulombViscous { coulomb_nm: fit.coulomb_nm, viscous_nm_s_per_rad: fit.viscous_nm_s_per_rad };
    for source in [VelocitySource::Measured, VelocitySource::Hybrid] {
        let compensator = Compensator::new(FrictionModel::<6>::uniform(law.into()), source);
        let torque = |measured, wanted| compensator.torque(&SVector::repeat(measured), &SVector::repeat(wanted))[0];
        println!(
            "{source:?}: about to move {:.3} Nm, moving at 0.3 rad/s {:.3} Nm",
            torque(0.0, 0.05),
            torque(0.3, 0.3)
        );
    }
    Ok(())
}
