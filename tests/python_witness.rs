//! Programs in Python as independent witnesses of our numbers; test binaries of several crates include this file.

use std::io::Write;
use std::process::{Command, Stdio};

use serde_json::Value;

/// A Python that imports `modules`, separated by commas (`TRIBO_PYTHON`, else `python3` on the path); says loudly what is
/// untested without.
#[allow(clippy::explicit_write, reason = "eprintln! is captured, this is not")]
pub fn python(modules: &str, untested: &str) -> Option<String> {
    let python = std::env::var("TRIBO_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let mut probe = Command::new(&python);
    probe.args(["-c", &format!("import {modules}")]).stdout(Stdio::null()).stderr(Stdio::null());
    if probe.status().is_ok_and(|status| status.success()) {
        return Some(python);
    }
    writeln!(std::io::stderr(), "SKIPPED: no Python with {modules} (set TRIBO_PYTHON); {untested}").expect("stderr");
    None
}

/// What a script prints as JSON, which finds the question as JSON in the file that is its argument. Infinite numbers are null.
#[track_caller]
pub fn answer(python: &str, script: &str, question: &Value) -> Value {
    let mut file = tempfile::NamedTempFile::new().expect("a file");
    file.write_all(question.to_string().as_bytes()).expect("written");
    let output = Command::new(python).args(["-c", script]).arg(file.path()).output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// The numbers of a list.
#[track_caller]
pub fn numbers(list: &Value) -> Vec<f64> {
    list.as_array().expect("a list").iter().map(|number| number.as_f64().expect("a number")).collect()
}
