//! Long work: reports progress to Python, which may stop it.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;
use upglow_fit::{Progress, Watch};

/// How often Python gets control. Shorter costs time; longer delays the response to Ctrl-C.
const PAUSE: Duration = Duration::from_millis(50);

/// State shared by the worker thread and the calling thread.
#[derive(Debug, Default)]
pub(crate) struct Watcher {
    latest: Mutex<Option<Progress>>,
    stopped: AtomicBool,
    finished: AtomicBool,
}

impl Watch for Watcher {
    fn progress(&self, progress: Progress) {
        let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        // Threads report out of order, but progress must not go back within a stage.
        let is_late = latest.is_some_and(|l| l.stage == progress.stage && l.done > progress.done);
        if !is_late {
            *latest = Some(progress);
        }
    }

    fn stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }
}

impl Watcher {
    /// Reports new progress to Python, and raises what is pending there, such as Ctrl-C.
    fn consult(&self, py: Python<'_>, report: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        py.check_signals()?;
        let latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let (Some(report), Some(Progress { stage, done, total })) = (report, latest) {
            report.call1((stage, done, total))?;
        }
        Ok(())
    }
}

/// Does `work` on another thread, while this one, which is Python's, calls `report` with stage,
/// units done and total. An exception from `report`, and Ctrl-C, stop the work.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    report: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watcher) -> T + Send,
) -> PyResult<T> {
    let (watcher, caller) = (Watcher::default(), thread::current());
    thread::scope(|scope| {
        let worker = scope.spawn(|| {
            let result = work(&watcher);
            watcher.finished.store(true, Ordering::Release);
            caller.unpark();
            result
        });
        let mut consulted = Ok(());
        while consulted.is_ok() && !watcher.finished.load(Ordering::Acquire) {
            py.detach(|| thread::park_timeout(PAUSE));
            if worker.is_finished() {
                break;
            }
            consulted = watcher.consult(py, report);
        }
        watcher.stopped.store(consulted.is_err(), Ordering::Relaxed);
        let result = py.detach(|| worker.join()).unwrap_or_else(|panic| resume_unwind(panic));
        consulted.and_then(|()| watcher.consult(py, report)).map(|()| result)
    })
}
