//! MuJoCo and Pinocchio as judges of arms that were read from files.

use nalgebra::{SMatrix, SVector};
use serde_json::{Value, json};
use tribo_robot::{Arm, DescribedArm, Kinematics, SerialChain, bias_torque, gravity_torque, mass_matrix};

/// States of each arm that are compared.
const STATES: usize = 8;

/// Our numbers of an arm in a few states anywhere within its limits, for [`MUJOCO`] or [`PINOCCHIO`] to judge; `file` has
/// `path` or `text`, the names of the joints are added.
pub fn question(chain: &SerialChain, file: Value) -> Value {
    let mut question = match chain.joints() {
        6 => numbers(&chain.arm::<6>().expect("six joints")),
        _ => numbers(&chain.arm::<7>().expect("seven joints")),
    };
    for (key, value) in file.as_object().expect("an object") {
        question[key] = value.clone();
    }
    question
}

fn numbers<const N: usize>(described: &DescribedArm<N>) -> Value {
    let DescribedArm { arm, joint_names, coulomb_nm, viscous_nm_s_per_rad } = described;
    let states: Vec<Value> = (0..STATES).map(|k| state(arm, k)).collect();
    json!({
        "joints": joint_names.as_slice(), "states": states,
        "coulomb": coulomb_nm.as_slice(), "viscous": viscous_nm_s_per_rad.as_slice(),
        "low": arm.limits.q_min_rad.as_slice(), "high": arm.limits.q_max_rad.as_slice(),
    })
}

fn state<const N: usize>(arm: &Arm<N>, k: usize) -> Value {
    let part = |j: usize, by: f64| (0.31 + by * (k * N + j) as f64).fract();
    let limits = &arm.limits;
    let q = SVector::<f64, N>::from_fn(|j, _| {
        limits.q_min_rad[j] + part(j, 0.618_034) * (limits.q_max_rad[j] - limits.q_min_rad[j])
    });
    let qd = SVector::<f64, N>::from_fn(|j, _| 4.0 * part(j, 0.754_878) - 2.0);
    let flange = Kinematics::at(arm, &q);
    let mass: SMatrix<f64, N, N> = mass_matrix(arm, &q);
    json!({
        "q": q.as_slice(), "qd": qd.as_slice(), "mass": mass.as_slice(),
        "bias": bias_torque(arm, &q, &qd).as_slice(), "gravity": gravity_torque(arm, &q).as_slice(),
        "flange": flange.flange_origin.as_slice(), "turn": flange.flange_rotation.transpose().as_slice(),
    })
}

/// Loads each model with all other joints at rest where the file has them; prints, file by file, the largest errors relative
/// to the largest entry or 1, or what is wrong.
pub const MUJOCO: &str = r#"
import json, sys, numpy as np, mujoco
def off(ours, theirs):
    return float(np.abs(np.ravel(ours) - np.ravel(theirs)).max() / max(1.0, np.abs(theirs).max()))
answers = []
for e in json.load(open(sys.argv[1])):
    try:
        m = mujoco.MjModel.from_xml_path(e["path"]) if "path" in e else mujoco.MjModel.from_xml_string(e["text"])
    except Exception as error:
        answers.append({"error": str(error)[:300]})
        continue
    d = mujoco.MjData(m)
    joints = [m.joint(name) for name in e["joints"]]
    at, dof = [j.qposadr[0] for j in joints], [j.dofadr[0] for j in joints]
    n, worst = len(dof), {}
    def see(name, ours, theirs):
        worst[name] = max(worst.get(name, 0.0), off(ours, theirs))
    for s in e["states"]:
        d.qpos[:], d.qvel[:] = m.qpos0, 0
        d.qpos[at], d.qvel[dof] = s["q"], s["qd"]
        mujoco.mj_forward(m, d)
        M = np.zeros((m.nv, m.nv))
        mujoco.mj_fullM(m, d, M)
        see("mass matrix", s["mass"], M[np.ix_(dof, dof)].T)
        see("bias", s["bias"], d.qfrc_bias[dof])
        if "base" in e:
            base, site = d.body(e["base"]), d.site(e["site"])
            R = base.xmat.reshape(3, 3)
            see("flange", s["flange"], R.T @ (site.xpos - base.xpos))
            see("flange's turn", s["turn"], R.T @ site.xmat.reshape(3, 3))
        d.qvel[:] = 0
        mujoco.mj_forward(m, d)
        see("gravity", s["gravity"], d.qfrc_bias[dof])
    see("dry friction", e["coulomb"], m.dof_frictionloss.ravel()[dof])
    see("viscous friction", e["viscous"], m.dof_damping.reshape(m.nv, -1)[dof, 0])
    for k, j in enumerate(joints):
        if m.jnt_limited[j.id]:
            see("range", [e["low"][k], e["high"][k]], m.jnt_range[j.id])
    answers.append({"errors": worst})
print(json.dumps(answers))
"#;

/// The same with Pinocchio and URDF, which has no rotor inertia.
pub const PINOCCHIO: &str = r#"
import json, sys, numpy as np, pinocchio as pin
def off(ours, theirs):
    return float(np.abs(np.ravel(ours) - np.ravel(theirs)).max() / max(1.0, np.abs(theirs).max()))
answers = []
for e in json.load(open(sys.argv[1])):
    try:
        m = pin.buildModelFromXML(open(e["path"], encoding="utf-8").read()) if "path" in e else pin.buildModelFromXML(e["text"])
    except Exception as error:
        answers.append({"error": str(error)[:300]})
        continue
    d = m.createData()
    joints = [m.joints[m.getJointId(name)] for name in e["joints"]]
    dof, worst = [j.idx_v for j in joints], {}
    def see(name, ours, theirs):
        worst[name] = max(worst.get(name, 0.0), off(ours, theirs))
    for s in e["states"]:
        q, v = pin.neutral(m), np.zeros(m.nv)
        for j, x, dx in zip(joints, s["q"], s["qd"]):
            v[j.idx_v] = dx
            if j.nq == 2:
                q[j.idx_q], q[j.idx_q + 1] = np.cos(x), np.sin(x)
            else:
                q[j.idx_q] = x
        M = pin.crba(m, d, q)
        M = np.triu(M) + np.triu(M, 1).T
        see("mass matrix", s["mass"], M[np.ix_(dof, dof)])
        see("bias", s["bias"], pin.nle(m, d, q, v)[dof])
        see("gravity", s["gravity"], pin.computeGeneralizedGravity(m, d, q)[dof])
    answers.append({"errors": worst})
print(json.dumps(answers))
"#;

/// Holds the answers to the tolerance; each file's errors are printed.
#[track_caller]
pub fn hold(names: &[String], answers: &Value, tolerance: f64) {
    let answers = answers.as_array().expect("a list");
    assert_eq!(answers.len(), names.len());
    let mut wrong = Vec::new();
    for (name, answer) in names.iter().zip(answers) {
        println!("{name}: {answer}");
        let right = answer["errors"].as_object().is_some_and(|errors| {
            errors.len() >= 3 && errors.values().all(|off| off.as_f64().is_some_and(|off| off <= tolerance))
        });
        if !right {
            wrong.push(format!("{name}: {answer}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
