//! The examples of the library crates run, and print what their readers are told to expect.
//!
//! They are the binaries that a build of the whole workspace leaves; where somebody builds this crate alone they are not there, and
//! the test says so. What is expected is closed form, or the figure of another test.

use std::path::PathBuf;
use std::process::Command;

/// Example, and parts of what it prints.
const EXAMPLES: &[(&str, &[&str])] = &[];

/// Examples of this profile: beside `deps`, where this program lies.
fn folder() -> PathBuf {
    let this = std::env::current_exe().expect("a running program has a path");
    this.parent().and_then(|deps| deps.parent()).expect("deps lies in the folder of the profile").join("examples")
}

#[test]
fn examples_print_what_they_promise() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let mut wrong = Vec::new();
    for (example, parts) in EXAMPLES {
        let binary = folder().join(format!("{example}{}", std::env::consts::EXE_SUFFIX));
        if !binary.is_file() {
            println!("SKIPPED {example}: not built; `cargo test --release --workspace` builds it");
            continue;
        }
        let output = Command::new(&binary).current_dir(scratch.path()).output().expect("an example can be started");
        let printed = String::from_utf8_lossy(&output.stdout);
        if !output.status.success() {
            wrong.push(format!("{example}: {}", String::from_utf8_lossy(&output.stderr)));
        }
        for part in parts.iter().filter(|part| !printed.contains(**part)) {
            wrong.push(format!("{example} does not print {part:?} but\n{printed}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
