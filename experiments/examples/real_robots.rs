//! Diagnosis on the real logs in `$TRIBO_DATA`: what the written model predicts for data it has not seen, beside plain fits, and
//! whether findings recur.
//!
//! ```sh
//! TRIBO_DATA=… cargo run --release -p tribo-experiments --example real_robots -- --out experiments/11_real_robots/expected.json
//! ```
#![allow(clippy::unwrap_used, clippy::panic, reason = "a command line without users to be kind to")]

use std::collections::BTreeSet;
use std::path::PathBuf;

use serde_json::{Value, json};
use tribo_diagnose::{Diagnosable, DiagnoseSettings, Diagnosis, diagnose};
use tribo_logs::{Quantity, RobotLog, read_log};
use tribo_model::{AnyModel, Model, ModelFile};
use tribo_regression::Nominal;
use tribo_sim::TorqueSide;

/// A robot with its logs.
struct Arm {
    name: &'static str,
    model: ModelFile,
    logs: Vec<(&'static str, RobotLog)>,
}

/// Train on some logs, test on another.
struct Split {
    name: String,
    train: Vec<RobotLog>,
    test: RobotLog,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let out = arguments.iter().position(|argument| argument == "--out").and_then(|at| arguments.get(at + 1));
    let mut ratios = Vec::new();
    let mut documents = Vec::new();
    for arm in arms() {
        let document = match ModelFile::validate_any(&arm.model).unwrap() {
            AnyModel::Six(model) => of_arm(&arm, &model, &mut ratios),
            AnyModel::Seven(model) => of_arm(&arm, &model, &mut ratios),
        };
        documents.push(document);
    }
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    println!("\nmean ratio over {} splits: {mean:.3}", ratios.len());
    let document = json!({"schema": "tribo.real_robots/1", "mean_ratio": mean, "robots": documents});
    if let Some(path) = out {
        std::fs::write(path, serde_json::to_string_pretty(&document).unwrap() + "\n").unwrap();
    }
}

fn data(path: &str) -> PathBuf {
    PathBuf::from(std::env::var("TRIBO_DATA").unwrap_or("../shared/data".to_owned())).join(path)
}

fn log(path: &str) -> RobotLog {
    read_log(data(path)).unwrap().0
}

fn part(log: &RobotLog, from: f64, to: f64) -> RobotLog {
    let row = |share: f64| (share * log.rows() as f64).round() as usize;
    log.slice(row(from)..row(to)).unwrap()
}

fn urdf(path: &str, side: TorqueSide, logs: &[RobotLog]) -> ModelFile {
    ModelFile { urdf: Some(std::fs::read_to_string(data(path)).unwrap()), ..ModelFile::bare(path, side, logs) }
}

fn arms() -> Vec<Arm> {
    let panda = log("panda_gaz2019");
    let ur10 = log("ur10_unisa/exciting_trajectory.csv.gz");
    let lwr = [1, 2, 3].map(|run| log(&format!("kuka_lwr4/run_{run}.csv.gz")));
    let gen3 = [1, 2].map(|run| log(&format!("kinova_gen3/opti_traj_testing{run}.csv.gz")));
    // The links' torque of the logs that have it left out: the whole arm is asked.
    let motors = [
        ("run", "RunTrajectory1"),
        ("record", "RecordTrajectory_quadratic"),
        ("testing 1", "opti_traj_testing1"),
        ("testing 2", "opti_traj_testing2"),
    ]
    .map(|(name, file)| (name, log(&format!("kinova_gen3/{file}.csv.gz")).without(&[Quantity::LinkTorque])));
    let [run_1, run_2, run_3] = lwr.clone();
    let [long, short] = gen3.clone();
    vec![
        Arm {
            name: "panda_gaz2019",
            model: ModelFile::bare("panda", TorqueSide::Link, std::slice::from_ref(&panda)),
            logs: vec![("log", panda)],
        },
        Arm {
            name: "ur10_unisa",
            model: urdf("ur10_unisa/ur10.urdf", TorqueSide::Motor, std::slice::from_ref(&ur10)),
            logs: vec![("log", ur10)],
        },
        Arm {
            name: "kuka_lwr4",
            model: urdf("kuka_lwr4/lwr4.urdf", TorqueSide::Link, &lwr),
            logs: vec![("run 1", run_1), ("run 2", run_2), ("run 3", run_3)],
        },
        Arm {
            name: "kinova_gen3",
            model: ModelFile::bare("kinova_gen3", TorqueSide::Motor, &gen3),
            logs: vec![("testing 1", long), ("testing 2", short)],
        },
        Arm {
            name: "kinova_gen3, torque of the motors alone",
            model: ModelFile::bare("kinova_gen3", TorqueSide::Motor, &motors.each_ref().map(|log| log.1.clone())),
            logs: motors.to_vec(),
        },
    ]
}

/// One log: two thirds against the last. Several: each log against each later one.
fn splits(arm: &Arm) -> Vec<Split> {
    if let [(_, only)] = &arm.logs[..] {
        let (train, test) = (part(only, 0.0, 2.0 / 3.0), part(only, 2.0 / 3.0, 1.0));
        return vec![Split { name: "two thirds → last third".to_owned(), train: vec![train], test }];
    }
    let count = arm.logs.len();
    let mut splits = Vec::new();
    for a in 0..count {
        for b in a + 1..count {
            let (first, second) = (&arm.logs[a], &arm.logs[b]);
            let name = format!("{} → {}", first.0, second.0);
            splits.push(Split { name, train: vec![first.1.clone()], test: second.1.clone() });
        }
    }
    splits
}

/// Findings by label, and by label and place.
fn names(diagnosis: &Diagnosis) -> [BTreeSet<String>; 2] {
    let labels = diagnosis.findings.iter().map(|finding| finding.label.to_string()).collect();
    let places = diagnosis
        .findings
        .iter()
        .flat_map(|finding| {
            let places = finding.joints.iter().chain(&finding.links).map(usize::to_string).collect::<Vec<_>>();
            let places = if places.is_empty() { vec!["arm".to_owned()] } else { places };
            places.into_iter().map(|place| format!("{} {place}", finding.label)).collect::<Vec<_>>()
        })
        .collect();
    [labels, places]
}

fn jaccard(a: &BTreeSet<String>, b: &BTreeSet<String>) -> f64 {
    let both = a.intersection(b).count() as f64;
    let any = a.union(b).count() as f64;
    if any > 0.0 { both / any } else { 1.0 }
}

fn figures(values: &[f64]) -> String {
    values.iter().map(|value| format!("{value:.3}")).collect::<Vec<_>>().join(" ")
}

fn of_arm<const N: usize>(arm: &Arm, model: &Model<N>, ratios: &mut Vec<f64>) -> Value
where
    Nominal<N>: Diagnosable,
{
    let nominal = model.to_nominal();
    let settings = DiagnoseSettings::default();
    let asked = |logs: &[RobotLog], validate: &[(String, RobotLog)]| {
        diagnose(logs, &nominal, validate, &settings, &|_, _| true).unwrap()
    };
    let mut rows = Vec::new();
    println!("\n## {}", arm.name);
    for split in splits(arm) {
        let diagnosis = asked(&split.train, &[("unseen".to_owned(), split.test)]);
        let unseen = &diagnosis.validation[0];
        let mean = |of: &[f64], over: &[f64]| of.iter().zip(over).map(|(a, b)| a / b).sum::<f64>() / N as f64;
        let plain_is_better = mean(&unseen.plain_nm, &unseen.full_nm) <= mean(&unseen.full_nm, &unseen.plain_nm);
        let baseline = if plain_is_better { &unseen.plain_nm } else { &unseen.full_nm };
        let by_joint: Vec<f64> = unseen.after_nm.iter().zip(baseline).map(|(ours, base)| ours / base).collect();
        let ratio = mean(&unseen.after_nm, baseline);
        let worst = by_joint.iter().copied().fold(0.0, f64::max);
        ratios.push(ratio);
        println!(
            "\n### {}: ratio {ratio:.3}, worst joint {worst:.2}, inside 95 % band {:.3}",
            split.name,
            unseen.inside95.unwrap_or(f64::NAN)
        );
        println!(
            "nominal  {}\nplain    {}\nfull     {}\nours     {}",
            figures(&unseen.before_nm),
            figures(&unseen.plain_nm),
            figures(&unseen.full_nm),
            figures(&unseen.after_nm)
        );
        let named: Vec<String> = diagnosis
            .findings
            .iter()
            .map(|finding| format!("{} {:?}{:?}", finding.label, finding.joints, finding.links))
            .collect();
        println!("{}: {}", diagnosis.verdict.name(), named.join(", "));
        rows.push(json!({
            "split": split.name,
            "ratio": ratio,
            "worst_joint": worst,
            "better_baseline": if plain_is_better { "plain" } else { "full" },
            "inside95": unseen.inside95,
            "nominal_nm": unseen.before_nm,
            "plain_nm": unseen.plain_nm,
            "full_nm": unseen.full_nm,
            "written_nm": unseen.after_nm,
            "verdict": diagnosis.verdict.name(),
            "findings": named,
        }));
    }
    // Do findings recur? Halves of the one log, or the runs.
    let pieces: Vec<(String, RobotLog)> = match &arm.logs[..] {
        [(_, only)] => vec![("half 1".to_owned(), part(only, 0.0, 0.5)), ("half 2".to_owned(), part(only, 0.5, 1.0))],
        several => several.iter().map(|(name, log)| ((*name).to_owned(), log.clone())).collect(),
    };
    let found: Vec<(String, [BTreeSet<String>; 2])> =
        pieces.into_iter().map(|(name, log)| (name, names(&asked(std::slice::from_ref(&log), &[])))).collect();
    let mut stability = Vec::new();
    for a in 0..found.len() {
        for b in a + 1..found.len() {
            let [labels, places] = [0, 1].map(|k| jaccard(&found[a].1[k], &found[b].1[k]));
            println!(
                "{} and {}: Jaccard of labels {labels:.2}, of labels at joints {places:.2}",
                found[a].0, found[b].0
            );
            stability.push(json!({"pair": [found[a].0, found[b].0], "labels": labels, "labels_at_joints": places}));
        }
    }
    for (name, [labels, _]) in &found {
        println!("{name}: {labels:?}");
    }
    json!({"robot": arm.name, "splits": rows, "stability": stability})
}
