//! MCAP as rosbag2 and Foxglove write it: which topic is taken, joints in order, clocks, every error; and our own files.

#![allow(clippy::unwrap_used, reason = "tests")]

use std::path::Path;

use crate::common::ros2::{Cdr, JOINT_STATE, Recorded, franka_robot_state, mcap_file};
use crate::common::{bits, file, relative, synthetic_log};
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions};
use tribo_logs::{
    LogColumns, LogFormat, LogSummary, LogTarget, Quantity, RobotLog, read_log, read_log_from, row, write_log_to,
    write_mcap,
};

const START_NS: u64 = 1_700_000_000_123_456_789;
const MS: u64 = 1_000_000;

fn read(messages: &[Recorded]) -> (RobotLog, LogSummary) {
    let (_directory, path) = file("bag.mcap", mcap_file(messages, Some(Compression::Zstd)));
    read_log(path).unwrap()
}

fn error(messages: &[Recorded]) -> String {
    let (_directory, path) = file("bag.mcap", mcap_file(messages, None));
    relative(&read_log(&path).unwrap_err().to_string(), &path)
}

fn joint_state(topic: &str, k: u64, message: Cdr) -> Recorded {
    Recorded::cdr(topic, "sensor_msgs/msg/JointState", JOINT_STATE, START_NS + k * MS + 7 * (k % 2), message)
}

/// Joints in a strange order, with a finger among them; entry of joint i in row k: 10 + i + k (q), 20.. (dq), 30.. (tau).
fn mixed(k: u64) -> Cdr {
    let names = ["arm_joint2", "arm_finger_joint1", "arm_joint1"];
    let values = |first: f64| [first + 1.0 + k as f64, f64::NAN, first + k as f64];
    Cdr::new().joint_state(START_NS + k * MS, &names, &values(10.0), &values(20.0), &values(30.0))
}

#[test]
fn joint_states_come_in_the_order_of_their_names() {
    for compression in [None, Some(Compression::Zstd), Some(Compression::Lz4)] {
        let messages: Vec<Recorded> = (0..4).map(|k| joint_state("/joint_states", k, mixed(k))).collect();
        let (_directory, path) = file("bag.mcap", mcap_file(&messages, compression));
        let (log, summary) = read_log(path).unwrap();
        assert_eq!((summary.format, summary.joints, summary.rows), (LogFormat::Mcap, 2, 4));
        assert_eq!(log.time_s, [0.0, 0.001, 0.002, 0.003], "of the header, not of the recorder");
        assert_eq!(row::<2>(&log.q_rad, 0), [10.0, 11.0]);
        assert_eq!((row::<2>(&log.dq_rad_s, 3), row::<2>(&log.tau_j_nm, 1)), ([23.0, 24.0], [31.0, 32.0]));
        let source = summary.source.unwrap();
        assert_eq!(
            source,
            "topic /joint_states (sensor_msgs/msg/JointState), joints arm_joint1 to arm_joint2, time from header.stamp"
        );
    }
}

#[test]
fn the_recorders_clock_serves_where_the_header_has_none() {
    let still = |k| Cdr::new().joint_state(0, &["j1"], &[k as f64], &[0.0], &[0.0]);
    let (log, summary) = read(&(0..3).map(|k| joint_state("/js", k, still(k))).collect::<Vec<_>>());
    assert_eq!(log.time_s, [0.0, 0.001_000_007, 0.002]);
    assert!(summary.source.unwrap().ends_with("time from the recorder"));
}

/// A state in which joint i of row k has q = i + k, dq = 100 + .., tau_J = 200 + .., tau_J_d = 300 + .., theta = 400 + ..,
/// dtheta = 500 + .., wrench = 600 + ..; the robot's clock runs in milliseconds from 41 s.
fn franka(k: u64, with_head: bool) -> Cdr {
    let names: Vec<String> = (1..=7).map(|joint| format!("fr3_joint{joint}")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let values = |first: u64, count: u64| (0..count).map(|i| (first + i + k) as f64).collect::<Vec<f64>>();
    let stamp_ns = START_NS + k * MS + 300 * (k % 3);
    let state = |cdr: Cdr, first: [u64; 3]| {
        let [q, dq, tau] = first.map(|first| if first == 999 { Vec::new() } else { values(first, 7) });
        cdr.joint_state(stamp_ns, &names, &q, &dq, &tau)
    };
    let wrench = |cdr: Cdr, first: u64| cdr.header(stamp_ns).f64s(&values(first, 6));
    let cdr = Cdr::new().header(stamp_ns);
    let cdr = if with_head { cdr.u8(1).text("an odd length").f64s(&[1.0]) } else { cdr };
    let cdr = cdr.f64s(&[0.0; 3]).f64s(&[0.0; 7]);
    let cdr = state(state(state(cdr, [0, 100, 200]), [700, 710, 300]), [400, 500, 999]);
    let cdr = state(cdr.f64s(&[9.0; 14]), [999, 999, 720]).f64s(&[8.0; 2]);
    let cdr = wrench(wrench(cdr, 730), 600);
    cdr.f64s(&[41.0 + k as f64 * 1e-3, 1.0]).u8(2).u8(0).u8(1)
}

#[test]
fn franka_robot_state_is_read_by_its_definition_in_any_version() {
    for (head, with_head) in [("", false), ("bool brand_new\nstring<=20 note\nfloat64 x\n", true)] {
        let definition = franka_robot_state(head);
        let message = |k| {
            let cdr = franka(k, with_head);
            Recorded::cdr("/state", "franka_msgs/msg/FrankaRobotState", &definition, START_NS + k * MS, cdr)
        };
        let (log, summary) = read(&[message(0), message(1), message(1), message(2)]);
        assert_eq!(log.time_s, [41.0, 41.001, 41.002], "the robot's own clock; the repeated row dropped");
        assert_eq!((summary.dropped_repeats, summary.warnings.len()), (1, 0), "{summary}");
        let per_joint =
            |first: u64| (0..7).map(|i| (0..3).map(|k| (first + i + k) as f64).collect()).collect::<Vec<Vec<f64>>>();
        assert_eq!((&log.q_rad, &log.dq_rad_s), (&per_joint(0), &per_joint(100)));
        assert_eq!((&log.tau_j_nm, log.tau_j_d_nm.as_ref().unwrap()), (&per_joint(200), &per_joint(300)));
        assert_eq!(
            (log.theta_rad.as_ref().unwrap(), log.dtheta_rad_s.as_ref().unwrap()),
            (&per_joint(400), &per_joint(500))
        );
        assert_eq!(
            log.o_f_ext.as_ref().unwrap()[..],
            per_joint(600)[..6],
            "of the base frame, not of the stiffness frame"
        );
        assert!(!log.has(Quantity::Temperature));
    }
}

#[test]
fn the_topic_that_says_most_is_taken_and_the_others_are_named() {
    let definition = franka_robot_state("");
    let kind = "franka_msgs/msg/FrankaRobotState";
    let clock = "int32 sec\nuint32 nanosec\n";
    let messages: Vec<Recorded> = (0..3)
        .flat_map(|k| {
            let at = START_NS + k * MS;
            [
                joint_state("/joint_states", k, mixed(k)),
                Recorded::cdr("/clock", "builtin_interfaces/msg/Time", clock, at, Cdr::new().u32(1).u32(2)),
                Recorded::cdr("/state", kind, &definition, at, franka(k, false)),
            ]
        })
        .collect();
    let (log, summary) = read(&messages);
    assert_eq!(log.joints(), 7);
    let source = summary.source.unwrap();
    assert!(
        source.starts_with("topic /state (franka_msgs/msg/FrankaRobotState), joints fr3_joint1 to fr3_joint7"),
        "{source}"
    );
    assert!(source.ends_with("could also be read: /joint_states (sensor_msgs/msg/JointState)"), "{source}");

    // Nothing to read: the reason for every topic.
    let lame = Cdr::new().joint_state(START_NS, &["j1"], &[1.0], &[], &[]);
    let text = error(&[
        joint_state("/js", 0, lame),
        Recorded::cdr("/clock", "builtin_interfaces/msg/Time", clock, 0, Cdr::new().u32(1).u32(2)),
    ]);
    assert_eq!(
        text,
        "bag.mcap: no topic with joint positions, velocities and torques; /js (sensor_msgs/msg/JointState): dq_i: 0 entries, \
         expected 1; /clock (builtin_interfaces/msg/Time): has no field for q_i"
    );
    assert!(error(&[]).ends_with("; it has no messages"));
}

#[test]
fn grippers_on_the_same_topic_and_effort_that_is_no_number() {
    let finger =
        |k| joint_state("/js", k, Cdr::new().joint_state(START_NS, &["finger_joint1"], &[0.1], &[0.1], &[0.1]));
    let (log, summary) =
        read(&[finger(0), joint_state("/js", 1, mixed(1)), finger(1), joint_state("/js", 2, mixed(2))]);
    assert_eq!((log.rows(), summary.dropped_incomplete, summary.rows_read()), (2, 2, 4));
    // NaN from the second message on.
    let bad = Cdr::new().joint_state(
        START_NS + 3 * MS,
        &["arm_joint2", "arm_joint1"],
        &[1.0, 2.0],
        &[1.0, 2.0],
        &[f64::NAN, 2.0],
    );
    let text = error(&[joint_state("/js", 1, mixed(1)), joint_state("/js", 3, bad)]);
    assert_eq!(text, "bag.mcap: topic /js, message 1: tau_J_1: NaN is not finite");
    // Too short a message.
    let cut = Cdr::new().header(START_NS).u32(1_000_000);
    let text = error(&[joint_state("/js", 1, mixed(1)), joint_state("/js", 2, cut)]);
    assert_eq!(text, "bag.mcap: topic /js, message 1: name: 1000000 elements in 0 bytes");
    // A clock that goes back, and nothing else to go by.
    let text =
        error(&[joint_state("/js", 5, mixed(5)), joint_state("/js", 1, mixed(1)), joint_state("/js", 9, mixed(9))]);
    assert_eq!(text, "bag.mcap: column time, row 1: -0.004 s does not exceed the stamp before, 0 s");
}

#[test]
fn json_is_read_by_arrays_by_columns_and_by_the_names_of_joint_state() {
    let forms = [
        r#"{"time":T,"q":[1,2],"dq":[3,4],"tau_J":[5,6],"theta":[7,8],"O_F_ext":[1,2,3,4,5,6],"note":"x"}"#,
        r#"{"time":T,"q_0":1,"q_1":2,"dq_0":3,"dq_1":4,"tau_J_0":5,"tau_J_1":6,"theta_0":7,"theta_1":8,"O_F_ext_0":1,"O_F_ext_1":2,"O_F_ext_2":3,"O_F_ext_3":4,"O_F_ext_4":5,"O_F_ext_5":6}"#,
        r#"{"time":T,"name":["b2","b1"],"position":[2,1],"velocity":[4,3],"effort":[6,5],"theta":[8,7],"O_F_ext":[1,2,3,4,5,6]}"#,
    ];
    let logs = forms.map(|form| {
        let messages: Vec<Recorded> = (0..3)
            .map(|k| Recorded::json("/log", k, &form.replace('T', &format!("{}", f64::from(k as u32) * 1e-3))))
            .collect();
        bits(&read(&messages).0)
    });
    assert_eq!(logs[0], logs[1]);
    assert_eq!(logs[0], logs[2]);
    assert_eq!(logs[0].len(), 1 + 4 * 2 + 6);
    let text = error(&[Recorded::json("/log", 1, forms[0]), Recorded::json("/log", 2, "{")]);
    assert!(text.starts_with("bag.mcap: no topic") && text.contains("/log (my.Log): is no JSON: "), "{text}");
    let text = error(&[
        Recorded::json("/log", 1, &forms[0].replace('T', "0")),
        Recorded::json("/log", 2, r#"{"q":[1,2],"dq":[1]}"#),
    ]);
    assert_eq!(text, "bag.mcap: topic /log, message 1: dq_i: 1 entries, expected 2");
}

#[test]
fn what_is_written_reads_back_to_the_same_bits_under_a_clock_that_increases() {
    let directory = tempfile::tempdir().unwrap();
    for (joints, full) in [(1, false), (7, true)] {
        let path = directory.path().join("log.mcap");
        // Two stamps within one nanosecond, and a start before zero.
        let mut columns = synthetic_log(joints, 300, full).into_columns();
        columns.time_s[0] = -0.5;
        columns.time_s[2] = columns.time_s[1] + 1e-12;
        let log = columns.validate().unwrap();
        write_mcap(&path, &log).unwrap();
        let (read, summary) = read_log(&path).unwrap();
        assert_eq!(bits(&read), bits(&log));
        assert!(summary.source.unwrap().starts_with("topic /robot (tribo.Log)"));
        let bytes = std::fs::read(&path).unwrap();
        write_mcap(&path, &log).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), bytes, "the same log gives the same bytes");
        let stamps: Vec<u64> =
            mcap::MessageStream::new(&bytes).unwrap().map(|message| message.unwrap().log_time).collect();
        assert!(stamps.windows(2).all(|pair| pair[0] < pair[1]) && stamps[0] == 0, "{:?}", &stamps[..4]);
        // Every message obeys the schema's names.
        let first = mcap::MessageStream::new(&bytes).unwrap().next().unwrap().unwrap();
        let schema: serde_json::Value = serde_json::from_slice(&first.channel.schema.as_ref().unwrap().data).unwrap();
        let message: serde_json::Value = serde_json::from_slice(&first.data).unwrap();
        let keys = |value: &serde_json::Value| value.as_object().unwrap().keys().cloned().collect::<Vec<String>>();
        assert_eq!(keys(&schema["properties"]), keys(&message));
    }
}

#[test]
fn a_bag_is_a_directory_with_one_file() {
    let directory = tempfile::tempdir().unwrap();
    let bag = directory.path().join("bag");
    std::fs::create_dir(&bag).unwrap();
    std::fs::write(bag.join("metadata.yaml"), "rosbag2_bagfile_information:\n").unwrap();
    let text = read_log(&bag).unwrap_err().to_string();
    assert!(text.contains("without .mcap"), "{text}");
    let log = synthetic_log(2, 5, false);
    write_mcap(bag.join("bag_0.mcap"), &log).unwrap();
    assert_eq!(bits(&read_log(&bag).unwrap().0), bits(&log));
    write_mcap(bag.join("bag_1.mcap"), &log).unwrap();
    assert!(read_log(&bag).unwrap_err().to_string().contains("a directory with 2 MCAP files; name one of them"));
}

#[test]
fn cut_files_say_so() {
    let whole =
        mcap_file(&(0..50).map(|k| joint_state("/js", k, mixed(k))).collect::<Vec<_>>(), Some(Compression::Zstd));
    for length in (8..whole.len()).step_by(5) {
        let (_directory, path) = file("bag.mcap", &whole[..length]);
        let text = relative(&read_log(&path).unwrap_err().to_string(), &path);
        assert!(text.starts_with("bag.mcap: damaged or cut off: "), "{length}: {text}");
    }
}

/// A chunk of equal messages packs to nearly nothing, and a file may have many: each is small enough for itself.
#[test]
fn a_small_file_cannot_ask_for_large_memory() {
    let options = WriteOptions::new().emit_message_indexes(false).disable_seeking(true).compression_threads(0);
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut writer = options.compression(Some(Compression::Zstd)).create(&mut bytes).unwrap();
    let channel_id = writer.add_channel(0, "/j", "json", &Default::default()).unwrap();
    let header = MessageHeader { channel_id, sequence: 0, log_time: 0, publish_time: 0 };
    for _ in 0..400_000 {
        writer.write_to_known_channel(&header, br#"{"time":0,"q":[1],"dq":[2],"tau_J":[3]}"#).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    let bytes = bytes.into_inner();
    assert!(bytes.len() < 20_000, "{} bytes", bytes.len());
    let text = read_log_from(bytes, Path::new("bomb.mcap")).unwrap_err().to_string();
    assert!(text.contains("bomb.mcap: damaged or cut off: unpacks to more than"), "{text}");
}

/// The log that packs best for its rows: an arm that stands still, without noise.
#[test]
fn a_still_arm_is_no_bomb() {
    let still = || vec![vec![-0.25; 60_000]; 7];
    let time_s = (0..60_000).map(|k| f64::from(k) / 1024.0).collect();
    let all = Some(still());
    let log = LogColumns {
        time_s,
        q_rad: still(),
        dq_rad_s: still(),
        tau_j_nm: still(),
        tau_j_d_nm: all.clone(),
        tau_friction_nm: all.clone(),
        tau_link_nm: all.clone(),
        theta_rad: all.clone(),
        dtheta_rad_s: all.clone(),
        temperature_c: all,
        ..LogColumns::default()
    };
    let log = log.validate().unwrap();
    for target in [LogTarget::Mcap, LogTarget::Parquet, LogTarget::Csv(Default::default())] {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let name = Path::new("still.csv.gz");
        write_log_to(&mut bytes, name, &log, target).unwrap();
        let bytes = bytes.into_inner();
        assert_eq!(read_log_from(bytes, name).unwrap().0, log);
    }
}
