//! Story: a stranger works through docs/tutorials and sees what the pages say.
//!
//! A tutorial is a transcript. Every block fenced as `sh` is run with `sh -eu`, all blocks of a page in one directory, one after the
//! other; where a block fenced as `text` follows, it is what standard output must be:
//!
//! ```text
//! … in a line              any text within the line, or none
//! a line that is only …    any number of lines, or none
//! spaces                   a run of them counts as one; at the end of a line, and of the output, nothing counts
//! ```
//!
//! `<!-- needs: … -->` before a block says what not everybody has: `display`, `network`, `pylibfranka`, `slurm` or `TRIBO_DATA`. Where it is not
//! there, the block is SKIPPED. Blocks find the binary as `tribo`, the repository in `TRIBO_REPOSITORY`, logs of real robots
//! in `TRIBO_DATA` (default: ../shared/data beside the workspace).

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::common::{Run, scratch, skipped, slurm_can_start};

/// A block of commands and what it prints.
#[derive(Debug, PartialEq)]
struct Block {
    /// Line of the page at which it begins, from 1.
    line: usize,
    need: Option<String>,
    script: String,
    output: Option<String>,
}

/// The blocks of a page, in order.
fn blocks(page: &str) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut need = None;
    // Whether only empty lines lie between the last block of commands and here.
    let mut follows = false;
    let mut lines = (1..).zip(page.lines());
    while let Some((line, text)) = lines.next() {
        if let Some(language) = text.strip_prefix("```") {
            let body: Vec<&str> = lines.by_ref().map(|(_, text)| text).take_while(|text| *text != "```").collect();
            if language == "sh" {
                blocks.push(Block { line, need: need.take(), script: body.join("\n"), output: None });
            } else if language == "text"
                && follows
                && let Some(last) = blocks.last_mut()
            {
                last.output = Some(body.join("\n"));
            }
            (need, follows) = (None, language == "sh");
        } else if let Some(named) = text.strip_prefix("<!-- needs: ").and_then(|rest| rest.strip_suffix(" -->")) {
            (need, follows) = (Some(named.to_owned()), false);
        } else if !text.trim().is_empty() {
            (need, follows) = (None, false);
        }
    }
    blocks
}

/// The lines of a text as they are compared.
fn lines(text: &str) -> Vec<String> {
    text.trim_end().lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect()
}

/// Whether a line is what the pattern says, `…` being any text.
fn line_matches(pattern: &str, line: &str) -> bool {
    let Some((start, rest)) = pattern.split_once('…') else { return pattern == line };
    let Some(mut left) = line.strip_prefix(start) else { return false };
    let (between, end) = rest.rsplit_once('…').map_or((None, rest), |(between, end)| (Some(between), end));
    for part in between.into_iter().flat_map(|between| between.split('…')) {
        let Some((_, behind)) = left.split_once(part) else { return false };
        left = behind;
    }
    left.ends_with(end)
}

/// The first expected line that is not there, however `…` before it is read; one past the last if there is more than
/// expected.
fn first_missing(expected: &[String], actual: &[String]) -> Option<usize> {
    // How many actual lines the expected ones so far may stand for.
    let mut taken = BTreeSet::from([0]);
    for (k, pattern) in expected.iter().enumerate() {
        taken = if pattern == "…" {
            taken.first().into_iter().flat_map(|least| *least..=actual.len()).collect()
        } else {
            let is_next = |at: &&usize| actual.get(**at).is_some_and(|line| line_matches(pattern, line));
            taken.iter().filter(is_next).map(|at| at + 1).collect()
        };
        if taken.is_empty() {
            return Some(k);
        }
    }
    (!taken.contains(&actual.len())).then_some(expected.len())
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

fn data() -> PathBuf {
    let beside = || repository().join("../shared/data");
    std::path::absolute(std::env::var_os("TRIBO_DATA").map_or_else(beside, PathBuf::from)).unwrap()
}

/// The Python with other people's programs, which blocks call `python3`.
fn python() -> PathBuf {
    std::env::var_os("TRIBO_PYTHON").map_or_else(|| PathBuf::from("python3"), PathBuf::from)
}

/// Why a block with this need cannot be run here.
fn unmet(need: &str) -> Option<&'static str> {
    match need {
        "display" => Some("somebody has to close the window again"),
        "network" => Some("a test downloads nothing"),
        "TRIBO_DATA" => {
            (!data().join("panda_gaz2019").is_dir()).then_some("no panda_gaz2019 under $TRIBO_DATA or ../shared/data")
        }
        "slurm" => slurm_can_start().err(),
        "pylibfranka" => {
            let mut probe = Command::new(python());
            probe.args(["-c", "import pylibfranka"]).stdout(Stdio::null()).stderr(Stdio::null());
            (!probe.status().is_ok_and(|status| status.success()))
                .then_some("no Python with pylibfranka (set TRIBO_PYTHON)")
        }
        other => panic!("needs: {other}; allowed: display, network, pylibfranka, slurm, TRIBO_DATA"),
    }
}

/// Runs a block in directory `at`, with the programs in `bin` before all others.
fn run(block: &Block, at: &Path, bin: &Path) -> Run {
    let mut command = if block.need.as_deref() == Some("slurm") {
        let mut cluster = Command::new(repository().join("cli/tests/slurm/cluster.sh"));
        cluster.arg(at.join("cluster")).arg("sh");
        cluster
    } else {
        Command::new("sh")
    };
    command
        .args(["-euc", &block.script])
        .env("PATH", format!("{}:{}", bin.display(), std::env::var("PATH").unwrap()))
        .env("TRIBO_REPOSITORY", repository())
        .env("TRIBO_DATA", data())
        .current_dir(at)
        .stdin(Stdio::null())
        .output()
        .unwrap()
        .into()
}

/// Works through a page.
///
/// # Errors
/// The first block that fails or prints something else.
fn follow(page: &Path, bin: &Path) -> Result<(), String> {
    let at = scratch();
    let followed = follow_in(at.path(), page, bin);
    // A page that is left half-way has a robot running, whose port the next one needs.
    if let (Err(_), Ok(robot)) = (&followed, std::fs::read_to_string(at.path().join("robot.pid"))) {
        Command::new("kill").arg(robot.trim()).status().unwrap();
    }
    followed
}

fn follow_in(at: &Path, page: &Path, bin: &Path) -> Result<(), String> {
    for block in blocks(&std::fs::read_to_string(page).unwrap()) {
        let place = format!("{}:{}", page.display(), block.line);
        if let Some(why) = block.need.as_deref().and_then(unmet) {
            skipped(&format!("{place}: {why}"));
            continue;
        }
        let run = run(&block, at, bin);
        let printed = format!("standard output:\n{}\nstandard error:\n{}", run.stdout, run.stderr);
        if run.code != Some(0) {
            return Err(format!("{place}: exit code {:?}\n{}\n{printed}", run.code, block.script));
        }
        let Some(expected) = block.output.as_deref().map(lines) else { continue };
        if let Some(k) = first_missing(&expected, &lines(&run.stdout)) {
            let wanted = expected.get(k).map_or("the end", String::as_str);
            return Err(format!("{place}: {}\nshould print, and does not: {wanted}\n{printed}", block.script));
        }
    }
    Ok(())
}

/// Works through `docs/tutorials/PAGE`.
fn work_through(page: &str) {
    let bin = scratch();
    let binary = std::env::var_os("TRIBO_BIN").unwrap_or_else(|| env!("CARGO_BIN_EXE_tribo").into());
    std::os::unix::fs::symlink(std::path::absolute(binary).unwrap(), bin.path().join("tribo")).unwrap();
    if let Some(python) = std::env::var_os("TRIBO_PYTHON") {
        let script = bin.path().join("python3");
        std::fs::write(&script, format!("#!/bin/sh\nexec '{}' \"$@\"\n", Path::new(&python).display())).unwrap();
        std::fs::set_permissions(&script, std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    }
    if let Err(wrong) = follow(&repository().join("docs/tutorials").join(page), bin.path()) {
        panic!("{wrong}");
    }
}

/// Every page, and the test that works through it: one after the other they would outlast all other stories.
macro_rules! pages {
    ($($page:literal in $story:ident;)+) => {
        const PAGES: &[&str] = &[$($page),+];
        $(
            #[test]
            fn $story() {
                work_through($page);
            }
        )+
    };
}

pages! {
    "1_tune.md" in a_first_campaign;
    "2_diagnose.md" in a_log_is_diagnosed;
    "3_your_robot.md" in your_own_robot;
    "4_study.md" in a_study;
    "5_libfranka.md" in libfranka_without_a_robot;
    "6_your_franka.md" in your_franka;
}

#[test]
fn every_page_is_worked_through() {
    let entries = std::fs::read_dir(repository().join("docs/tutorials")).unwrap().map(|entry| entry.unwrap().path());
    let pages = entries.filter(|path| path.extension().is_some_and(|kind| kind == "md"));
    let mut pages: Vec<String> = pages.map(|path| path.file_name().unwrap().to_str().unwrap().to_owned()).collect();
    pages.sort();
    assert_eq!(pages, PAGES);
}

#[test]
fn a_page_is_cut_into_commands_and_what_they_print() {
    let page = "# 1\n```text\na picture\n```\n\n<!-- needs: slurm -->\n```sh\ntrue\nfalse\n```\n\n```text\none\n\ntwo\n```\n\
                ```sh\nls\n```\nno more\n```text\nof another\n```\n<!-- needs: display -->\nwords\n```sh\nmake\n```\n";
    let block = |line, need: Option<&str>, script: &str, output: Option<&str>| Block {
        line,
        need: need.map(str::to_owned),
        script: script.to_owned(),
        output: output.map(str::to_owned),
    };
    let wanted = [
        block(7, Some("slurm"), "true\nfalse", Some("one\n\ntwo")),
        block(17, None, "ls", None),
        block(26, None, "make", None),
    ];
    assert_eq!(blocks(page), wanted);
}

#[test]
fn an_ellipsis_is_any_text_within_a_line() {
    for (pattern, line) in [
        ("J 2.9…", "J 2.941"),
        ("J 2.9…", "J 2.9"),
        ("…", ""),
        ("5 trials in … s; written …/tuned.yaml", "5 trials in 1.2 s; written a b/tuned.yaml"),
        ("[…, …]", "[0.1, 0.2]"),
        ("a…b…b", "abb"),
    ] {
        assert!(line_matches(pattern, line), "{pattern} | {line}");
    }
    for (pattern, line) in [
        ("J 2.9…", "J 3.0"),
        ("J 2.941", "J 2.942"),
        ("in … s", "in 3 ms."),
        ("ab…ba", "aba"),
        ("a…b…b", "ab"),
        ("…done", "done."),
    ] {
        assert!(!line_matches(pattern, line), "{pattern} | {line}");
    }
}

#[test]
fn a_line_of_an_ellipsis_is_any_number_of_lines_and_a_wrong_one_is_found() {
    let missing = |expected: &str, actual: &str| first_missing(&lines(expected), &lines(actual));
    assert_eq!(missing(" a   b\nc", "a b  \n  c\n\n"), None);
    assert_eq!(missing("a\n…\nb", "a\nb"), None);
    assert_eq!(missing("a\n…\nb", "a\nb\nx\n\nb"), None);
    assert_eq!(missing("a\n…", "a"), None);
    assert_eq!(missing("…\nb\n…\nd", "a\nb\nc\nd"), None);

    assert_eq!(missing("a\nb", "a\nc"), Some(1));
    assert_eq!(missing("a\nb", "a"), Some(1));
    assert_eq!(missing("a", "a\nb"), Some(1));
    assert_eq!(missing("a\n…\nb", "a\nb\nx"), Some(3));
    assert_eq!(missing("a\n…\nb\nc", "a\nb\nd"), Some(3));
    assert_eq!(missing("a\n…\nb\nc", "a\nx"), Some(2));
    assert_eq!(missing("", "a"), Some(0));
}
