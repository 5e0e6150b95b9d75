//! Errors of the library as exceptions.

use std::error::Error;

use pyo3::PyErr;
use pyo3::exceptions::{PyOSError, PyValueError};

/// `OSError` where the operating system refused something, else `ValueError`; the message is the library's.
pub(crate) fn raised(error: impl Error + 'static) -> PyErr {
    let mut cause: Option<&(dyn Error + 'static)> = Some(&error);
    let mut refused = false;
    while let Some(error) = cause {
        refused |= error.is::<std::io::Error>();
        cause = error.source();
    }
    let message = error.to_string();
    if refused { PyOSError::new_err(message) } else { PyValueError::new_err(message) }
}

/// A `ValueError`.
pub(crate) fn bad(message: impl Into<String>) -> PyErr {
    PyValueError::new_err(message.into())
}
