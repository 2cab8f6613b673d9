//! The commands, one per file.

mod figures;
mod reproduce;

use upglow_fit::BuildError;
use upglow_terminal::{Failure, Format};

use crate::args::{Args, Command};
use crate::error::StudyError;

/// Does what was asked for.
pub(crate) fn run(args: Args) -> Result<(), Failure> {
    let format = if args.json { Format::Json } else { Format::Text };
    match args.command {
        Command::Figures(figures) => figures::run(&figures, format, args.quiet),
        Command::Reproduce(reproduce) => reproduce::run(&reproduce, format, args.quiet),
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
