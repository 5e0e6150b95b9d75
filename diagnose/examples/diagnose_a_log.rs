//! What does my model get wrong about this log?
//!
//! `cargo run --release -p tribo-diagnose --example diagnose_a_log`
//!
//! The log is recorded from a simulated Panda that carries 0.5 kg and has 0.4 Nm more dry friction in joint 2 than the model says. A log of
//! yours comes from `tribo_logs::read_log`.

use tribo_diagnose::{DiagnoseSettings, diagnose};
use tribo_regression::Nominal;
use tribo_robot::presets;
use tribo_sim::excitation::{Envelope, Excitation};
use tribo_sim::{Effect, Recording, TorqueSide, Truth, record};

/// Width of the smooth sign of friction laws (rad/s).
const SMOOTHING_RAD_S: f64 = 0.005;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let known = Truth::panda_coulomb_viscous();
    let effects = vec![
        Effect::Payload { mass_kg: 0.5, com_m: [0.01, 0.0, 0.06], inertia_kg_m2: [0.0; 6] },
        Effect::Coulomb { joint: 2, delta_coulomb_nm: 0.4 },
    ];
    let truth = Truth { effects, ..known.clone() };
    let motion = Excitation::Multisine.draw(&Envelope::of(&presets::panda()), 30.0, 1);
    let log = record(&truth, SMOOTHING_RAD_S, motion.as_ref(), &Recording::default(), 1)?;

    let nominal =
        Nominal { smoothing_rad_s: SMOOTHING_RAD_S, ..Nominal::new(known.arm, known.friction, TorqueSide::Motor) };
    let go_on = |_stage: &str, _share: f64| true;
    let diagnosis = diagnose(&[log], &nominal, &[], &DiagnoseSettings::default(), &go_on)?;
    let names = &diagnosis.joint_names;
    println!("verdict: {}", diagnosis.verdict.name());
    for finding in &diagnosis.findings {
        println!("{} at {}", finding.label, finding.location.among(names));
        for parameter in &finding.parameters {
            println!("  {} = {:.4?} in {:.4?}", parameter.name, parameter.value, parameter.ci95);
        }
        println!("  removes {:.0} % of the residual on unseen blocks", finding.held_out_gain * 100.0);
        for rival in &finding.alternatives {
            println!("  could also be {} at {}", rival.label, rival.location.among(names));
        }
    }
    Ok(())
}
