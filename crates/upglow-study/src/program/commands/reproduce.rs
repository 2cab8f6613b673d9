//! `upglow-study reproduce`: the paper's claims, measured.

use serde::Serialize;
use upglow_terminal::{Console, Failure, Report, files};

use super::failure;
use crate::args::ReproduceArgs;
use crate::claims::Claim;
use crate::cubes::Cubes;
use crate::report::{reproduce, to_markdown};

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
    let claims = console.work(args.threads, |bar| reproduce(&cubes, bar))?;
    let report = ReproduceReport { resolution: args.resolution, claims: claims.map_err(failure)? };
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
