//! The number of threads that work.

use pyo3::PyResult;

use crate::errors::{check_range, value_error};

/// More threads would fill the memory, and are a typing error.
const MOST_THREADS: usize = 1024;

/// Runs `work` on a number of threads; by default one per core.
pub(crate) fn on_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let Some(count) = threads else { return Ok(work()) };
    check_range("threads", count, [1, MOST_THREADS])?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().map_err(value_error)?;
    Ok(pool.install(work))
}
