//! A directory for the files of one input.

use std::path::{Path, PathBuf};

use tempfile::TempDir;

thread_local! {
    /// In memory where the system offers it: what is tested are readers, and no disk.
    static SCRATCH: TempDir = tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).expect("a directory");
}

/// The directory of this thread.
pub fn directory() -> PathBuf {
    SCRATCH.with(|scratch| scratch.path().to_owned())
}

/// Puts a file there, in place of an earlier one.
pub fn put(path: &Path, content: &[u8]) {
    std::fs::write(path, content).expect("a file in the scratch directory");
}
