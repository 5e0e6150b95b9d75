//! The model of version 5, compiled.

use std::io;
use std::process::Command;

use tribo_robot::Arm;

use super::c_source;

/// Why there is no model library.
#[derive(Debug, thiserror::Error)]
pub enum LibraryError {
    /// No compiler could be started.
    #[error("the C compiler {compiler} cannot be started ({source}); set CC to one, or do without the model library")]
    NoCompiler {
        /// Its command.
        compiler: String,
        /// The operating system's reason.
        source: io::Error,
    },
    /// The compiler refused.
    #[error("the C compiler {compiler} failed on the model library: {message}")]
    Compiler {
        /// Its command.
        compiler: String,
        /// What it said.
        message: String,
    },
    /// Files could not be written or read.
    #[error("model library: {0}")]
    File(#[from] io::Error),
}

/// The shared object that a Panda's client downloads and loads, for this machine: [`c_source`] compiled by `$CC`, or `cc`.
///
/// # Errors
///
/// [`LibraryError`] without a compiler that can make a shared object.
pub fn library(arm: &Arm<7>) -> Result<Vec<u8>, LibraryError> {
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".to_owned());
    let directory = tempfile::tempdir()?;
    let (source, object) = (directory.path().join("model.c"), directory.path().join("model.so"));
    std::fs::write(&source, c_source(arm))?;
    let mut command = Command::new(&compiler);
    command.args(["-std=c99", "-O2", "-shared", "-fPIC", "-o"]).arg(&object).arg(&source).arg("-lm");
    let output = command.output().map_err(|source| LibraryError::NoCompiler { compiler: compiler.clone(), source })?;
    if !output.status.success() {
        let message = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        return Err(LibraryError::Compiler { compiler, message });
    }
    Ok(std::fs::read(object)?)
}
