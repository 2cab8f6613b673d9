//! Values that several threads change.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// The value. What is locked here is whole at every step, so a panic of another thread is no harm to it.
pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
