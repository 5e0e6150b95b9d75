//! Story: somebody tunes a robot that only they can run.
//!
//! `ask` hands out parameters, `tell` takes logs. With `tribo simulate` in the place of the robot, the loop of `docs/your_robot.md` ends
//! with the costs of `tribo tune`, to the last bit; trials in flight, failures, logs that are not what they should be and
//! processes that die change nothing that was told.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::Path;
use std::process::{Command, Stdio};

use crate::common::{journal, journal_lines, run, scratch, snapshot, start};
use serde_json::Value;

/// The fenced shell block of `docs/your_robot.md` that speaks of `tribo ask` in a loop.
fn loop_of_the_document() -> String {
    let readme = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/your_robot.md")).unwrap();
    let blocks = readme.split("```sh\n").skip(1).map(|rest| rest.split("```").next().unwrap());
    let mut told = blocks.filter(|block| block.contains("tribo ask") && block.contains("done"));
    told.next().expect("the document shows the loop").to_owned()
}

fn costs(trials: &Value) -> Vec<String> {
    trials.as_array().unwrap().iter().map(|trial| trial["cost"].to_string()).collect()
}

/// Asks in campaign `mine`, runs trial `number` on the simulated arm and leaves its log in `name`.
fn ask_and_run(at: &Path, number: usize, flags: &str, name: &str) -> Value {
    let asked = run(at, &format!("ask mine --json --out {name}.yaml {flags}")).ok().json();
    assert_eq!(asked["trial"], number, "{asked}");
    let simulate =
        format!("simulate mine/campaign.yaml --trial {number} --compensation {name}.yaml --log {name}.csv -q");
    run(at, &simulate).ok();
    asked
}

/// A model with less friction in a joint than the bare arm: that of a URDF would be below zero.
#[test]
fn a_format_that_cannot_hold_the_law_leaves_the_campaign_as_it_was() {
    let at = scratch();
    let model = "schema: tribo.model/1\nrobot: panda\neffects:\n- {cause: coulomb, joint: 2, delta_coulomb_nm: -0.3}\n";
    std::fs::write(at.path().join("m.yaml"), model).unwrap();
    run(at.path(), "ask mine --model m.yaml --trials 3 --format urdf --out never.urdf");
    let before = snapshot(&at.path().join("mine"));
    for form in ["--format urdf --out never.urdf", "--format mjcf", "--format urdf --out never.urdf --json"] {
        let refused = run(at.path(), &format!("ask mine {form}"));
        assert_eq!(refused.code, Some(2), "{refused:?}");
        assert!(refused.stderr.contains("joint 2: Coulomb friction is -0.3"), "{refused:?}");
        assert_eq!(snapshot(&at.path().join("mine")), before, "{form}");
    }
    assert!(!at.path().join("never.urdf").exists());
    // With --json alone nobody reads a text: none is made, and none is refused.
    let asked = run(at.path(), "ask mine --format urdf --json").ok();
    assert_eq!(asked.json()["trial"], 0, "no trial was left running: {asked:?}");
    assert!(!asked.stderr.contains("not in the urdf text"), "{asked:?}");
    run(at.path(), "ask mine --trial 0 --format c").ok();
}

#[test]
fn the_loop_of_the_document_ends_with_the_costs_of_tune() {
    let at = scratch();
    // The shell finds the binary under the name that the document calls it by.
    let bin = at.path().join("bin");
    std::fs::create_dir(&bin).unwrap();
    let binary = std::env::var_os("TRIBO_BIN").unwrap_or_else(|| env!("CARGO_BIN_EXE_tribo").into());
    std::fs::copy(binary, bin.join("tribo")).unwrap();
    let path = format!("{}:{}", bin.display(), std::env::var("PATH").unwrap());
    let output = Command::new("sh")
        .args(["-euc", &loop_of_the_document()])
        .env("PATH", path)
        .current_dir(at.path())
        .stdin(Stdio::null())
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");

    let tuned = run(at.path(), "tune --seed 7 --out tuned --json -q").ok().json();
    let mine = journal(&at.path().join("campaigns/mine"));
    let ended: Vec<String> = mine.iter().map(|trial| trial.end.clone().unwrap().1).collect();
    let wanted: Vec<String> = costs(&tuned["trials"]).iter().map(|cost| format!("[{cost}]")).collect();
    assert_eq!(ended, wanted);
    assert!((3..6).contains(&wanted.len()), "it ends when nothing is left to gain: {wanted:?}");
    let (mine, tuned) = (at.path().join("campaigns/mine/tuned.yaml"), at.path().join("tuned/tuned.yaml"));
    let without_references = |path: &Path| -> Vec<String> {
        let text = std::fs::read_to_string(path).unwrap();
        text.lines().filter(|line| !line.starts_with("uncompensated_cost")).map(str::to_owned).collect()
    };
    assert_eq!(without_references(&mine), without_references(&tuned));
}

/// Bayesian optimisation too, with another estimator, another law and another pose, from files that are read back in other formats.
#[test]
fn other_strategies_estimators_and_formats_give_the_costs_of_tune() {
    let at = scratch();
    let settings = "--strategy bo --init 2 --residual momentum --friction stribeck --pose 1 --seed 3 --trials 4";
    let tuned = run(at.path(), &format!("tune {settings} --out tuned --json -q")).ok().json();
    let told: Vec<String> = (0..4)
        .map(|number| {
            ask_and_run(at.path(), number, &format!("{settings} --truth coulomb_viscous"), "trial");
            run(at.path(), "convert trial.csv trial.parquet -q").ok();
            run(at.path(), "tell mine trial.parquet --json").ok().json()["cost"].to_string()
        })
        .collect();
    assert_eq!(told, costs(&tuned["trials"]));
}

/// Nothing is left to gain after a few trials: `tell` says so, `ask` hands out no more, unless it is asked for all the same.
/// The controller that runs the trials takes its parameters in the format that it knows.
#[test]
fn a_trial_is_asked_for_in_the_format_of_the_controller() {
    let at = scratch();
    let header = run(at.path(), "ask mine --format c").ok();
    assert!(header.stdout.contains("#ifndef TRIBO_COMPENSATOR_H"), "{header:?}");
    run(at.path(), "ask mine --trial 0 --format ros2 --out next.yaml -q").ok();
    let parameters = std::fs::read_to_string(at.path().join("next.yaml")).unwrap();
    assert!(parameters.contains("ros__parameters"), "{parameters}");
    let kept = run(at.path(), "ask mine --trial 0").ok();
    assert!(kept.stdout.starts_with("schema: tribo.tuned/1"), "{kept:?}");
}

#[test]
fn a_campaign_ends_when_nothing_is_left_to_gain() {
    let at = scratch();
    let flags = "--truth coulomb_viscous --trials 20";
    let mut told = Value::Null;
    for number in 0..3 {
        assert!(told["early_stop"].is_null(), "{told}");
        ask_and_run(at.path(), number, flags, "trial");
        told = run(at.path(), "tell mine trial.csv --json").ok().json();
    }
    let stop = &told["early_stop"];
    assert!(stop["expected_gain"].as_f64().unwrap() < stop["least_gain"].as_f64().unwrap(), "{told}");
    let refused = run(at.path(), "ask mine");
    assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""));
    for needle in ["nothing left to gain", "tribo export mine", "--anyway"] {
        assert!(refused.stderr.contains(needle), "{refused:?}");
    }
    let watched = run(at.path(), "report mine").ok();
    assert!(watched.stderr.is_empty() || !watched.stderr.contains("error"), "{watched:?}");
    let report = std::fs::read_to_string(at.path().join("mine/report.html")).unwrap();
    assert!(report.contains("ended early: nothing left to gain"), "the badge");
    // A `tell` that was killed before it had said so is made good, and what another campaign left is not believed.
    let (early_stop, said) = (at.path().join("mine/early_stop.yaml"), |path: &Path| std::fs::read(path).ok());
    let ended = said(&early_stop).expect("why it ended");
    for left in [None, Some("trials: 3\nexpected_gain: 7\nleast_gain: 9\nrepeatability: 1\n")] {
        std::fs::remove_file(&early_stop).unwrap();
        left.map_or(Ok(()), |text| std::fs::write(&early_stop, text)).unwrap();
        assert_eq!(run(at.path(), "ask mine").code, Some(2));
        assert!(said(&early_stop).as_ref() == Some(&ended), "{left:?}");
    }
    // All the same, once; and from now on until all trials are told.
    ask_and_run(at.path(), 3, "--anyway", "trial");
    run(at.path(), "tell mine trial.csv -q").ok();
    assert_eq!(run(at.path(), "ask mine").code, Some(2));
    ask_and_run(at.path(), 4, "--stop-below never", "trial");
    run(at.path(), "tell mine trial.csv -q").ok();
    ask_and_run(at.path(), 5, "", "trial");
    let nonsense = run(at.path(), "ask mine --stop-below often");
    assert!(nonsense.code == Some(2) && nonsense.stderr.contains("repeatability"), "{nonsense:?}");
}

/// Where a Stribeck law is expected to pay, the campaign goes over to it and says so; a law that was asked for stays.
#[test]
fn a_campaign_goes_over_to_the_law_that_its_logs_show() {
    let at = scratch();
    let tuned = run(at.path(), "tune --truth stribeck --out tuned --json").ok();
    assert!(tuned.stderr.contains("from trial 2 on the friction law is Stribeck"), "{tuned:?}");
    let tuned = tuned.json();
    assert_eq!((&tuned["law_change"]["law"], &tuned["law_change"]["from_trial"]), (&"stribeck".into(), &2.into()));
    let flags = "--truth stribeck --trials 6";
    let mut costs_of_asked = Vec::new();
    for number in 0..tuned["trials"].as_array().unwrap().len() {
        let asked = ask_and_run(at.path(), number, flags, "trial");
        let law = if number < 2 { "coulomb_viscous" } else { "stribeck" };
        assert_eq!(asked["compensator"]["friction"]["law"], law, "{asked}");
        costs_of_asked.push(run(at.path(), "tell mine trial.csv --json").ok().json()["cost"].to_string());
    }
    assert_eq!(costs_of_asked, costs(&tuned["trials"]));
    // It goes on after a kill with the law that it has.
    let again = run(at.path(), "tune --resume --out tuned --json").ok().json();
    assert_eq!((&again["trials"], &again["law_change"]), (&tuned["trials"], &tuned["law_change"]));
    run(at.path(), "report tuned -q").ok();
    run(at.path(), "export tuned --format c --out friction.h").ok();

    let kept = run(at.path(), "tune --truth stribeck --friction coulomb_viscous --out kept --json").ok().json();
    assert!(kept["law_change"].is_null());
    let ratio =
        |document: &Value| document["best"]["cost"].as_f64().unwrap() / document["oracle_cost"].as_f64().unwrap();
    assert!(ratio(&tuned) < ratio(&kept) - 0.03, "{} {}", ratio(&tuned), ratio(&kept));
}

#[test]
fn several_trials_are_in_flight_and_come_back_in_any_order() {
    let at = scratch();
    let flags = "--truth coulomb_viscous --trials 6";
    let zero = ask_and_run(at.path(), 0, flags, "zero");
    let told = run(at.path(), "tell mine zero.csv --json").ok().json();
    assert_eq!((&told["state"], &told["best"]["trial"]), (&"complete".into(), &0.into()), "{zero}");
    let one = ask_and_run(at.path(), 1, flags, "one");
    let two = ask_and_run(at.path(), 2, flags, "two");
    let three = ask_and_run(at.path(), 3, flags, "three");
    assert_eq!(three["running"], serde_json::json!([1, 2, 3]));
    assert_ne!(one["params"], two["params"], "the same question twice");
    assert_ne!(two["params"], three["params"], "the same question twice");

    // Several are running: which one is it?
    let refused = run(at.path(), "tell mine one.csv");
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("say which with --trial"), "{refused:?}");
    run(at.path(), "tell mine --give-up --trial 2").ok();
    run(at.path(), "tell mine three.csv --trial 3 -q").ok();
    let told = run(at.path(), "tell mine one.csv --json").ok().json();
    assert_eq!((&told["trial"], &told["finished"]), (&1.into(), &3.into()));
    assert!(told["best"]["cost"].as_f64().unwrap() < 4.0, "{told}");
    for (trial, reason) in [(2, "was given up"), (1, "has been told already"), (9, "has not been asked for")] {
        let refused = run(at.path(), &format!("tell mine one.csv --trial {trial}"));
        assert_eq!(refused.code, Some(2));
        assert!(refused.stderr.contains(reason), "{refused:?}");
    }

    // A number that was given up is not used again, and its place is asked for anew.
    for number in 4..7 {
        ask_and_run(at.path(), number, &format!("{flags} --anyway"), "next");
        run(at.path(), "tell mine next.csv -q").ok();
    }
    let refused = run(at.path(), "ask mine");
    assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""));
    assert!(refused.stderr.contains("all 6 trials are told (6)"), "{refused:?}");
    run(at.path(), "report mine -q").ok();
    let report = std::fs::read_to_string(at.path().join("mine/report.html")).unwrap();
    assert!(report.contains("of 6, from 24.3 without compensation."), "the headline");
    assert!(!report.contains("with the true friction it would be"), "nobody knows it");
    run(at.path(), "export mine --format json").ok();
    ask_and_run(at.path(), 7, "--trials 7 --anyway", "longer");
}

#[test]
fn a_trial_that_failed_teaches_what_it_can() {
    let at = scratch();
    let settings = "schema: tribo.tune/1\nstrategy: random\ntrials: 9\nguard: null\nlimits: {error_m: 0.005}\n";
    std::fs::write(at.path().join("tight.yaml"), settings).unwrap();
    // Random parameters break tight limits: the log ends early, the reason is the simulator's.
    let mut crashed = 0;
    for number in 0..3 {
        let begin = if number == 0 { "--config tight.yaml" } else { "" };
        run(at.path(), &format!("ask mine --out next.yaml -q {begin}")).ok();
        let simulate =
            format!("simulate mine/campaign.yaml --trial {number} --compensation next.yaml --log trial.csv --json");
        let simulated = run(at.path(), &simulate).ok().json();
        let told = match simulated["reason"].as_str() {
            None => run(at.path(), "tell mine trial.csv --json").ok().json(),
            Some(reason) => {
                crashed += 1;
                let refused = run(at.path(), "tell mine trial.csv");
                assert_eq!(refused.code, Some(2), "a short log passes for a whole one: {refused:?}");
                assert!(refused.stderr.contains("--failed REASON"), "{refused:?}");
                run(at.path(), &format!("tell mine trial.csv --failed {reason} --json")).ok().json()
            }
        };
        assert_eq!(told["cost"].to_string(), simulated["cost"].to_string());
        let seconds = |document: &Value| document["aborted_at_s"].as_f64().unwrap_or(-99.0);
        assert!((seconds(&told) - seconds(&simulated)).abs() < 1e-9, "{told} {simulated}");
    }
    assert!(crashed > 0, "no trial has crashed");

    // Without log: the whole penalty, in the user's own words.
    run(at.path(), "ask mine -q").ok();
    let told = run(at.path(), "tell mine --failed e-stop --json").ok().json();
    assert_eq!((told["cost"].as_f64(), &told["reason"]), (Some(1000.0), &"e-stop".into()));
    run(at.path(), "report mine -q").ok();
    let report = std::fs::read_to_string(at.path().join("mine/report.html")).unwrap();
    assert!(report.contains("e-stop"), "the report hides the reason");
}

/// Where a second trial shakes the arm, the next step is half as large, then a quarter.
#[test]
fn after_two_trials_that_failed_the_next_step_is_smaller() {
    let at = scratch();
    let coulomb = |asked: &Value| -> Vec<f64> {
        (0..7).map(|joint| asked["params"][format!("joint_{joint}")]["coulomb_nm"].as_f64().unwrap()).collect()
    };
    ask_and_run(at.path(), 0, "--truth coulomb_viscous", "trial");
    run(at.path(), "tell mine trial.csv -q").ok();
    let steps: Vec<Vec<f64>> = (1..5)
        .map(|number| {
            let asked = ask_and_run(at.path(), number, "", "trial");
            run(at.path(), "tell mine --failed oscillation -q").ok();
            coulomb(&asked)
        })
        .collect();
    for (k, step) in steps.iter().enumerate() {
        for (joint, (nm, whole_nm)) in step.iter().zip(&steps[0]).enumerate() {
            let part = nm / whole_nm;
            assert!((part - [1.0, 1.0, 0.5, 0.25][k]).abs() < 1e-9, "step {k}, joint {joint}: {part}");
        }
    }
    // Without a log nobody knows whether joints stood.
    run(at.path(), "ask other -q").ok();
    let told = run(at.path(), "tell other --failed oscillation --json").ok().json();
    assert_eq!(told["standing"], serde_json::json!([]), "{told}");
}

#[test]
fn logs_and_calls_that_are_not_what_they_should_be_change_nothing() {
    let at = scratch();
    ask_and_run(at.path(), 0, "--truth coulomb_viscous --trials 2", "good");
    let lines = |from: usize, to: usize| -> String {
        let text = std::fs::read_to_string(at.path().join("good.csv")).unwrap();
        text.lines().enumerate().filter(|(k, _)| *k < from || *k >= to).map(|(_, line)| format!("{line}\n")).collect()
    };
    std::fs::write(at.path().join("gap.csv"), lines(5000, 5100)).unwrap();
    std::fs::write(at.path().join("short.csv"), lines(30_000, 99_999)).unwrap();
    std::fs::write(at.path().join("torn.csv"), &lines(30_000, 99_999)[..2_000_000]).unwrap();
    let without = |stem: &str| -> String {
        let text = std::fs::read_to_string(at.path().join("good.csv")).unwrap();
        text.replacen(stem, "note_", 7)
    };
    std::fs::write(at.path().join("uncommanded.csv"), without("tau_J_d_")).unwrap();
    run(at.path(), "simulate --robot ur10e --log six.csv -q").ok();
    let before = journal_lines(&at.path().join("mine"));
    for (call, words) in [
        ("tell mine gap.csv", "gap.csv: a gap of 0.101 s at time 4.998 s"),
        ("tell mine short.csv", "short.csv: ends after 29.998 s, a trial takes 33 s"),
        ("tell mine torn.csv", "torn.csv:"),
        ("tell mine uncommanded.csv", "uncommanded.csv: missing columns tau_J_d_i"),
        ("tell mine six.csv", "six.csv: 6 joints; the robot of the campaign has 7"),
        ("tell mine nowhere.csv", "nowhere.csv"),
        ("tell nowhere good.csv", "nowhere: holds no campaign"),
        ("tell mine", "LOG"),
        ("ask mine --strategy bo", "`strategy` is another in this campaign"),
        ("ask mine --seed 4", "`seed` is another in this campaign"),
        ("ask mine --torque measured", "`user_trials.torque` is another in this campaign"),
        ("ask mine --trial 3", "trial 3 has not been asked for; running: 0"),
        ("ask mine --trials 0", "field `trials` is 0"),
        ("ask other --trial 3", "other: holds no campaign yet"),
        ("ask other --judged 0", "user_trials.judged_s"),
        ("tune --resume --out mine", "its trials run elsewhere"),
    ] {
        let refused = run(at.path(), call);
        assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""), "{call}: {refused:?}");
        assert!(refused.stderr.contains(words), "{call}: {refused:?}");
    }
    assert_eq!(journal_lines(&at.path().join("mine")), before);
    assert!(!at.path().join("other").exists() && !at.path().join("nowhere").exists());
    run(at.path(), "tune --trials 1 --out tuned -q").ok();
    let refused = run(at.path(), "ask tuned");
    assert!(refused.code == Some(2) && refused.stderr.contains("tribo tune --resume"), "{refused:?}");
    let again = run(at.path(), "ask mine --trial 0 -q").ok();
    assert_eq!(again.stdout, std::fs::read_to_string(at.path().join("good.yaml")).unwrap(), "the same question again");
    run(at.path(), "tell mine good.csv -q").ok();
}

/// Robots ask at the same time; each gets a trial of its own, and processes killed while they ask leave none half-asked.
#[test]
fn processes_that_ask_at_once_or_die_asking_leave_a_whole_campaign() {
    let at = scratch();
    run(at.path(), "ask mine --strategy sobol --trials 99 -q").ok();
    let asking: Vec<_> = (0..4).map(|_| start(at.path(), "ask mine --json")).collect();
    let mut numbers: Vec<u64> = asking
        .into_iter()
        .map(|child| {
            let asked: crate::common::Run = child.wait_with_output().unwrap().into();
            asked.ok().json()["trial"].as_u64().unwrap()
        })
        .collect();
    numbers.sort_unstable();
    assert_eq!(numbers, [1, 2, 3, 4]);

    for pause_ms in (0..40).step_by(2) {
        let mut child = start(at.path(), "ask mine --json");
        std::thread::sleep(std::time::Duration::from_millis(pause_ms));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    let last = run(at.path(), "ask mine --json").ok().json();
    let running: Vec<u64> = last["running"].as_array().unwrap().iter().map(|number| number.as_u64().unwrap()).collect();
    assert_eq!(running, (0..running.len() as u64).collect::<Vec<_>>());
    let trials = journal(&at.path().join("mine"));
    assert_eq!(trials.len(), running.len());
    assert!(trials.iter().all(|trial| trial.params.len() == 14), "a trial without its parameters");
}

/// A log that does not say what the compensator added is judged where that can be worked out, and refused where it cannot.
#[test]
fn a_log_has_to_say_what_the_compensator_added() {
    let at = scratch();
    let without_compensation = |from: &str, to: &str| {
        let whole = std::fs::read_to_string(at.path().join(from)).unwrap();
        let kept: Vec<bool> =
            whole.lines().next().unwrap().split(',').map(|name| !name.starts_with("tau_friction")).collect();
        assert_eq!(kept.iter().filter(|kept| !**kept).count(), 7);
        let less = |line: &str| -> String {
            line.split(',').zip(&kept).filter(|(_, kept)| **kept).map(|(cell, _)| cell).collect::<Vec<_>>().join(",")
        };
        let text: Vec<String> = whole.lines().map(less).collect();
        std::fs::write(at.path().join(to), text.join("\n") + "\n").unwrap();
    };
    let flags = "--truth coulomb_viscous --seed 9";
    ask_and_run(at.path(), 0, flags, "zero");
    without_compensation("zero.csv", "zero_less.csv");
    run(at.path(), "tell mine zero_less.csv -q").ok();
    ask_and_run(at.path(), 1, flags, "one");
    without_compensation("one.csv", "one_less.csv");
    let refused = run(at.path(), "tell mine one_less.csv");
    assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""), "{refused:?}");
    for needle in ["one_less.csv: missing columns tau_friction", "--velocity measured"] {
        assert!(refused.stderr.contains(needle), "{refused:?}");
    }
    run(at.path(), "tell mine one.csv -q").ok();

    // The velocity of the log is all that this compensator believes.
    let mine = at.path().join("mine");
    std::fs::rename(&mine, at.path().join("hybrid")).unwrap();
    for number in 0..2 {
        ask_and_run(at.path(), number, &format!("{flags} --velocity measured"), "trial");
        without_compensation("trial.csv", "less.csv");
        let told = run(at.path(), "tell mine less.csv --json").ok().json();
        let tuned =
            run(at.path(), &format!("tune --seed 9 --velocity measured --trials 2 --out tuned{number} --json -q"))
                .ok()
                .json();
        let ratio = told["cost"].as_f64().unwrap() / tuned["trials"][number]["cost"].as_f64().unwrap();
        assert!((ratio - 1.0).abs() < 0.1, "trial {number}: {ratio}");
    }
}

/// A tool of half a kilogram that nobody told of is said wherever the campaign is shown: the friction law does not explain the robot.
#[test]
fn a_law_that_does_not_explain_the_robot_is_said_by_every_command() {
    let at = scratch();
    let payload = "effects:\n- {cause: payload, mass_kg: 0.5, com_m: [0, 0, 0.05], inertia_kg_m2: [1.0e-3, 0, 0, 1.0e-3, 0, 1.0e-3]}\n";
    std::fs::write(at.path().join("heavy.yaml"), format!("schema: tribo.model/1\nrobot: panda\n{payload}")).unwrap();
    let said = |text: &str| text.contains("something else is at work in this robot");
    let tuned = run(at.path(), "tune --truth heavy.yaml --trials 2 --out tuned").ok();
    assert!(said(&tuned.stdout) || said(&tuned.stderr), "{tuned:?}");
    ask_and_run(at.path(), 0, "--truth heavy.yaml", "trial");
    let told = run(at.path(), "tell mine trial.csv").ok();
    assert!(said(&told.stdout) || said(&told.stderr), "{told:?}");
    let asked = run(at.path(), "ask mine").ok();
    assert!(said(&asked.stderr), "{asked:?}");
    run(at.path(), "report mine -q").ok();
    assert!(said(&std::fs::read_to_string(at.path().join("mine/report.html")).unwrap()));
}
