//! The commands, one a file.

mod bake;
mod build;
mod check;
mod color;
mod color_report;
mod examples;
mod export;
mod inspect;
mod inspect_table;
mod lint;
mod read;
mod summary;
mod verify;

use upglow_terminal::Failure;

use crate::args::{Args, Command};
use crate::output::Format;

/// Does what was asked for.
pub(crate) fn run(args: Args) -> Result<(), Failure> {
    let format = if args.json { Format::Json } else { Format::Text };
    match args.command {
        Command::Build(build) => build::run(&build, format, args.quiet),
        Command::Inspect(inspect) => inspect::run(&inspect, format),
        Command::Verify(verify) => verify::run(&verify, format, args.quiet),
        Command::Color(color) => color::run(&color, format),
        Command::Export(export) => export::run(&export, format, args.quiet),
        Command::Bake(bake) => bake::run(&bake, format, args.quiet),
        Command::Check(check) => check::run(&check, format, args.quiet),
        Command::Read(read) => read::run(&read, format),
        Command::Lint(lint) => lint::run(&lint, format),
        Command::Examples(examples) => examples::run(&examples, format),
        Command::Figures(_) => Err(moved("figures")),
        Command::Reproduce(_) => Err(moved("reproduce")),
    }
}

/// The program that has a command which was once here.
fn moved(command: &'static str) -> Failure {
    Failure::option(
        command,
        format_args!("now a command of the program upglow-study, run `upglow-study {command}`"),
    )
}
