//! How long-running work reports its progress, and how it is stopped.

/// How far the work is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// What is being done, for display.
    pub stage: &'static str,
    /// Units done in this stage.
    pub done: usize,
    /// Units in this stage.
    pub total: usize,
}

/// A watcher of the work.
pub trait Watch: Sync {
    /// Receives progress; called often, and from many threads.
    fn progress(&self, progress: Progress);

    /// Whether the work should stop; called often, and from many threads.
    fn stopped(&self) -> bool;
}

/// Ignores progress and never stops the work.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn progress(&self, _: Progress) {}

    fn stopped(&self) -> bool {
        false
    }
}
