//! `upglow-study reproduce`: measures the claims of the paper.

use serde::Serialize;
use upglow_terminal::{Console, Failure, Report, files};

use super::failure;
use crate::args::ReproduceArgs;
use crate::claims::{Claim, claims};
use crate::cubes::Cubes;
use crate::report::to_markdown;

#[derive(Clone, Debug, Serialize)]
struct ReproduceReport {
    resolution: usize,
    claims: Vec<Claim>,
}

pub(super) fn run(args: &ReproduceArgs, console: &Console) -> Result<(), Failure> {
    if let Some(path) = &args.output {
        files::check_output(path)?;
    }
    let cubes = Cubes::new(args.resolution);
    let claims = console.work(args.threads, |bar| claims(&cubes, bar))?.map_err(failure)?;
    let report = ReproduceReport { resolution: args.resolution, claims };
    if let Some(path) = &args.output {
        files::write(path, report.text().as_bytes())?;
    }
    console.print(&report)
}

impl Report for ReproduceReport {
    fn text(&self) -> String {
        to_markdown(self.resolution, &self.claims)
    }
}
