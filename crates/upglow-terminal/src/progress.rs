//! Progress on standard error, and Ctrl-C.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use upglow_fit::{Progress, Watch};

/// Redrawing more often than this many times a second costs time and shows nothing more.
const REDRAWS_PER_S: u8 = 10;

/// A bar for the work in hand, with the time left; nothing where standard error is not a terminal.
///
/// Ctrl-C and termination end the work at its next step, so that no unfinished file stays behind.
#[derive(Debug)]
pub struct Bar {
    bar: ProgressBar,
    stage: Mutex<&'static str>,
    stopped: Arc<AtomicBool>,
}

impl Bar {
    /// Starts to watch; `quiet` draws nothing.
    #[must_use]
    pub fn start(quiet: bool) -> Self {
        let target = if quiet {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr_with_hz(REDRAWS_PER_S)
        };
        let bar = ProgressBar::with_draw_target(Some(1), target)
            .with_style(style())
            .with_message("starting");
        let stopped = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&stopped);
        // Without a handler Ctrl-C ends the program at once; files appear whole or not at all then too.
        let _ = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed));
        Self { bar, stage: Mutex::new(""), stopped }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

fn style() -> ProgressStyle {
    ProgressStyle::with_template("{msg} {wide_bar} {percent:>3}%  {elapsed} so far, {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar())
}

impl Watch for Bar {
    fn progress(&self, Progress { stage, done, total }: Progress) {
        if self.bar.is_hidden() {
            return;
        }
        {
            let mut current = self.stage.lock().unwrap_or_else(PoisonError::into_inner);
            if *current != stage {
                *current = stage;
                self.bar.reset();
                self.bar.set_message(stage);
                self.bar.set_length(total as u64);
            }
        }
        // Threads report out of order; the bar goes one way.
        if done as u64 > self.bar.position() {
            self.bar.set_position(done as u64);
        }
    }

    fn stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }
}
