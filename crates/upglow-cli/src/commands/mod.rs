//! The commands, one a file.

mod bake;
mod build;
mod check;
mod color;
mod color_report;
mod examples;
mod export;
mod figures;
mod inspect;
mod inspect_table;
mod lint;
mod read;
mod reproduce;
mod study;
mod summary;
mod verify;

use std::num::NonZeroUsize;

use crate::args::{Args, Command};
use crate::failure::Failure;
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
        Command::Figures(figures) => figures::run(&figures, format, args.quiet),
        Command::Reproduce(reproduce) => reproduce::run(&reproduce, format, args.quiet),
    }
}

/// Runs `work` on so many threads; one for each core without a number.
fn on_threads<T: Send>(
    threads: Option<NonZeroUsize>,
    work: impl FnOnce() -> T + Send,
) -> Result<T, Failure> {
    let count = threads.map_or(0, NonZeroUsize::get);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().map_err(|error| {
        Failure::input("--threads", format_args!("{error}, expected fewer threads"))
    })?;
    Ok(pool.install(work))
}
