//! `upglow-study reduced`: 4×4 matrices of measured fluorescent samples, beside these under other lights.

use std::fmt::Write;

use serde::Serialize;
use upglow::ReducedModel;
use upglow_color::{Grid, Illuminant, ReducedBasis};
use upglow_fit::{BuildError, Preset};
use upglow_terminal::{Bar, Console, Failure, Report};

use super::failure;
use super::relight::IN_MEMORY;
use crate::args::ReducedArgs;
use crate::bispectral::read_folder;
use crate::lights::{is_smooth, lights};
use crate::reduced::Engine;
use crate::rule::cube;
use crate::samples::Sample;
use crate::spread::Spread;

#[derive(Clone, Debug, Serialize)]
pub(crate) struct ReducedReport {
    lights: Vec<String>,
    samples: Vec<String>,
    pub(crate) engines: Vec<EngineReport>,
    /// The same of light that meets two surfaces, for each pair of samples.
    pub(crate) twice: Vec<EngineReport>,
    cube: Option<CubeReport>,
}

/// Means of ΔE00 over the samples.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct EngineReport {
    engine: &'static str,
    /// Under each light.
    pub(crate) under: Vec<f64>,
    /// Over all lights but that of the contract.
    pub(crate) mean: f64,
    /// Over those of them that are smooth.
    pub(crate) smooth: f64,
}

/// The matrices of a cube of the preset `natural`.
#[derive(Clone, Debug, Serialize)]
struct CubeReport {
    resolution: usize,
    /// Of the nodes, which share would return some light stronger without a limit.
    limited: f64,
    /// By how much the worst would.
    greatest_gain: f64,
    /// How many nodes are stronger than the contract's light under it, and are made darker.
    darkened: usize,
}

pub(super) fn run(args: &ReducedArgs, console: &Console) -> Result<(), Failure> {
    let measured = read_folder(args.bispectral.as_deref())?;
    let mut report = measure(&measured);
    report.cube = match args.resolution {
        Some(resolution) => {
            Some(console.work(args.threads, |bar| gains(resolution, bar))?.map_err(failure)?)
        }
        None => None,
    };
    console.print(&report)
}

/// Every engine on every sample.
pub(crate) fn measure(measured: &[Sample]) -> ReducedReport {
    let lights = lights();
    let once: Vec<Vec<&Sample>> = measured.iter().map(|sample| vec![sample]).collect();
    let pair = |first| measured.iter().map(move |second| vec![first, second]);
    let pairs: Vec<Vec<&Sample>> = measured.iter().flat_map(pair).collect();
    let report = |engine: Engine, surfaces: &[Vec<&Sample>]| {
        let each: Vec<Vec<f64>> =
            surfaces.iter().map(|samples| engine.differences(samples, &lights)).collect();
        let under: Vec<f64> =
            (0..lights.len()).map(|k| Spread::of(each.iter().map(|row| row[k])).mean).collect();
        let over = |holds: &dyn Fn(&Illuminant) -> bool| {
            let others = lights.iter().zip(&under).skip(1).filter(|(light, _)| holds(light));
            Spread::of(others.map(|(_, difference)| *difference)).mean
        };
        let (mean, smooth) = (over(&|_| true), over(&is_smooth));
        EngineReport { engine: engine.name(), under, mean, smooth }
    };
    let of = |surfaces: &[Vec<&Sample>]| {
        let engines = if measured.is_empty() { &[][..] } else { &Engine::ALL };
        engines.iter().map(|engine| report(*engine, surfaces)).collect()
    };
    ReducedReport {
        lights: lights.iter().map(|light| light.name().to_owned()).collect(),
        samples: measured.iter().map(|sample| sample.name.clone()).collect(),
        engines: of(&once),
        twice: of(&pairs),
        cube: None,
    }
}

fn gains(resolution: usize, bar: &Bar) -> Result<CubeReport, BuildError> {
    let cube = cube(Preset::Natural, "acescg", resolution, bar)?;
    let basis = ReducedBasis::try_new(cube.contract(), Grid::FIT)
        .expect("daylight has blue, green and red");
    let model = ReducedModel::new(cube.model(), &basis);
    let reduction = model.reduction();
    let white = reduction.white();
    let unlimited = |node| reduction.unlimited(model.answers(cube.node_material(node)));
    let gains: Vec<f64> =
        (0..cube.nodes().len()).map(|node| reduction.gain(unlimited(node))).collect();
    let strongest = (1.0 + VISIBLE_GAIN) * reduction.strength(white);
    let darkened = (0..cube.nodes().len())
        .filter(|node| reduction.strength(unlimited(*node) * white) > strongest)
        .count();
    let stronger = gains.iter().filter(|gain| **gain > 1.0 + VISIBLE_GAIN).count();
    let limited = stronger as f64 / gains.len() as f64;
    let greatest_gain = gains.into_iter().fold(0.0, f64::max);
    Ok(CubeReport { resolution, limited, greatest_gain, darkened })
}

/// Gains below it are not counted: stored materials are in single precision.
const VISIBLE_GAIN: f64 = 1e-6;

impl Report for ReducedReport {
    fn text(&self) -> String {
        let mut text = String::new();
        let tables =
            [("means", &self.engines), ("means after two surfaces, all pairs", &self.twice)];
        for (what, engines) in tables.into_iter().filter(|(_, engines)| !engines.is_empty()) {
            let (samples, lights) = (self.samples.join(", "), self.lights.join(" | "));
            let rule = " --- |".repeat(self.lights.len() + 3);
            write!(
                text,
                "ΔE00 from {samples}, {what}\n\n| engine | {lights} | smooth | all |\n|{rule}\n"
            )
            .expect(IN_MEMORY);
            for EngineReport { engine, under, mean, smooth } in engines {
                let cells: Vec<String> =
                    under.iter().chain([smooth, mean]).map(|value| format!("{value:.2}")).collect();
                writeln!(text, "| {engine} | {} |", cells.join(" | ")).expect(IN_MEMORY);
            }
            text.push('\n');
        }
        if let Some(CubeReport { resolution, limited, greatest_gain, darkened }) = &self.cube {
            writeln!(
                text,
                "Of the {resolution}³ nodes of the preset natural in ACEScg, {:.2} % would return some light stronger \
                 without a limit; the greatest gain is {greatest_gain:.3}. Under D65 itself {darkened} are stronger than the \
                 light.",
                100.0 * limited
            )
            .expect(IN_MEMORY);
        }
        text
    }
}
