//! Whether a log is accepted.

use std::ffi::CString;

use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use tribo_logs::recognise::{Remark, Use, refusal, said};

use crate::failure::bad;

/// Refuses a log that cannot be right for what it is wanted for; what only may be wrong is a `UserWarning`. With `anyway`
/// everything is a warning.
///
/// # Errors
/// `ValueError` with one line per reason.
pub(crate) fn accept(py: Python<'_>, name: &str, remarks: &[Remark], wanted: Use, anyway: bool) -> PyResult<()> {
    if let Some(reasons) = refusal(name, remarks, wanted).filter(|_| !anyway) {
        return Err(bad(reasons));
    }
    said(name, remarks).try_for_each(|line| warn(py, &line))
}

/// A `UserWarning` about the caller's line.
///
/// # Errors
/// Where warnings are made errors.
pub(crate) fn warn(py: Python<'_>, message: &str) -> PyResult<()> {
    let text = CString::new(message.replace('\0', " ")).unwrap_or_default();
    PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 2)
}
