//! Work on several threads, with progress on standard error and a handler of Ctrl-C.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock, Mutex, Once, PoisonError};
use std::thread::sleep;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use upglow_fit::{Progress, Watch};

use crate::failure::Failure;
use crate::output::Console;
use crate::program;
use crate::values::in_range;

/// Redrawing more often than this costs time without being visible.
const REDRAWS_PER_S: u8 = 10;

/// Whether the user has pressed Ctrl-C, or the system has asked the program to terminate.
static STOPPED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// More threads than this are probably a typing error, and would exhaust the memory.
const MOST_THREADS: usize = 1024;

/// The option for the number of threads.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct Threads {
    /// Number of threads; results are the same for any number [default: one per core]
    #[arg(long, value_name = "N", value_parser = in_range([1, MOST_THREADS]))]
    threads: Option<usize>,
}

/// A progress bar with the remaining time; invisible if standard error is not a terminal.
///
/// Ctrl-C and termination stop the work at its next step, so that no unfinished file stays behind.
#[derive(Debug)]
pub struct Bar {
    bar: ProgressBar,
    stage: Mutex<&'static str>,
}

impl Console {
    /// Runs work on a pool of threads, and shows its progress unless `--quiet` was given.
    ///
    /// # Errors
    ///
    /// [`Failure::Input`] if the threads cannot be started.
    pub fn work<T: Send>(
        &self,
        threads: Threads,
        work: impl FnOnce(&Bar) -> T + Send,
    ) -> Result<T, Failure> {
        let bar = Bar::start(self.quiet);
        let pool =
            rayon::ThreadPoolBuilder::new().num_threads(threads.threads.unwrap_or(0)).build();
        let pool = pool.map_err(|_| {
            Failure::input("--threads", "more than the system gives, expected fewer threads")
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
        catch_stops();
        Self { bar, stage: Mutex::new("") }
    }
}

fn style() -> ProgressStyle {
    ProgressStyle::with_template("{msg} {wide_bar} {percent:>3}%  {elapsed} so far, {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar())
}

/// How long work may take to end after the user has stopped it. Then it waits for something else, such as the reader
/// of a pipe.
const GRACE: Duration = Duration::from_secs(5);
/// How often it is looked whether the user has stopped the work.
const LOOK: Duration = Duration::from_millis(200);

/// Lets [`check_stopped`] know of Ctrl-C, termination and the end of the terminal, which then no longer end the
/// program at once, but five seconds later at the latest. What the program was started to ignore, as by `nohup`, it
/// ignores.
pub fn catch_stops() {
    use signal_hook::consts::{SIGINT, SIGTERM};
    #[cfg(unix)]
    let signals = [SIGINT, SIGTERM, signal_hook::consts::SIGHUP];
    #[cfg(not(unix))]
    let signals = [SIGINT, SIGTERM];
    static CAUGHT: Once = Once::new();
    CAUGHT.call_once(|| {
        for signal in signals.into_iter().filter(|&signal| !is_ignored(signal)) {
            // Without a handler the signal ends the program at once, which leaves no unfinished file either that
            // the next run would not remove.
            let _ = signal_hook::flag::register(signal, STOPPED.clone());
        }
        // Where the system gives no thread for it, the program waits.
        let _ = std::thread::Builder::new().spawn(|| {
            while check_stopped().is_ok() {
                sleep(LOOK);
            }
            sleep(GRACE);
            std::process::exit(Failure::Stopped.report(program()).into());
        });
    });
}

/// Makes a limit on the size of files an error of the file, which else would end the program.
pub(crate) fn catch_limit_of_files() {
    #[cfg(unix)]
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
}

/// Whether the program was started to ignore a signal; `false` on systems that do not tell.
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask >> (signal - 1) & 1 == 1
}

/// Returns an error after Ctrl-C.
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
        // Threads report out of order; the bar never moves back.
        if done as u64 > self.bar.position() {
            self.bar.set_position(done as u64);
        }
    }

    fn stopped(&self) -> bool {
        check_stopped().is_err()
    }
}
