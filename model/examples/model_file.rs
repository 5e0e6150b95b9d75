//! A model file: read, checked, and what a controller makes of it.
//!
//! `cargo run --release -p tribo-model --example model_file`

use tribo_model::{ControllerModel, ModelFile, YamlDocument, not_cancelled_sentences};
use tribo_robot::{gravity_torque, presets};

/// What a user writes, or `tribo diagnose --extend`.
const FILE: &str = "\
schema: tribo.model/1
robot: panda
payload: {mass_kg: 0.5, com_m: [0.0, 0.0, 0.06]}
friction:
  law: coulomb_viscous
  joints:
  - {coulomb_nm: 0.6, viscous_nm_s_per_rad: 1.0}
  - {coulomb_nm: 0.6, viscous_nm_s_per_rad: 1.0}
  - {coulomb_nm: 0.5, viscous_nm_s_per_rad: 0.8}
  - {coulomb_nm: 0.5, viscous_nm_s_per_rad: 0.8}
  - {coulomb_nm: 0.3, viscous_nm_s_per_rad: 0.4}
  - {coulomb_nm: 0.3, viscous_nm_s_per_rad: 0.4}
  - {coulomb_nm: 0.2, viscous_nm_s_per_rad: 0.3}
effects:
- {cause: torque_offset, joint: 3, offset_nm: 0.4}
- {cause: time_delay, delay_s: 0.002}
";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let document = YamlDocument::embedded("model.yaml", FILE);
    let file: ModelFile = document.parse()?;
    let model = file.validate::<7>().map_err(|error| document.explain(error))?;
    let q = presets::panda_ready_pose();
    let weight_nm = gravity_torque(&model.arm, &q) - gravity_torque(&presets::panda(), &q);
    println!("the payload costs {:.2} Nm in joint 1", weight_nm[1]);
    println!("dry friction of joint 0: {:.2} Nm", model.friction.joints[0].set_valued(0.0).upper_nm);

    let controller_model = ControllerModel::by_controller(&model);
    println!("what a compensator cannot cancel:");
    for sentence in not_cancelled_sentences(&controller_model.not_cancelled, &controller_model.arm.joint_names) {
        println!("  {sentence}");
    }

    // A slip of the pen is named with its line.
    let wrong = YamlDocument::embedded("model.yaml", &FILE.replace("mass_kg: 0.5", "mass_kg: -0.5"));
    let file: ModelFile = wrong.parse()?;
    if let Err(error) = file.validate::<7>() {
        println!("refused: {}", wrong.explain(error));
    }
    Ok(())
}
