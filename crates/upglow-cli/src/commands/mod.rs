//! The commands, one per file.

mod bake;
mod bake_plan;
mod bake_tasks;
mod build;
mod check;
mod color;
mod color_report;
mod documents;
mod engine;
mod examples;
#[cfg(feature = "explore")]
mod explore;
mod export;
mod fit_matrix;
mod inspect;
mod inspect_table;
mod lint;
mod luts;
mod manual;
mod material_report;
mod read;
mod relight;
mod relight_report;
mod verify;

use upglow_terminal::Failure;

use crate::args::{Args, Command};

/// Runs the command that was typed.
pub(crate) fn run(Args { command, console }: Args) -> Result<(), Failure> {
    match command {
        Command::Build(args) => build::run(&args, &console),
        Command::Inspect(args) => inspect::run(args, &console),
        Command::Verify(args) => verify::run(&args, &console),
        Command::Color(args) => color::run(&args, &console),
        Command::FitMatrix(args) => fit_matrix::run(&args, &console),
        Command::Relight(args) => relight::run(&args, &console),
        Command::Export(args) => export::run(&args, &console),
        Command::Bake(args) => bake::run(&args, &console),
        Command::Check(args) => check::run(&args, &console),
        Command::Read(args) => read::run(&args, &console),
        Command::Lint(args) => lint::run(&args, &console),
        #[cfg(feature = "explore")]
        Command::Explore(args) => explore::run(&args, &console),
        #[cfg(not(feature = "explore"))]
        Command::Explore(_) => Err(Failure::option("explore", WITHOUT_SERVER)),
        Command::Examples(args) => examples::run(&args, &console),
        Command::Completions(args) => manual::completions(&args, &console),
        Command::Man(args) => manual::man(&args, &console),
        Command::Figures(_) => Err(moved("figures")),
        Command::Reproduce(_) => Err(moved("reproduce")),
    }
}

#[cfg(not(feature = "explore"))]
const WITHOUT_SERVER: &str = "not in this build, run \
    `cargo install --path crates/upglow-cli --features explore`, or `upglow export CUBE cube.html`";

/// Names the program that now has the command.
fn moved(command: &str) -> Failure {
    let message =
        format!("now a command of the program upglow-study, run `upglow-study {command}`");
    Failure::option(command, message)
}
