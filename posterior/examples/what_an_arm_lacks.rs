//! Which families of causes does a log show, and how surely?
//!
//! `cargo run --release -p tribo-posterior --example what_an_arm_lacks`
//!
//! The log is recorded from a simulated Panda with friction in all joints and a gain of one torque sensor; the model has neither.

use tribo_friction::FrictionModel;
use tribo_posterior::{ArmScale, Columns, Family, PARTS, Problem, Start, posterior, select};
use tribo_regression::{Nominal, RegressionData};
use tribo_robot::presets;
use tribo_sim::excitation::{Envelope, Excitation};
use tribo_sim::{Effect, Recording, TorqueSide, Truth, record};

/// Width of the smooth sign of friction laws (rad/s).
const SMOOTHING_RAD_S: f64 = 0.005;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let known = Truth::panda_coulomb_viscous();
    let truth = Truth { effects: vec![Effect::TorqueGain { joint: 3, gain_error: 0.04 }], ..known.clone() };
    let motion = Excitation::Multisine.draw(&Envelope::of(&presets::panda()), 30.0, 1);
    let log = record(&truth, SMOOTHING_RAD_S, motion.as_ref(), &Recording::default(), 1)?;

    let nominal = Nominal {
        smoothing_rad_s: SMOOTHING_RAD_S,
        ..Nominal::new(known.arm, FrictionModel::none(), TorqueSide::Motor)
    };
    let data = RegressionData::of_logs(&[log], &nominal, None)?;
    let scale = ArmScale::of(&data);
    let columns = Columns::of(&data, &scale, PARTS);
    let problem = Problem::of(&data, columns, scale, vec![false]);
    let parts = problem.all_parts();
    let (all, _) = posterior(&problem, &parts, &Start::of(&Family::ALL)).ok_or("no posterior")?;
    let selection = select(&problem, &parts, &all);
    for family in &selection.selected {
        println!("{family:?}: {:.0} nat", selection.worth.get(family).copied().unwrap_or(f64::NAN));
    }
    let (fit, _) = posterior(&problem, &parts, &Start::of(&selection.selected)).ok_or("no posterior")?;
    for place in problem.of_family(Family::Gain) {
        let joint = problem.places[place].joint().unwrap_or_default();
        println!("gain of joint {joint}: {:+.4} ± {:.4}", fit.state[place], 1.96 * fit.sd(place));
    }
    Ok(())
}
