//! Story: what a file of somebody else holds is shown on the terminal, and not obeyed by it.
//!
//! ESC, the C1 controls (U+009B begins a command, too), carriage returns and marks that turn the direction of writing stand in names of
//! columns, topics, robots, joints and in YAML. No stream of any command has one of them.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::Path;

use crate::common::{Run, run, scratch};

/// Clears the screen, colours, goes back to the start of the line, turns the direction of writing.
const HOSTILE: &str = "\u{1b}[2J\u{9b}31m\r\u{202e}x";

#[track_caller]
fn harmless(run: &Run) {
    let obeyed = |letter: char| (letter.is_control() && letter != '\n') || letter == '\u{202e}';
    for stream in [&run.stdout, &run.stderr] {
        assert!(!stream.chars().any(obeyed), "{stream:?}");
    }
}

fn write(at: &Path, name: &str, content: &str) {
    std::fs::write(at.join(name), content).unwrap();
}

#[test]
fn no_name_is_obeyed() {
    let at = scratch();
    let at = at.path();
    let joints = |stem: &str| (0..7).map(|j| format!("{stem}_{j}")).collect::<Vec<_>>().join(",");
    let header = format!("time,{},{},{}", joints("q"), joints("dq"), joints("tau_J"));
    let rows: String = (0..3).map(|k| format!("{}{}\n", f64::from(k) * 1e-3, ",0".repeat(21))).collect();
    let wide: String = rows.lines().map(|row| format!("{row},1\n")).collect();

    // A column that nobody knows is named in the summary, one that is missing in an error, a cell in another.
    write(at, "odd.csv", &format!("{header},{HOSTILE}\n{wide}"));
    let summary = run(at, "convert odd.csv out.parquet").ok();
    harmless(&summary);
    assert!(summary.stdout.contains("not known    \\u{1b}[2J\\u{9b}31m"), "{summary:?}");
    let document = run(at, "convert odd.csv out.parquet --json").ok();
    harmless(&document);
    document.json();
    write(at, "missing.csv", &format!("time,q_0,dq_0,{HOSTILE}\n0,1,2,3\n"));
    write(at, "cell.csv", &format!("{header}\n{HOSTILE}{}\n", ",0".repeat(21)));
    write(at, "garbage.log", HOSTILE);

    write(
        at,
        "robot.yaml",
        &format!(
            "schema: tribo.model/1\nrobot: \"{}\"\n",
            HOSTILE
                .escape_default()
                .to_string()
                .replace("\\u{1b}", "\\e")
                .replace("\\u{9b}", "\\x9b")
                .replace("\\u{202e}", "\\u202e")
        ),
    );
    write(at, "key.yaml", &format!("schema: tribo.model/1\nrobot: panda\n{HOSTILE}: 1\n"));
    write(at, "arm.urdf", &format!("<robot name=\"r\"><link name=\"{}\"/></robot>", "\u{9b}2J"));
    write(at, "arm2.urdf", "<robot name=\"r\"><link name=\"a\u{202e}b\"/><link name=\"c\"/></robot>");
    for call in [
        "estimate missing.csv",
        "estimate cell.csv",
        "estimate garbage.log",
        "estimate odd.csv --model robot.yaml",
        "estimate odd.csv --model key.yaml",
        "simulate --robot arm.urdf",
        "simulate --robot arm2.urdf",
        "simulate robot.yaml",
        "export key.yaml --format c",
    ] {
        let refused = run(at, call);
        assert_eq!(refused.code, Some(2), "{call}: {refused:?}");
        harmless(&refused);
    }
    assert!(
        run(at, "simulate --robot arm.urdf").stderr.contains("the name of link `\\u{9b}2J` has a control character")
    );
}
