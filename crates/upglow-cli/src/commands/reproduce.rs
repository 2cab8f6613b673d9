//! `upglow reproduce`: the seed paper's claims, measured.

use serde::Serialize;
use upglow_study::{Claim, Cubes, Number, reproduce, to_markdown};

use super::on_threads;
use super::study::study_failure;
use crate::args::ReproduceArgs;
use crate::failure::Failure;
use crate::files;
use crate::output::{Format, Report};
use crate::progress::Bar;

#[derive(Clone, Debug, Serialize)]
struct ReproduceReport {
    resolution: usize,
    claims: Vec<ClaimReport>,
    #[serde(skip)]
    markdown: String,
}

#[derive(Clone, Debug, Serialize)]
struct ClaimReport {
    id: &'static str,
    section: &'static str,
    quote: &'static str,
    measure: &'static str,
    numbers: Vec<NumberReport>,
    verdict: String,
    why: &'static str,
}

#[derive(Clone, Debug, Serialize)]
struct NumberReport {
    name: &'static str,
    value: f64,
    unit: &'static str,
    paper: Option<f64>,
}

pub(crate) fn run(args: &ReproduceArgs, format: Format, quiet: bool) -> Result<(), Failure> {
    if let Some(path) = &args.output {
        files::check_output(path)?;
    }
    let cubes = Cubes::new(args.resolution);
    let bar = Bar::start(quiet);
    let claims = on_threads(args.threads, || reproduce(&cubes, &bar))?;
    bar.finish();
    let claims = claims.map_err(study_failure)?;
    let markdown = to_markdown(args.resolution, &claims);
    if let Some(path) = &args.output {
        files::write(path, markdown.as_bytes())?;
    }
    let claims = claims.iter().map(ClaimReport::of).collect();
    format.print(&ReproduceReport { resolution: args.resolution, claims, markdown })
}

impl ClaimReport {
    fn of(claim: &Claim) -> Self {
        let Claim { id, section, quote, measure, ref numbers, verdict, why } = *claim;
        let numbers = numbers.iter().map(NumberReport::of).collect();
        Self { id, section, quote, measure, numbers, verdict: verdict.to_string(), why }
    }
}

impl NumberReport {
    fn of(&Number { name, value, unit, paper, .. }: &Number) -> Self {
        Self { name, value, unit, paper }
    }
}

impl Report for ReproduceReport {
    fn text(&self) -> String {
        self.markdown.clone()
    }
}
