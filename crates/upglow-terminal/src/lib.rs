//! What the programs `upglow` and `upglow-study` share: how they read the command line,
//! end, print, show progress and write files.
//!
//! Data goes to standard output; progress, warnings and errors go to standard error. A program that
//! has no result prints one line and exits with a status of its own for each kind of [`Failure`].

mod failure;
pub mod files;
mod output;
mod progress;
mod values;

use std::process::ExitCode;

use clap::Parser;

pub use failure::Failure;
pub use output::{Console, Report, size};
pub use progress::{Bar, Threads, check_stopped};
pub use values::{count, in_range, number, parsed, word};

/// Reads the command line, does what it asks for, and gives the status to exit with.
///
/// Lines on standard error start with the name that `Args` gives to its command.
pub fn run<Args: Parser>(work: impl FnOnce(Args) -> Result<(), Failure>) -> ExitCode {
    let command = Args::command();
    let program = command.get_name();
    match Args::try_parse() {
        Ok(args) => match work(args) {
            Ok(()) => ExitCode::SUCCESS,
            Err(failure) => failure.report(program),
        },
        Err(error) => failure::report_usage(program, &error),
    }
}
