//! What the programs `upglow` and `upglow-study` share: reading the command line, printing reports,
//! showing progress, writing files, reporting errors.
//!
//! Data goes to standard output; progress, warnings and errors go to standard error. A program that
//! fails prints one line and exits with a status that depends on the kind of [`Failure`].

mod failure;
pub mod files;
mod output;
mod progress;
mod values;

use std::ffi::OsString;
use std::process::ExitCode;
use std::sync::OnceLock;

use clap::Parser;

pub use failure::Failure;
pub use output::{Console, Report, escaped, say, size};
pub use progress::{Bar, Threads, catch_stops, check_stopped};
pub use values::{count, in_range, number, parsed, word};

/// Reads the words of a command line that nobody typed.
///
/// # Errors
///
/// [`Failure::Usage`] with the line that the program prints of such a command line.
pub fn parse<Args: Parser>(words: impl IntoIterator<Item = String>) -> Result<Args, Failure> {
    Args::try_parse_from(words).map_err(|error| Failure::Usage(failure::usage_line(&error)))
}

/// Reads the words of a command line, the first of which is the program, runs `work` with what they say, and
/// returns the exit status.
///
/// Error messages start with the name that `Args` gives to its command.
pub fn run<Args: Parser>(
    words: impl IntoIterator<Item = OsString>,
    work: impl FnOnce(Args) -> Result<(), Failure>,
) -> ExitCode {
    let program = PROGRAM.get_or_init(|| Args::command().get_name().to_owned());
    progress::catch_limit_of_files();
    let words: Vec<OsString> = words.into_iter().collect();
    let done = match Args::try_parse_from(&words) {
        Ok(args) => work(args),
        Err(error) => failure::of_usage(&error, &words),
    };
    done.map_or_else(|failure| failure.report(program), |()| 0).into()
}

/// The name of the program, before its messages.
static PROGRAM: OnceLock<String> = OnceLock::new();

fn program() -> &'static str {
    PROGRAM.get().map_or("upglow", String::as_str)
}
