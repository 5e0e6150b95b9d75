//! Dynamics of an arm: a preset, and one of your own from a URDF.
//!
//! `cargo run --release -p tribo-robot --example arm_dynamics -- [arm.urdf of a six-joint arm]`

use nalgebra::SVector;
use tribo_robot::urdf::{self, to_urdf};
use tribo_robot::{Arm, Kinematics, forward_dynamics, gravity_torque, mass_matrix, presets, rnea};

fn describe<const N: usize>(name: &str, arm: &Arm<N>, q: &SVector<f64, N>) {
    let (qd, qdd) = (SVector::repeat(0.2), SVector::repeat(1.0));
    let tau = rnea(arm, q, &qd, &qdd);
    let back = forward_dynamics(arm, q, &qd, &tau);
    let kinematics = Kinematics::at(arm, q);
    let flange_m = kinematics.base_from_flange().translation.vector;
    println!("{name}, {N} joints");
    println!("  flange            {:.3} {:.3} {:.3} m", flange_m.x, flange_m.y, flange_m.z);
    println!("  holds its weight  {:.2?} Nm", gravity_torque(arm, q).as_slice());
    println!("  at 1 rad/s²       {:.2?} Nm", tau.as_slice());
    println!("  inertia, joint 0  {:.3} kg m²", mass_matrix(arm, q)[(0, 0)]);
    println!("  there and back    {:.0e} rad/s² of error", (back - qdd).amax().max(1e-16));
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    describe("Panda", &presets::panda(), &presets::panda_ready_pose());
    let (name, text) = match std::env::args().nth(1) {
        Some(path) => (path.clone(), std::fs::read_to_string(&path)?),
        None => ("UR10e from a URDF".to_owned(), to_urdf(&presets::ur10e())),
    };
    let own = urdf::parse(&text, None, None)?.arm::<6>().ok_or("this example takes six joints")?;
    describe(&name, &own.arm, &SVector::from([0.0, -1.57, 1.57, -1.57, -1.57, 0.0]));
    Ok(())
}
