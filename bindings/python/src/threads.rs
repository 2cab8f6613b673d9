//! The threads that work.

use std::mem;
use std::process;
use std::sync::{Arc, Mutex, OnceLock};

use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::errors::{check_range, kind_error, value_error};

/// A number of threads, as Python gives it, or one per core.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Threads(Option<usize>);

/// More threads would fill the memory, and are a typing error.
const MOST_THREADS: i64 = 1024;

impl FromPyObject<'_, '_> for Threads {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        if given.is_none() {
            return Ok(Self::default());
        }
        let expected = "a whole number or None";
        let count: i64 = given.extract().map_err(|_| kind_error("threads", given, expected))?;
        check_range("threads", count, [1, MOST_THREADS])?;
        Ok(Self(usize::try_from(count).ok()))
    }
}

/// What rayon takes for it.
const ONE_PER_CORE: usize = 0;

/// The process that first asked for threads: those of rayon's own pool live in it, and not in what is
/// forked from it.
static FIRST_PROCESS: OnceLock<u32> = OnceLock::new();

/// A forked process, and its pool.
static FORKED: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Runs `work` on a number of threads; by default one per core.
pub(crate) fn on_threads<T: Send>(
    threads: Threads,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let process = process::id();
    if let Threads(Some(count)) = threads {
        Ok(pool(count)?.install(work))
    } else if *FIRST_PROCESS.get_or_init(|| process) == process {
        Ok(work())
    } else {
        Ok(pool_after_fork(process)?.install(work))
    }
}

fn pool(threads: usize) -> PyResult<ThreadPool> {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(value_error)
}

/// A pool of a forked process. It is kept, unless the lock is taken, which may be so for ever: another
/// thread held it at the time of the fork.
fn pool_after_fork(process: u32) -> PyResult<Arc<ThreadPool>> {
    let make = || pool(ONE_PER_CORE).map(Arc::new);
    let Ok(mut kept) = FORKED.try_lock() else { return make() };
    match &*kept {
        Some((of, pool)) if *of == process => Ok(Arc::clone(pool)),
        _ => {
            let pool = make()?;
            // The threads of an older pool live in the parent process: nobody can end them from here.
            mem::forget(kept.replace((process, Arc::clone(&pool))));
            Ok(pool)
        }
    }
}
