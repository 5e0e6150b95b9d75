//! Twenty thousand random damages to a small file of each format (300 000 with those of `bad_parquet.rs`): never a panic, and an error names the file.

#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use std::fs;

use common::ros2::{Cdr, JOINT_STATE, Recorded, franka_robot_state, mcap_file};
use common::{XorShift, bits, kinova_csv, libfranka_csv, mutated, scratch, synthetic_log};
use mcap::Compression;
use tribo_logs::{read_csv_from, read_log, write_csv, write_parquet};

const MUTATIONS: usize = 20_000;

#[test]
fn damaged_csv_is_an_error_or_a_valid_log() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("small.csv");
    write_csv(&path, &synthetic_log(2, 6, true)).unwrap();
    let whole = fs::read(&path).unwrap();
    let mut random = XorShift(0x5eed_0001);
    let mut refused = 0;
    for _ in 0..MUTATIONS {
        match read_csv_from(&mutated(&whole, &mut random)[..], &path) {
            Ok((log, _)) => assert!(log.into_columns().validate().is_ok()),
            Err(error) => {
                refused += 1;
                assert!(error.to_string().contains("small.csv"), "{error}");
            }
        }
    }
    assert!(
        (MUTATIONS / 10..MUTATIONS).contains(&refused),
        "{refused} refused: the mutations bite and some are harmless"
    );
}

#[test]
fn damaged_files_of_every_format_are_an_error_or_a_valid_log() {
    let directory = scratch();
    let log = synthetic_log(2, 6, false);
    for (name, seed) in [("small.csv.gz", 0x5eed_0002), ("small.parquet", 0x5eed_0004)] {
        let path = directory.path().join(name);
        let parquet = name.ends_with("parquet");
        if parquet {
            write_parquet(&path, &log).unwrap()
        } else {
            write_csv(&path, &log).unwrap()
        }
        let whole = fs::read(&path).unwrap();
        let mut random = XorShift(seed);
        for _ in 0..MUTATIONS {
            let torn = mutated(&whole, &mut random);
            fs::write(&path, &torn).unwrap();
            match read_log(&path) {
                Ok((read, _)) if parquet => assert!(torn == whole && bits(&read) == bits(&log), "damage went unseen"),
                Ok((read, _)) => assert!(read.into_columns().validate().is_ok()),
                Err(error) => assert!(error.to_string().contains(name), "{error}"),
            }
        }
    }
}

#[test]
fn damaged_files_of_other_programs_are_an_error_or_a_valid_log() {
    let directory = scratch();
    let path = directory.path().join("small.csv");
    let texts = [kinova_csv(4), libfranka_csv("current", 3), libfranka_csv("spaced", 3), libfranka_csv("legacy", 3)];
    for (whole, seed) in texts.into_iter().zip(0x5eed_0005..) {
        let mut random = XorShift(seed);
        for _ in 0..MUTATIONS {
            fs::write(&path, mutated(whole.as_bytes(), &mut random)).unwrap();
            match read_log(&path) {
                Ok((read, _)) => assert!(read.into_columns().validate().is_ok()),
                Err(error) => assert!(error.to_string().contains("small.csv"), "{error}"),
            }
        }
    }
}

#[test]
fn a_damaged_directory_of_text_files_is_an_error_or_a_valid_log() {
    let directory = scratch();
    let at = |name: &str| directory.path().join(format!("exciting_traj_{name}.txt"));
    let column = |rows: usize| (0..rows).map(|k| format!("{}\n", k as f64 * 1e-3)).collect::<String>();
    let whole = [("time", column(4)), ("positions", column(28)), ("velocity", column(28)), ("torques", column(28))];
    let write = |(name, text): &(&str, String)| fs::write(at(name), text).unwrap();
    whole.iter().for_each(write);
    let mut random = XorShift(0x5eed_000a);
    for _ in 0..MUTATIONS {
        let damaged = &whole[random.below(4)];
        fs::write(at(damaged.0), mutated(damaged.1.as_bytes(), &mut random)).unwrap();
        match read_log(directory.path()) {
            Ok((read, _)) => assert!(read.into_columns().validate().is_ok()),
            Err(error) => assert!(error.to_string().contains(directory.path().to_str().unwrap()), "{error}"),
        }
        write(damaged);
    }
}

/// Packed chunks meet damage with a checksum, plain ones (no compression) pass it on to definitions and messages.
#[test]
fn damaged_mcap_is_an_error_or_a_valid_log() {
    let directory = scratch();
    let path = directory.path().join("small.mcap");
    let state = |k: u64| {
        let cdr = Cdr::new().joint_state(k * 1_000_000, &["j2", "j1"], &[k as f64, 2.0], &[3.0, 4.0], &[5.0, 6.0]);
        Recorded::cdr("/js", "sensor_msgs/msg/JointState", JOINT_STATE, k, cdr)
    };
    let json = |k: u64| Recorded::json("/j", k, &format!(r#"{{"time":{k},"q":[1],"dq":[2],"tau_J":[3]}}"#));
    let messages: Vec<Recorded> = (0..3).flat_map(|k| [state(k), json(k)]).collect();
    for (compression, seed) in
        [(None, 0x5eed_000b), (Some(Compression::Zstd), 0x5eed_000c), (Some(Compression::Lz4), 0x5eed_000d)]
    {
        let whole = mcap_file(&messages, compression);
        let mut random = XorShift(seed);
        for _ in 0..MUTATIONS {
            fs::write(&path, mutated(&whole, &mut random)).unwrap();
            match read_log(&path) {
                Ok((read, _)) => assert!(read.into_columns().validate().is_ok()),
                Err(error) => assert!(error.to_string().contains("small.mcap"), "{error}"),
            }
        }
    }
}

/// Damage inside messages and definitions, in files that are whole otherwise: checksums do not help here.
#[test]
fn damaged_messages_are_an_error_or_a_valid_log() {
    let directory = scratch();
    let path = directory.path().join("small.mcap");
    let definition = franka_robot_state("");
    let mut random = XorShift(0x5eed_000e);
    let state =
        |k: u64| Cdr::new().joint_state(k * 1_000_000, &["j2", "j1"], &[k as f64, 2.0], &[3.0, 4.0], &[5.0, 6.0]);
    for turn in 0..MUTATIONS {
        let (kind, text) =
            if turn % 2 == 0 { ("p/msg/JointState", JOINT_STATE) } else { ("p/msg/FrankaRobotState", &definition[..]) };
        let text = String::from_utf8_lossy(&mutated(text.as_bytes(), &mut random)).into_owned();
        let messages: Vec<Recorded> = (0..3)
            .map(|k| {
                let mut recorded = Recorded::cdr("/js", kind, &text, k, state(k));
                recorded.bytes = if k == 0 { recorded.bytes } else { mutated(&recorded.bytes, &mut random) };
                recorded
            })
            .collect();
        fs::write(&path, mcap_file(&messages, None)).unwrap();
        match read_log(&path) {
            Ok((read, _)) => assert!(read.into_columns().validate().is_ok()),
            Err(error) => assert!(error.to_string().contains("small.mcap"), "{error}"),
        }
    }
}
