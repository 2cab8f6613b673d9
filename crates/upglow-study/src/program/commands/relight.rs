//! `upglow-study relight`: materials made of what is known of surfaces, beside these under other lights.

use std::fmt::Write;

use serde::Serialize;
use upglow_color::Illuminant;
use upglow_fit::{Progress, Watch};
use upglow_terminal::{Console, Failure, Report};

use crate::args::RelightArgs;
use crate::bispectral::read_folder;
use crate::lights::{SEVEN, lights};
use crate::relight::{LitSet, Relit, sets};
use crate::samples::SampleSet;
use crate::spread::Spread;
use crate::ways::{Way, WholeMatrix, ways};

#[derive(Clone, Debug, Serialize)]
pub(crate) struct RelightReport {
    pub(crate) sets: Vec<SetReport>,
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct SetReport {
    samples: &'static str,
    count: usize,
    ways: Vec<WayReport>,
}

/// ΔE00 between samples and the materials of one way.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct WayReport {
    way: String,
    /// How many materials have a dye.
    dyed: usize,
    lights: Vec<LightReport>,
    /// Of each sample's mean over the seven lights beside daylight, without those that the way was told of.
    mean_of_seven: Mean,
    /// The same over all lights.
    mean: Mean,
    /// Of the colors that the way was not told, the share that is within its band of nine of ten materials; `None`
    /// for a way without a band.
    in_band: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct LightReport {
    light: String,
    /// Whether the way was told the color under this light.
    told: bool,
    #[serde(flatten)]
    mean: Mean,
}

/// A mean over samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Mean {
    de2000: f64,
    /// `None` for one sample.
    standard_error: Option<f64>,
}

impl Mean {
    fn of(values: Vec<f64>) -> Self {
        let Spread { count, mean, standard_error, .. } = Spread::of(values);
        Self { de2000: mean, standard_error: (count > 1).then_some(standard_error) }
    }
}

pub(super) fn run(args: &RelightArgs, console: &Console) -> Result<(), Failure> {
    let measured = read_folder(args.bispectral.as_deref())?;
    let mut ways = ways();
    if !measured.is_empty() {
        let whole = WholeMatrix::of(&measured);
        ways.push(Box::new(whole.map_err(|(name, error)| Failure::input(name, error))?));
    }
    for name in &args.only {
        if !ways.iter().any(|way| way.name() == name) {
            let names: Vec<&str> = ways.iter().map(|way| way.name()).collect();
            let message = format!("unknown way {name:?}, expected one of: {}", names.join("; "));
            return Err(Failure::option("--only", message));
        }
    }
    ways.retain(|way| args.only.is_empty() || args.only.iter().any(|name| name == way.name()));
    let report = console.work(args.threads, |bar| measure(&sets(&measured), &ways, bar))?;
    console.print(&report?)
}

/// Every way on every set, for whose samples it makes materials.
///
/// # Errors
///
/// [`Failure::Stopped`] if `watch` stopped the work.
pub(crate) fn measure(
    sets: &[SampleSet],
    ways: &[Box<dyn Way>],
    watch: &dyn Watch,
) -> Result<RelightReport, Failure> {
    let lights = lights();
    let mut reports = Vec::with_capacity(sets.len());
    let total = sets.len() * ways.len();
    for (s, set) in sets.iter().enumerate() {
        let lit = LitSet::new(set, &lights);
        let mut rows = Vec::with_capacity(ways.len());
        for (w, way) in ways.iter().enumerate() {
            if watch.stopped() {
                return Err(Failure::Stopped);
            }
            watch.progress(Progress { stage: "relighting", done: s * ways.len() + w, total });
            if !way.is_for(set) {
                continue;
            }
            let relit = Relit::of(&lit, way.as_ref());
            let light = |(k, light): (usize, &Illuminant)| LightReport {
                light: light.name().to_owned(),
                told: relit.told[k],
                mean: Mean::of(relit.under(k)),
            };
            rows.push(WayReport {
                way: way.name().to_owned(),
                dyed: relit.dyed,
                lights: lights.iter().enumerate().map(light).collect(),
                mean_of_seven: Mean::of(relit.means(SEVEN)),
                mean: Mean::of(relit.means(0..lights.len())),
                in_band: relit.in_band,
            });
        }
        if !rows.is_empty() {
            reports.push(SetReport { samples: set.name, count: set.samples.len(), ways: rows });
        }
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
    /// The table in Markdown: each row once, and which ways have the same.
    fn table(&self) -> String {
        let Self { samples, count, ways } = self;
        let lights = ways.first().map_or(&[][..], |way| &way.lights);
        let names: Vec<&str> = lights.iter().map(|light| light.light.as_str()).collect();
        let mut text = format!(
            "ΔE00 from {samples} (n = {count}), means ± standard errors; in brackets under lights of which the \
             way was told\n\n\
             | way | with dye | {} | the seven | all | in band |\n|{}\n",
            names.join(" | "),
            " --- |".repeat(lights.len() + 5),
        );
        let mut notes = String::new();
        for (k, of_way) in ways.iter().enumerate() {
            let WayReport { way, dyed, lights, mean_of_seven, mean, in_band } = of_way;
            let is_same = |other: &&WayReport| (other.dyed, &other.lights) == (*dyed, lights);
            if ways[..k].iter().any(|other| is_same(&other)) {
                continue;
            }
            let light = |LightReport { told, mean, .. }: &LightReport| match told {
                true => format!("({:.2})", mean.de2000),
                false => format!("{:.2}", mean.de2000),
            };
            let total = |Mean { de2000, standard_error }: &Mean| match standard_error {
                Some(error) => format!("{de2000:.2} ± {error:.2}"),
                None => format!("{de2000:.2}"),
            };
            let cells = lights.iter().map(light).chain([mean_of_seven, mean].map(total));
            let cells = cells.collect::<Vec<_>>().join(" | ");
            let in_band = in_band.map_or(String::new(), |share| format!("{:.0} %", 100.0 * share));
            writeln!(text, "| {way} | {dyed} | {cells} | {in_band} |").expect(IN_MEMORY);
            let same = ways[k + 1..].iter().filter(is_same).map(|other| other.way.as_str());
            let same: Vec<&str> = same.collect();
            if !same.is_empty() {
                writeln!(notes, "\nThe same as {way}: {}.", same.join("; ")).expect(IN_MEMORY);
            }
        }
        text + &notes
    }
}

/// Why texts can be written.
pub(super) const IN_MEMORY: &str = "writing to a string cannot fail";
