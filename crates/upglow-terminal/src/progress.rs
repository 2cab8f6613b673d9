//! Work on many threads, with progress on standard error, and Ctrl-C.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use upglow_fit::{Progress, Watch};

use crate::failure::Failure;
use crate::output::Console;
use crate::values::in_range;

/// Redrawing more often than this many times a second costs time and shows nothing more.
const REDRAWS_PER_S: u8 = 10;

/// Whether Ctrl-C or termination was asked for.
static STOPPED: AtomicBool = AtomicBool::new(false);

/// More threads than this are a typing error: they would take the machine's memory.
const MOST_THREADS: usize = 1024;

/// The option for the number of threads.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct Threads {
    /// Number of threads; results are the same for any number [default: one per core]
    #[arg(long, value_name = "N", value_parser = in_range([1, MOST_THREADS]))]
    threads: Option<usize>,
}

/// A bar for the work in hand, with the time left; nothing where standard error is not a terminal.
///
/// Ctrl-C and termination end the work at its next step, so that no unfinished file stays behind.
#[derive(Debug)]
pub struct Bar {
    bar: ProgressBar,
    stage: Mutex<&'static str>,
}

impl Console {
    /// Does work on so many threads, under a bar unless the user wants quiet.
    ///
    /// # Errors
    ///
    /// [`Failure::Input`] if the system does not give so many threads.
    pub fn work<T: Send>(
        &self,
        threads: Threads,
        work: impl FnOnce(&Bar) -> T + Send,
    ) -> Result<T, Failure> {
        let bar = Bar::start(self.quiet);
        let pool =
            rayon::ThreadPoolBuilder::new().num_threads(threads.threads.unwrap_or(0)).build();
        let pool = pool.map_err(|error| {
            Failure::input("--threads", format!("{error}, expected fewer threads"))
        })?;
        let done = pool.install(|| work(&bar));
        bar.bar.finish_and_clear();
        Ok(done)
    }
}

impl Bar {
    fn start(quiet: bool) -> Self {
        let target = if quiet {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr_with_hz(REDRAWS_PER_S)
        };
        let bar = ProgressBar::with_draw_target(Some(1), target)
            .with_style(style())
            .with_message("starting");
        // Without a handler Ctrl-C ends the program at once; files appear whole or not at all then
        // too. A second piece of work finds the handler of the first.
        let _ = ctrlc::set_handler(|| STOPPED.store(true, Ordering::Relaxed));
        Self { bar, stage: Mutex::new("") }
    }
}

fn style() -> ProgressStyle {
    ProgressStyle::with_template("{msg} {wide_bar} {percent:>3}%  {elapsed} so far, {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar())
}

/// Refuses to go on after Ctrl-C.
///
/// # Errors
///
/// [`Failure::Stopped`].
pub fn check_stopped() -> Result<(), Failure> {
    if STOPPED.load(Ordering::Relaxed) { Err(Failure::Stopped) } else { Ok(()) }
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
        check_stopped().is_err()
    }
}
