//! Joint states as they come from a driver, and the wrench of a push, without a network.
//!
//! `cargo run --release -p tribo-ros2 --example wrench_of_messages`

use nalgebra::Vector6;
use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
use tribo_friction::{Compensator, FrictionModel, VelocitySource};
use tribo_logs::JointState;
use tribo_robot::{ControlTerms, Wrench, gravity_torque, presets};
use tribo_ros2::message::wrench_stamped;
use tribo_ros2::{ArmJoints, WrenchStream};
use tribo_runtime::MeasuredWrench;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A Panda that stands; from 1 s on its motors press 10 N upwards against something that holds it.
    let (arm, q) = (presets::panda(), presets::panda_ready_pose());
    let terms = ControlTerms::at(&arm, &q, &nalgebra::SVector::zeros());
    let gravity = gravity_torque(&arm, &q);
    let press = Wrench::from_force_moment(&[0.0, 0.0, 10.0, 0.0, 0.0, 0.0]).to_vector();

    // The estimator, and joints that a driver lists in its own order, fingers among them.
    let frictionless = Compensator::new(FrictionModel::none(), VelocitySource::Measured);
    let ekf = WrenchEkf::new(WrenchEkfSettings::default());
    let mut stream = WrenchStream::new(MeasuredWrench::new(arm, frictionless, ekf), ArmJoints::new(None));
    let mut names = vec!["panda_finger_joint1".to_owned()];
    names.extend((1..=7).rev().map(|j| format!("panda_joint{j}")));
    let listed = |of_joint: &dyn Fn(usize) -> f64| -> Vec<f64> {
        std::iter::once(0.0).chain((0..7).rev().map(of_joint)).collect()
    };
    for k in 1..=2000_u64 {
        let pressing = if k < 1000 { Vector6::zeros() } else { press };
        let tau = gravity + terms.jacobian.transpose() * pressing;
        let message = JointState {
            stamp_ns: k * 1_000_000,
            names: names.clone(),
            position: listed(&|j| q[j]),
            velocity: listed(&|_| 0.0),
            effort: listed(&|j| tau[j]),
        };
        let taken = stream.take(&message, None)?;
        if let Some(wrench) = taken.wrench.filter(|_| k % 500 == 0) {
            let force = wrench.estimate.wrench_base.force_n;
            let bytes = wrench_stamped(wrench.stamp_ns, "panda_link0", &wrench.estimate.wrench_base);
            println!("{:.1} s   fz {:6.2} N   {} bytes", k as f64 * 1e-3, force.z, bytes.len());
        }
    }
    println!("joints: {:?}", stream.joints().names().map(|names| names.join(" ")));
    Ok(())
}
