//! `upglow build`: fits a cube and writes it.

use std::time::Instant;

use serde::Serialize;
use upglow::{Model, QuantumYield};
use upglow_fit::{BuildError, CubeSummary, build_cube};
use upglow_terminal::{Console, Failure, Report, check_stopped};

use crate::args::BuildArgs;
use crate::files;
use crate::output::{Lines, warn, warn_of_ultraviolet};
use crate::plan::{BuildPlan, options_failure};

#[derive(Debug, Serialize)]
struct BuildReport {
    file: String,
    bytes: u64,
    resolution: usize,
    model: &'static str,
    /// `None` if model and options were chosen one by one.
    preset: Option<String>,
    time_s: f64,
    summary: CubeSummary,
    /// What the light lacks that the dyes absorb.
    missing_ultraviolet: Option<String>,
}

pub(crate) fn run(args: &BuildArgs, console: &Console) -> Result<(), Failure> {
    let BuildPlan { contract, model, options } = BuildPlan::new(args)?;
    let resolution = args.fit.resolution;
    warn_of_unpublished_yields(&model);
    let missing_ultraviolet = warn_of_ultraviolet(model.missing_ultraviolet(&contract.illuminant));
    let start = Instant::now();
    let built = console
        .work(args.fit.threads, |bar| build_cube(&contract, &model, options, resolution, bar))?;
    let cube = built.map_err(|error| match error {
        BuildError::Stopped => Failure::Stopped,
        BuildError::Options(error) => options_failure(error, &options),
        BuildError::Cube(error) => Failure::option("--resolution", error),
        error => Failure::input("build", error),
    })?;
    let bytes = cube.to_bytes();
    check_stopped()?;
    files::write(&args.output, &bytes)?;
    console.print(&BuildReport {
        file: args.output.display().to_string(),
        bytes: bytes.len() as u64,
        resolution,
        model: model.name(),
        preset: cube.fit().preset.clone(),
        time_s: start.elapsed().as_secs_f64(),
        summary: CubeSummary::of(&cube),
        missing_ultraviolet,
    })
}

/// Warns that a yield of 1 is used for dyes without a published one.
fn warn_of_unpublished_yields(model: &Model) {
    let Some(dyes) = model.dyes() else { return };
    let unpublished = dyes.without_published_yield();
    if dyes.options().quantum_yield == QuantumYield::Measured && !unpublished.is_empty() {
        let names = unpublished.join(", ");
        warn(format_args!("no published quantum yield, taken as 1: {names}"));
    }
}

impl Report for BuildReport {
    fn text(&self) -> String {
        let mut lines = Lines::default();
        lines
            .add_summary(&self.summary)
            .add("time", format_args!("{:.1} s", self.time_s))
            .add_file("file", &self.file, self.bytes);
        lines.to_string()
    }
}
