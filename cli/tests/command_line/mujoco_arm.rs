//! Story: an arm that MuJoCo simulates is diagnosed; its friction is the engine's, its links are not the model's, it carries a body.
//!
//! The recipe is that of `experiments/12_mujoco`. Skipped, loudly, without a Python with MuJoCo.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::Path;
use std::process::Command;

use crate::common::{scratch, tribo};
use crate::python_witness::python;
use serde_json::Value;

#[test]
fn an_arm_that_mujoco_simulates_is_predicted_and_its_payload_weighed() {
    let Some(python) = python("mujoco,numpy", "an arm in MuJoCo is not diagnosed") else { return };
    let at = scratch();
    let recipe = Path::new(env!("CARGO_MANIFEST_DIR")).join("../experiments/12_mujoco/mujoco_arms.py");
    let binary = tribo(at.path(), [""]).get_program().to_owned();
    let mut asked = Command::new(python);
    asked.arg(recipe).arg(binary).arg(at.path());
    asked.args("--arms panda,ur5e --payloads 1 --seeds 3 --seconds 20,10 --json".split(' '));
    let output = asked.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let answers: Vec<Value> = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(answers.len(), 2);
    for answer in answers {
        println!("{answer}");
        let number = |key: &str| answer[key].as_f64().unwrap();
        // A fifth of what any plain fit leaves of a faster motion; with the smooth sign in place of the engine's ramp it is more than a quarter.
        assert!(number("ratio") < 0.2 && number("worst_joint") < 0.4, "{answer}");
        assert!((number("payload_kg") - number("truth_kg")).abs() < 0.1, "{answer}");
        assert!((0.9..=1.0).contains(&number("inside95")) && answer["leads"] == true, "{answer}");
        let never = ["time_delay", "external_contact", "presliding", "thermal_friction", "joint_elasticity"];
        let causes = answer["causes"].as_array().unwrap();
        assert!(!causes.iter().any(|cause| never.contains(&cause.as_str().unwrap())), "{answer}");
    }
}
