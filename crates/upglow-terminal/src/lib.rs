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

use clap::Parser;

pub use failure::Failure;
pub use output::{Console, Report, say, size};
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
    let command = Args::command();
    let program = command.get_name();
    match Args::try_parse_from(words) {
        Ok(args) => match work(args) {
            Ok(()) => ExitCode::SUCCESS,
            Err(failure) => failure.report(program),
        },
        Err(error) => failure::report_usage(program, &error),
    }
}
