//! `upglow build`: fits a cube and writes it.

use std::time::Instant;

use serde::Serialize;
use upglow::{Model, QuantumYield};
use upglow_fit::{BuildError, Watch, build_cube};
use upglow_terminal::{Bar, Failure, on_threads};

use super::summary::SummaryReport;
use crate::args::BuildArgs;
use crate::files;
use crate::output::{Format, Lines, Report, warn};
use crate::plan::BuildPlan;

#[derive(Clone, Debug, Serialize)]
struct BuildReport {
    file: String,
    bytes: u64,
    resolution: usize,
    model: &'static str,
    time_s: f64,
    summary: SummaryReport,
}

pub(crate) fn run(args: &BuildArgs, format: Format, quiet: bool) -> Result<(), Failure> {
    let plan = BuildPlan::new(args)?;
    warn_of_unpublished_yields(&plan.model);
    let start = Instant::now();
    let bar = Bar::start(quiet);
    let built = on_threads(plan.threads, || {
        build_cube(&plan.contract, &plan.model, plan.options, plan.resolution, &bar)
    })?;
    bar.finish();
    let cube = built.map_err(|error| match error {
        BuildError::Stopped => Failure::Stopped,
        BuildError::Options(error) => Failure::option("--slope-max-per-nm", error),
        BuildError::Cube(error) => Failure::option("--resolution", error),
        error => Failure::input("build", error),
    })?;
    let bytes = cube.to_bytes().map_err(|error| Failure::file(&plan.output, error))?;
    if bar.stopped() {
        return Err(Failure::Stopped);
    }
    files::write(&plan.output, &bytes)?;
    format.print(&BuildReport {
        file: plan.output.display().to_string(),
        bytes: bytes.len() as u64,
        resolution: plan.resolution,
        model: plan.model.name(),
        time_s: start.elapsed().as_secs_f64(),
        summary: SummaryReport::of(&cube),
    })
}

/// A yield of 1 stands for one that nobody measured: the user should know.
fn warn_of_unpublished_yields(model: &Model) {
    let Model::Dyes(dyes) = model else { return };
    let unpublished = dyes.without_published_yield();
    if dyes.options().quantum_yield == QuantumYield::Measured && !unpublished.is_empty() {
        let names = unpublished.join(", ");
        warn(format_args!("no published quantum yield, taken as 1: {names}"));
    }
}

impl Report for BuildReport {
    fn text(&self) -> String {
        let mut lines = Lines::default();
        self.summary.add_to(&mut lines);
        lines
            .add("time", format_args!("{:.1} s", self.time_s))
            .add("file", format_args!("{}, {}", self.file, files::size(self.bytes)));
        lines.to_string()
    }
}
