//! What friction that is not compensated costs: three trials of the simulated Panda.
//!
//! `cargo run --release -p tribo-trial --example cost_of_friction`
//!
//! J is the wrench that the EKF reports in free motion, in N and Nm: nobody touches the arm, so all of it is friction.

use tribo_control::{ImpedanceSettings, PAPER_PHASES_RAD, SinusoidReference};
use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
use tribo_friction::law::CoulombViscous;
use tribo_friction::{FrictionModel, VelocitySource};
use tribo_robot::{Kinematics, presets};
use tribo_sim::{DEFAULT_SUB_STEPS, Sensors, Truth, WrenchPulses};
use tribo_trial::{CostMeasure, PenaltyLimits, Trial, run_trial};

fn main() {
    let (model, start) = (presets::panda(), presets::panda_ready_pose());
    let flange = Kinematics::at(&model, &start).base_from_flange();
    let trial = Trial {
        truth: Truth::panda_coulomb_viscous(),
        sensors: Sensors::default(),
        sub_steps: DEFAULT_SUB_STEPS,
        pulses: WrenchPulses::default(),
        gears_nm_per_rad: presets::PANDA_JOINT_STIFFNESS_NM_PER_RAD,
        effects: Default::default(),
        impedance: ImpedanceSettings::default(),
        reference: SinusoidReference::paper(flange, PAPER_PHASES_RAD),
        velocity: VelocitySource::Reference,
        guard: None,
        limits: PenaltyLimits::default(),
        measure: CostMeasure::Paper,
        stopped_at_s: None,
        dt_s: 1e-3,
        model,
        start,
    };
    let none = FrictionModel::<7>::none();
    let guess = FrictionModel::uniform(CoulombViscous { coulomb_nm: 0.3, viscous_nm_s_per_rad: 0.5 }.into());
    for (name, friction) in [("none", &none), ("a guess", &guess), ("the true one", &trial.truth.friction)] {
        let outcome = run_trial(&trial, friction, WrenchEkf::new(WrenchEkfSettings::default()), 1);
        let ended = if outcome.aborted.is_some() { "stopped" } else { "complete" };
        println!("{name:<14} J = {:6.2}   {ended}", outcome.cost.total());
    }
}
