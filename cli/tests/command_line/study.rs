//! Story: a study of some seventy cells on machines that die.
//!
//! Four slices run side by side and are killed with SIGKILL at seeded random moments until nothing is left to do; the directory
//! then equals, byte for byte, that of one process that ran in peace. Job arrays find their slice by themselves.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use crate::common::{run, scratch, start, tribo};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// 4 seeds × 3 poses × (references and 5 strategies) = 72 cells.
const STUDY: &str = "schema: tribo.study/1
seeds: 4
poses: [0, 1, 2]
cases:
- {truth: coulomb_viscous, friction: coulomb_viscous}
strategies:
- {strategy: grey_box, trials: 2}
- {strategy: zero, trials: 1}
- {strategy: random, trials: 1}
- {strategy: paper, trials: 1}
- {strategy: bo, trials: 1}
oracle_runs: 1
settings: {sub_steps: 1}
";

/// Every file below a directory, with its bytes.
fn files(directory: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if path.is_dir() {
            found.extend(files(&path).into_iter().map(|(below, bytes)| (format!("{name}/{below}"), bytes)));
        } else {
            found.insert(name, std::fs::read(path).unwrap());
        }
    }
    found
}

#[test]
fn slices_that_are_killed_end_like_one_process_in_peace() {
    let at = scratch();
    std::fs::write(at.path().join("study.yaml"), STUDY).unwrap();
    let started = Instant::now();
    let peace = run(at.path(), "study study.yaml --out peace --json -q").ok().json();
    let duration = started.elapsed();
    let whole = files(&at.path().join("peace"));
    assert_eq!(whole.keys().filter(|name| name.starts_with("cells/")).count(), 72);
    assert_eq!(peace["rows"].as_array().unwrap().len(), 5);
    let over_first = |row: usize| peace["rows"][row]["over_first"].as_f64().unwrap();
    assert!(over_first(1) > 4.0 && over_first(2) > 2.0, "grey box is the best of them: {peace}");
    assert!(peace["rows"][1]["p"].as_f64().unwrap() < 5e-3, "12 pairs, all one way: {peace}");

    let mut moments = Pcg64::seed_from_u64(5);
    let mut kills = 0;
    loop {
        let mut slices: Vec<_> = (1..=4)
            .map(|k| start(at.path(), &format!("study study.yaml --out pieces --shard {k}/4 --threads 1 -q")))
            .collect();
        // An eighth to three eighths of the time that everything takes, so that a slow machine gets on too.
        let part = 0.125 + 0.25 * (moments.next_u64() % 1000) as f64 / 1000.0;
        std::thread::sleep(duration.mul_f64(part));
        let mut all_ended = true;
        for slice in &mut slices {
            if slice.try_wait().unwrap().is_none() {
                all_ended = false;
                slice.kill().unwrap();
                kills += 1;
            }
            let status = slice.wait().unwrap();
            assert!(status.code().is_none_or(|code| code == 0), "{status}");
        }
        if all_ended {
            break;
        }
        assert!(kills < 100, "it never ends");
    }
    assert!(kills > 4, "nothing was killed");
    let pieces: BTreeMap<String, Vec<u8>> =
        files(&at.path().join("pieces")).into_iter().filter(|(name, _)| !name.ends_with(".tmp")).collect();
    assert_eq!(pieces.keys().collect::<Vec<_>>(), whole.keys().collect::<Vec<_>>());
    for (name, bytes) in &whole {
        assert!(pieces[name] == *bytes, "{name} differs");
    }
}

#[test]
fn job_arrays_take_their_slices_and_the_last_one_tells() {
    let at = scratch();
    let small = STUDY.replace("seeds: 4", "seeds: 1").replace("poses: [0, 1, 2]", "poses: [0]");
    std::fs::write(at.path().join("small.yaml"), small).unwrap();
    let mut counts = Vec::new();
    for task in [7, 4, 5, 6] {
        let mut command = tribo(at.path(), ["study", "small.yaml", "--json", "-q"]);
        command.env("SLURM_ARRAY_TASK_ID", task.to_string());
        command.env("SLURM_ARRAY_TASK_MIN", "4").env("SLURM_ARRAY_TASK_STEP", "1").env("SLURM_ARRAY_TASK_COUNT", "4");
        let told = crate::common::Run::from(command.output().unwrap()).ok().json();
        counts.push(told["cells_left"].as_u64());
    }
    assert_eq!(counts, [Some(5), Some(3), Some(1), None], "the last slice finds everything there");
    let by_slices = files(&at.path().join("small"));
    assert!(by_slices.contains_key("results.json") && by_slices.contains_key("report.html"));
    run(at.path(), "study small.yaml --out at_once -q").ok();
    assert_eq!(by_slices, files(&at.path().join("at_once")));

    // What is there is not computed again, and what is not this study's is refused.
    let cell = at.path().join("small/cells/case0_ekf_pose0_seed0001_zero_1.json");
    let before = std::fs::metadata(&cell).unwrap().modified().unwrap();
    run(at.path(), "study small.yaml -q").ok();
    assert_eq!(std::fs::metadata(&cell).unwrap().modified().unwrap(), before);
    std::fs::write(at.path().join("other.yaml"), STUDY).unwrap();
    std::fs::write(at.path().join("typo.yaml"), STUDY.replace("trials: 2", "trials: 0")).unwrap();
    std::fs::write(at.path().join("law.yaml"), STUDY.replace("settings: {sub", "settings: {sob")).unwrap();
    for (call, words) in [
        ("study other.yaml --out small", "small: holds another study"),
        ("study typo.yaml", "typo.yaml:6: field `strategies.0.trials` is 0"),
        ("study law.yaml", "law.yaml:13"),
        ("study small.yaml --shard 5/4", "shard 5/4; allowed: K/N"),
        ("study nowhere.yaml", "nowhere.yaml"),
    ] {
        let refused = run(at.path(), call);
        assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""), "{call}: {refused:?}");
        assert!(refused.stderr.contains(words), "{call}: {refused:?}");
    }
    std::fs::write(&cell, "{torn").unwrap();
    let refused = run(at.path(), "study small.yaml");
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("remove the file to have the cell computed again"), "{refused:?}");
}

/// Where the settings ask for it, campaigns of a study end as `tune` does; otherwise they are of equal length.
#[test]
fn campaigns_of_a_study_end_early_where_they_are_told_to() {
    let at = scratch();
    let study = "schema: tribo.study/1\nseeds: 1\nposes: [0]\ncases: [{truth: coulomb_viscous, friction: coulomb_viscous}]\n\
                 strategies: [{strategy: grey_box, trials: 7}]\noracle_runs: 1\n";
    let costs = |name: &str, settings: &str| {
        std::fs::write(at.path().join(format!("{name}.yaml")), format!("{study}{settings}")).unwrap();
        run(at.path(), &format!("study {name}.yaml --out {name} -q")).ok();
        let cell = at.path().join(name).join("cells/case0_ekf_pose0_seed0001_grey_box_7.json");
        let cell: serde_json::Value = serde_json::from_slice(&std::fs::read(cell).unwrap()).unwrap();
        let costs = cell["result"]["campaign"]["cost"].as_array().unwrap().iter();
        costs.map(|cost| cost.as_f64().unwrap()).collect::<Vec<_>>()
    };
    let whole = costs("whole", "");
    let early = costs("early", "settings: {stop_below: 0.5}\n");
    assert_eq!(whole.len(), 7);
    assert!((2..7).contains(&early.len()) && whole.starts_with(&early), "{early:?} {whole:?}");
}
