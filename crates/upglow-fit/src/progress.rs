//! How long work tells where it stands, and how it is stopped.

/// A step of the work that was done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// What is being done, for people.
    pub stage: &'static str,
    /// Units done in this stage.
    pub done: usize,
    /// Units in this stage.
    pub total: usize,
}

/// Somebody who watches the work, from any thread.
pub trait Watch: Sync {
    /// Takes note of progress. Called often and from many threads.
    fn progress(&self, progress: Progress);

    /// Whether the work should stop; asked often.
    fn stopped(&self) -> bool;
}

/// Nobody watches.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn progress(&self, _: Progress) {}

    fn stopped(&self) -> bool {
        false
    }
}
