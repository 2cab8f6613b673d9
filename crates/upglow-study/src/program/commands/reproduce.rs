//! `upglow-study reproduce`: measures the claims of the paper.

use serde::Serialize;
use upglow_terminal::{Console, Failure, Report, files};

use super::failure;
use crate::args::ReproduceArgs;
use crate::bispectral::read_folder;
use crate::claims::{Claim, claims};
use crate::cubes::Cubes;
use crate::report::to_markdown;

#[derive(Clone, Debug, Serialize)]
struct ReproduceReport {
    resolution: usize,
    /// The measured materials, by the names of their files.
    measured: Vec<String>,
    claims: Vec<Claim>,
}

pub(super) fn run(args: &ReproduceArgs, console: &Console) -> Result<(), Failure> {
    if let Some(path) = &args.output {
        files::check_ending(path, &["md", "txt"])?;
        files::check_output(path)?;
    }
    let measured = read_folder(args.bispectral.as_deref())?;
    let cubes = Cubes::new(args.resolution);
    let claims =
        console.work(args.threads, |bar| claims(&cubes, &measured, bar))?.map_err(failure)?;
    let measured = measured.into_iter().map(|found| found.name).collect();
    let report = ReproduceReport { resolution: args.resolution, measured, claims };
    if let Some(path) = &args.output {
        files::write(path, report.text().as_bytes())?;
    }
    console.print(&report)
}

impl Report for ReproduceReport {
    fn text(&self) -> String {
        to_markdown(self.resolution, &self.measured, &self.claims)
    }
}
