//! How many threads work.

use pyo3::PyResult;

use crate::errors::value_error;

/// More threads than this are a typing error: they would take the machine's memory.
const MOST_THREADS: usize = 1024;

/// Runs `work` on so many threads; one for each core where no number is given.
pub(crate) fn on_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let Some(count) = threads else { return Ok(work()) };
    if !(1..=MOST_THREADS).contains(&count) {
        return Err(value_error(format_args!("threads is {count}, expected 1 to {MOST_THREADS}")));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().map_err(value_error)?;
    Ok(pool.install(work))
}
