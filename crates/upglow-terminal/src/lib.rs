//! What the programs `upglow` and `upglow-study` share: how they read numbers of the command line,
//! end, print, show progress and write files.
//!
//! Data goes to standard output; progress, warnings and errors go to standard error. A program that
//! has no result prints one line and exits with a status of its own for each kind of [`Failure`].

mod failure;
pub mod files;
mod numbers;
mod output;
mod progress;
mod threads;

use std::process::ExitCode;

use clap::Parser;

pub use failure::{Failure, Line, io_message};
pub use numbers::{in_range, whole};
pub use output::{Format, Report};
pub use progress::Bar;
pub use threads::{on_threads, threads};

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
