//! Story: `tribo serve` is a robot, and `tune`, `simulate` and `investigate` drive it over the wire, in lockstep.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::io::BufReader;
use std::path::Path;
use std::process::{Child, Stdio};

use serde_json::{Deserializer, Value};

use crate::common::{run, scratch, tribo};

/// A robot that serves until it is dropped.
struct Served {
    child: Child,
    host: String,
}

impl Served {
    /// `tribo serve` with these arguments, in lockstep, at a port that nobody has.
    fn new(at: &Path, arguments: &str) -> Self {
        Self::paced(at, &format!("--lockstep {arguments}"))
    }

    /// The same in real time unless the arguments say otherwise.
    fn paced(at: &Path, arguments: &str) -> Self {
        let all = format!("serve --port 0 --json {arguments}");
        let mut child = tribo(at, all.split_whitespace()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let stdout = BufReader::new(child.stdout.take().unwrap());
        let first: Value = Deserializer::from_reader(stdout).into_iter().next().unwrap().unwrap();
        let host = format!("127.0.0.1:{}", first["port"]);
        Self { child, host }
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn costs(document: &Value) -> Vec<f64> {
    document["trials"].as_array().unwrap().iter().map(|trial| trial["cost"].as_f64().unwrap()).collect()
}

/// The loop commands what a unit makes of it that adds gravity itself: costs over the wire are the simulated ones to the last bit.
#[test]
fn a_live_campaign_is_the_simulated_one() {
    let at = scratch();
    let simulated = costs(&run(at.path(), "tune --trials 3 --stop-below never --json -q --out simulated").ok().json());
    let server = Served::new(at.path(), "--fresh");
    let call =
        format!("tune --live {} --yes --no-rehearsal --trials 3 --stop-below never --json -q --out live", server.host);
    let live = run(at.path(), &call).ok().json();
    assert_eq!(costs(&live), simulated, "over the wire, in process");
    assert_eq!(
        (costs(&live).len(), live["robot"].as_str(), live["lost_periods"].as_u64()),
        (3, Some("panda"), Some(0))
    );

    // What the robot sent is there at the full rate, and every other command reads it.
    let recorded =
        run(at.path(), "estimate live/recordings/0001.parquet --torque-side link --residual momentum --json").ok();
    assert_eq!(recorded.json()["log"]["rows"].as_u64().or(Some(33_000)), Some(33_000));
    assert!(at.path().join("live/tuned.yaml").exists());
    run(at.path(), "export live --format c --out compensator.h").ok();

    // Going on with more trials, on an FR3: another robot is refused, the same is not.
    let other = Served::new(at.path(), "--robot fr3");
    let refused = run(at.path(), &format!("tune --resume --live {} --yes --out live", other.host));
    assert_eq!(refused.code, Some(2), "{refused:?}");
    assert!(refused.stderr.contains("fr3"), "{refused:?}");
    run(at.path(), &format!("tune --resume --live {} --yes --out live", server.host)).ok();
}

/// Version 10 carries floats: friction within a tenth of what was hidden all the same.
#[test]
fn an_fr3_is_tuned_over_floats() {
    let at = scratch();
    let server = Served::new(at.path(), "--robot fr3");
    let live = run(at.path(), &format!("tune --live {} --yes --json -q --out live", server.host)).ok().json();
    let costs = costs(&live);
    assert!(costs[1] < 0.2 * costs[0], "{costs:?}");
    let best = live["best"]["trial"].as_u64().unwrap() as usize;
    let found = &live["trials"][best]["params"];
    let hidden = &run(at.path(), "tune --robot fr3 --trials 1 --json -q --out simulated").ok().json()["true_params"];
    for joint in (0..7).map(|j| format!("joint_{j}")) {
        let [found, hidden] = [found, hidden].map(|all| all[&joint]["coulomb_nm"].as_f64().unwrap());
        assert!((found / hidden - 1.0).abs() < 0.1, "{joint}: {found} Nm, {hidden} hidden");
    }
}

/// A standing robot that somebody pushes is felt without commanding it; what was watched is a log like any other.
#[test]
fn a_standing_robot_is_watched() {
    let at = scratch();
    let pushes = "schema: tribo.pushes/1\npushes:\n- {start_s: 0.0, end_s: 1000.0, force_n: [0, 0, 12]}\n";
    std::fs::write(at.path().join("pushes.yaml"), pushes).unwrap();
    // In lockstep time stands still until somebody commands.
    let server = Served::paced(at.path(), "--truth frictionless --pushes pushes.yaml");
    let call = format!("estimate --live {} --seconds 3 --record watched.parquet --residual ekf --json", server.host);
    let felt = run(at.path(), &call).ok().json();
    let z = felt["estimators"]["ekf"]["mean"][2].as_f64().unwrap();
    assert!((z + 12.0).abs() < 1.0, "{z} N of -12 N");
    let again = "estimate watched.parquet --robot panda --torque-side link --residual ekf --json";
    assert_eq!(run(at.path(), again).ok().json()["estimators"], felt["estimators"]);
    let long = run(at.path(), &format!("estimate --live {} --seconds -1 --record w.csv", server.host));
    assert!(long.code == Some(2) && long.stderr.contains("--seconds is -1"), "{long:?}");
    let nowhere = run(at.path(), &format!("estimate --live {} --record w.txt", server.host));
    assert!(nowhere.code == Some(2) && nowhere.stderr.contains("unknown ending"), "{nowhere:?}");
}

#[test]
fn nobody_there_and_nobody_asked_are_told() {
    let at = scratch();
    let nobody = run(at.path(), "tune --live 127.0.0.1:1 --yes --out c");
    assert_eq!(nobody.code, Some(2), "{nobody:?}");
    assert!(!at.path().join("c").exists(), "nothing begun");
    let unasked = run(at.path(), "tune --live 127.0.0.1:1 --out c");
    assert_eq!(unasked.code, Some(2), "{unasked:?}");
    assert!(unasked.stderr.contains("--yes"), "{unasked:?}");
    let taken = Served::new(at.path(), "");
    let port = taken.host.rsplit(':').next().unwrap().to_owned();
    let refused = run(at.path(), &format!("serve --port {port}"));
    assert_eq!(refused.code, Some(2), "{refused:?}");
    assert!(refused.stderr.contains("--port"), "{refused:?}");
}

/// Friction that the model lacks gets its joint; all is in files, and a second call moves nothing and says the same.
#[test]
fn a_live_robot_is_asked_for_its_friction() {
    let at = scratch();
    hide(at.path(), "{cause: coulomb, joint: 2, delta_coulomb_nm: 0.6}");
    let server = Served::new(at.path(), "--truth truth.yaml");
    let call = format!("investigate --live {} --yes --model known.yaml --json -q --out found", server.host);
    let found = run(at.path(), &call).ok().json();
    let findings = found["answer"]["findings"].as_array().unwrap();
    let named = |finding: &&Value| finding["label"] == "coulomb" && finding["joint"] == 2;
    assert!(findings.iter().any(|finding| named(&finding)), "{found:#}");
    for name in [
        "investigation.yaml",
        "motion_00.yaml",
        "log_00.parquet",
        "answer_00.json",
        "check.parquet",
        "extended.yaml",
        "report.html",
    ] {
        assert!(at.path().join("found").join(name).exists(), "{name}");
    }
    drop(server);
    let again = run(at.path(), &call);
    assert_eq!(again.code, Some(2), "nobody there to be asked what it is: {again:?}");
    let server = Served::new(at.path(), "--truth truth.yaml");
    let call = format!("investigate --live {} --yes --model known.yaml --json -q --out found", server.host);
    assert_eq!(run(at.path(), &call).ok().json(), found);
    let other = run(at.path(), &format!("{call} --seed 5"));
    assert_eq!(other.code, Some(2), "another seed is another investigation: {other:?}");
}

/// A sensor that reads too much is seen in no torque that was sent: the motors lack nothing, the sensors are asked next.
#[test]
fn a_live_robots_sensors_are_asked_where_its_motors_lack_nothing() {
    let at = scratch();
    hide(at.path(), "{cause: torque_gain, joint: 3, gain_error: 0.08}");
    let server = Served::new(at.path(), "--truth truth.yaml");
    let call = format!("investigate --live {} --yes --model known.yaml --json -q --out found", server.host);
    let found = run(at.path(), &call).ok().json();
    assert_eq!((&found["torque_sensors"], &found["verdict"]), (&true.into(), &"named".into()), "{found:#}");
    let findings = found["answer"]["findings"].as_array().unwrap();
    let told: Vec<_> = findings.iter().map(|finding| (&finding["label"], &finding["joint"])).collect();
    assert_eq!(told, [(&"torque_gain".into(), &3.into())], "what is stamped a period late is no friction of sensors");
    let written = |name: &str| std::fs::read_to_string(at.path().join("found").join(name)).unwrap();
    let of_motors: Value = serde_json::from_str(&written("answer_00.json")).unwrap();
    assert_eq!(of_motors["verdict"], "nothing_missing", "{of_motors:#}");
    let extended = written("extended.yaml");
    assert!(extended.contains("torque_side: link") && extended.contains("torque_gain"), "{extended}");
    let unseen = &found["answer"]["validation"][0];
    let rms = |when: &str| unseen[when].as_array().map(|all| all[3].as_f64().unwrap()).unwrap();
    assert!(rms("after_nm") < 0.1 * rms("before_nm"), "{unseen:#}");
}

/// One motion cannot tell a light payload from a heavier link; the one that the answer advises does, and adds no cause that is not there. The
/// robot is a command.
#[test]
fn a_payload_is_told_from_a_heavier_link_by_a_second_motion() {
    let at = scratch();
    hide(at.path(), "{cause: payload, mass_kg: 0.06, com_m: [0.0, 0.0, 0.03]}");
    let binary = std::env::var_os("TRIBO_BIN").unwrap_or_else(|| env!("CARGO_BIN_EXE_tribo").into());
    let robot =
        format!("'{}' simulate --truth truth.yaml --trajectory {{trajectory}} --log {{log}} -q", binary.display());
    let call = ["investigate", "--robot-command", &robot, "--model", "known.yaml", "--json", "-q", "--out", "asked"];
    let found = crate::common::Run::from(tribo(at.path(), call).output().unwrap()).ok().json();
    assert_eq!((&found["motions"], &found["verdict"]), (&Value::from(2), &Value::from("named")), "{found:#}");
    let labels = |found: &Value| {
        found["answer"]["findings"].as_array().map(|all| all.iter().map(|one| one["label"].clone()).collect())
    };
    assert_eq!(labels(&found), Some(vec![Value::from("payload")]), "{found:#}");

    let failing =
        ["investigate", "--robot-command", "false {trajectory} {log}", "--robot", "panda", "--out", "failing"];
    let failing = crate::common::Run::from(tribo(at.path(), failing).output().unwrap());
    assert_eq!(failing.code, Some(2), "{failing:?}");
    assert!(failing.stderr.contains("the robot's command failed"), "{failing:?}");
}

/// `known.yaml`, and `truth.yaml` with one effect more.
fn hide(at: &Path, effect: &str) {
    let known = Path::new(env!("CARGO_MANIFEST_DIR")).join("../experiments/06_diagnosis/example/nominal.yaml");
    let known = std::fs::read_to_string(known).unwrap();
    std::fs::write(at.join("known.yaml"), &known).unwrap();
    std::fs::write(at.join("truth.yaml"), format!("{known}effects:\n- {effect}\n")).unwrap();
}

/// The window watches a robot whatever its mode is, and draws it without a display.
#[test]
fn a_robot_is_watched_in_the_window() {
    let at = scratch();
    let server = Served::paced(at.path(), "--robot fr3");
    let live = format!("dashboard --live {} --residual momentum --screenshot live.png --seconds", server.host);
    run(at.path(), &format!("{live} 2")).ok();
    run(at.path(), "dashboard --view live --screenshot empty.png").ok();
    // Arm, curves and bands take more than the bars around an empty view.
    let [live_bytes, empty_bytes] =
        ["live.png", "empty.png"].map(|name| std::fs::metadata(at.path().join(name)).unwrap().len());
    assert!(2 * live_bytes > 3 * empty_bytes, "{live_bytes} and {empty_bytes} bytes");
    let refusals = [
        (format!("{live} 0"), "--seconds is 0"),
        ("dashboard --live 127.0.0.1:9 --screenshot none.png".to_owned(), "127.0.0.1:9"),
        (format!("{live} 1 --robot ur10e"), "a Franka has seven joints"),
    ];
    for (call, why) in refusals {
        let refused = run(at.path(), &call);
        assert!(refused.code == Some(2) && refused.stderr.contains(why), "{refused:?}");
    }
    assert!(!at.path().join("none.png").exists());
}
