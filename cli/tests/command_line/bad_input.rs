//! Story: whatever is wrong with the input, the message says where, and nothing is done by halves.
//!
//! Each row of the tables is one call. It must end with exit code 2 and silence on standard output; standard error
//! names file, line (where there is one), field and allowed range; the directory holds the same bytes as before.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::fmt::Write;
use std::path::Path;
use std::sync::OnceLock;

use crate::common::{copy_directory, finished, journal_lines, run, scratch, snapshot, start, wait_until};
use tempfile::TempDir;

/// A call that must be refused.
struct Case {
    /// Files to write first: path and content.
    files: &'static [(&'static str, &'static str)],
    /// The call.
    arguments: &'static str,
    /// What the message must contain.
    needles: &'static [&'static str],
}

/// Runs `tribo` where it must refuse, and compares the directory before and after. Anything left over is told as text.
fn refusal(at: &Path, arguments: &str, needles: &[&str]) -> Result<(), String> {
    let before = snapshot(at);
    let run = run(at, arguments);
    let mut complaints = String::new();
    if run.code != Some(2) {
        write!(complaints, " exit code {:?}", run.code).unwrap();
    }
    if !run.stdout.is_empty() {
        write!(complaints, " wrote to stdout: {:?}", run.stdout).unwrap();
    }
    for needle in needles.iter().filter(|needle| !run.stderr.contains(**needle)) {
        write!(complaints, " no `{needle}`").unwrap();
    }
    // The message tells its cause once.
    for phrase in ["os error", "line "] {
        if run.stderr.matches(phrase).count() > 1 {
            write!(complaints, " says `{phrase}` twice").unwrap();
        }
    }
    if snapshot(at) != before {
        write!(complaints, " changed the directory: {:?}", snapshot(at).keys()).unwrap();
    }
    let told = format!("tribo {arguments}:{complaints}\n  {}", run.stderr);
    if complaints.is_empty() { Ok(()) } else { Err(told) }
}

/// Runs every case in a directory of its own and tells all failures at once.
fn refuse_all(cases: &[Case]) {
    let refuse = |case: &Case| {
        let at = scratch();
        for (path, content) in case.files {
            std::fs::create_dir_all(at.path().join(path).parent().unwrap()).unwrap();
            std::fs::write(at.path().join(path), content).unwrap();
        }
        refusal(at.path(), case.arguments, case.needles)
    };
    tell(cases.iter().map(refuse));
}

fn tell(results: impl Iterator<Item = Result<(), String>>) {
    let failures: Vec<String> = results.filter_map(Result::err).collect();
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn settings() {
    let tune = "tune c.yaml --trials 1 --out z";
    refuse_all(&[
        Case {
            files: &[("c.yaml", "seed: 1\nbogus: 2\n")],
            arguments: tune,
            needles: &["c.yaml:2:1: ", "`bogus`", "trials"],
        },
        Case {
            files: &[("c.yaml", "seed: 1\nlimits:\n  # metres\n  eror_m: 2\n")],
            arguments: tune,
            needles: &["c.yaml:4:3: ", "`eror_m`", "error_m"],
        },
        Case {
            files: &[("c.yaml", "seed: 1\ninit: many\n")],
            arguments: tune,
            needles: &["c.yaml:2:7: field `init`: not a whole number"],
        },
        Case {
            files: &[("c.yaml", "limits:\n  error_m: wide\n")],
            arguments: tune,
            needles: &["c.yaml:2:12: field `limits.error_m`: not a number"],
        },
        Case {
            files: &[("c.yaml", "strategy: magic\n")],
            arguments: tune,
            needles: &["c.yaml:1:11: field `strategy`: ", "`magic`", "grey_box"],
        },
        Case {
            files: &[("c.yaml", "seed: 1\nlimits:\n  error_m: -0.05\n")],
            arguments: tune,
            needles: &["c.yaml:3: field `limits.error_m` is -0.05; allowed: greater than 0, at most 10"],
        },
        Case {
            files: &[("c.yaml", "limits:\n  error_m: .nan\n")],
            arguments: tune,
            needles: &["c.yaml:2: field `limits.error_m` is NaN; allowed: greater than 0, at most 10"],
        },
        Case {
            files: &[("c.yaml", "ekf:\n  measurement:\n    diagonal:\n      position_m: 0\n      rotation_rad: 0.1\n")],
            arguments: tune,
            needles: &[
                "c.yaml:4: field `ekf.measurement.diagonal.position_m` is 0; allowed: greater than 0, at most 1",
            ],
        },
        Case {
            files: &[("c.yaml", "model_error:\n  payload_kg: 21\n")],
            arguments: "simulate c.yaml --log z.csv",
            needles: &["c.yaml:2: field `model_error.payload_kg` is 21; allowed: 0 to 20"],
        },
        Case {
            files: &[("c.yaml", "schema: tribo.tune/9\n")],
            arguments: tune,
            needles: &["c.yaml:1: field `schema` is tribo.tune/9; allowed: tribo.tune/1"],
        },
        Case {
            files: &[("c.yaml", "seed: 1\nseed: 2\n")],
            arguments: tune,
            needles: &["c.yaml:2:1: ", "duplicate", "seed"],
        },
        Case { files: &[("c.yaml", "trials: [1\n")], arguments: tune, needles: &["c.yaml:1:9: field `trials`: "] },
        Case { files: &[], arguments: tune, needles: &["c.yaml: No such file or directory"] },
        Case { files: &[("c.yaml/x", "")], arguments: tune, needles: &["c.yaml: Is a directory"] },
        Case {
            files: &[("r.yaml", "schema: tribo.reproduce/1\nseeds: 0\n")],
            arguments: "reproduce roveda2022 --config r.yaml --out z.json",
            needles: &["r.yaml:"],
        },
        Case {
            files: &[("r.yaml", "schema: tribo.reproduce/2\n")],
            arguments: "reproduce 04 --config r.yaml --out z.json",
            needles: &["r.yaml:"],
        },
        Case { files: &[], arguments: "reproduce 03 --seeds 0 --out z.json", needles: &["seeds", "1 to 10000"] },
    ]);
    // Not text at all.
    let at = scratch();
    std::fs::write(at.path().join("c.yaml"), b"seed: 1\n# \xff\n").unwrap();
    refusal(at.path(), tune, &["c.yaml:2:3: not UTF-8 text"]).unwrap();
}

const MODEL: &str = "schema: tribo.model/1\nrobot: panda\nfriction:\n  law: coulomb_viscous\n  joints:\n";

/// A model file with `joints` joints, the third of which has Coulomb friction `third_nm`.
fn model(joints: usize, third_nm: f64) -> String {
    (0..joints).fold(MODEL.to_owned(), |text, j| {
        format!("{text}  - coulomb_nm: {}\n    viscous_nm_s_per_rad: 1\n", if j == 2 { third_nm } else { 0.5 })
    })
}

#[test]
fn model_of_the_truth() {
    for (content, needles) in [
        (model(7, -0.5), &["m.yaml:10: field `friction.joints[2].coulomb_nm` is -0.5; allowed: 0 to 1000"][..]),
        (model(6, 0.5), &["m.yaml:5: field `friction.joints` is 6 entries; allowed: 7 entries, one per joint"]),
        (model(7, 0.5).replace("panda", "puma"), &["m.yaml:2: field `robot` is puma; allowed: panda"]),
        (
            model(7, 0.5).replace("model/1", "model/7"),
            &["m.yaml:1: field `schema` is tribo.model/7; allowed: tribo.model/1"],
        ),
        (
            model(7, 0.5).replace("robot: panda", "robot: panda\njoints: 6"),
            &["m.yaml:3: field `joints` is 6; allowed: 7"],
        ),
        (model(7, 0.5).replace("  law: coulomb_viscous\n", ""), &["m.yaml:", "`law`"]),
        (
            model(7, 0.5).replace("law: coulomb_viscous", "law: gaz_sigmoid"),
            &["m.yaml:6: field `friction.joints[0].phi1_nm` is missing; allowed: 0 to 1000"],
        ),
        (
            model(7, 0.5).replace("robot: panda", "robot: panda\npayload:\n  mass_kg: -1"),
            &["m.yaml:4: field `payload.mass_kg` is -1; allowed: 0 to 100"],
        ),
        (model(7, 0.5).replace("robot: panda", "robot: panda\ncolour: red"), &["m.yaml:3:1: ", "`colour`"]),
    ] {
        let at = scratch();
        std::fs::write(at.path().join("m.yaml"), content).unwrap();
        std::fs::write(at.path().join("log.csv"), log(7, 3)).unwrap();
        tell(
            [
                "tune --truth m.yaml --trials 1 --out z",
                "simulate --truth m.yaml --log z.csv",
                "estimate log.csv --model m.yaml",
            ]
            .into_iter()
            .map(|arguments| refusal(at.path(), arguments, needles)),
        );
    }
    refuse_all(&[Case { files: &[], arguments: "tune --truth m.yaml --out z", needles: &["m.yaml: No such file"] }]);
}

/// A canonical log of a still arm, as text.
fn log(joints: usize, rows: usize) -> String {
    let names =
        ["q", "dq", "tau_J"].map(|stem| (0..joints).map(|j| format!("{stem}_{j}")).collect::<Vec<_>>().join(","));
    let cells = ["0.25", "0.00", "0.25"].map(|cell| vec![cell; joints].join(",")).join(",");
    let line = |row: usize| format!("{:.3},{cells}\n", row as f64 * 1e-3);
    format!("time,{}\n{}", names.join(","), (0..rows).map(line).collect::<String>())
}

#[test]
fn logs() {
    let at = scratch();
    let write = |name: &str, content: &str| std::fs::write(at.path().join(name), content).unwrap();
    write("good.csv", &log(7, 3000));
    write("six.csv", &log(6, 3000));
    write("garbage.csv", "this is no log\n1,2,3\n");
    write("empty.csv", "");
    write("cut.csv", &log(7, 30)[..1000]);
    write("back.csv", &log(7, 30).replace("\n0.007,", "\n0.002,"));
    let lines: Vec<String> = log(7, 30).lines().map(str::to_owned).collect();
    let mut with_nan = lines.clone();
    with_nan[4] = with_nan[4].replacen("0.25", "NaN", 2).replacen("NaN", "0.25", 1);
    write("nan.csv", &with_nan.join("\n"));
    write("short.csv", &log(7, 40));
    std::fs::create_dir(at.path().join("folder")).unwrap();

    let refused = [
        ("estimate nowhere.csv", &["nowhere.csv: no such file"][..]),
        ("estimate garbage.csv", &["garbage.csv: unknown format", "this is no log", "canonical CSV"]),
        ("estimate empty.csv", &["empty.csv: is empty"]),
        ("estimate folder", &["folder: unknown format"]),
        ("estimate six.csv", &["six.csv: 6 joints; say which robot that is: --robot NAME"]),
        ("estimate nan.csv", &["nan.csv:5: column q_1: `NaN` is not a finite decimal number"]),
        ("estimate cut.csv", &["cut.csv:", "cells, the header has 22"]),
        ("estimate back.csv", &["back.csv:9: column time: 0.002 s does not exceed the stamp before, 0.006 s"]),
        ("estimate short.csv", &["short.csv: the longest of 1 bursts lasts 0.039 s, a band of 10.0 Hz needs"]),
        ("estimate good.csv --out nowhere/z.parquet", &["nowhere: no such file or directory"]),
        ("estimate good.csv --out good.csv/z.parquet", &["good.csv"]),
        ("estimate good.csv --model good.csv", &["good.csv:"]),
        (
            "estimate good.csv --residual double_encoder",
            &["good.csv: missing columns theta_0 to theta_6", "double_encoder"],
        ),
        ("convert good.csv z.mat", &["z.mat: unknown ending; allowed: .csv, .csv.gz, .parquet, .mcap"]),
        ("convert good.csv nowhere/z.csv", &["nowhere: no such file or directory"]),
        ("convert good.csv /proc/z.csv", &["/proc: cannot create a file in this directory"]),
        ("convert nan.csv z.parquet", &["nan.csv:5: column q_1"]),
        ("simulate --log z.txt", &["z.txt: unknown ending; allowed: .csv, .csv.gz, .parquet, .mcap"]),
        ("simulate --log nowhere/z.csv", &["nowhere: no such file or directory"]),
        ("simulate --compensation nowhere.yaml", &["nowhere.yaml: No such file"]),
    ];
    tell(refused.into_iter().map(|(arguments, needles)| refusal(at.path(), arguments, needles)));
}

/// Small files that ask for much: the rest is in `tests/fuzz_inputs/bombs.rs`, this is how it ends for the user.
#[test]
fn what_asks_for_too_much() {
    let at = scratch();
    let put = |name: &str, content: &str| std::fs::write(at.path().join(name), content).unwrap();
    put("far.csv", include_str!("../../../fuzz/regressions/csv_log/longer_than_a_number.csv"));
    let laughs: String =
        (1..12).map(|k| format!("a{k}: &a{k} [{}]\n", [&*format!("*a{}", k - 1); 10].join(","))).collect();
    put("laughs.yaml", &format!("a0: &a0 [0]\n{laughs}"));
    put("deep.yaml", &"[".repeat(100_000));
    let study = "schema: tribo.study/1\nseeds: 10000\ncases: [{truth: stribeck, friction: stribeck}]\n\
                 strategies: [{strategy: zero, trials: 1}]\n";
    put("grid.yaml", &format!("{study}poses: [{}0]\n", "0, ".repeat(900)));
    let effect = "- {cause: time_delay, delay_s: 0}\n";
    put("effects.yaml", &format!("schema: tribo.model/1\nrobot: panda\neffects:\n{}", effect.repeat(300)));
    let refused = [
        ("diagnose far.csv", &["far.csv: time, last less first: inf is outside"][..]),
        ("convert far.csv z.parquet", &["far.csv: time, last less first: inf is outside"]),
        ("tune laughs.yaml --out z", &["laughs.yaml:"]),
        ("tune deep.yaml --out z", &["deep.yaml:"]),
        ("study grid.yaml --out z", &["grid.yaml:5: field `poses[1]` is there twice; allowed: once"]),
        ("simulate --log z.csv --truth effects.yaml", &["effects.yaml:3: field `effects` is 300 entries"]),
        #[cfg(target_os = "linux")]
        ("tune /dev/zero --out z", &["/dev/zero:1:1: more than 67108864 bytes"]),
    ];
    tell(refused.into_iter().map(|(arguments, needles)| refusal(at.path(), arguments, needles)));
}

#[test]
fn values_on_the_command_line() {
    let log = log(7, 3000);
    let at = scratch();
    std::fs::write(at.path().join("good.csv"), log).unwrap();
    let refused = [
        ("tune --out z --pose 3", &["'3'", "--pose", "0..=2"][..]),
        ("tune --out z --trials 0", &["field `trials` is 0; allowed: 1 to 10000"]),
        ("tune --out z --trials -1", &["'-1'", "--trials"]),
        ("tune --out z --trials many", &["'many'", "--trials"]),
        ("tune --out z --init 0", &["field `init` is 0; allowed: 1 to 1000"]),
        ("tune --out z --seed -1", &["'-1'", "--seed"]),
        ("tune --out z --strategy magic", &["magic", "--strategy", "grey_box"]),
        ("tune --out z --bogus", &["--bogus"]),
        ("tune --out z --check high", &["'high'", "--check"]),
        ("estimate good.csv --band-hz 0", &["band 0 Hz is outside (0, 350"]),
        ("estimate good.csv --band-hz -5", &["band -5 Hz is outside (0, 350"]),
        ("estimate good.csv --band-hz nan", &["band NaN Hz is outside (0, 350"]),
        ("estimate good.csv --block-s 0", &["--block-s is 0; allowed: greater than 0"]),
        ("estimate good.csv --block-s -2", &["--block-s is -2; allowed: greater than 0"]),
        ("estimate good.csv --block-s nan", &["--block-s is NaN; allowed: greater than 0"]),
        ("estimate good.csv --residual magic", &["magic", "--residual", "ekf"]),
        ("estimate good.csv --model m.yaml --torque-side link", &["--model", "--torque-side"]),
        ("simulate --log z.csv --pulse-force -1", &["--pulse-force is -1; allowed: 0 to 1000"]),
        ("simulate --log z.csv --pulse-moment 1e9", &["--pulse-moment is 1000000000; allowed: 0 to 1000"]),
        ("simulate --log z.csv --pulse-force nan", &["--pulse-force is NaN; allowed: 0 to 1000"]),
        ("simulate --log z.csv --torque-side top", &["top", "--torque-side", "motor", "link"]),
        ("export . --format xml", &["xml", "--format", "json"]),
        ("bench --realtime 0.5", &["--realtime is 0.5; allowed: 1 to 86400"]),
        ("bench --realtime nan", &["--realtime is NaN; allowed: 1 to 86400"]),
        ("bench --realtime 2 --stall -1", &["--stall is -1; allowed: 0 to 10000"]),
        ("bench --realtime 2 --stall 3 --stall-at 9", &["--stall-at is 9; allowed: 0 to 2"]),
        ("bench --realtime 2 --overruns 0", &["--overruns", "1..=1000"]),
        ("bench --stall 3", &["--realtime"]),
        ("bench --quick --realtime 2", &["--quick", "--realtime"]),
        ("bench --ticks 3", &["--ticks", "1000..=100000000"]),
        ("bench --robot r2d2 --quick", &["r2d2"]),
        ("completions tcsh", &["tcsh", "bash"]),
        ("juggle", &["juggle"]),
    ];
    tell(refused.into_iter().map(|(arguments, needles)| refusal(at.path(), arguments, needles)));
}

/// A finished campaign of two trials, made once and copied by whoever damages it.
fn campaign() -> &'static Path {
    static CAMPAIGN: OnceLock<TempDir> = OnceLock::new();
    let at = CAMPAIGN.get_or_init(|| {
        let at = scratch();
        run(at.path(), "tune --trials 2 --strategy grey_box --quiet --out c").ok();
        at
    });
    at.path()
}

/// The campaign with one change, and the call that must be refused.
fn damaged(change: impl Fn(&Path), arguments: &str, needles: &[&str]) -> Result<(), String> {
    let at = scratch();
    copy_directory(campaign(), at.path());
    change(&at.path().join("c"));
    refusal(at.path(), arguments, needles)
}

fn edit(path: &Path, change: impl Fn(Vec<String>) -> Vec<String>) {
    let text = std::fs::read_to_string(path).unwrap();
    std::fs::write(path, change(text.lines().map(str::to_owned).collect()).join("\n") + "\n").unwrap();
}

/// Cuts the journal behind the end of the first trial, as a kill may.
fn killed_after_one_trial(campaign: &Path) {
    let ends = journal_lines(campaign).iter().position(|line| line["op_code"] == 6).unwrap();
    edit(&campaign.join("journal.log"), |lines| lines[..=ends].to_vec());
    std::fs::remove_file(campaign.join("tuned.yaml")).unwrap();
    assert_eq!(finished(campaign), 1);
}

#[test]
fn places_of_campaigns() {
    let nothing = |_: &Path| {};
    let lines = journal_lines(&campaign().join("c")).len();
    let again = format!("c/journal.log:{}: corrupt journal: trial 1 has ended already", lines + 1);
    let journal = |change: fn(Vec<String>) -> Vec<String>| move |c: &Path| edit(&c.join("journal.log"), change);
    let swap = |mut lines: Vec<String>| {
        lines[19] = "nonsense".to_owned();
        lines
    };
    let without_study = |lines: Vec<String>| lines[1..].to_vec();
    let ended_twice = |mut lines: Vec<String>| {
        let end = lines.iter().rposition(|line| line.contains("\"op_code\":6")).unwrap();
        lines.push(lines[end].clone());
        lines
    };
    let without_parameter = |lines: Vec<String>| {
        let other = |line: &String| !(line.contains("joint_3.coulomb_nm") && line.contains("\"trial_id\":0"));
        lines.into_iter().filter(other).collect()
    };
    let resume = "tune --resume --out c";
    tell(
        [
            damaged(nothing, "tune --trials 1 --out c", &["c: holds a campaign already", "--resume", "--out"]),
            damaged(nothing, "tune --resume --out c --seed 4", &["--seed cannot be combined with --resume"]),
            damaged(nothing, "tune --resume --out c --strategy bo", &["--strategy cannot be combined with --resume"]),
            damaged(nothing, "tune --resume --out c --truth gaz", &["--truth cannot be combined with --resume"]),
            damaged(nothing, "tune --resume --out c/trials", &["c/trials: holds no campaign (no campaign.yaml)"]),
            damaged(nothing, "tune --resume --out nowhere", &["nowhere: holds no campaign"]),
            damaged(nothing, "tune --resume", &["no campaign in campaigns/ to resume", "--out"]),
            damaged(nothing, "tune --trials 1 --out /proc/z", &["/proc/z: "]),
            damaged(nothing, "tune --trials 1 --out c/journal.log/z", &["c/journal.log/z: Not a directory"]),
            damaged(nothing, "tune --trials 1 --out c/journal.log", &["c/journal.log: Not a directory"]),
            damaged(
                |c| {
                    edit(&c.join("campaign.yaml"), |lines| {
                        lines.iter().map(|l| l.replace("trials: 2", "trials: 0")).collect()
                    })
                },
                resume,
                &["c/campaign.yaml:11: field `trials` is 0; allowed: 1 to 10000"],
            ),
            damaged(journal(swap), resume, &["c/journal.log:20: corrupt journal: not JSON"]),
            damaged(journal(without_study), resume, &["c/journal.log:1: corrupt journal: no study"]),
            damaged(journal(ended_twice), resume, &[&again]),
            damaged(journal(without_parameter), resume, &["c/journal.log: trial 0 has no usable `joint_3.coulomb_nm`"]),
            damaged(
                |c| {
                    let path = c.join("journal.log");
                    let mut bytes = std::fs::read(&path).unwrap();
                    bytes[10] = 0xff;
                    std::fs::write(path, bytes).unwrap();
                },
                resume,
                &["c/journal.log:1: corrupt journal: not UTF-8 text at byte 11"],
            ),
        ]
        .into_iter(),
    );
}

/// The grey box learns from the logs of past trials; without them a killed campaign cannot go on as it would have.
#[test]
fn logs_of_finished_trials() {
    let lost = |c: &Path| {
        killed_after_one_trial(c);
        std::fs::remove_file(c.join("trials/0000.parquet")).unwrap();
    };
    let flipped = |c: &Path| {
        killed_after_one_trial(c);
        let path = c.join("trials/0000.parquet");
        let mut bytes = std::fs::read(&path).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        std::fs::write(path, bytes).unwrap();
    };
    let cut = |c: &Path| {
        killed_after_one_trial(c);
        let path = c.join("trials/0000.parquet");
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(path, &bytes[..bytes.len() / 2]).unwrap();
    };
    tell(
        [
            damaged(lost, "tune --quiet --resume --out c", &["trial 1: c/trials/0000.parquet: no such file"]),
            damaged(flipped, "tune --quiet --resume --out c", &["trial 1: c/trials/0000.parquet: damaged or cut off"]),
            damaged(cut, "tune --quiet --resume --out c", &["trial 1: c/trials/0000.parquet: damaged or cut off"]),
        ]
        .into_iter(),
    );
}

#[test]
fn tuned_parameters() {
    let tuned = |from: &'static str, to: &'static str| {
        move |c: &Path| edit(&c.join("tuned.yaml"), |lines| lines.iter().map(|line| line.replace(from, to)).collect())
    };
    let gone = |c: &Path| std::fs::remove_file(c.join("tuned.yaml")).unwrap();
    let json = "export c/tuned.yaml --format json --out z.json";
    tell(
        [
            damaged(gone, json, &["c/tuned.yaml: no tuned parameters here; has the campaign finished?"]),
            damaged(
                tuned("tribo.tuned/1", "tribo.tuned/2"),
                json,
                &["c/tuned.yaml:1: field `schema` is tribo.tuned/2; allowed"],
            ),
            damaged(
                tuned("- coulomb_nm: 0.", "- coulomb_nm: -0."),
                json,
                &["c/tuned.yaml:15: field `friction.joints[0].coulomb_nm` is -0.", "allowed: 0 to 1000"],
            ),
            damaged(
                tuned("law: coulomb_viscous", "law: stribeck"),
                json,
                &["c/tuned.yaml:15: field `friction.joints[0].", "is missing"],
            ),
            damaged(tuned("cost:", "price:"), json, &["c/tuned.yaml:6:1: ", "`price`"]),
            damaged(tuned("cost:", "cost: dear #"), json, &["c/tuned.yaml:6:7: field `cost`: not a number"]),
            damaged(
                tuned("cost:", "cost: dear #"),
                "simulate --compensation c/tuned.yaml --log z.csv",
                &["c/tuned.yaml:6:7: "],
            ),
            damaged(|_| {}, "export nowhere --format json", &["nowhere: no tuned parameters here"]),
            damaged(|_| {}, "export c --format json --out nowhere/z.json", &["nowhere: no such file or directory"]),
            damaged(|_| {}, "export c/journal.log --format yaml", &["c/journal.log:"]),
        ]
        .into_iter(),
    );
}

/// Two processes on one campaign: the second is told so and changes nothing, the first does not notice.
#[test]
fn a_campaign_that_is_running() {
    let at = scratch();
    let mut first = start(at.path(), "tune --trials 100 --strategy zero --quiet --out c");
    wait_until("the campaign has begun", || !journal_lines(&at.path().join("c")).is_empty());
    let resumed = run(at.path(), "tune --resume --out c");
    let created = run(at.path(), "tune --trials 1 --out c");
    assert!(first.try_wait().unwrap().is_none(), "the first has ended");
    first.kill().unwrap();
    first.wait().unwrap();
    assert_eq!(resumed.code, Some(2), "{resumed:?}");
    assert!(resumed.stderr.contains("c/journal.log: another process is running this campaign"), "{resumed:?}");
    assert_eq!(created.code, Some(2), "{created:?}");
    assert!(created.stderr.contains("c: holds a campaign already"), "{created:?}");
}
