//! The Python package `tribo`: the library on NumPy arrays.
//!
//! ```text
//! tribo/*.py (dataclasses, docs, type hints)  →  tribo._tribo (this crate)  →  the crates of the workspace
//! ```
//!
//! Arrays are `(n, N)`: a row per sample, a column per joint; one sample may be `(N,)`. Numbers are copied in and out once, and Python's
//! lock is released while they are worked on. Bad input is a `ValueError`, a file that the system refuses an `OSError`, both with
//! the messages of the command. Nothing is computed here: the same functions give the same bits as in Rust.

mod arm;
mod campaign;
mod compensator;
mod diagnosis;
mod estimate;
mod estimator;
mod failure;
mod interrupt;
mod log;
mod meant;
mod model;
mod record;
mod remarks;
mod rows;
mod simulated_arm;
mod study;
mod tune;

use pyo3::prelude::*;

/// Compiled part of the package `tribo`.
#[pymodule]
mod _tribo {
    use super::pyfunction;
    use super::{PyResult, Python};

    #[pymodule_export]
    use super::arm::PyArm;
    #[pymodule_export]
    use super::campaign::{ask, campaign_state, give_up, tell, withdraw};
    #[pymodule_export]
    use super::compensator::PyCompensator;
    #[pymodule_export]
    use super::diagnosis::{RawDiagnosis, diagnose};
    #[pymodule_export]
    use super::estimate::estimate;
    #[pymodule_export]
    use super::estimator::PyWrenchEstimator;
    #[pymodule_export]
    use super::log::{PyLog, read_log};
    #[pymodule_export]
    use super::model::PyModel;
    #[pymodule_export]
    use super::record::record;
    #[pymodule_export]
    use super::simulated_arm::PySimulatedArm;
    #[pymodule_export]
    use super::study::PyStudy;
    #[pymodule_export]
    use super::tune::tune;

    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
    #[pymodule_export]
    const PRESETS: [&str; tribo_robot::presets::NAMES.len()] = tribo_robot::presets::NAMES;

    /// Runs the `tribo` command with these words, the name of the program first; gives its exit code.
    #[pyfunction]
    fn command(py: Python<'_>, words: Vec<std::ffi::OsString>) -> PyResult<u8> {
        Ok(py.detach(|| tribo_cli::run(words)))
    }
}
