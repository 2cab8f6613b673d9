//! The commands, one per file.

mod figures;
pub(crate) mod reduced;
pub(crate) mod relight;
mod reproduce;
mod rule;

use upglow_fit::BuildError;
use upglow_terminal::Failure;

use crate::args::{Args, Command};

/// Runs the command that was typed.
pub(crate) fn run(Args { command, console }: Args) -> Result<(), Failure> {
    match command {
        Command::Figures(args) => figures::run(&args, &console),
        Command::Reproduce(args) => reproduce::run(&args, &console),
        Command::Relight(args) => relight::run(&args, &console),
        Command::Reduced(args) => reduced::run(&args, &console),
        Command::Rule(args) => rule::run(&args, &console),
    }
}

fn failure(error: BuildError) -> Failure {
    match error {
        BuildError::Stopped => Failure::Stopped,
        error => Failure::option("--resolution", error),
    }
}
