//! The commands, one per file.

mod figures;
mod reproduce;

use upglow_fit::BuildError;
use upglow_terminal::Failure;

use crate::args::{Args, Command};
use crate::error::StudyError;

/// Does what was asked for.
pub(crate) fn run(Args { command, console }: Args) -> Result<(), Failure> {
    match command {
        Command::Figures(args) => figures::run(&args, &console),
        Command::Reproduce(args) => reproduce::run(&args, &console),
    }
}

/// What the command line did wrong, or why the work ended.
fn failure(error: StudyError) -> Failure {
    match error {
        StudyError::Build(BuildError::Stopped) => Failure::Stopped,
        StudyError::Build(BuildError::Cube(error)) => Failure::option("--resolution", error),
        StudyError::UnknownFigure { .. } => Failure::option("--only", error),
        error => Failure::input("study", error),
    }
}
