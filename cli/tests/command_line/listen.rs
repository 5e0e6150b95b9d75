//! Story: a user of ROS 2 has a robot without a force sensor, starts `tribo listen` beside the driver and gets the wrench on a topic.
//!
//! Driver and user are programs on Cyclone DDS, the library under rmw_cyclonedds (`ros2_peer.py`). They talk in a network of their own
//! (`unshare -n`), where no message of anybody else is and none gets out; that needs root.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use serde_json::{Value, json};
use tribo_model::Model;
use tribo_robot::SensorFrame;
use tribo_sim::TorqueSide;
use tribo_trial::{EstimatorName, LogEstimator};

use crate::common::{Run, run, scratch, skipped};
use crate::python_witness::python;

/// Both ends on Cyclone DDS.
const PEER: &str = include_str!("ros2_peer.py");
/// Names of the joints as the driver of a Panda has them.
const NAMES: [&str; 7] =
    ["panda_joint1", "panda_joint2", "panda_joint3", "panda_joint4", "panda_joint5", "panda_joint6", "panda_joint7"];

/// A network of its own, and a Python with Cyclone DDS.
struct Network {
    python: String,
}

impl Network {
    /// None where it cannot be made; says so.
    fn new(untested: &str) -> Option<Self> {
        let python = python("cyclonedds", untested)?;
        let alone = Command::new("unshare")
            .args(["-n", "sh", "-c", &inside("true")])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
        if alone.is_ok_and(|status| status.success()) {
            return Some(Self { python });
        }
        skipped(&format!("no network of its own (needs root, unshare and ip); {untested}"));
        None
    }

    /// Runs a shell script there, with `$tribo`, `$peer` and the files of `at`.
    fn start(&self, at: &Path, script: &str) -> Child {
        fs::write(at.join("peer.py"), PEER).unwrap();
        let mut command = Command::new("unshare");
        command.args(["-n", "sh", "-c", &inside(script)]).current_dir(at).stdin(Stdio::null());
        let binary = std::env::var_os("TRIBO_BIN").unwrap_or_else(|| env!("CARGO_BIN_EXE_tribo").into());
        command.env("tribo", binary).env("peer", format!("{} peer.py", self.python));
        command.env_remove("CYCLONEDDS_URI").env_remove("ROS_DOMAIN_ID");
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    }

    fn run(&self, at: &Path, script: &str) -> Run {
        self.start(at, script).wait_with_output().unwrap().into()
    }
}

/// A script with a loopback that knows multicast; what it started ends with it.
fn inside(script: &str) -> String {
    format!(
        "trap 'kill $hears $listens $sends 2> /dev/null' EXIT; ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo && {{ {script}\n}}"
    )
}

/// A trial of the simulated Panda as canonical CSV, and what the peer is to do with it.
fn question(at: &Path, rows: usize, changes: &[(&str, Value)]) {
    run(at, "simulate --log trial.csv --seed 3").ok();
    let mut question = json!({
        "csv": "trial.csv", "rows": rows, "rate_hz": 1000, "ready": "ready", "effort": true, "velocity": true, "names": NAMES, "extra": true,
    });
    for (field, value) in changes {
        question[*field] = value.clone();
    }
    fs::write(at.join("question.json"), question.to_string()).unwrap();
}

fn document(path: &Path) -> Value {
    let text = fs::read_to_string(path).unwrap();
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// Ten thousand wrenches at 1 kHz, none lost either way; what was published is what `estimate` says of the recording, to the bit.
#[test]
fn ten_thousand_messages_become_ten_thousand_wrenches() {
    let Some(network) = Network::new("the wrench over DDS") else { return };
    let at = scratch();
    // Half a second for the estimator to settle.
    question(at.path(), 10_500, &[]);
    let script = "
        $peer hear question.json > heard.json 2> heard.txt & hears=$!
        $tribo listen --robot panda --residual ekf --for 45 --record r.mcap --json > listened.json 2> listened.txt & listens=$!
        $peer publish question.json > sent.json || exit 9
        wait $hears || exit 8
        kill -INT $listens; wait $listens";
    let ran = network.run(at.path(), script);
    let said = fs::read_to_string(at.path().join("listened.txt")).unwrap_or_default();
    let heard_said = fs::read_to_string(at.path().join("heard.txt")).unwrap_or_default();
    // Stopped before its time, with all that was recorded.
    assert_eq!(ran.code, Some(130), "{ran:?}\n{said}\n{heard_said}");
    assert!(said.contains("panda_joint1, panda_joint2") && said.contains("r.mcap is whole"), "{said}");
    let (heard, sent, listened) = (
        document(&at.path().join("heard.json")),
        document(&at.path().join("sent.json")),
        document(&at.path().join("listened.json")),
    );

    // Every message came, every wrench went and came.
    assert_eq!(sent["sent"], 10_500);
    for (field, expected) in
        [("received", 10_500), ("used", 10_500), ("published", 10_000), ("lost", 0), ("gaps", 0), ("unsent", 0)]
    {
        assert_eq!(listened[field], expected, "{field}: {listened}");
    }
    let wrenches = heard["wrench"].as_array().unwrap();
    assert_eq!((wrenches.len(), heard["covariance"].as_array().unwrap().len()), (10_000, 10_000));
    println!("from stamp to wrench, in the listener: {}", listened["stamp_to_wrench_ms"]);
    println!("from arrival to wrench, in the listener: {}", listened["taken_to_wrench_ms"]);
    println!("from stamp to the hearer: {}; the driver was at most {} ms late", heard["age_ms"], sent["latest_ms"]);

    // The same as estimate says of what was recorded.
    run(at.path(), "estimate r.mcap --robot panda --residual ekf --out e.parquet --quiet").ok();
    let (columns, _) = columns(&at.path().join("e.parquet"));
    let first_ns = sent["first_ns"].as_u64().unwrap();
    let axes = ["fx_n", "fy_n", "fz_n", "mx_nm", "my_nm", "mz_nm"];
    for (k, wrench) in wrenches.iter().enumerate() {
        assert_eq!(wrench[0].as_u64().unwrap(), first_ns + (k as u64 + 500) * 1_000_000);
        assert_eq!(wrench[1], "panda_link0");
        for (i, axis) in axes.iter().enumerate() {
            let estimated = columns[&format!("wrench_{axis}")][k];
            assert_eq!(wrench[2][i].as_f64().unwrap().to_bits(), estimated.to_bits(), "row {k}, {axis}");
        }
    }

    // The covariance is in the order of the wrench, and says which one it belongs to.
    let last = &heard["covariance"][9_999];
    let stamp = wrenches[9_999][0].as_u64().unwrap();
    let label = format!("fx fy fz tx ty tz, stamp {}.{:09}", stamp / 1_000_000_000, stamp % 1_000_000_000);
    assert_eq!(last[0], json!([[label, 6, 36], ["fx fy fz tx ty tz", 6, 6]]));
    for (i, axis) in axes.iter().enumerate() {
        let (variance, sd) = (last[1][7 * i].as_f64().unwrap(), columns[&format!("wrench_sd_{axis}")][9_999]);
        assert!((variance.sqrt() - sd).abs() <= 1e-12 * sd, "{axis}: {variance} and {sd}");
    }

    // Monitors see it once a second.
    let diagnostics = heard["diagnostics"].as_array().unwrap();
    assert!(diagnostics.len() >= 10, "{}", diagnostics.len());
    let fine = diagnostics.iter().find(|status| status["message"] == "wrenches go out").unwrap();
    assert_eq!((&fine["name"], &fine["values"]["estimator"]), (&json!("tribo: wrench"), &json!("ekf")));
    assert!(fine["values"]["stamp to wrench, p99 [ms]"].is_string(), "{fine}");
}

fn columns(path: &Path) -> (std::collections::HashMap<String, Vec<f64>>, usize) {
    let table = tribo_files::read_table(path).unwrap();
    let rows = table.columns.first().map_or(0, |(_, values)| values.len());
    (table.columns.into_iter().collect(), rows)
}

/// The model is read again when it changes, and a broken file changes nothing; wrenches go on all the time.
#[test]
fn parameters_change_while_it_listens() {
    let Some(network) = Network::new("parameters that change while it listens") else { return };
    let at = scratch();
    question(at.path(), 6_000, &[("extra", json!(false))]);
    let model = |coulomb_nm: f64| {
        let joint = format!("    - {{coulomb_nm: {coulomb_nm}, viscous_nm_s_per_rad: 0.0}}\n");
        format!(
            "schema: tribo.model/1\nrobot: panda\nfriction:\n  law: coulomb_viscous\n  joints:\n{}",
            joint.repeat(7)
        )
    };
    for (name, text) in [
        ("m.yaml", model(0.0)),
        ("next.yaml", model(0.4)),
        ("broken.yaml", "schema: tribo.model/1\nrobot: [\n".to_owned()),
    ] {
        fs::write(at.path().join(name), text).unwrap();
    }
    let script = "
        $peer hear question.json > heard.json & hears=$!
        $tribo listen --model m.yaml --residual momentum --json --rate 100 > listened.json 2> listened.txt & listens=$!
        $peer publish question.json > sent.json & sends=$!
        until grep -q 'joint states come' listened.txt; do sleep 0.1; done
        sleep 1; cp broken.yaml m.yaml; sleep 1.5; cp next.yaml m.yaml
        wait $sends && wait $hears || exit 9
        kill -INT $listens; wait $listens";
    let ran = network.run(at.path(), script).ok();
    let said = fs::read_to_string(at.path().join("listened.txt")).unwrap();
    assert!(said.contains("m.yaml has changed and cannot be used") && said.contains("m.yaml:"), "{ran:?} {said}");
    assert!(said.contains("m.yaml has changed and is in use"), "{said}");
    let heard = document(&at.path().join("heard.json"));
    let stamps: Vec<u64> =
        heard["wrench"].as_array().unwrap().iter().map(|wrench| wrench[0].as_u64().unwrap()).collect();
    // A hundred per second, and no hole where the estimators change places.
    assert!(stamps.windows(2).all(|pair| pair[1] - pair[0] == 10_000_000), "{stamps:?}");
    assert_eq!(stamps.len(), 550);
    let refused = heard["diagnostics"]
        .as_array()
        .unwrap()
        .iter()
        .any(|status| status["values"]["parameters refused"].is_string());
    assert!(refused, "{}", heard["diagnostics"]);
}

/// A torque that the controller tells takes the place of the friction believed: the estimator, fed here with the recording and that torque,
/// says the same to the bit.
#[test]
fn a_told_compensation_is_taken_for_the_friction() {
    const TOLD_NM: f64 = 0.7;
    let Some(network) = Network::new("a compensation that is told") else { return };
    let at = scratch();
    question(at.path(), 1_000, &[("added_nm", json!(TOLD_NM)), ("told", json!(true))]);
    let script = "
        $peer hear question.json > heard.json & hears=$!
        $tribo listen --robot panda --json --record r.mcap --compensation /tau_friction > listened.json & listens=$!
        $peer publish question.json > sent.json && wait $hears || exit 9
        kill -INT $listens; wait $listens";
    network.run(at.path(), script).ok();
    let heard = document(&at.path().join("heard.json"));
    let (log, _) = tribo_logs::read_log(at.path().join("r.mcap")).unwrap();
    assert_eq!((log.rows(), heard["wrench"].as_array().unwrap().len()), (1_000, 500));

    let estimator = LogEstimator::new(&Model::<7>::panda(TorqueSide::Motor));
    let mut measured = estimator.measured(EstimatorName::Ekf).unwrap();
    let row = |columns: &[Vec<f64>], k: usize| -> [f64; 7] { std::array::from_fn(|j| columns[j][k]) };
    let told = [TOLD_NM; 7].into();
    for k in 0..log.rows() {
        let (q, qd, tau) = (row(&log.q_rad, k).into(), row(&log.dq_rad_s, k).into(), row(&log.tau_j_nm, k).into());
        let frame = SensorFrame { time_s: log.time_s[k], q, qd, tau, theta: None };
        if k == 0 {
            measured.begin(&frame);
            continue;
        }
        let expected = measured.step(&frame, Some(&told)).wrench_base.to_force_moment();
        for (i, expected) in expected.iter().enumerate().filter(|_| k >= 500) {
            let value = heard["wrench"][k - 500][2][i].as_f64().unwrap();
            assert_eq!(value.to_bits(), expected.to_bits(), "row {k}, component {i}: {value} and {expected}");
        }
    }
}

/// What is wrong with a topic is said with its name and what it has, and the exit code is 2.
#[test]
fn topics_that_cannot_be_used_are_named() {
    let Some(network) = Network::new("errors about topics") else { return };
    let script = "
        $peer publish question.json > sent.json & sends=$!
        $tribo listen --robot panda --for 20 $extra > /dev/null; code=$?
        kill $sends; exit $code";
    for (changes, option, expected) in [
        (
            vec![("effort", json!(false))],
            "",
            "topic /joint_states: none of the first 100 messages can be used: the last one has no effort",
        ),
        (vec![], "--joints a,b,c,d,e,f,g", "panda_joint1, which lack a, b, c, d, e, f, g"),
        (vec![("names", json!(["a", "b", "c", "d", "e", "f"]))], "", "which lack an arm of 7 joints"),
    ] {
        let at = scratch();
        let ready = ("ready", Value::Null);
        question(at.path(), 2_000, &[&changes[..], &[ready]].concat());
        let ran = network.run(at.path(), &script.replace("$extra", option));
        assert_eq!(ran.code, Some(2), "{ran:?}");
        assert!(ran.stderr.contains(expected), "{expected}: {}", ran.stderr);
    }
    let at = scratch();
    let ran = network.run(at.path(), "$tribo listen --robot panda --for 1 --record r.mcap");
    assert_eq!(ran.code, Some(2), "{ran:?}");
    // A machine that is busy looks a little longer than it was asked to.
    let looked_s = ran
        .stderr
        .split_once("topic /joint_states: no message in ")
        .and_then(|(_, rest)| rest.split_once(" s, domain 0; nobody publishes")?.0.parse::<f64>().ok());
    assert!(looked_s.is_some_and(|looked_s| looked_s >= 1.0), "{}", ran.stderr);
}

/// What cannot be is refused before anybody listens.
#[test]
fn options_that_cannot_be_are_refused() {
    let at = scratch();
    for (arguments, expected) in [
        ("--for 1", "--model"),
        ("--robot panda --rate 0", "--rate is 0; allowed: above 0"),
        ("--robot panda --for nan", "--for is NaN; allowed: above 0"),
        ("--robot panda --domain 233", "0..=232"),
        ("--robot panda --residual double_encoder", "motor positions"),
        ("--robot panda --joints a,b", "--joints has 2 names; the arm has 7 joints"),
        ("--robot panda --joints a,b,c,d,e,f,a", "--joints names a twice"),
        ("--robot panda --record r.csv", "ends with .mcap"),
        ("--robot panda --joint-states /2a", "topic /2a: is no name of a topic"),
        ("--robot panda --address 192.0.2.1", "--address 192.0.2.1: no network interface"),
        ("--robot nobody", "nobody"),
        ("--model none.yaml", "none.yaml"),
        ("--compensator none.yaml", "none.yaml"),
    ] {
        let ran = run(at.path(), &format!("listen {arguments}"));
        assert_eq!(ran.code, Some(2), "{arguments}: {ran:?}");
        assert!(ran.stderr.contains(expected), "{arguments}: {}", ran.stderr);
    }
}
