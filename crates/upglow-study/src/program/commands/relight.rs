//! `upglow-study relight`: materials made from the colors of surfaces, beside these under other lights.

use std::fmt::Write;

use serde::Serialize;
use upglow_color::Contract;
use upglow_fit::Watch;
use upglow_terminal::{Bar, Console, Failure, Report};

use crate::args::RelightArgs;
use crate::bispectral::Measured;
use crate::relight::{Relit, sets, ways};
use crate::spread::Spread;

#[derive(Clone, Debug, Serialize)]
struct RelightReport {
    sets: Vec<SetReport>,
}

#[derive(Clone, Debug, Serialize)]
struct SetReport {
    samples: &'static str,
    count: usize,
    lights: Vec<String>,
    ways: Vec<WayReport>,
}

/// ΔE00 between samples and the materials of one way.
#[derive(Clone, Debug, Serialize)]
struct WayReport {
    way: String,
    /// How many materials have a dye.
    dyed: usize,
    contract: Mean,
    lights: Vec<Mean>,
    /// Of each sample's mean over the lights.
    mean: Mean,
}

/// A mean over samples.
#[derive(Clone, Copy, Debug, Serialize)]
struct Mean {
    de2000: f64,
    standard_error: f64,
}

impl Mean {
    fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let Spread { mean, standard_error, .. } = Spread::of(values);
        Self { de2000: mean, standard_error }
    }
}

pub(super) fn run(args: &RelightArgs, console: &Console) -> Result<(), Failure> {
    let folder = args.bispectral.as_deref();
    let measured = folder.map(Measured::read_folder).transpose()?.unwrap_or_default();
    let report = console.work(args.threads, |bar| measure(&measured, bar))?;
    console.print(&report?)
}

fn measure(measured: &[Measured], bar: &Bar) -> Result<RelightReport, Failure> {
    let ways = ways(&Contract::default());
    let mut reports = Vec::new();
    for (set, lights) in sets(measured) {
        let mut rows = Vec::with_capacity(ways.len());
        for way in &ways {
            if bar.stopped() {
                return Err(Failure::Stopped);
            }
            let relit = Relit::of(&set, way, &lights);
            rows.push(WayReport {
                way: way.name.clone(),
                dyed: relit.dyed,
                contract: Mean::of(relit.home.iter().copied()),
                lights: relit.away.iter().map(|of| Mean::of(of.iter().copied())).collect(),
                mean: Mean::of(relit.means()),
            });
        }
        reports.push(SetReport {
            samples: set.name,
            count: set.samples.len(),
            lights: lights.iter().map(|light| light.name().to_owned()).collect(),
            ways: rows,
        });
    }
    Ok(RelightReport { sets: reports })
}

impl Report for RelightReport {
    fn text(&self) -> String {
        let tables: Vec<String> = self.sets.iter().map(SetReport::table).collect();
        tables.join("\n")
    }
}

impl SetReport {
    /// The table in Markdown.
    fn table(&self) -> String {
        let Self { samples, count, lights, ways } = self;
        let mut text = format!(
            "ΔE00 from {samples} (n = {count}), mean ± standard error\n\n\
             | way | with dye | D65 | {} | mean of the others |\n|{}\n",
            lights.join(" | "),
            " --- |".repeat(lights.len() + 4),
        );
        for WayReport { way, dyed, contract, lights, mean } in ways {
            let means = [contract].into_iter().chain(lights).chain([mean]);
            let means: Vec<String> = means
                .map(|Mean { de2000, standard_error }| format!("{de2000:.2} ± {standard_error:.2}"))
                .collect();
            writeln!(text, "| {way} | {dyed} | {} |", means.join(" | "))
                .expect("writing to a string cannot fail");
        }
        text
    }
}
