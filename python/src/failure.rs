//! Errors of the library as exceptions.

use std::error::Error;
use std::io::ErrorKind;

use pyo3::PyErr;
use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyValueError};
use tribo_files::LogError;

/// `FileNotFoundError` of a file that is not there, `OSError` where the operating system refused something else, else `ValueError`; the
/// message is the library's.
pub(crate) fn raised(error: impl Error + 'static) -> PyErr {
    let message = error.to_string();
    let mut cause: Option<&(dyn Error + 'static)> = Some(&error);
    while let Some(error) = cause {
        if matches!(error.downcast_ref(), Some(LogError::NotFound { .. })) {
            return PyFileNotFoundError::new_err(message);
        }
        match error.downcast_ref::<std::io::Error>().map(std::io::Error::kind) {
            Some(ErrorKind::NotFound) => return PyFileNotFoundError::new_err(message),
            Some(_) => return PyOSError::new_err(message),
            None => cause = error.source(),
        }
    }
    PyValueError::new_err(message)
}

/// A `ValueError`.
pub(crate) fn bad(message: impl Into<String>) -> PyErr {
    PyValueError::new_err(message.into())
}
