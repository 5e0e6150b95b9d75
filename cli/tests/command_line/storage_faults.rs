//! Story: the place where files go fails, in the middle of a campaign, and nothing that was finished is lost.
//!
//! A full disk is a limit on the size of files here (`ulimit -f`, with its signal ignored: a write beyond it fails half done, as on a
//! full disk). Whatever fails, the message names the file, the exit code is 2, no half-written file stays, and once there is room
//! again `tune --resume` ends with the result of an undisturbed run.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]
#![cfg(target_os = "linux")]

use std::path::Path;
use std::process::Command;

use crate::common::{Run, finished, result, run, scratch, skipped, snapshot, strangers};

const CAMPAIGN: &str = "--trials 4 --strategy grey_box --seed 9";

/// `tribo` with files of at most `bytes`, a multiple of 512.
fn with_room_for(bytes: u64, at: &Path, arguments: &str) -> Run {
    let script = "trap '' XFSZ; ulimit -f $0; exec \"$@\"";
    let output = Command::new("sh")
        .args(["-c", script, &(bytes / 512).to_string(), env!("CARGO_BIN_EXE_tribo")])
        .args(arguments.split_whitespace())
        .current_dir(at)
        .output()
        .unwrap();
    output.into()
}

fn refused(answer: &Run, file: &str) {
    assert_eq!(answer.code, Some(2), "{answer:?}");
    assert!(answer.stderr.contains(file) && !answer.stderr.contains("panicked"), "{answer:?}");
}

#[test]
fn the_disk_fills_up_in_a_campaign() {
    let at = scratch();
    let whole = run(at.path(), &format!("tune {CAMPAIGN} --json --out whole")).ok().json();
    let log_bytes = std::fs::metadata(at.path().join("whole/trials/0000.parquet")).unwrap().len();

    // Not even the settings find room: no campaign has begun, and the next one may.
    refused(&with_room_for(512, at.path(), &format!("tune {CAMPAIGN} --out c")), "c/campaign.yaml");
    assert!(!at.path().join("c/campaign.yaml").exists());
    // Room for the journal, not for the log of a trial: that trial is not finished.
    refused(
        &with_room_for(log_bytes / 1024 * 512, at.path(), &format!("tune {CAMPAIGN} --out c")),
        "c/trials/0000.parquet",
    );
    assert_eq!(finished(&at.path().join("c")), 0);
    assert_eq!(strangers(&at.path().join("c")), Vec::<std::path::PathBuf>::new());

    // The journal of two trials, and room for a few letters more: the line that fails is cut in two.
    run(at.path(), "tune --resume --trials 2 --quiet --out c").ok();
    let journal_bytes = std::fs::metadata(at.path().join("c/journal.log")).unwrap().len();
    let before = snapshot(&at.path().join("c"));
    refused(&with_room_for((journal_bytes + 600) / 512 * 512, at.path(), "tune --resume --trials 4 --out c"), "c/");
    assert_eq!(finished(&at.path().join("c")), 2);
    for (path, content) in before.iter().filter(|(path, _)| path.extension().is_some_and(|kind| kind == "parquet")) {
        assert!(std::fs::read(at.path().join("c").join(path)).unwrap() == *content, "{} has changed", path.display());
    }
    let resumed = run(at.path(), "tune --resume --trials 4 --json --out c").ok().json();
    assert_eq!(result(&resumed), result(&whole));
    assert_eq!(strangers(&at.path().join("c")), Vec::<std::path::PathBuf>::new());
}

/// What a command writes is there whole or not at all; what was there before stays.
#[test]
fn the_disk_fills_up_under_every_other_file() {
    let at = scratch();
    run(at.path(), "tune --trials 2 --seed 9 --quiet --out c").ok();
    run(at.path(), "simulate --log log.parquet --quiet").ok();
    for (arguments, file) in [
        ("simulate --log log.csv", "log.csv"),
        ("simulate --log log.mcap", "log.mcap"),
        ("convert log.parquet copy.csv.gz", "copy.csv.gz"),
        ("report c --out page.html", "page.html"),
        ("export c --format c --out friction.h", "friction.h"),
    ] {
        refused(&with_room_for(512, at.path(), arguments), file);
        assert!(!at.path().join(file).exists(), "{arguments} left half a file");
    }
    std::fs::write(at.path().join("friction.h"), "precious").unwrap();
    refused(&with_room_for(512, at.path(), "export c --format c --out friction.h"), "friction.h");
    assert_eq!(std::fs::read_to_string(at.path().join("friction.h")).unwrap(), "precious");
    let mut left: Vec<_> = snapshot(at.path()).into_keys().filter(|path| !path.starts_with("c")).collect();
    left.sort();
    assert_eq!(left, [Path::new("friction.h"), Path::new("log.parquet")]);
}

/// Somebody without the right to write, in a directory with a campaign: told so, nothing changes.
#[test]
fn the_directory_is_read_only() {
    let at = scratch();
    run(at.path(), "tune --trials 2 --seed 9 --quiet --out c").ok();
    let mode = |mode: &str| {
        assert!(Command::new("chmod").args(["-R", mode]).arg(at.path()).status().unwrap().success());
    };
    mode("a-w,a+rX");
    let before = snapshot(at.path());
    // The superuser may write everywhere: somebody else, where there is a way to be it.
    let as_nobody = |arguments: &str| -> Option<Run> {
        let mut command = match std::fs::write(at.path().join("c/x"), "") {
            Err(_) => Command::new(env!("CARGO_BIN_EXE_tribo")),
            Ok(()) => {
                std::fs::remove_file(at.path().join("c/x")).unwrap();
                let mut command = Command::new("setpriv");
                command.args(["--reuid=65534", "--regid=65534", "--clear-groups", env!("CARGO_BIN_EXE_tribo")]);
                command
            }
        };
        let output = command.args(arguments.split_whitespace()).current_dir(at.path()).output().ok()?;
        // 126 and 127: setpriv may not, or the binary is where only its owner may go.
        (!matches!(output.status.code(), Some(126 | 127 | 1))).then(|| output.into())
    };
    let cases = [
        ("tune --resume --trials 3 --out c", "c/"),
        ("tune --trials 1 --out fresh", "fresh"),
        ("export c --format c --out c/friction.h", "c: cannot create a file in this directory"),
        ("simulate --log c/log.csv", "c: cannot create a file in this directory"),
    ];
    for (arguments, file) in cases {
        match as_nobody(arguments) {
            None => skipped("cannot be anybody without the right to write"),
            Some(answer) => refused(&answer, file),
        }
    }
    let after = snapshot(at.path());
    mode("u+w");
    assert!(before == after, "something was written");
}
