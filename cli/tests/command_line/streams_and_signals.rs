//! Story: pipes, full disks and Ctrl-C around a command.
//!
//! ```text
//! standard output cannot be written    exit code 2 and why; a reader that has gone is no error
//! standard error cannot be written     nobody can be told, the work is done all the same
//! Ctrl-C before what was asked for     exit code 130
//! a log that comes through a pipe      others ask and tell meanwhile
//! ```

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]
#![cfg(target_os = "linux")]

use std::fs::{File, OpenOptions};
use std::path::Path;
use std::process::{Command, Stdio};

use crate::common::{Run, finished, run, scratch, start, tribo, wait_until};

fn full() -> File {
    OpenOptions::new().write(true).open("/dev/full").unwrap()
}

fn on_full_output(at: &Path, arguments: &str) -> Run {
    let mut command = tribo(at, arguments.split_whitespace());
    command.stdout(full()).stderr(Stdio::piped()).output().unwrap().into()
}

#[test]
fn output_that_does_not_arrive_is_an_error() {
    let at = scratch();
    run(at.path(), "tune --trials 1 --strategy zero --quiet --out c").ok();
    let calls = [
        "",
        "--help",
        "--version",
        "tune --help",
        "man",
        "completions bash",
        "simulate --json",
        "tune --trials 1 --strategy zero --json --out other",
        "export c --format c",
        "report c --json",
        "ask mine",
    ];
    for arguments in calls {
        let answer = on_full_output(at.path(), arguments);
        assert_eq!(answer.code, Some(2), "`tribo {arguments}`: {answer:?}");
        assert!(answer.stderr.contains("tribo: standard output: No space left on device"), "{arguments}: {answer:?}");
    }
    // What was done is done.
    assert_eq!(finished(&at.path().join("other")), 1);
    assert_eq!(run(at.path(), "ask mine --json -q").ok().json()["running"], serde_json::json!([0, 1]));
}

#[test]
fn messages_that_nobody_reads_stop_nothing() {
    let at = scratch();
    run(at.path(), "tune --trials 1 --strategy zero --quiet --out c").ok();
    let calls = [
        ("tune --trials 1 --strategy zero --out other", 0),
        ("tune --trials 1 --strategy zero --residual momentum --out another", 0),
        ("export c --format urdf", 0),
        ("ask mine", 0),
        ("tune --resume --out nowhere", 2),
        ("tune --no-such-flag", 2),
        ("report c/campaign.yaml", 2),
    ];
    for (arguments, code) in calls {
        let mut command = tribo(at.path(), arguments.split_whitespace());
        let output = command.stdout(Stdio::piped()).stderr(full()).output().unwrap();
        assert_eq!(output.status.code(), Some(code), "`tribo {arguments}`");
        assert_eq!(output.stdout.is_empty(), code != 0, "`tribo {arguments}`");
    }
}

/// `eprintln!` panics where standard error cannot be written; `message!` does not.
#[test]
fn no_message_can_panic() {
    let mut directories = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("src")];
    let mut files = 0;
    while let Some(directory) = directories.pop() {
        for entry in std::fs::read_dir(directory).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                directories.push(path);
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap();
            assert!(!text.contains("println!") && !text.contains("eprint!"), "{}", path.display());
            files += 1;
        }
    }
    assert!(files > 20);
}

fn interrupted(at: &Path, arguments: &str, when: impl FnMut() -> bool) -> Run {
    let child = start(at, arguments);
    wait_until("the command is at work", when);
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    child.wait_with_output().unwrap().into()
}

#[test]
fn ctrl_c_before_the_answer_is_130() {
    let at = scratch();
    let campaign = at.path().join("c");
    let stopped =
        interrupted(at.path(), "tune --trials 200 --strategy zero --check 9 --out c", || finished(&campaign) > 0);
    assert_eq!((stopped.code, stopped.stdout.as_str()), (Some(130), ""), "{stopped:?}");
    assert!(stopped.stderr.contains("go on with: tribo tune --resume --out c"), "{stopped:?}");

    let study = "schema: tribo.study/1\nseeds: 200\ncases:\n- {truth: coulomb_viscous, friction: coulomb_viscous}\n\
                 strategies:\n- {strategy: zero, trials: 2}\noracle_runs: 1\n";
    std::fs::write(at.path().join("study.yaml"), study).unwrap();
    let cells = at.path().join("study/cells");
    let done = || std::fs::read_dir(&cells).is_ok_and(|mut cells| cells.next().is_some());
    let stopped = interrupted(at.path(), "study study.yaml", done);
    assert_eq!((stopped.code, stopped.stdout.as_str()), (Some(130), ""), "{stopped:?}");
    assert!(stopped.stderr.contains("every finished cell is kept"), "{stopped:?}");
}

#[test]
fn a_log_that_is_waited_for_holds_nobody_up() {
    let at = scratch();
    run(at.path(), "ask mine --strategy sobol --trials 9 -q").ok();
    assert!(Command::new("mkfifo").arg(at.path().join("pipe")).status().unwrap().success());
    let mut waiting = start(at.path(), "tell mine pipe");
    // Long enough to have opened the campaign, had it done so.
    std::thread::sleep(std::time::Duration::from_millis(500));
    assert!(waiting.try_wait().unwrap().is_none(), "it does not wait");
    let mut asking = start(at.path(), "ask mine -q");
    wait_until("somebody else may ask", || asking.try_wait().unwrap().is_some());
    assert!(asking.wait().unwrap().success());
    waiting.kill().unwrap();
    waiting.wait().unwrap();
}

#[test]
fn a_report_replaces_reports_alone() {
    let at = scratch();
    run(at.path(), "tune --trials 1 --strategy zero --quiet --out c").ok();
    std::fs::write(at.path().join("notes.html"), "<!doctype html><title>tribo</title>mine").unwrap();
    let refused = run(at.path(), "report c --out notes.html");
    assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""), "{refused:?}");
    assert!(refused.stderr.contains("notes.html: is there and no report of a campaign"), "{refused:?}");
    assert_eq!(
        std::fs::read_to_string(at.path().join("notes.html")).unwrap(),
        "<!doctype html><title>tribo</title>mine"
    );
    for _ in 0..2 {
        run(at.path(), "report c --out page.html -q").ok();
    }
}

#[test]
fn threads_have_a_range() {
    let at = scratch();
    for threads in ["1025", "99999999", "two"] {
        let refused = run(at.path(), &format!("simulate --threads {threads}"));
        assert_eq!(refused.code, Some(2), "{refused:?}");
        assert!(refused.stderr.contains("--threads"), "{refused:?}");
    }
    run(at.path(), "simulate --threads 3 -q").ok();
}
