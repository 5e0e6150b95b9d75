//! The gate of the fuzz targets, without a fuzzer: every seed, everything that was found, and small damages to both.
//!
//! `fuzz/seeds/TARGET/` are good files, `fuzz/regressions/TARGET/` files that once did harm (`fuzz/README.md` tells how). The
//! damages are the same in every run.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use tribo_tests::fuzz_inputs::{TARGETS, Target};

mod bombs;
mod damage;
mod seeds;

use damage::{XorShift, mutated};

/// Damages per file: of a log, which comes from anywhere, more than of what Tribo itself writes.
const DAMAGES_TO_LOGS: usize = 20_000;
const DAMAGES: usize = 2_000;
/// A reader that takes longer for a file of some kilobytes has lost its way; libFuzzer's limit, for a computer that is busy.
const LONGEST: Duration = Duration::from_secs(10);

/// A folder of `fuzz/`.
fn folder(kind: &str, target: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz").join(kind).join(target)
}

/// The files of a folder by name; none where there is no folder.
fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut paths: Vec<PathBuf> = fs::read_dir(folder)
        .into_iter()
        .flatten()
        .map(|entry| entry.expect("a readable folder").path())
        .filter(|path| path.is_file())
        .collect();
    paths.sort();
    paths.into_iter().map(|path| (path.clone(), fs::read(path).expect("a readable file"))).collect()
}

/// One input, in good time.
fn take((name, check): Target, what: &str, input: &[u8]) {
    let started = Instant::now();
    check(input);
    let took = started.elapsed();
    assert!(took < LONGEST, "{name}: {what} took {took:?}");
}

fn replay(target: Target) {
    let seeds = files(&folder("seeds", target.0));
    assert!(!seeds.is_empty(), "{} has no seeds", target.0);
    let mut random = XorShift(0x5eed_0000 + target.0.len() as u64);
    for (path, input) in seeds.iter().chain(&files(&folder("regressions", target.0))) {
        take(target, &path.display().to_string(), input);
        let damages = if target.0.ends_with("_log") { DAMAGES_TO_LOGS } else { DAMAGES };
        for number in 0..damages {
            take(target, &format!("damage {number} to {}", path.display()), &mutated(input, &mut random));
        }
    }
}

macro_rules! targets {
    ($($name:ident)+) => {
        $(#[test]
        fn $name() {
            let named = |target: &&Target| target.0 == stringify!($name);
            replay(*TARGETS.iter().find(named).expect("a target of this name"));
        })+

        /// Every target has a test above, a program in `fuzz/` and no folder is left over.
        #[test]
        fn nothing_is_forgotten() {
            let mut names: Vec<&str> = TARGETS.iter().map(|target| target.0).collect();
            names.sort_unstable();
            assert_eq!(names, [$(stringify!($name)),+]);
            let program = |name: &&str| folder("fuzz_targets", &format!("{name}.rs")).is_file();
            assert!(names.iter().all(program), "{names:?}");
            for kind in ["seeds", "regressions"] {
                for entry in fs::read_dir(folder(kind, "")).expect("a folder") {
                    let name = entry.expect("an entry").file_name();
                    assert!(names.iter().any(|known| name == *known), "{kind}: {name:?} is no target");
                }
            }
        }
    };
}

targets! {
    arguments bag_log campaign_journal column_map csv_log early_stop_yaml expected_json experiment_yaml foreign_log joint_state journal
    kinova_gen3_log libfranka_log
    mcap_log mcap_message mjcf model_yaml panda_gaz_log parquet_log references_yaml study_cell_json study_yaml told_trial
    trajectory_yaml tune_yaml tuned_yaml urdf
}
