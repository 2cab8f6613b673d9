//! Arrays of numbers, in single and double precision.

use numpy::{Element, PyArray2, PyReadonlyArray2};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use rayon::prelude::*;
use upglow_color::Xyz;
use upglow_fit::Watch as _;

use crate::errors::value_error;
use crate::threads::{Threads, on_threads};
use crate::watch::watched;

/// Single or double precision, the element type of an array.
pub(crate) trait Number: Element + Copy + Send + Sync + Into<f64> {
    const NAN: Self;

    /// The nearest number of this precision.
    fn from_double(value: f64) -> Self;
}

impl Number for f64 {
    const NAN: Self = Self::NAN;

    fn from_double(value: f64) -> Self {
        value
    }
}

impl Number for f32 {
    const NAN: Self = Self::NAN;

    #[expect(clippy::cast_possible_truncation, reason = "its purpose is to round")]
    fn from_double(value: f64) -> Self {
        value as Self
    }
}

/// Tristimulus values in single precision.
pub(crate) fn to_single(Xyz(xyz): Xyz) -> [f32; 3] {
    xyz.map(f32::from_double)
}

/// An array as rows of three numbers.
pub(crate) fn triples<'a, T: Element>(
    array: &'a PyReadonlyArray2<'_, T>,
) -> PyResult<&'a [[T; 3]]> {
    Ok(array.as_slice()?.as_chunks().0)
}

/// A new array of zeros. Rust's own function panics where memory is short.
///
/// # Errors
///
/// Python's `MemoryError`.
pub(crate) fn zeros<T: Element>(
    py: Python<'_>,
    shape: [usize; 2],
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let array =
        py.import("numpy")?.call_method1("zeros", ((shape[0], shape[1]), T::get_dtype(py)))?;
    Ok(array.cast_into()?)
}

/// As many values.
///
/// # Errors
///
/// Python's `MemoryError`.
pub(crate) fn values<T: Clone>(value: T, count: usize) -> PyResult<Vec<T>> {
    let mut values = Vec::new();
    if values.try_reserve_exact(count).is_err() {
        let size = size_of::<T>();
        return Err(PyMemoryError::new_err(format!("no room for {count} results of {size} bytes")));
    }
    values.resize(count, value);
    Ok(values)
}

/// Numbers that a thread computes at a time: enough that the cost of distributing them vanishes.
const BATCH: usize = 4096;

/// Fills rows of `width` numbers in parallel. Each row is computed independently, so the number of threads
/// changes no result.
pub(crate) fn fill<T: Send>(
    py: Python<'_>,
    threads: Threads,
    out: &mut [T],
    width: usize,
    work: impl Fn(usize, &mut [T]) + Sync,
) -> PyResult<()> {
    if width == 0 {
        return Ok(());
    }
    let rows = (BATCH / width).max(1);
    fill_batches(py, threads, out, rows * width, |batch, out| {
        for (row, out) in out.chunks_exact_mut(width).enumerate() {
            work(batch * rows + row, out);
        }
    })
}

/// Fills batches of `size` in parallel, the last of which may be smaller; one alone on this thread. Ctrl-C stops the work.
pub(crate) fn fill_batches<T: Send>(
    py: Python<'_>,
    threads: Threads,
    out: &mut [T],
    size: usize,
    work: impl Fn(usize, &mut [T]) + Sync,
) -> PyResult<()> {
    if out.len() <= size {
        py.detach(|| work(0, out));
        return Ok(());
    }
    watched(py, None, |watcher| {
        let batch = |(batch, out): (usize, &mut [T])| {
            if !watcher.stopped() {
                work(batch, out);
            }
        };
        on_threads(threads, || out.par_chunks_mut(size).enumerate().for_each(batch))
    })?
}

/// Checks that `found` numbers are given for `expected` rows.
pub(crate) fn check_count(what: &str, found: usize, expected: usize) -> PyResult<()> {
    if found == expected {
        return Ok(());
    }
    Err(value_error(format_args!("{found} {what}, expected {expected}, one for each color")))
}
