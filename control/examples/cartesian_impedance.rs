//! A Cartesian impedance controller with a friction compensator of your own.
//!
//! `cargo run --release -p tribo-control --example cartesian_impedance`
//!
//! The robot is a stand-in of one line: rigid-body dynamics with dry friction, one Euler step per tick. Put yours in its place.

use nalgebra::{SVector, Vector6};
use tribo_control::{DampedPseudoInverse, ImpedanceController, ImpedanceSettings, TorqueLimiter};
use tribo_robot::{ControlTerms, Kinematics, forward_dynamics, presets};

/// Control period (s).
const DT_S: f64 = 1e-3;
/// Dry friction of every joint (Nm), smooth enough for one Euler step.
fn friction_nm(qd: &SVector<f64, 7>) -> SVector<f64, 7> {
    qd.map(|qd| (qd / 0.01).tanh())
}

/// Tool position error (mm) two seconds after a step of 5 cm, with so much of the friction compensated.
fn error_after_a_step_mm(share: f64) -> Result<f64, Box<dyn std::error::Error>> {
    let (arm, mut q) = (presets::panda(), presets::panda_ready_pose());
    let mut qd = SVector::<f64, 7>::zeros();
    let controller = ImpedanceController {
        settings: ImpedanceSettings::default(),
        pseudo_inverse: DampedPseudoInverse::default(),
        posture: q,
        rotor_inertia_kg_m2: arm.rotor_inertia_kg_m2,
    };
    let mut limiter = TorqueLimiter::new(&arm.limits);
    let mut reference = Kinematics::at(&arm, &q).base_from_flange();
    reference.translation.vector.x += 0.05;
    for _ in 0..2000 {
        let terms = ControlTerms::at(&arm, &q, &qd);
        let mine = |qd: &SVector<f64, 7>, _: &_, _: &_| (friction_nm(qd) * share, SVector::zeros());
        let (torque, _) = controller.tick(&terms, &q, &qd, &reference, &Vector6::zeros(), mine)?;
        let (command, _) = limiter.limit(&torque.total(), &torque.gravity, DT_S);
        let qdd = forward_dynamics(&arm, &q, &qd, &(command - friction_nm(&qd)));
        qd += qdd * DT_S;
        q += qd * DT_S;
    }
    let reached = Kinematics::at(&arm, &q).base_from_flange();
    Ok((reached.translation.vector - reference.translation.vector).norm() * 1e3)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for share in [0.0, 1.0] {
        println!("{:3.0} % compensated: {:.2} mm off after 2 s", share * 100.0, error_after_a_step_mm(share)?);
    }
    Ok(())
}
