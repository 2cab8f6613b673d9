//! Conversion of Rust's errors to Python exceptions with the same text.

use std::fmt::Display;
use std::io;
use std::path::Path;

use pyo3::exceptions::{PyOSError, PyTypeError, PyValueError};
use pyo3::prelude::*;

/// A `ValueError`, for an invalid argument.
pub(crate) fn value_error(error: impl Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// A `TypeError`, for an argument of another kind.
pub(crate) fn kind_error(name: &str, found: Borrowed<'_, '_, PyAny>, expected: &str) -> PyErr {
    let kind = found.get_type();
    let kind = kind.name().map_or_else(|_| "of another kind".to_owned(), |name| name.to_string());
    PyTypeError::new_err(format!("{name} is {kind}, expected {expected}"))
}

/// Checks that an argument is in a range, which NaN never is.
pub(crate) fn check_range<T: PartialOrd + Display>(
    name: &str,
    found: T,
    [least, most]: [T; 2],
) -> PyResult<()> {
    if found >= least && found <= most {
        return Ok(());
    }
    Err(value_error(format_args!("{name} is {found}, expected {least} to {most}")))
}

/// An `OSError` for a file that cannot be read or written: `FileNotFoundError`, `PermissionError` …
pub(crate) fn os_error(path: &Path, error: &io::Error) -> PyErr {
    let text = error.to_string();
    match error.raw_os_error() {
        Some(number) => {
            let end = text.find(" (os error").unwrap_or(text.len());
            PyOSError::new_err((number, text[..end].to_owned(), path.as_os_str().to_owned()))
        }
        // Without a number the class that Python raises follows from the kind.
        None => io::Error::new(error.kind(), format!("{}: {text}", path.display())).into(),
    }
}
