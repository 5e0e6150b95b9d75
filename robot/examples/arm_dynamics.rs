//! Dynamics of an arm: a preset, and one of your own from a URDF.
//!
//! `cargo run --release -p tribo-robot --example arm_dynamics -- [arm.urdf of a six-joint arm]`

use nalgebra::SVector;
use tribo_robot::urdf::UrdfChain;
use tribo_robot::{Arm, Kinematics, forward_dynamics, gravity_torque, mass_matrix, presets, rnea};

/// A shoulder and an elbow of 0.4 m and 0.3 m, swinging in the vertical plane.
const TWO_LINKS: &str = r#"<robot name="two_links">
  <link name="base"/>
  <link name="upper"><inertial><origin xyz="0.2 0 0"/><mass value="2.0"/>
    <inertia ixx="0.002" iyy="0.03" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="lower"><inertial><origin xyz="0.15 0 0"/><mass value="1.2"/>
    <inertia ixx="0.001" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tip"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" velocity="3" effort="40"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0.4 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" velocity="3" effort="20"/></joint>
  <joint name="end" type="fixed"><parent link="lower"/><child link="tip"/><origin xyz="0.3 0 0"/></joint>
</robot>"#;

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
    if let Some(path) = std::env::args().nth(1) {
        let own = UrdfChain::parse(&std::fs::read_to_string(&path)?, None, None)?;
        let own = own.arm::<6>().ok_or("this example takes six joints")?;
        describe(&path, &own.arm, &SVector::zeros());
    } else {
        let two = UrdfChain::parse(TWO_LINKS, None, None)?.arm::<2>().ok_or("two joints were written")?;
        describe("two links from a URDF", &two.arm, &SVector::zeros());
    }
    Ok(())
}
