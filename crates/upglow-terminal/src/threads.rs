//! The number of threads, and work on so many.

use std::num::NonZeroUsize;

use crate::failure::Failure;
use crate::numbers::in_range;

/// More threads than this are a typing error: they would take the machine's memory.
const MOST_THREADS: usize = 1024;

/// The value of the option `--threads`.
///
/// # Errors
///
/// What was found and expected, in one line.
pub fn threads(text: &str) -> Result<NonZeroUsize, String> {
    in_range([1, MOST_THREADS], text)
}

/// Runs `work` on so many threads; one for each core without a number.
///
/// # Errors
///
/// [`Failure::Input`] if the system does not give so many.
pub fn on_threads<T: Send>(
    threads: Option<NonZeroUsize>,
    work: impl FnOnce() -> T + Send,
) -> Result<T, Failure> {
    let count = threads.map_or(0, NonZeroUsize::get);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().map_err(|error| {
        Failure::input("--threads", format_args!("{error}, expected fewer threads"))
    })?;
    Ok(pool.install(work))
}
