//! Story: a trial was told that should not have been, and logs that teach nothing came back.
//!
//! `tell --withdraw` takes a trial back: the journal keeps it, and neither strategy, best trial nor tuned.yaml use it. A short, an absurd
//! or a wrongly scaled log may be refused or told; the campaign can be asked afterwards in any case.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::Path;

use crate::common::{journal_lines, run, scratch, snapshot};
use serde_json::{Value, json};

/// Asks for trial `number` and runs it on the simulated arm.
fn ask_and_run(at: &Path, number: usize, flags: &str) -> Value {
    let asked = run(at, &format!("ask mine --json -q --out next.yaml --truth coulomb_viscous {flags}")).ok().json();
    assert_eq!(asked["trial"], number, "{asked}");
    run(at, &format!("simulate mine/campaign.yaml --trial {number} --compensation next.yaml --log trial.csv -q")).ok();
    asked
}

fn tuned(at: &Path) -> Option<String> {
    std::fs::read_to_string(at.join("mine/tuned.yaml")).ok()
}

/// A trial whose log was replaced by another one's can be taken back: nothing else brings its campaign on.
#[test]
fn a_trial_whose_log_was_replaced_is_taken_back() {
    let at = scratch();
    for number in 0..2 {
        ask_and_run(at.path(), number, if number == 0 { "--seed 7 --trials 9" } else { "" });
        run(at.path(), "tell mine trial.csv -q").ok();
    }
    let log = |number: usize| at.path().join(format!("mine/trials/000{number}.parquet"));
    std::fs::copy(log(0), log(1)).unwrap();
    run(at.path(), "tell mine --withdraw 1 --reason replaced -q").ok();
    ask_and_run(at.path(), 2, "");
}

#[test]
fn a_trial_is_taken_back() {
    let at = scratch();
    ask_and_run(at.path(), 0, "--seed 7 --trials 3");
    run(at.path(), "tell mine trial.csv -q").ok();
    let without = tuned(at.path()).unwrap();
    let first = ask_and_run(at.path(), 1, "");
    run(at.path(), "tell mine trial.csv -q").ok();
    let with = tuned(at.path()).unwrap();
    assert!(with.contains("\ntrial: 1\n") && without.contains("\ntrial: 0\n"));
    ask_and_run(at.path(), 2, "");
    run(at.path(), "report mine -q").ok();

    let before = snapshot(at.path());
    for (call, words) in [
        ("tell mine --withdraw 2 --reason slip", "trial 2 has not been told; to give it up: --give-up"),
        ("tell mine --withdraw 7 --reason slip", "trial 7 has not been asked for"),
        ("tell mine --withdraw 1", "--reason"),
        ("tell mine trial.csv --reason slip", "cannot be used with"),
        ("tell mine --reason slip", "--withdraw"),
        ("tell mine trial.csv --withdraw 1 --reason slip", "cannot be used with"),
    ] {
        let refused = run(at.path(), call);
        assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""), "{call}: {refused:?}");
        assert!(refused.stderr.contains(words), "{call}: {refused:?}");
    }
    let refused: crate::common::Run =
        crate::common::tribo(at.path(), ["tell", "mine", "--withdraw", "1", "--reason", " "]).output().unwrap().into();
    assert!(refused.code == Some(2) && refused.stderr.contains("say why"), "{refused:?}");
    assert!(snapshot(at.path()) == before, "a refusal changed something");

    let call = ["tell", "mine", "--withdraw", "1", "--reason", "the cable was caught"];
    let told: crate::common::Run = crate::common::tribo(at.path(), call).output().unwrap().into();
    assert!(told.ok().stdout.starts_with("trial 1 withdrawn: 1 of 3 count; best: trial 0, expected J 24."));
    assert_eq!(tuned(at.path()).unwrap(), without, "tuned.yaml as it was before trial 1");
    let report = std::fs::read_to_string(at.path().join("mine/report.html")).unwrap();
    assert!(report.contains("Withdrawn trials (1)") && report.contains("the cable was caught"));
    let lines = journal_lines(&at.path().join("mine"));
    // Then what the trials left amount to.
    let (last, concluded) = (&lines[lines.len() - 2], &lines[lines.len() - 1]);
    assert_eq!(concluded["user_attr"]["conclusion"]["best"]["trial"], 0);
    assert_eq!(
        (&last["op_code"], &last["user_attr"]["withdrawn_1"]["reason"]),
        (&json!(2), &json!("the cable was caught"))
    );
    let again = run(at.path(), "tell mine --withdraw 1 --reason twice");
    assert!(again.code == Some(2) && again.stderr.contains("trial 1 was withdrawn already"), "{again:?}");

    // Its place is asked for anew, by the one log that counts: that of trial 0, to the same parameters.
    run(at.path(), "tell mine --give-up").ok();
    let anew = ask_and_run(at.path(), 3, "");
    assert_eq!(anew["params"], first["params"]);
    run(at.path(), "tell mine trial.csv -q").ok();
    let told = run(at.path(), "tell mine --withdraw 3 --reason b --json").ok().json();
    assert_eq!(
        (&told["state"], &told["finished"], &told["best"]["trial"]),
        (&json!("withdrawn"), &json!(1), &json!(0))
    );
    let told = run(at.path(), "tell mine --withdraw 0 --reason c --json").ok().json();
    assert_eq!((&told["best"], &told["finished"]), (&Value::Null, &json!(0)));
    assert_eq!(tuned(at.path()), None, "nothing is tuned");
    let refused = run(at.path(), "export mine --format c");
    assert!(refused.code == Some(2) && refused.stderr.contains("no tuned parameters here"), "{refused:?}");
    run(at.path(), "report mine -q").ok();
}

/// The log of a trial, changed; what `tell` says of it is not asked here, only that the campaign can go on.
fn the_campaign_goes_on_after(change: impl Fn(Vec<String>) -> Vec<String>, failed: &str) {
    let at = scratch();
    ask_and_run(at.path(), 0, "--seed 7 --trials 6");
    let text = std::fs::read_to_string(at.path().join("trial.csv")).unwrap();
    let changed = change(text.lines().map(str::to_owned).collect()).join("\n") + "\n";
    std::fs::write(at.path().join("bad.csv"), changed).unwrap();
    let told = run(at.path(), &format!("tell mine bad.csv -q {failed}"));
    assert!(matches!(told.code, Some(0 | 2)), "{told:?}");
    for line in journal_lines(&at.path().join("mine")).iter().filter(|line| line["op_code"] == 6) {
        assert!(line["values"][0].as_f64().is_some_and(f64::is_finite), "{line}");
    }
    if told.code == Some(2) {
        run(at.path(), "tell mine --give-up").ok();
    }
    for number in 1..4 {
        ask_and_run(at.path(), number, "--anyway");
        run(at.path(), "tell mine trial.csv -q").ok();
    }
    let best = run(at.path(), "export mine --format json -q").ok().json();
    assert!(best["cost"].as_f64().unwrap() < 8.0, "{best}");
}

#[test]
fn a_short_first_log_of_a_failure_blocks_nobody() {
    the_campaign_goes_on_after(|lines| lines[..400].to_vec(), "--failed e-stop");
}

#[test]
fn a_log_of_an_instant_blocks_nobody() {
    the_campaign_goes_on_after(|lines| lines[..40].to_vec(), "--failed e-stop");
}

/// The first number of every name that begins with `stem`, in row `row`, becomes `value`.
fn one_sample(stem: &'static str, value: &'static str) -> impl Fn(Vec<String>) -> Vec<String> {
    move |mut lines| {
        let header = lines.iter().position(|line| line.contains(stem)).unwrap();
        let column = lines[header].split(',').position(|name| name.trim().starts_with(stem)).unwrap();
        let row = header + 15_000;
        let mut cells: Vec<&str> = lines[row].split(',').collect();
        cells[column] = value;
        lines[row] = cells.join(",");
        lines
    }
}

/// One wrong number among 33 000 rows changes neither the cost nor what is tried next: its row is left out, and said.
#[test]
fn one_absurd_sample_changes_nothing() {
    let at = scratch();
    ask_and_run(at.path(), 0, "--seed 7 --trials 6");
    let text = std::fs::read_to_string(at.path().join("trial.csv")).unwrap();
    let told_and_asked = |campaign: &str, log: &str| {
        let told = run(at.path(), &format!("tell {campaign} {log} --json")).ok();
        let asked = run(at.path(), &format!("ask {campaign} --json -q")).ok().json();
        (told.json()["cost"].as_f64().unwrap(), told.stderr, asked["params"].clone())
    };
    let copied = |name: &str| {
        std::fs::create_dir(at.path().join(name)).unwrap();
        for file in ["campaign.yaml", "journal.log"] {
            std::fs::copy(at.path().join("mine").join(file), at.path().join(name).join(file)).unwrap();
        }
    };
    copied("good");
    let good = told_and_asked("good", "trial.csv");
    assert_eq!(good.1, "");
    for (k, (stem, value)) in [
        ("q_3", "1e12"),
        ("q_3", "0"),
        ("tau_J_d_3", "1e300"),
        ("tau_J_d_3", "1000"),
        ("dq_3", "1e40"),
        ("tau_friction_3", "-1e4"),
    ]
    .into_iter()
    .enumerate()
    {
        let changed = one_sample(stem, value)(text.lines().map(str::to_owned).collect()).join("\n") + "\n";
        std::fs::write(at.path().join("bad.csv"), changed).unwrap();
        copied(&format!("bad{k}"));
        let bad = told_and_asked(&format!("bad{k}"), "bad.csv");
        assert!(bad.1.contains("1 of 33000 rows") && bad.1.contains(&format!("{stem} is ")), "{stem}: {}", bad.1);
        assert!((bad.0 / good.0 - 1.0).abs() < 1e-3, "{stem} of {value}: J {} instead of {}", bad.0, good.0);
        for joint in 0..7 {
            let fc = |params: &Value| params[format!("joint_{joint}")]["coulomb_nm"].as_f64().unwrap();
            assert!((fc(&bad.2) - fc(&good.2)).abs() < 0.01, "{stem} of {value}: {} instead of {}", bad.2, good.2);
        }
    }
}

/// What a log says of its compensator is held against what was asked for, and no log is two trials.
#[test]
fn the_log_of_another_trial_is_refused() {
    let at = scratch();
    ask_and_run(at.path(), 0, "--seed 7 --trials 6");
    run(at.path(), "tell mine trial.csv -q").ok();
    std::fs::rename(at.path().join("trial.csv"), at.path().join("zero.csv")).unwrap();
    ask_and_run(at.path(), 1, "");
    let before = snapshot(&at.path().join("mine"));
    let text = std::fs::read_to_string(at.path().join("trial.csv")).unwrap();
    let names: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let scaled = |stem: &str, factor: f64| {
        let rows = text.lines().skip(1).map(|line| {
            let cell = |(cell, name): (&str, &&str)| match name.starts_with(stem) {
                true => (factor * cell.parse::<f64>().unwrap()).to_string(),
                false => cell.to_owned(),
            };
            line.split(',').zip(&names).map(cell).collect::<Vec<_>>().join(",")
        });
        std::fs::write(
            at.path().join("bad.csv"),
            format!("{}\n{}\n", names.join(","), rows.collect::<Vec<_>>().join("\n")),
        )
        .unwrap();
    };
    let refused = |log: &str, words: &str| {
        let refused = run(at.path(), &format!("tell mine {log}"));
        assert!(refused.code == Some(2) && refused.stderr.contains(words), "{log}: {refused:?}");
    };
    refused("zero.csv", "is not what was asked for");
    for (stem, factor) in [
        ("tau_friction", 0.0),
        ("tau_friction", 1.4),
        ("tau_friction", -1.0),
        ("tau_friction_2", 0.0),
        ("tau_friction_1", 0.7),
    ] {
        scaled(stem, factor);
        refused("bad.csv", "is not what was asked for");
    }
    scaled("tau_friction", 1e3);
    refused("bad.csv", "tau_friction");
    assert!(snapshot(&at.path().join("mine")) == before, "a refusal changed something");
    run(at.path(), "tell mine trial.csv -q").ok();

    // Without tau_friction the positions say whose log it is.
    run(at.path(), "ask other --velocity measured --truth coulomb_viscous --seed 7 -q --out next.yaml").ok();
    run(at.path(), "simulate other/campaign.yaml --trial 0 --compensation next.yaml --log trial.csv -q").ok();
    run(at.path(), "tell other trial.csv -q").ok();
    run(at.path(), "ask other -q").ok();
    let kept: Vec<usize> = (0..names.len()).filter(|k| !names[*k].starts_with("tau_friction")).collect();
    let text = std::fs::read_to_string(at.path().join("trial.csv")).unwrap();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        kept.iter().map(|k| cells[*k]).collect::<Vec<_>>().join(",")
    };
    std::fs::write(at.path().join("bare.csv"), text.lines().map(row).collect::<Vec<_>>().join("\n") + "\n").unwrap();
    let refused = run(at.path(), "tell other bare.csv");
    assert!(refused.code == Some(2) && refused.stderr.contains("are those of trial 0"), "{refused:?}");
}

#[test]
fn a_log_in_milliseconds_blocks_nobody() {
    the_campaign_goes_on_after(
        |lines| {
            let milli = |line: String| match line
                .split_once(',')
                .and_then(|(time, rest)| Some((time.parse::<f64>().ok()?, rest)))
            {
                Some((time_s, rest)) => format!("{},{rest}", 1000.0 * time_s),
                None => line,
            };
            lines.into_iter().map(milli).collect()
        },
        "",
    );
}

/// A campaign on a robot takes five trials unless somebody says otherwise, and `tell` says what is known after each.
#[test]
fn tell_says_what_was_learnt() {
    let at = scratch();
    let asked = run(at.path(), "ask mine --seed 7 --truth coulomb_viscous --out next.yaml").ok();
    assert!(asked.stderr.contains("trial 0 of 5 (chosen by constant)"), "{asked:?}");
    run(at.path(), "simulate mine/campaign.yaml --trial 0 --compensation next.yaml --log trial.csv -q").ok();
    let told = run(at.path(), "tell mine trial.csv").ok();
    assert!(told.stdout.contains("learnt from the last logs") && told.stdout.contains(" ± "), "{told:?}");
    assert!(told.stdout.contains("unsure") || told.stdout.contains("every parameter is known"), "{told:?}");
    ask_and_run(at.path(), 1, "");
    let told = run(at.path(), "tell mine trial.csv --json").ok().json();
    // The next trial of least squares is what was learnt, with a deviation less of viscous friction, which is dangerous.
    let next = run(at.path(), "ask mine --json -q").ok().json();
    let learnt = told["learnt"].as_array().unwrap();
    assert_eq!(learnt.len(), 14);
    for known in learnt {
        let (joint, name) = known["parameter"].as_str().unwrap().split_once('.').unwrap();
        let (value, sd) = (known["value"].as_f64().unwrap(), known["sd"].as_f64().unwrap());
        let tried = next["params"][joint][name].as_f64().unwrap();
        let wanted = if name.starts_with("viscous") { (value - sd).max(0.0) } else { tried };
        assert!(sd > 0.0 && (tried - wanted).abs() <= 1e-9 + 1e-9 * value.abs(), "{known}: tried {tried}");
        assert!((tried - value).abs() < 1.001 * sd, "{known}: tried {tried}");
        assert_eq!(known["unsure"], json!(sd > 0.2 * value.abs()));
    }
    // More is asked for only on request; another strategy has a budget of its own.
    let other = run(at.path(), "ask other --strategy bo").ok();
    assert!(other.stderr.contains("trial 0 of 50"), "{other:?}");
}
