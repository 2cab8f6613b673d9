//! `upglow-study rule`: which colors get a dye, and how much more of it than the least.

use std::fmt::Write;

use serde::Serialize;
use upglow_fit::{BuildError, Preset};
use upglow_terminal::{Bar, Console, Failure, Report};

use super::failure;
use crate::args::RuleArgs;
use crate::rule::{
    Doses, Dyed, colors, contract_of_every_color, cube, doses, dyed_alone, dyed_by_look_up,
    dyed_nodes,
};
use crate::spread::Spread;
use crate::ways::{Way, presets_and_limits};

#[derive(Clone, Debug, Serialize)]
struct RuleReport {
    resolution: usize,
    /// Of colors fitted by themselves.
    alone: Vec<WayReport>,
    in_cubes: Vec<WayReport>,
    /// Of the preset `natural`.
    doses: Vec<DoseReport>,
    missed_alone: usize,
    missed_exhaustively: usize,
}

#[derive(Clone, Debug, Serialize)]
struct WayReport {
    way: String,
    dyed: Vec<Dyed>,
}

/// Doses over the least that is known.
#[derive(Clone, Debug, Serialize)]
struct DoseReport {
    materials: &'static str,
    count: usize,
    median: f64,
    p95: f64,
    p99: f64,
    worst: f64,
}

impl DoseReport {
    fn new(materials: &'static str, spread: Spread) -> Self {
        let Spread { count, median, p95, p99, max: worst, .. } = spread;
        Self { materials, count, median, p95, p99, worst }
    }
}

pub(super) fn run(args: &RuleArgs, console: &Console) -> Result<(), Failure> {
    let report = console.work(args.threads, |bar| measure(args, bar))?.map_err(failure)?;
    console.print(&report)
}

fn measure(args: &RuleArgs, bar: &Bar) -> Result<RuleReport, BuildError> {
    let RuleArgs { resolution, colors: random, nodes, .. } = *args;
    let colors = colors(random);
    let alone = presets_and_limits(&contract_of_every_color()).into_iter().map(|way| {
        let dyed = colors.iter().map(|colors| dyed_alone(colors, &way)).collect();
        WayReport { way: way.name().to_owned(), dyed }
    });
    let alone = alone.collect();
    let mut in_cubes = Vec::new();
    for preset in [Preset::Konig2020, Preset::Natural] {
        let all = dyed_nodes(&cube(preset, "srgb", resolution, bar)?);
        let wide = cube(preset, "acescg", resolution, bar)?;
        let dyed = vec![all, dyed_by_look_up(&wide, random)];
        in_cubes.push((WayReport { way: preset.to_string(), dyed }, wide));
    }
    let (in_cubes, mut wide): (_, Vec<_>) = in_cubes.into_iter().unzip();
    let natural = wide.pop().expect("the preset natural is the last");
    let Doses { alone: by_itself, in_cube, missed_alone, missed_exhaustively } =
        doses(&natural, Preset::Natural, nodes, bar)?;
    let doses = vec![
        DoseReport::new("fitted by themselves", by_itself),
        DoseReport::new("in the cube", in_cube),
    ];
    Ok(RuleReport { resolution, alone, in_cubes, doses, missed_alone, missed_exhaustively })
}

impl Report for RuleReport {
    fn text(&self) -> String {
        let Self { resolution, missed_alone, missed_exhaustively, .. } = self;
        let mut text = format!(
            "Colors with a dye, each fitted by itself; in brackets the lightest of them\n\n{}\n\
             The same of the materials in cubes of {resolution}³ nodes\n\n{}\n\
             Doses over the least that is known, nodes of the ACEScg cube of the preset natural with a dye.\n\
             Within the limit of slopes the fit by itself misses {missed_alone} of them, the exhaustive search \
             {missed_exhaustively}.\n\n\
             | nodes | n | median | 95 in 100 within | 99 in 100 within | worst |\n\
             | --- | --- | --- | --- | --- | --- |\n",
            table(&self.alone),
            table(&self.in_cubes),
        );
        for DoseReport { materials, count, median, p95, p99, worst } in &self.doses {
            let numbers = [median, p95, p99, worst].map(|number| format!("{number:.2}"));
            writeln!(text, "| {materials} | {count} | {} |", numbers.join(" | "))
                .expect("writing to a string cannot fail");
        }
        text
    }
}

/// How many colors have a dye, in Markdown.
fn table(rows: &[WayReport]) -> String {
    let line = |first: &str, cells: Vec<String>| format!("| {first} | {} |\n", cells.join(" | "));
    let heads = |dyed: &Dyed| format!("{} (n = {})", dyed.colors, dyed.count);
    let cell = |Dyed { dyed, count, lightest, .. }: &Dyed| match dyed {
        0 => "0".to_owned(),
        _ => format!("{dyed}, {:.2} % (L* {lightest:.0})", 100.0 * *dyed as f64 / *count as f64),
    };
    let Some(first) = rows.first() else { return String::new() };
    let rule = vec!["---".to_owned(); first.dyed.len()];
    let mut text = line("way", first.dyed.iter().map(heads).collect()) + &line("---", rule);
    for WayReport { way, dyed } in rows {
        text += &line(way, dyed.iter().map(cell).collect());
    }
    text
}
