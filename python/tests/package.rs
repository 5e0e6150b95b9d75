//! The Python package, tested by pytest: the library as Cargo built it beside the Python files, as a wheel has them.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::{Path, PathBuf};
use std::process::Command;

use nalgebra::SVector;
use tribo_robot::{presets, rnea};

/// Folder of this crate.
fn here() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// The library, two folders above this test program or beside it.
fn library() -> Option<PathBuf> {
    let name = format!("{}_tribo{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let program = std::env::current_exe().ok()?;
    program.ancestors().skip(1).take(2).map(|folder| folder.join(&name)).find(|path| path.is_file())
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            std::fs::copy(&path, to.join(path.file_name().unwrap())).unwrap();
        }
    }
}

/// Numbers that the library itself gives, to be met to the last bit.
fn expected(path: &Path) {
    let row = |seed: f64| -> Vec<[f64; 7]> {
        let of = |k: usize| std::array::from_fn(|j| (seed + 1.7 * k as f64 + 0.9 * j as f64).sin());
        (0..50).map(of).collect()
    };
    let (q, qd, qdd) = (row(0.1), row(1.3), row(2.9));
    let arm = presets::panda();
    let of = |row: &[f64; 7]| SVector::<f64, 7>::from_column_slice(row);
    let tau: Vec<[f64; 7]> =
        (0..q.len()).map(|k| rnea(&arm, &of(&q[k]), &of(&qd[k]), &of(&qdd[k])).data.0[0]).collect();
    let document = serde_json::json!({"q": q, "qd": qd, "qdd": qdd, "tau": tau});
    std::fs::write(path, document.to_string()).unwrap();
}

#[test]
fn pytest_passes() {
    let python = std::env::var("TRIBO_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has = |module: &str| {
        let import = format!("import {module}");
        Command::new(&python).args(["-c", &import]).output().is_ok_and(|output| output.status.success())
    };
    if let Some(missing) = ["sys", "numpy", "pytest"].into_iter().find(|module| !has(module)) {
        return println!("SKIPPED: the Python package is not tested, {python} has no {missing}");
    }
    let library = library().expect("the library of this crate beside its tests");
    let folder = tempfile::tempdir().unwrap();
    let package = folder.path().join("site/tribo");
    copy(&here().join("tribo"), &package);
    std::fs::copy(library, package.join("_tribo.abi3.so")).unwrap();
    expected(&folder.path().join("expected.json"));
    let output = Command::new(&python)
        .args(["-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider", "-o", "addopts="])
        .arg(here().join("tests"))
        .current_dir(folder.path())
        .env("PYTHONPATH", folder.path().join("site"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("TRIBO_EXPECTED", folder.path().join("expected.json"))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    println!("{said}");
    assert!(output.status.success(), "{said}\n{}", String::from_utf8_lossy(&output.stderr));
}
