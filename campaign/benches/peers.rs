//! Ours beside Pinocchio, MuJoCo, straight-line C that CasADi generates for the arm, and DAQP, in one run on one core: `cargo bench -p tribo-campaign --bench peers`.
//!
//! The peers are C and C++ programs of our own around their libraries (`peers/`, built by `peers/build.sh` with
//! `-O3 -march=native -DNDEBUG`). All get the same inputs from the same files; before anything is timed, the outputs of the first
//! twenty must agree with ours to 1e-9. Then five rounds, in each of which every program and we are timed in turn; the least of
//! the five medians counts. Prints one table (Markdown) and leaves `peers.json`; `--json` prints that instead. Ours has the instructions
//! of `.cargo/config.toml`; `RUSTFLAGS="-C target-cpu=native"` sets those that the peers get, `-C target-cpu=x86-64` those of any
//! processor. A peer that cannot be had is SKIPPED.

#[path = "../../residual/tests/estimators/common/published_instances.rs"]
mod published_instances;
#[path = "../../residual/tests/estimators/common/reference_stream.rs"]
mod reference_stream;
#[path = "../../robot/benches/common/states.rs"]
mod states;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

use nalgebra::{SMatrix, SVector, UnitQuaternion};
use published_instances::{LAMBDA, instance, prior};
use serde_json::{Value, json};
use states::{State, bare_panda, states};
use tribo_residual::{ForceProblem, ForceSolver};
use tribo_robot::{
    Arm, ControlTerms, Kinematics, Plant, bias_torque, forward_dynamics, gravity_torque, inverse_dynamics_regressor,
    mass_matrix, rnea,
};
use tribo_sim::{BoxFrictionPlant, Sensors, Truth};

/// Rounds of which the least median counts.
const ROUNDS: usize = 5;
/// Passes of a median.
const PASSES: usize = 21;
/// Relative difference of outputs that is not rounding.
const AGREEMENT: f64 = 1e-9;
/// What the tolerance of DAQP leaves.
const QP_AGREEMENT: f64 = 1e-8;

/// Rows of the table: what, peer, name of the call there, name of ours.
const ROWS: [(&str, &str, &str, &str); 33] = [
    ("RNEA", "pinocchio", "rnea", "rnea"),
    ("CRBA (Pinocchio: LOCAL)", "pinocchio", "crba", "crba"),
    ("CRBA (Pinocchio: WORLD)", "pinocchio", "crba_world", "crba"),
    ("ABA (Pinocchio: LOCAL)", "pinocchio", "aba", "aba"),
    ("ABA (Pinocchio: WORLD)", "pinocchio", "aba_world", "aba"),
    ("bias C q̇ + g", "pinocchio", "bias", "bias"),
    ("gravity", "pinocchio", "gravity", "gravity"),
    ("flange Jacobian", "pinocchio", "jacobian", "jacobian"),
    ("pose, Jacobian, J̇q̇", "pinocchio", "jacobian_drift", "jacobian_drift"),
    ("pose, J, J̇q̇, M, bias", "pinocchio", "control_terms", "control_terms"),
    ("torque regressor", "pinocchio", "regressor", "regressor"),
    ("RNEA (mj_inverse)", "mujoco", "rnea", "rnea"),
    ("CRBA (mj_makeM, mj_fullM)", "mujoco", "crba", "crba"),
    ("ABA (mj_forward)", "mujoco", "aba", "aba"),
    ("bias (mj_rne)", "mujoco", "bias", "bias"),
    ("flange Jacobian (mj_jacSite)", "mujoco", "jacobian", "jacobian"),
    ("Jacobian, J̇q̇ (mj_jacDot)", "mujoco", "jacobian_drift", "jacobian_drift"),
    ("pose, J, J̇q̇, M, bias", "mujoco", "control_terms", "control_terms"),
    ("RNEA", "generated", "rnea", "rnea"),
    ("CRBA", "generated", "crba", "crba"),
    ("pose, Jacobian, J̇q̇", "generated", "jacobian_drift", "jacobian_drift"),
    ("pose, J, J̇q̇, M, C q̇, g", "generated", "control_terms", "control_terms"),
    ("1 ms in five steps: Coulomb, viscous", "mujoco", "period_of_five_steps", "plant_coulomb_viscous"),
    ("1 ms in five steps: Stribeck", "mujoco", "period_of_five_steps", "plant_stribeck"),
    ("1 ms in five steps: LuGre", "mujoco", "period_of_five_steps", "plant_lugre"),
    ("1 ms in five steps: Gaz", "mujoco", "period_of_five_steps", "plant_gaz"),
    ("QP: ours whole, DAQP solver alone, cold", "daqp", "qp_cold", "estimate_cold"),
    ("QP: ours whole, DAQP solver alone, warm", "daqp", "qp_warm", "estimate_warm"),
    ("QP + 12 limits: ours whole, DAQP solver alone", "daqp", "qp_with_limits", "estimate_with_limits"),
    ("QP: both whole, cold", "daqp", "estimate", "estimate_cold"),
    ("QP + 12 limits: both whole", "daqp", "estimate_with_limits", "estimate_with_limits"),
    ("QP + 12 limits: both whole, 99 % of instances", "daqp", "estimate_with_limits_p99", "estimate_with_limits_p99"),
    ("QP + 12 limits: DAQP solver alone, 99 %", "daqp", "qp_with_limits_p99", "estimate_with_limits_p99"),
];

type Times = BTreeMap<String, f64>;
type Problem = ForceProblem<7, 6>;

/// Everything that is timed works on this.
struct Inputs {
    arm: Arm<7>,
    states: Vec<State<7>>,
    instances: Vec<Problem>,
}

fn main() -> ExitCode {
    let inputs = Inputs { arm: bare_panda(), states: states(1000), instances: (0..1000).map(instance).collect() };
    let out = target_directory().join("peers");
    if let Err(error) = write_inputs(&out, &inputs) {
        eprintln!("{}: {error}", out.display());
        return ExitCode::FAILURE;
    }
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/peers");
    let built = Command::new(here.join("build.sh")).arg(&out).status();
    if !built.is_ok_and(|status| status.success()) {
        eprintln!("SKIPPED all peers: benches/peers/build.sh does not run");
    }
    // The programs inherit the core; where it cannot be had the run is not pinned, and says so.
    let core = tribo_runtime::allowed_cores().last().copied();
    let pinned = core.filter(|core| tribo_runtime::run_on_cores(&[*core]).is_ok());

    let mut peers = Vec::new();
    let mut disagree = false;
    for name in ["pinocchio", "mujoco", "generated", "daqp"] {
        if !out.join(name).is_file() {
            continue;
        }
        match largest_difference(&out, name, &inputs) {
            Ok(differences) => {
                for (call, difference) in &differences {
                    let allowed = if name == "daqp" { QP_AGREEMENT } else { AGREEMENT };
                    if *difference > allowed {
                        disagree = true;
                        eprintln!("DISAGREES {name} {call}: {difference:e}");
                    }
                }
                peers.push((name, differences));
            }
            Err(error) => eprintln!("SKIPPED {name}: {error}"),
        }
    }

    let (mut ours, mut theirs) = (Times::new(), BTreeMap::<&str, Times>::new());
    for _ in 0..ROUNDS {
        keep_least(&mut ours, our_times(&inputs));
        for (name, _) in &peers {
            match ask(&out, name, "time") {
                Ok(answer) => keep_least(theirs.entry(name).or_default(), times_of(&answer)),
                Err(error) => eprintln!("SKIPPED {name}: {error}"),
            }
        }
    }

    let document = document(&out, &ours, &theirs, &peers, pinned);
    let text = format!("{document:#}\n");
    if let Err(error) = std::fs::write(out.join("peers.json"), &text) {
        eprintln!("{}: {error}", out.join("peers.json").display());
    }
    if std::env::args().any(|argument| argument == "--json") {
        print!("{text}");
    } else {
        show(&document);
    }
    if disagree { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// The build directory of this program: `target/release/deps/peers-…`.
fn target_directory() -> PathBuf {
    let program = std::env::current_exe().unwrap_or_default();
    program.ancestors().nth(3).map_or_else(std::env::temp_dir, Path::to_owned)
}

fn numbers<'a>(values: impl IntoIterator<Item = &'a f64>) -> String {
    values.into_iter().fold(String::new(), |mut line, value| {
        // Writing to a string does not fail.
        let _ = write!(line, "{value:?} ");
        line
    })
}

/// `arm.txt`, `arm.xml`, `states.txt`, `instances.txt`.
fn write_inputs(out: &Path, inputs: &Inputs) -> std::io::Result<()> {
    std::fs::create_dir_all(out)?;
    let arm = &inputs.arm;
    let rows = |m: &SMatrix<f64, 3, 3>| numbers(m.transpose().iter());
    let mut text = String::new();
    for (place, link) in arm.placements.iter().zip(&arm.links) {
        let _ = writeln!(text, "{}{}", rows(&place.rotation), numbers(place.translation.iter()));
        let _ = writeln!(text, "{:?} {}{}", link.mass_kg, numbers(link.com_m.iter()), rows(&link.inertia_kg_m2));
    }
    let (rotation, translation) = (&arm.link_from_flange_rotation, &arm.link_from_flange_translation);
    let _ = writeln!(text, "{}{}", rows(rotation), numbers(translation.iter()));
    let _ = writeln!(text, "{}", numbers(arm.gravity_m_s2.iter()));
    std::fs::write(out.join("arm.txt"), text)?;
    std::fs::write(out.join("arm.xml"), mjcf(arm))?;

    let states = inputs.states.iter().map(|s| numbers([&s.q, &s.qd, &s.qdd, &s.tau].into_iter().flatten()) + "\n");
    std::fs::write(out.join("states.txt"), states.collect::<String>())?;
    let instances = inputs.instances.iter().map(|p| {
        let vectors = [&p.torque, &p.lower, &p.upper, &p.covariance.diagonal()].map(|v| numbers(v.iter()));
        numbers(p.jacobian.transpose().iter()) + &vectors.concat() + "\n"
    });
    std::fs::write(out.join("instances.txt"), instances.collect::<String>())
}

/// The bare arm in MuJoCo's format: bodies, hinges, no shapes.
fn mjcf(arm: &Arm<7>) -> String {
    let pose = |rotation: &SMatrix<f64, 3, 3>, translation: &SVector<f64, 3>| {
        let q = UnitQuaternion::from_matrix(rotation);
        format!("pos=\"{}\" quat=\"{}\"", numbers(translation.iter()), numbers(&[q.w, q.i, q.j, q.k]))
    };
    let mut xml = format!(
        "<mujoco><compiler angle=\"radian\"/><option gravity=\"{}\"/><worldbody>\n",
        numbers(arm.gravity_m_s2.iter())
    );
    for (place, link) in arm.placements.iter().zip(&arm.links) {
        let i = &link.inertia_kg_m2;
        let inertia = [i[(0, 0)], i[(1, 1)], i[(2, 2)], i[(0, 1)], i[(0, 2)], i[(1, 2)]];
        let _ = writeln!(
            xml,
            "<body {}><inertial pos=\"{}\" mass=\"{:?}\" fullinertia=\"{}\"/><joint axis=\"0 0 1\"/>",
            pose(&place.rotation, &place.translation),
            numbers(link.com_m.iter()),
            link.mass_kg,
            numbers(&inertia)
        );
    }
    let flange = pose(&arm.link_from_flange_rotation, &arm.link_from_flange_translation);
    let _ = writeln!(xml, "<site name=\"flange\" {flange}/>{}</worldbody></mujoco>", "</body>".repeat(7));
    xml
}

fn ask(out: &Path, peer: &str, what: &str) -> Result<String, String> {
    let output = Command::new(out.join(peer)).arg(out).arg(what).output().map_err(|error| error.to_string())?;
    if !output.status.success() {
        return Err(format!("{}: {}", output.status, String::from_utf8_lossy(&output.stderr).trim()));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

fn times_of(answer: &str) -> Times {
    let pair = |line: &str| line.split_once(' ').and_then(|(name, ns)| Some((name.to_owned(), ns.parse().ok()?)));
    answer.lines().filter_map(pair).collect()
}

fn keep_least(least: &mut Times, times: Times) {
    for (name, ns) in times {
        least.entry(name).and_modify(|best| *best = best.min(ns)).or_insert(ns);
    }
}

/// Largest |theirs − ours| / (1 + |ours|) per call.
fn largest_difference(out: &Path, peer: &str, inputs: &Inputs) -> Result<Times, String> {
    let mut largest = Times::new();
    for line in ask(out, peer, "check")?.lines() {
        let mut words = line.split_whitespace();
        let (Some(call), Some(k)) = (words.next(), words.next().and_then(|k| k.parse::<usize>().ok())) else {
            continue;
        };
        let theirs: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
        let ours = if peer == "daqp" { our_forces(inputs, call, k) } else { our_values(inputs, call, k) };
        let worst = match ours.len() == theirs.len() && !ours.is_empty() {
            true => ours.iter().zip(&theirs).map(|(a, b)| relative(*a, *b)).fold(0.0, f64::max),
            false => f64::INFINITY,
        };
        largest.entry(call.to_owned()).and_modify(|most| *most = most.max(worst)).or_insert(worst);
    }
    if largest.is_empty() { Err("no outputs".to_owned()) } else { Ok(largest) }
}

/// What is not a number differs infinitely.
fn relative(ours: f64, theirs: f64) -> f64 {
    let difference = (ours - theirs).abs() / (1.0 + ours.abs());
    if difference.is_nan() { f64::INFINITY } else { difference }
}

/// Our output of a call for state `k`, flattened as the peers do: column by column.
fn our_values(inputs: &Inputs, call: &str, k: usize) -> Vec<f64> {
    let (arm, State { q, qd, qdd, tau }) = (&inputs.arm, &inputs.states[k]);
    let kinematics = Kinematics::at(arm, q);
    match call {
        "rnea" => rnea(arm, q, qd, qdd).as_slice().to_vec(),
        "crba" | "crba_world" => mass_matrix(arm, q).as_slice().to_vec(),
        "aba" | "aba_world" => forward_dynamics(arm, q, qd, tau).as_slice().to_vec(),
        "bias" => bias_torque(arm, q, qd).as_slice().to_vec(),
        "gravity" => gravity_torque(arm, q).as_slice().to_vec(),
        "jacobian" => kinematics.jacobian().as_slice().to_vec(),
        "jacobian_drift" => kinematics.jdot_qd(qd).as_slice().to_vec(),
        "control_terms" => {
            let terms = ControlTerms::at(arm, q, qd);
            [terms.mass_matrix.as_slice(), terms.bias_nm().as_slice()].concat()
        }
        "regressor" => {
            let blocks = inverse_dynamics_regressor(arm, q, qd, qdd);
            let torque = blocks
                .iter()
                .zip(&arm.links)
                .fold(SVector::<f64, 7>::zeros(), |sum, (y, link)| sum + y * link.parameters());
            torque.as_slice().to_vec()
        }
        _ => Vec::new(),
    }
}

/// Force, or its twelve limits x+, x−, y+, ….
fn our_forces(inputs: &Inputs, call: &str, k: usize) -> Vec<f64> {
    let mut solver = ForceSolver::new(prior());
    let Ok(estimate) = solver.estimate(&inputs.instances[k]) else { return Vec::new() };
    match call {
        "estimate" => estimate.force.as_slice().to_vec(),
        _ => (0..12).filter_map(|i| Some(sign(i) * solver.limit(&direction(i), LAMBDA).ok()?.value)).collect(),
    }
}

fn sign(i: usize) -> f64 {
    1.0 - 2.0 * (i % 2) as f64
}

fn direction(i: usize) -> SVector<f64, 6> {
    SVector::from_fn(|r, _| if r == i / 2 { sign(i) } else { 0.0 })
}

fn our_times(inputs: &Inputs) -> Times {
    let arm = &inputs.arm;
    let mut times = Times::new();
    fn calls<R>(times: &mut Times, name: &str, states: &[State<7>], call: impl Fn(&State<7>) -> R) {
        let mut passes: Vec<f64> = (0..=PASSES)
            .map(|_| {
                let started = Instant::now();
                for state in states {
                    black_box(call(black_box(state)));
                }
                started.elapsed().as_secs_f64() * 1e9 / states.len() as f64
            })
            .skip(1)
            .collect();
        times.insert(name.to_owned(), quantile(&mut passes, 0.5));
    }
    calls(&mut times, "rnea", &inputs.states, |s| rnea(arm, &s.q, &s.qd, &s.qdd));
    calls(&mut times, "crba", &inputs.states, |s| mass_matrix(arm, &s.q));
    calls(&mut times, "aba", &inputs.states, |s| forward_dynamics(arm, &s.q, &s.qd, &s.tau));
    calls(&mut times, "bias", &inputs.states, |s| bias_torque(arm, &s.q, &s.qd));
    calls(&mut times, "gravity", &inputs.states, |s| gravity_torque(arm, &s.q));
    calls(&mut times, "jacobian", &inputs.states, |s| Kinematics::at(arm, &s.q).jacobian());
    calls(&mut times, "jacobian_drift", &inputs.states, |s| {
        let kinematics = Kinematics::at(arm, &s.q);
        (kinematics.base_from_flange(), kinematics.jacobian(), kinematics.jdot_qd(&s.qd))
    });
    calls(&mut times, "control_terms", &inputs.states, |s| ControlTerms::at(arm, &s.q, &s.qd));
    calls(&mut times, "regressor", &inputs.states, |s| inverse_dynamics_regressor(arm, &s.q, &s.qd, &s.qdd));

    for (name, truth) in [
        ("plant_coulomb_viscous", Truth::panda_coulomb_viscous()),
        ("plant_stribeck", Truth::panda_stribeck()),
        ("plant_lugre", Truth::panda_lugre()),
        ("plant_gaz", Truth::panda_gaz()),
    ] {
        let each = |s: &State<7>| {
            let mut plant = BoxFrictionPlant::new(truth.clone(), Sensors::default(), s.q, 1).with_velocity(s.qd);
            let torque = s.tau * 0.01;
            let started = Instant::now();
            plant.actuate(black_box(&torque));
            let elapsed = started.elapsed();
            black_box(&plant);
            elapsed.as_secs_f64() * 1e9
        };
        let mut least = least_of_each(&inputs.states, each);
        times.insert(name.to_owned(), quantile(&mut least, 0.5));
    }

    let mut solver = ForceSolver::<7, 6>::new(prior());
    for (name, warm, limits) in
        [("estimate_cold", false, false), ("estimate_warm", true, false), ("estimate_with_limits", false, true)]
    {
        let mut least = least_of_each(&inputs.instances, |problem| {
            if warm {
                black_box(solve(&mut solver, problem, limits));
            }
            let started = Instant::now();
            black_box(solve(&mut solver, black_box(problem), limits));
            started.elapsed().as_secs_f64() * 1e9
        });
        times.insert(name.to_owned(), quantile(&mut least, 0.5));
        times.insert(format!("{name}_p99"), quantile(&mut least, 0.99));
    }
    times
}

fn solve(solver: &mut ForceSolver<7, 6>, problem: &Problem, limits: bool) -> f64 {
    let force = solver.estimate(problem).map_or(f64::NAN, |estimate| estimate.force[0]);
    let limits = if limits { 12 } else { 0 };
    (0..limits).fold(force, |sum, i| sum + solver.limit(&direction(i), LAMBDA).map_or(f64::NAN, |limit| limit.value))
}

/// The least of five times per input.
fn least_of_each<T>(inputs: &[T], mut time: impl FnMut(&T) -> f64) -> Vec<f64> {
    let mut least = vec![f64::INFINITY; inputs.len()];
    for _ in 0..5 {
        for (least, input) in least.iter_mut().zip(inputs) {
            *least = least.min(time(input));
        }
    }
    least
}

fn quantile(values: &mut [f64], p: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * p) as usize]
}

fn document(
    out: &Path,
    ours: &Times,
    theirs: &BTreeMap<&str, Times>,
    peers: &[(&str, Times)],
    pinned: Option<usize>,
) -> Value {
    let version = |peer: &str| {
        let text = std::fs::read_to_string(out.join(format!("{peer}.version"))).unwrap_or_default();
        text.trim().to_owned()
    };
    let rows = ROWS.iter().map(|(what, peer, call, our_call)| {
        let (our_ns, peer_ns) = (ours.get(*our_call), theirs.get(peer).and_then(|times| times.get(*call)));
        let ratio = our_ns.zip(peer_ns).map(|(ours, theirs)| ours / theirs);
        json!({"what": what, "peer": peer, "ours_ns": our_ns, "peer_ns": peer_ns, "ratio": ratio})
    });
    let differences: BTreeMap<_, _> = peers.iter().cloned().collect();
    let versions: BTreeMap<_, _> = peers.iter().map(|(peer, _)| (*peer, version(peer))).collect();
    json!({
        "schema": "tribo.peers/1",
        "pinned_core": pinned,
        "avx2": cfg!(target_feature = "avx2"),
        "versions": versions,
        "largest_relative_difference": differences,
        "rows": rows.collect::<Vec<_>>(),
    })
}

fn show(document: &Value) {
    let core = document["pinned_core"].as_u64().map_or("not pinned".to_owned(), |core| format!("core {core}"));
    let instructions = if document["avx2"] == true { "AVX2" } else { "the instructions of any x86-64" };
    println!("least of {ROUNDS} medians, {core}; ours with {instructions}; peers {}\n", document["versions"]);
    println!("| {:<46} | {:<9} | {:>7} | {:>7} | {:>7} |", "call [ns]", "peer", "ours", "theirs", "ratio");
    println!("|{0:-<48}|{0:-<11}|{0:->8}:|{0:->8}:|{0:->8}:|", "");
    for row in document["rows"].as_array().into_iter().flatten() {
        let number = |key: &str, digits: usize| {
            row[key].as_f64().map_or("SKIPPED".to_owned(), |value| format!("{value:.digits$}"))
        };
        let text = |key: &str| row[key].as_str().unwrap_or_default().to_owned();
        println!(
            "| {:<46} | {:<9} | {:>7} | {:>7} | {:>7} |",
            text("what"),
            text("peer"),
            number("ours_ns", 0),
            number("peer_ns", 0),
            number("ratio", 2)
        );
    }
}
