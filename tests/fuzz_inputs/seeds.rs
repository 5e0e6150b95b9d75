//! The seeds that Tribo's own writers make. The others are written by hand, in the same folders.
//!
//! `TRIBO_RECORD_SEEDS=1 cargo test --release -p tribo-tests --test fuzz_inputs seeds` writes them anew, after a format has changed.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use mcap::Compression;
use nalgebra::SVector;
use tribo_campaign::{AnyTune, RecognisedTrial, TuneConfig, UserTrials, recognise_trial};
use tribo_logs::recognise::Fault;
use tribo_logs::{JointState, LogColumns, LogTarget, RobotLog, read_log_from, write_log_to};
use tribo_model::{TunedFile, to_yaml};
use tribo_robot::urdf::to_urdf;
use tribo_robot::{Arm, gravity_torque, presets, rnea};
use tribo_tests::fuzz_inputs::recorder::{Cdr, JOINT_STATE, Recorded, franka_robot_state, mcap_file};

/// Folder, name and content of each.
fn seeds() -> Vec<(&'static str, &'static str, Vec<u8>)> {
    let mut seeds = vec![
        ("urdf", "panda.urdf", to_urdf(&presets::panda()).into_bytes()),
        ("urdf", "ur10e.urdf", to_urdf(&presets::ur10e()).into_bytes()),
        ("tune_yaml", "campaign.yaml", campaign(TuneConfig::default())),
        (
            "tune_yaml",
            "user_campaign.yaml",
            campaign(TuneConfig { user_trials: Some(UserTrials::default()), ..TuneConfig::default() }),
        ),
        ("tuned_yaml", "tuned.yaml", tuned()),
    ];
    for (folder, name, target) in [
        ("csv_log", "full.csv", LogTarget::Csv(Default::default())),
        ("csv_log", "full.csv.gz", LogTarget::Csv(Default::default())),
        ("parquet_log", "full.parquet", LogTarget::Parquet),
        ("mcap_log", "full.mcap", LogTarget::Mcap),
    ] {
        let mut file = Cursor::new(Vec::new());
        write_log_to(&mut file, Path::new(name), &log(), target).expect("a log can be written");
        seeds.push((folder, name, file.into_inner()));
    }
    for (name, options, log) in [
        ("commanded", 0_u8, trial()),
        ("failed_without_gravity", 5, trial()),
        ("measured_momentum", 10, trial()),
        ("two_seconds", 0, sines(1.0)),
        ("joint_1_turned", 0, sines(-1.0)),
    ] {
        let mut file = Cursor::new(Vec::new());
        write_log_to(&mut file, Path::new(name), &log, LogTarget::Csv(Default::default()))
            .expect("a log can be written");
        seeds.push(("told_trial", name, [&[options][..], &file.into_inner()].concat()));
    }
    let messages: Vec<Recorded> = (0..3).flat_map(|k| [joint_state(k), json(k)]).collect();
    for (name, packed) in
        [("plain.mcap", None), ("zstd.mcap", Some(Compression::Zstd)), ("lz4.mcap", Some(Compression::Lz4))]
    {
        seeds.push(("mcap_log", name, mcap_file(&messages, packed)));
    }
    let franka: Vec<Recorded> = (0..3).map(franka_state).collect();
    let joints: Vec<Recorded> = (0..3).map(joint_state).collect();
    let flat: Vec<Recorded> = (0..3).map(json).collect();
    for (name, messages) in [("franka_robot_state", franka), ("joint_state", joints), ("json", flat)] {
        seeds.push(("mcap_message", name, apart(&messages)));
    }
    let arm = presets::panda();
    let messages: Vec<Vec<u8>> = (0..8).map(|k| panda_joint_state(&arm, k * 120)).collect();
    seeds.push(("joint_state", "panda", messages.join(&b"\n--\n"[..])));
    seeds
}

/// A standing Panda with a finger at k ms, velocities in every other message.
fn panda_joint_state(arm: &Arm<7>, k: u64) -> Vec<u8> {
    let q = presets::panda_ready_pose();
    let with_finger = |first: f64, values: &[f64]| -> Vec<f64> { [&[first], values].concat() };
    let names = std::iter::once("panda_finger_joint1".to_owned()).chain((1..=7).map(|j| format!("panda_joint{j}")));
    let state = JointState {
        stamp_ns: 1_700_000_000_000_000_000 + k * 1_000_000,
        names: names.collect(),
        position: with_finger(0.02, q.as_slice()),
        velocity: if k.is_multiple_of(240) { vec![0.0; 8] } else { Vec::new() },
        effort: with_finger(0.0, gravity_torque(arm, &q).as_slice()),
    };
    state.to_cdr()
}

/// Two joints, three rows, everything that a log can hold.
fn log() -> RobotLog {
    let columns = |start: f64| -> Vec<Vec<f64>> {
        (0..2).map(|j| (0..3).map(|k| start + f64::from(j) + f64::from(k) / 8.0).collect()).collect()
    };
    let log = LogColumns {
        time_s: vec![0.0, 1e-3, 2e-3],
        q_rad: columns(0.0),
        dq_rad_s: columns(10.0),
        tau_j_nm: columns(-0.1),
        tau_j_d_nm: Some(columns(30.0)),
        tau_friction_nm: Some(columns(35.0)),
        tau_link_nm: Some(columns(40.0)),
        theta_rad: Some(columns(50.0)),
        dtheta_rad_s: Some(columns(60.0)),
        temperature_c: Some(columns(25.0)),
        temperature_ambient_c: Some(vec![20.0, 20.5, 1e-300]),
        o_f_ext: Some(std::array::from_fn(|k| vec![k as f64, 0.5, -0.0])),
    };
    log.validate().expect("a valid log")
}

/// A Panda of two encoders that moves for 30 ms.
fn trial() -> RobotLog {
    let rows = 31;
    let pose = [0.0, -0.7, 0.0, -2.3, 0.0, 1.5, 0.7];
    let column = |value: &dyn Fn(f64) -> f64| -> Vec<f64> { (0..rows).map(|k| value(f64::from(k) * 1e-3)).collect() };
    let each = |value: &dyn Fn(usize, f64) -> f64| -> Vec<Vec<f64>> {
        (0..7).map(|j| column(&|t| (value(j, t) * 1e6).round() / 1e6)).collect()
    };
    let log = LogColumns {
        time_s: column(&|t| t),
        q_rad: each(&|j, t| pose[j] + 0.1 * t),
        dq_rad_s: each(&|_, _| 0.1),
        tau_j_nm: each(&|j, t| 5.0 - j as f64 + t),
        tau_j_d_nm: Some(each(&|j, _| 5.0 - j as f64)),
        tau_friction_nm: Some(each(&|_, _| 0.5)),
        theta_rad: Some(each(&|j, t| pose[j] + 0.1 * t + 1e-4)),
        ..LogColumns::default()
    };
    log.validate().expect("a valid log")
}

/// Two and a half seconds of a Panda with dry friction of 0.5 Nm, long enough for the judgement of the arm; the commanded torque of joint 1 has this
/// sign.
fn sines(sign: f64) -> RobotLog {
    let (arm, rate_hz, rows) = (presets::panda(), 50.0, 126);
    let round = |x: f64| (x * 1e4).round() / 1e4;
    let mut log = LogColumns::default();
    for column in [&mut log.q_rad, &mut log.dq_rad_s, &mut log.tau_j_nm] {
        column.resize(7, Vec::new());
    }
    let mut commanded = vec![Vec::new(); 7];
    for k in 0..rows {
        let t = f64::from(k) / rate_hz;
        let phase = |j: usize| (3.0 + 0.6 * j as f64, 0.8 * j as f64);
        let of = |value: &dyn Fn(f64, f64) -> f64| {
            SVector::<f64, 7>::from_fn(|j, _| value(phase(j).0, phase(j).0 * t + phase(j).1))
        };
        let q = presets::panda_ready_pose() + of(&|_, at| 0.25 * at.sin());
        let qd = of(&|w, at| 0.25 * w * at.cos());
        let qdd = of(&|w, at| -0.25 * w * w * at.sin());
        let tau = rnea(&arm, &q, &qd, &qdd) + qd.map(|qd| 0.5 * (qd / 0.01).tanh());
        log.time_s.push(t);
        for j in 0..7 {
            log.q_rad[j].push(round(q[j]));
            log.dq_rad_s[j].push(round(qd[j]));
            log.tau_j_nm[j].push(round(tau[j]));
            commanded[j].push(round(if j == 1 { sign * tau[j] } else { tau[j] }));
        }
    }
    log.tau_j_d_nm = Some(commanded);
    log.tau_friction_nm = Some(vec![vec![0.0; log.rows()]; 7]);
    log.validate().expect("a valid log")
}

fn joint_state(k: u64) -> Recorded {
    let cdr = Cdr::new().joint_state(k * 1_000_000, &["j2", "j1"], &[k as f64, 2.0], &[3.0, 4.0], &[5.0, 6.0]);
    Recorded::cdr("/js", "sensor_msgs/msg/JointState", JOINT_STATE, k, cdr)
}

fn json(k: u64) -> Recorded {
    Recorded::json("/j", k, &format!(r#"{{"time":{k},"q":[1],"dq":[2],"tau_J":[3],"O_F_ext":[0,0,1,0,0,{k}.5]}}"#))
}

/// Fields in the order of the definition.
fn franka_state(k: u64) -> Recorded {
    let arm =
        |cdr: Cdr, value: f64| cdr.joint_state(k * 1_000_000, &["j1", "j2"], &[value; 2], &[value; 2], &[value; 2]);
    let cdr = Cdr::new().header(k * 1_000_000).f64s(&[0.0; 10]);
    let cdr = arm(arm(arm(cdr, k as f64), 2.0), 3.0).f64s(&[0.0; 14]);
    let cdr = arm(cdr, 4.0).f64s(&[0.0; 2]);
    let cdr = cdr.header(k * 1_000_000).f64s(&[0.5; 6]).header(k * 1_000_000).f64s(&[1.5; 6]);
    let cdr = cdr.f64s(&[k as f64 * 1e-3, 1.0]).u8(2).u8(0).u8(0);
    Recorded::cdr("/franka", "franka_msgs/msg/FrankaRobotState", &franka_robot_state(""), k, cdr)
}

/// As `mcap_message` takes them apart.
fn apart(messages: &[Recorded]) -> Vec<u8> {
    let first = &messages[0];
    let definition = if first.json { "" } else { &first.definition };
    let head = [first.kind.as_bytes(), definition.as_bytes()];
    let parts: Vec<&[u8]> = head.into_iter().chain(messages.iter().map(|message| &message.bytes[..])).collect();
    parts.join(&b"\n--\n"[..])
}

fn campaign(config: TuneConfig) -> Vec<u8> {
    let tune = config.validate_any().expect("valid settings");
    // The version would change the seed with every release.
    let config = TuneConfig { tribo_version: String::new(), ..tune.config().clone() };
    to_yaml(&config).expect("settings can be written").into_bytes()
}

fn tuned() -> Vec<u8> {
    let tune = TuneConfig::default().validate_any().expect("valid settings");
    let AnyTune::Seven(tune) = tune else { unreachable!("a Panda has seven joints") };
    let file = tribo_campaign::trial_compensator(&tune, 2, &vec![0.25; tune.space.zero().len()]);
    let file = TunedFile { tribo_version: String::new(), cost: Some(2.5), uncompensated_cost: Some(24.0), ..file };
    to_yaml(&file).expect("tuned parameters can be written").into_bytes()
}

/// Seeds of logs are logs: what starts from damage does not get far.
#[test]
fn seeds_are_good() {
    for (folder, name, content) in seeds() {
        let path = super::folder("seeds", folder).join(name);
        if std::env::var_os("TRIBO_RECORD_SEEDS").is_some() {
            fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            fs::write(&path, &content).expect("a seed can be written");
        }
        assert!(path.is_file(), "{} is not recorded; see the head of this file", path.display());
        if folder.ends_with("_log") {
            read_log_from(content, &path).unwrap_or_else(|error| panic!("{error}"));
        }
    }
}

/// What starts from a log too short to be judged never comes to the judgement of velocities and of the arm.
#[test]
fn seeds_of_trials_reach_the_judgement() {
    let tune = TuneConfig { user_trials: Some(UserTrials::default()), ..TuneConfig::default() };
    let tune = tune.validate::<7>().expect("valid settings");
    let user_trials = UserTrials { judged_from_s: 0.005, judged_s: 0.02, ..UserTrials::default() };
    let faults = |log: &RobotLog| -> Vec<Fault> {
        let RecognisedTrial { remarks, .. } = recognise_trial(&tune, &user_trials, log, false);
        remarks.into_iter().flatten().map(|remark| remark.fault).collect()
    };
    assert_eq!(faults(&sines(1.0)), []);
    assert_eq!(faults(&sines(-1.0)), [Fault::TorqueSign]);
    let mut backwards = sines(1.0).into_columns();
    backwards.dq_rad_s.iter_mut().flatten().for_each(|dq| *dq = -*dq);
    assert_eq!(faults(&backwards.validate().expect("a valid log")), [Fault::VelocitySign]);
}
