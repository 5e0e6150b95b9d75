//! Story: `tribo diagnose` refuses what it cannot use before it works, names it, and leaves every file as it was.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::Path;

use crate::common::{run, scratch, snapshot};
use tempfile::TempDir;

/// A canonical log of joints that swing, as text.
fn log(joints: usize, rows: usize) -> String {
    let names =
        ["q", "dq", "tau_J"].map(|stem| (0..joints).map(|j| format!("{stem}_{j}")).collect::<Vec<_>>().join(","));
    let line = |row: usize| {
        let time_s = row as f64 * 1e-3;
        let of_joint =
            |f: fn(f64) -> f64| (0..joints).map(|_| format!("{:.6}", f(time_s))).collect::<Vec<_>>().join(",");
        format!(
            "{time_s:.3},{},{},{}\n",
            of_joint(|t| 0.25 + 0.1 * t.sin()),
            of_joint(|t| 0.1 * t.cos()),
            of_joint(|_| 0.25)
        )
    };
    format!("time,{}\n{}", names.join(","), (0..rows).map(line).collect::<String>())
}

const MODEL: &str = "schema: tribo.model/1\nrobot: panda\n";

/// A directory with good and bad inputs.
fn inputs() -> TempDir {
    let at = scratch();
    let write = |name: &str, content: &str| std::fs::write(at.path().join(name), content).unwrap();
    write("good.csv", &log(7, 3000));
    write("other.csv", &log(7, 3001));
    write("six.csv", &log(6, 3000));
    write("two_rows.csv", &log(7, 2));
    write("header_only.csv", &log(7, 0));
    write("garbage.csv", "this is no log\n1,2,3\n");
    write("nan.csv", &log(7, 30).replacen("0.250100", "NaN", 1));
    write("m.yaml", MODEL);
    write("bad.yaml", &MODEL.replace("panda", "puma"));
    write("unknown_key.yaml", &format!("{MODEL}colour: red\n"));
    write("notes.txt", "my notes\n");
    write("page.html", "<!DOCTYPE html><p>old\n");
    std::fs::create_dir(at.path().join("folder")).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink("good.csv", at.path().join("link.csv")).unwrap();
    at
}

/// Every complaint about a call that must be refused with exit code 2, silent on standard output, changing nothing.
fn complaints(at: &Path, arguments: &str, needles: &[&str]) -> Option<String> {
    let before = snapshot(at);
    let run = run(at, &format!("diagnose {arguments}"));
    let told = needles.iter().all(|needle| run.stderr.contains(needle));
    let fine = run.code == Some(2) && run.stdout.is_empty() && told && snapshot(at) == before;
    (!fine).then(|| format!("diagnose {arguments}: needs {needles:?}\n  {run:?}"))
}

#[track_caller]
fn refuse_all(cases: &[(&str, &[&str])]) {
    let at = inputs();
    let failures: Vec<String> =
        cases.iter().filter_map(|(arguments, needles)| complaints(at.path(), arguments, needles)).collect();
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn logs_and_models() {
    refuse_all(&[
        ("", &["<LOG>..."]),
        ("nowhere.csv", &["nowhere.csv: no such file or directory"]),
        ("good.csv nowhere.csv", &["nowhere.csv: no such file or directory"]),
        ("good.csv --validate nowhere.csv", &["nowhere.csv: no such file or directory"]),
        ("folder", &["folder: unknown format"]),
        ("garbage.csv", &["garbage.csv: unknown format"]),
        ("six.csv", &["six.csv: 6 joints; say which robot that is: --robot NAME"]),
        ("good.csv --validate six.csv", &["six.csv: 6 joints; the model has 7"]),
        ("nan.csv", &["nan.csv:", "column q_0: `NaN` is not a finite decimal number"]),
        ("header_only.csv", &["header_only.csv", "row"]),
        ("two_rows.csv", &["two_rows.csv"]),
        ("good.csv good.csv", &["good.csv: is given twice"]),
        ("good.csv ./good.csv", &["./good.csv: is given twice"]),
        ("good.csv --validate good.csv", &["good.csv: validates nothing, the log is given already"]),
        ("good.csv --model nowhere.yaml", &["nowhere.yaml: No such file or directory"]),
        ("good.csv --model folder", &["folder: Is a directory"]),
        ("good.csv --model bad.yaml", &["bad.yaml:2: field `robot` is puma; allowed: "]),
        ("good.csv --model unknown_key.yaml", &["unknown_key.yaml:3:1: ", "`colour`"]),
        ("good.csv --model good.csv", &["good.csv:"]),
        ("good.csv --model m.yaml --torque-side link", &["--model", "--torque-side"]),
    ]);
}

#[test]
fn values() {
    refuse_all(&[
        ("good.csv --band-hz 0", &["--band-hz is 0; allowed: greater than 0"]),
        ("good.csv --band-hz -4", &["--band-hz is -4; allowed: greater than 0"]),
        ("good.csv --band-hz nan", &["--band-hz is NaN; allowed: greater than 0"]),
        ("good.csv --band-hz inf", &["--band-hz is inf; allowed: greater than 0"]),
        ("good.csv --seed -1", &["'-1'", "--seed"]),
        ("good.csv --seed many", &["'many'", "--seed"]),
        ("good.csv --torque-side top", &["top", "--torque-side", "motor", "link"]),
    ]);
}

#[test]
fn targets() {
    refuse_all(&[
        ("good.csv --extend folder", &["--extend folder: is a directory"]),
        ("good.csv --report folder", &["--report folder: is a directory"]),
        ("good.csv --trajectory folder", &["--trajectory folder: is a directory"]),
        ("good.csv --extend good.csv", &["--extend good.csv: is a log to be read; it is left untouched"]),
        ("good.csv --report ./good.csv", &["--report ./good.csv: is a log to be read; it is left untouched"]),
        ("good.csv --validate other.csv --report other.csv", &["--report other.csv: is a log to be read"]),
        ("good.csv --extend other.csv", &["--extend other.csv: exists and is no model file; it is left untouched"]),
        ("good.csv --trajectory m.yaml", &["--trajectory m.yaml: exists and is no trajectory file"]),
        ("good.csv --report notes.txt", &["--report notes.txt: exists and is no HTML file; it is left untouched"]),
        ("good.csv --model m.yaml --extend m.yaml", &["--extend m.yaml: is the model that the log is held against"]),
        (
            "good.csv --extend new.yaml --trajectory new.yaml",
            &["--trajectory new.yaml: is the target of another option"],
        ),
        ("good.csv --extend nowhere/m.yaml", &["nowhere: no such file or directory"]),
        ("good.csv --report notes.txt/r.html", &["notes.txt: is not a directory"]),
        ("two_rows.csv --report r.html --extend x.yaml", &["two_rows.csv"]),
    ]);
    #[cfg(unix)]
    refuse_all(&[
        ("good.csv link.csv", &["link.csv: is given twice"]),
        ("good.csv --report link.csv", &["--report link.csv: is a log to be read; it is left untouched"]),
        ("good.csv --report /dev/null", &["--report /dev/null: is not a regular file"]),
    ]);
}
