//! Rust's errors as Python's own, with the same text.

use std::fmt::Display;
use std::io;
use std::path::Path;

use pyo3::PyErr;
use pyo3::exceptions::{PyOSError, PyValueError};

/// What was given is not what it should be.
pub(crate) fn value_error(error: impl Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// A file cannot be read or written: `FileNotFoundError`, `PermissionError` and their like.
pub(crate) fn os_error(path: &Path, error: &io::Error) -> PyErr {
    let text = error.to_string();
    match error.raw_os_error() {
        Some(number) => {
            let end = text.find(" (os error").unwrap_or(text.len());
            PyOSError::new_err((number, text[..end].to_owned(), path.as_os_str().to_owned()))
        }
        // An error that another one wraps: its kind still names Python's class.
        None => io::Error::new(error.kind(), format!("{}: {text}", path.display())).into(),
    }
}
