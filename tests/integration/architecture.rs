//! Crates point one way (ARCHITECTURE.md, Direction), and files keep a friendly size.
//!
//! ```text
//! robot friction bayesopt files logs figure  ←  control ekf residual sim  ←  runtime regression  ←  posterior  ←  diagnose
//!     ←  model  ←  trial export fci ros2  ←  campaign  ←  watch bench experiments  ←  dashboard  ←  cli
//! ```
//!
//! The evidence is `cargo metadata`, the law is [`violations`], and the last test shows that every clause of it can fail.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde::Deserialize;

/// The table: a crate may use crates of a lower layer, and of its own layer only where [`SIDEWAYS`] says so.
const LAYERS: [&[&str]; 12] = [
    &["robot", "friction", "bayesopt", "files", "logs", "figure"],
    &["control", "ekf", "residual", "sim"],
    &["runtime", "regression"],
    &["posterior"],
    &["diagnose"],
    &["model"],
    &["trial", "export", "fci", "ros2"],
    &["campaign"],
    &["watch", "bench", "experiments"],
    &["dashboard"],
    &["cli"],
    &["python"],
];
/// Edges inside a layer.
const SIDEWAYS: [(&str, &str); 2] = [("friction", "robot"), ("logs", "files")];
/// Edges that point downwards and are forbidden all the same: the loop knows a robot and an estimator by trait only.
const FORBIDDEN: [(&str, &str); 3] = [("runtime", "sim"), ("runtime", "ekf"), ("runtime", "residual")];
/// Crates from outside and who may use them (prefix match where the name ends with `*`).
const RESERVED: [(&str, &[&str]); 9] = [
    ("pyo3", &["python"]),
    ("numpy", &["python"]),
    ("egui*", &["dashboard", "cli"]),
    ("eframe", &["dashboard", "cli"]),
    ("clap*", &["cli", "tests"]),
    ("faer*", &["bayesopt", "friction", "residual", "posterior"]),
    ("argmin*", &["bayesopt", "friction", "residual", "posterior"]),
    ("allocation-counter", &["tests"]),
    ("tribo-tests", &[]),
];
/// A file longer than this is split by noun.
const LONGEST_FILE: usize = 600;
/// The package of stories stands outside the table: it may use everything and nobody uses it.
const STORIES: &str = "tests";

#[derive(Clone, Debug, Deserialize)]
struct Metadata {
    packages: Vec<Package>,
    workspace_root: PathBuf,
}

#[derive(Clone, Debug, Deserialize)]
struct Package {
    name: String,
    manifest_path: PathBuf,
    dependencies: Vec<Dependency>,
}

#[derive(Clone, Debug, Deserialize)]
struct Dependency {
    name: String,
    /// `None` is a normal dependency; otherwise "dev" or "build".
    kind: Option<String>,
}

fn metadata() -> Metadata {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("cargo metadata is JSON")
}

/// The crate's short name, `tribo-x` without its prefix.
fn room(name: &str) -> Option<&str> {
    name.strip_prefix("tribo-")
}

fn layer(room: &str) -> Option<usize> {
    LAYERS.iter().position(|layer| layer.contains(&room))
}

fn matches(pattern: &str, name: &str) -> bool {
    pattern.strip_suffix('*').map_or(pattern == name, |prefix| name.starts_with(prefix))
}

/// Everything about the dependencies that breaks the law. Dev-dependencies are exempt from direction, not from
/// reservation.
fn violations(metadata: &Metadata) -> Vec<String> {
    let mut found = Vec::new();
    for package in &metadata.packages {
        let Some(from) = room(&package.name) else {
            found.push(format!("package {} is not called tribo-*", package.name));
            continue;
        };
        let folder = package.manifest_path.parent().and_then(Path::file_name);
        if folder.is_none_or(|folder| folder != from) {
            found.push(format!("{} does not live in {from}/", package.name));
        }
        if from != STORIES && layer(from).is_none() {
            found.push(format!("{} has no layer in the table", package.name));
        }
        for dependency in &package.dependencies {
            for (pattern, allowed) in RESERVED {
                if matches(pattern, &dependency.name) && !allowed.contains(&from) {
                    found.push(format!("{} uses {}, reserved for {allowed:?}", package.name, dependency.name));
                }
            }
            let (Some(to), Some(above)) = (room(&dependency.name), layer(from)) else { continue };
            if dependency.kind.as_deref() == Some("dev") {
                continue;
            }
            let downwards = layer(to).is_some_and(|below| below < above);
            if !(downwards || SIDEWAYS.contains(&(from, to))) || FORBIDDEN.contains(&(from, to)) {
                found.push(format!("{} must not use {}", package.name, dependency.name));
            }
        }
    }
    found
}

/// Whether a manifest says `[lints] workspace = true`.
fn inherits_lints(manifest: &str) -> bool {
    let section = manifest.split("\n[").find_map(|section| section.trim_start_matches('[').strip_prefix("lints]"));
    section.is_some_and(|body| body.lines().any(|line| line.replace(' ', "") == "workspace=true"))
}

/// Rust files below `folder`, build output aside.
pub fn rust_files(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("a readable entry").path();
        let hidden = path.file_name().is_some_and(|name| name == "target" || name.to_string_lossy().starts_with('.'));
        if path.is_dir() && !hidden {
            rust_files(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

#[test]
fn crates_point_one_way() {
    let metadata = metadata();
    assert!(metadata.packages.len() >= 10, "metadata lists the workspace");
    let found = violations(&metadata);
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn every_crate_inherits_the_workspace_lints() {
    for package in metadata().packages {
        let manifest = std::fs::read_to_string(&package.manifest_path).expect("a readable manifest");
        assert!(inherits_lints(&manifest), "{} has no [lints] workspace = true", package.name);
    }
}

#[test]
fn no_source_file_is_too_long() {
    let mut files = Vec::new();
    rust_files(&metadata().workspace_root, &mut files);
    assert!(files.len() > 50, "the walk finds the sources");
    for path in files {
        let lines = std::fs::read_to_string(&path).expect("a readable source").lines().count();
        assert!(lines <= LONGEST_FILE, "{} has {lines} lines", path.display());
    }
}

/// Power check: each forbidden edge, planted in the real metadata, is found.
#[test]
fn every_clause_can_fail() {
    let real = metadata();
    let with_edge = |from: &str, to: &str, kind: Option<&str>| {
        let mut planted = real.clone();
        let name = format!("tribo-{from}");
        let package = planted.packages.iter_mut().find(|package| package.name == name).expect("a known crate");
        package.dependencies.push(Dependency { name: to.to_owned(), kind: kind.map(str::to_owned) });
        violations(&planted).len() - violations(&real).len()
    };
    for (from, to) in [
        ("robot", "tribo-friction"),
        ("friction", "tribo-bayesopt"),
        ("logs", "tribo-robot"),
        ("files", "tribo-logs"),
        ("control", "tribo-sim"),
        ("ekf", "tribo-sim"),
        ("ekf", "tribo-control"),
        ("residual", "tribo-sim"),
        ("residual", "tribo-ekf"),
        ("runtime", "tribo-residual"),
        ("sim", "tribo-control"),
        ("runtime", "tribo-sim"),
        ("runtime", "tribo-ekf"),
        ("runtime", "tribo-experiments"),
        ("experiments", "tribo-cli"),
        ("experiments", "tribo-dashboard"),
        ("figure", "tribo-logs"),
        ("figure", "egui"),
        ("diagnose", "egui_plot"),
        ("regression", "tribo-posterior"),
        ("posterior", "tribo-diagnose"),
        ("diagnose", "tribo-model"),
        ("robot", "egui"),
        ("experiments", "eframe"),
        ("experiments", "clap"),
        ("experiments", "clap_complete"),
        ("control", "faer"),
        ("sim", "argmin-math"),
        ("cli", "tribo-tests"),
    ] {
        assert!(with_edge(from, to, None) >= 1, "{from} -> {to} goes unnoticed");
    }
    assert_eq!(with_edge("friction", "tribo-robot", None), 0);
    assert_eq!(with_edge("runtime", "tribo-sim", Some("dev")), 0);
    assert_eq!(with_edge("cli", "clap_mangen", None), 0);

    let mut renamed = real.clone();
    renamed.packages[0].name = "tribo-nowhere".to_owned();
    assert!(violations(&renamed).len() >= 2, "wrong folder and no layer");
    renamed.packages[0].name = "nowhere".to_owned();
    assert!(!violations(&renamed).is_empty());

    assert!(inherits_lints("[package]\nname = \"x\"\n\n[lints]\nworkspace = true\n"));
    assert!(!inherits_lints("[package]\nname = \"x\"\nlicense.workspace = true\n"));
    assert!(!inherits_lints("[lints]\n[dependencies]\nworkspace = true\n"));
}
