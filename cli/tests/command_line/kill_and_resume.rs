//! Story: the power fails in the middle of a campaign, more than once, and the result is the one it would have been.
//!
//! The real binary is killed with SIGKILL at seeded random moments, then `tune --resume` goes on; after every kill
//!
//! ```text
//! each op_code 6 line that was complete in journal.log is there for good, with the same value
//! each trial that has ended has its trials/NNNN.parquet
//! ```
//!
//! and at the end parameters, costs, references and best trial equal those of the uninterrupted run to the last bit,
//! and no temporary file is left. A campaign killed before its first file, campaign.yaml, is one that never began: the
//! resume says so with exit code 2, and the same `tune` begins it again.
//! Ctrl-C and SIGTERM end a campaign between two trials, exit code 0, and tell how to go on.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use crate::common::{
    finished, journal, result, run, scratch, snapshot, start, strangers, trial_log, tribo, wait_until,
};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Kills per campaign, after which it may run to its end.
const KILLS: usize = 6;

/// Kills a campaign with these arguments again and again; `seed` draws the moments.
fn survives_kills(arguments: &str, seed: u64) {
    let at = scratch();
    let started = Instant::now();
    let whole = run(at.path(), &format!("tune {arguments} --json --out whole")).ok().json();
    let duration = started.elapsed();

    let begin = format!("tune {arguments} --json --out killed");
    let go_on = "tune --resume --json --out killed";
    let campaign = at.path().join("killed");
    let mut moments = Pcg64::seed_from_u64(seed);
    let mut hits = Vec::new();
    let mut document = None;
    let mut known = Vec::new();
    for attempt in 0.. {
        // What is on the disk, and how to go on from there.
        let before = journal(&campaign);
        for (old, new) in known.iter().zip(&before) {
            assert_eq!(old, new, "an ended trial has changed");
        }
        let begun = campaign.join("campaign.yaml").exists();
        if !begun && attempt > 0 {
            let refused = run(at.path(), go_on);
            assert_eq!(refused.code, Some(2), "{refused:?}");
            assert!(refused.stderr.contains("holds no campaign"), "{refused:?}");
        }

        // The next attempt, killed when it has finished 0, 1 or 2 more trials and up to one trial's time has passed (three
        // reference runs come first), the last attempt not at all.
        let mut child = start(at.path(), if begun { go_on } else { &begin });
        if attempt < KILLS {
            let enough = finished(&campaign) + (moments.next_u64() % 3) as usize;
            wait_until("the next trial ends", || finished(&campaign) >= enough || child.try_wait().unwrap().is_some());
            std::thread::sleep(duration.mul_f64(moments.next_u64() as f64 / u64::MAX as f64 / 8.0));
            child.kill().unwrap();
        }
        let output = child.wait_with_output().unwrap();
        if output.status.success() {
            document = Some(crate::common::Run::from(output).json());
            break;
        }
        assert!(attempt < KILLS, "{output:?}");

        // What was finished is there, and its log too.
        let after = journal(&campaign);
        for (number, trial) in before.iter().enumerate().filter(|(_, trial)| trial.end.is_some()) {
            assert_eq!(after.get(number), Some(trial), "trial {number} was finished before the kill");
        }
        for number in (0..after.len()).filter(|&number| after[number].end.is_some()) {
            assert!(trial_log(&campaign, number).exists(), "trial {number} has ended without a log");
        }
        hits.push(after.iter().filter(|trial| trial.end.is_some()).count());
        known = after.iter().take_while(|trial| trial.end.is_some()).cloned().collect();
    }
    println!("{arguments}: {duration:.1?} uninterrupted; finished trials at each kill: {hits:?}");
    assert!(hits.len() >= 2, "the kills came too late to test anything");

    assert_eq!(result(&document.unwrap()), result(&whole));
    assert_same_trials(&campaign, &at.path().join("whole"));
    assert_eq!(strangers(&campaign), Vec::<std::path::PathBuf>::new());
}

/// The two campaigns agree in every bit but the times of day.
fn assert_same_trials(one: &Path, other: &Path) {
    assert_eq!(journal(one), journal(other));
    let files = |campaign: &Path| {
        let mut files = snapshot(campaign);
        files.remove(Path::new("journal.log"));
        files
    };
    let (one, other) = (files(one), files(other));
    assert_eq!(one.keys().collect::<Vec<_>>(), other.keys().collect::<Vec<_>>());
    for (path, content) in one {
        assert!(content == other[&path], "{} differs", path.display());
    }
}

#[test]
fn bayesian_optimisation_survives_kills() {
    survives_kills("--trials 8 --init 4 --strategy bo --seed 11", 1);
}

#[test]
fn grey_box_survives_kills() {
    survives_kills("--trials 8 --init 4 --stop-below never --strategy grey_box --seed 12 --threads 1", 2);
}

#[test]
fn trials_side_by_side_survive_kills() {
    survives_kills("--trials 9 --batch 3 --stop-below never --strategy grey_box --seed 14 --threads 2", 4);
}

#[test]
fn the_papers_search_on_two_threads_survives_kills() {
    survives_kills("--trials 8 --init 4 --strategy paper --seed 13 --threads 2", 3);
}

/// The same at 1 200 more moments.
#[test]
#[ignore = "takes a quarter of an hour; cargo test --release -p tribo-cli --test command_line kill_and_resume -- --ignored --nocapture"]
fn every_strategy_survives_many_kills() {
    for seed in 100..180 {
        for strategy in ["bo", "grey_box", "paper"] {
            let threads = 1 + seed % 2;
            survives_kills(
                // A campaign that ended early would be over before the kills.
                &format!(
                    "--trials 8 --init 4 --stop-below never --strategy {strategy} --seed {seed} --threads {threads}"
                ),
                seed,
            );
        }
    }
}

/// Sends `signal` once a trial has ended, and resumes.
fn ends_cleanly_on(signal: &str) {
    let at = scratch();
    let arguments = "--trials 6 --strategy grey_box --stop-below never --seed 5 --json";
    let whole = run(at.path(), &format!("tune {arguments} --out whole")).ok().json();

    let campaign = at.path().join("stopped");
    let child = start(at.path(), &format!("tune {arguments} --out stopped"));
    wait_until("the first trial ends", || finished(&campaign) > 0);
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let stopped = crate::common::Run::from(child.wait_with_output().unwrap());
    assert_eq!((stopped.code, stopped.stdout.as_str()), (Some(0), ""), "{stopped:?}");
    let done = finished(&campaign);
    let advice = format!("stopped after {done} of 6 trials; go on with: tribo tune --resume --out stopped");
    assert!(stopped.stderr.contains(&advice), "{stopped:?}");
    assert!(done < 6, "the signal came too late to test anything");
    assert!(journal(&campaign).iter().all(|trial| trial.end.is_some()), "a trial was left running");
    assert_eq!(strangers(&campaign), Vec::<std::path::PathBuf>::new());

    let resumed = run(at.path(), "tune --resume --out stopped --json").ok();
    assert_eq!(result(&resumed.json()), result(&whole));
    assert_same_trials(&campaign, &at.path().join("whole"));
}

#[test]
fn ctrl_c_ends_cleanly() {
    ends_cleanly_on("-INT");
}

#[test]
fn sigterm_ends_cleanly() {
    ends_cleanly_on("-TERM");
}

/// A write that the power failure cut in two: half a line of every kind of record, behind the records before it.
#[test]
fn a_torn_last_line_is_no_obstacle() {
    let at = scratch();
    let whole = run(at.path(), "tune --trials 3 --strategy grey_box --seed 6 --json --out whole").ok().json();
    let text = std::fs::read_to_string(at.path().join("whole/journal.log")).unwrap();
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    for (op_code, trial) in [(4, 0), (5, 1), (8, 1), (6, 1), (6, 2)] {
        let of_trial = |line: &&str| {
            let line: serde_json::Value = serde_json::from_str(line).unwrap();
            line["op_code"] == op_code && line["trial_id"].as_u64().is_none_or(|number| number == trial)
        };
        let torn = lines.iter().position(of_trial).unwrap();
        let kept = lines[..torn].concat() + &lines[torn][..lines[torn].len() / 2];
        let name = format!("torn_{op_code}_{trial}");
        let campaign = at.path().join(&name);
        crate::common::copy_directory(&at.path().join("whole"), &campaign);
        std::fs::remove_file(campaign.join("tuned.yaml")).unwrap();
        std::fs::write(campaign.join("journal.log"), kept).unwrap();

        let resumed = run(at.path(), &format!("tune --resume --json --out {name}")).ok();
        assert_eq!(result(&resumed.json()), result(&whole), "op_code {op_code} of trial {trial} torn");
        assert_same_trials(&campaign, &at.path().join("whole"));
    }
}

/// Of two trials side by side the later one has finished, and the kill came before the end of the earlier one.
#[test]
fn a_later_trial_may_have_finished_first() {
    let at = scratch();
    for (name, batch) in [("design", "--strategy paper --init 4"), ("batch", "--strategy grey_box --batch 3")] {
        let arguments = format!("tune --trials 5 {batch} --stop-below never --seed 15 --threads 2 --json");
        let whole = at.path().join(name);
        let document = run(at.path(), &format!("{arguments} --out {name}")).ok().json();

        let killed = at.path().join(format!("{name}_killed"));
        crate::common::copy_directory(&whole, &killed);
        let text = std::fs::read_to_string(whole.join("journal.log")).unwrap();
        // Trials 0 and 2 have ended, 1 and 3 have begun, 4 is unknown.
        let mut begun = 0;
        let kept = text.split_inclusive('\n').filter(|line| {
            let line: serde_json::Value = serde_json::from_str(line).unwrap();
            let op_code = line["op_code"].as_u64().unwrap();
            begun += usize::from(op_code == 4);
            let concludes = !line["user_attr"]["conclusion"].is_null();
            begun < 5 && !concludes && (op_code < 6 || matches!(line["trial_id"].as_u64(), Some(0 | 2)))
        });
        std::fs::write(killed.join("journal.log"), kept.collect::<String>()).unwrap();
        for file in ["tuned.yaml", "trials/0001.parquet", "trials/0003.parquet", "trials/0004.parquet"] {
            std::fs::remove_file(killed.join(file)).unwrap();
        }

        let resumed = run(at.path(), &format!("tune --resume --threads 2 --json --out {name}_killed")).ok();
        assert_eq!(result(&resumed.json()), result(&document), "{name}");
        assert_same_trials(&killed, &whole);
    }
}

/// SIGKILL in the middle of an atomic write leaves a hidden temporary file; the resume takes it away.
#[test]
fn the_temporary_file_of_a_killed_write_is_removed() {
    let at = scratch();
    run(at.path(), "tune --trials 1 --strategy zero --quiet --out c").ok();
    let left = ["c/.tuned.yaml.Ab12Cd.tmp", "c/trials/.0000.parquet.Ab12Cd.tmp"].map(|name| at.path().join(name));
    left.iter().for_each(|path| std::fs::write(path, "half").unwrap());
    tribo(at.path(), ["tune", "--resume", "--quiet", "--out", "c"]).status().unwrap();
    assert_eq!(strangers(&at.path().join("c")), Vec::<std::path::PathBuf>::new());
}

/// `--resume --trials` adds trials to a campaign, and it is as if it had had them from the start.
#[test]
fn a_resumed_campaign_may_grow() {
    let at = scratch();
    let whole = run(at.path(), "tune --trials 4 --strategy grey_box --seed 7 --json --out whole").ok().json();
    run(at.path(), "tune --trials 2 --strategy grey_box --seed 7 --quiet --out grown").ok();
    let grown = run(at.path(), "tune --resume --trials 4 --json --out grown").ok().json();
    assert_eq!(result(&grown), result(&whole));
}
