//! Instructions per tick, counted by valgrind: the one measure of speed that does not depend on what else a computer does.
//!
//! ```text
//! instructions per tick = (count of 2000 ticks − count of 1000 ticks) / 1000        start and end cancel
//! ```
//!
//! Fails at 20 % more than `recorded.json` holds for the profile it was compiled with. After a change that is meant,
//! `TRIBO_RECORD_INSTRUCTIONS=1 cargo test --release -p tribo-tests --test callgrind` writes the new figures there. Without valgrind it says SKIPPED.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;
use std::process::Command;

const FEWER: u64 = 1000;
const MORE: u64 = 2000;
/// What a figure may grow before somebody must look.
const MARGIN: f64 = 0.20;

/// Figures by profile, then by what is counted.
type Recorded = BTreeMap<String, BTreeMap<String, u64>>;

/// What the binary was compiled with: the settings of the workspace, unless the environment had others.
fn profile() -> String {
    let lto = option_env!("CARGO_PROFILE_RELEASE_LTO").unwrap_or("off");
    let units = option_env!("CARGO_PROFILE_RELEASE_CODEGEN_UNITS").unwrap_or("1");
    let vectors = if cfg!(target_feature = "avx2") { ", AVX2" } else { "" };
    format!("release, lto {lto}, {units} codegen units, {}{vectors}", std::env::consts::ARCH)
}

fn file() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("callgrind/recorded.json")
}

/// Instructions of a whole run; none where valgrind does not know the processor that we are compiled for.
fn instructions(what: &str, count: u64) -> Option<u64> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null", env!("CARGO_BIN_EXE_ticks"), what])
        .arg(count.to_string())
        .output()
        .expect("valgrind runs");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    if said.contains("SIGILL") {
        return None;
    }
    assert!(output.status.success(), "{said}");
    let line = said.lines().find_map(|line| line.split_once("Collected :")).expect("callgrind's summary");
    Some(line.1.trim().parse().expect("a number"))
}

fn per_tick(what: &str) -> Option<u64> {
    Some((instructions(what, MORE)? - instructions(what, FEWER)?) / (MORE - FEWER))
}

/// Past the capture of the test harness.
#[allow(clippy::explicit_write, reason = "eprintln! is captured, this is not")]
fn say(text: &str) {
    writeln!(std::io::stderr(), "{text}").expect("standard error");
}

/// Whether `counted` is more than a fifth above `recorded`.
fn too_many(counted: u64, recorded: u64) -> bool {
    counted as f64 > recorded as f64 * (1.0 + MARGIN)
}

#[test]
fn a_tick_takes_no_more_instructions_than_recorded() {
    if cfg!(debug_assertions) {
        return say("SKIPPED: instructions are counted in release builds");
    }
    if Command::new("valgrind").arg("--version").output().is_err() {
        return say("SKIPPED: no valgrind");
    }
    let text = std::fs::read_to_string(file()).expect("recorded.json");
    let mut recorded: Recorded = serde_json::from_str(&text).expect("figures by profile");
    let mut counted = BTreeMap::new();
    for what in ["tick", "period"] {
        let Some(count) = per_tick(what) else { return say("SKIPPED: valgrind does not know these instructions") };
        counted.insert(what.to_owned(), count);
    }
    if std::env::var_os("TRIBO_RECORD_INSTRUCTIONS").is_some() {
        recorded.insert(profile(), counted);
        let text = serde_json::to_string_pretty(&recorded).expect("JSON") + "\n";
        return std::fs::write(file(), text).expect("a writable file");
    }
    let Some(before) = recorded.get(&profile()) else {
        return say(&format!("SKIPPED: no figures for {}; counted {counted:?}", profile()));
    };
    for (what, count) in &counted {
        let before = before.get(what).copied().expect("a figure for each");
        assert!(
            !too_many(*count, before),
            "{what}: {count} instructions, recorded {before}: more than {:.0} % above. If that is meant, record it (see the head of this file)",
            100.0 * MARGIN
        );
        say(&format!("{what}: {count} instructions, recorded {before}"));
    }
}

#[test]
fn a_fifth_more_is_too_many() {
    assert!(!too_many(1000, 1000) && !too_many(1200, 1000) && too_many(1201, 1000));
}
