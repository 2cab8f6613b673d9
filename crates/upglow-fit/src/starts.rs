//! Where fits start: a table of materials at the slope limit, and the ones nearest to a color.

use upglow::{AnalyticModel, DyeModel, Edge, Fluorescence, Model, ModelOnGrid};
use upglow_color::{Goal, Lab, Xyz, ciede2000_residuals, lab_from_xyz};

use crate::Fit;
use crate::parabola::MIDDLE_NM;
use crate::problem::Shape;
use crate::sums::{Lanes, Sums};

/// One material to start from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Start {
    pub(crate) reflectance: Edge,
    pub(crate) fluorescence: Fluorescence,
}

impl From<Fit> for Start {
    fn from(fit: Fit) -> Self {
        Self { reflectance: fit.reflectance, fluorescence: fit.fluorescence }
    }
}

/// The start materials and their colors, sorted into buckets of like fluorescence, or of like shape
/// where nothing fluoresces.
#[derive(Clone, Debug)]
pub(crate) struct StartTable {
    shapes: Vec<Edge>,
    entries: Vec<Entry>,
    /// First entry of each bucket, and the end.
    buckets: Vec<usize>,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    lab: [f32; 3],
    shape: u32,
    fluorescence: Fluorescence,
}

/// Steepest points of the start shapes, nm: first, last, step. A finer step finds no better
/// materials, one of 40 nm loses some.
const EDGES_NM: [u32; 3] = [390, 710, 20];
/// Their widths, nm, from a spike to a straight edge.
const WIDTHS_NM: [f64; 6] = [4.0, 10.0, 25.0, 60.0, 150.0, 1000.0];
/// Start slopes are the limit, and thirds of it down to this, 1/nm: softer colors need no limit.
const SOFTEST_PER_NM: f64 = 0.005;
/// Weights of the second dye.
const WEIGHTS: [f64; 3] = [0.0, 0.5, 1.0];
/// Concentrations for dyes of a thin solution, and for dense pigments, which are wide.
const CONCENTRATIONS: &[f64] = &[0.45, 1.0];
const DENSE_CONCENTRATIONS: &[f64] = &[0.2, 0.5, 1.0];
/// Into how many buckets of like shape the starts without fluorescence go.
const PASSIVE_BUCKETS: usize = 24;
/// Emission peaks and Stokes shifts of bells, nm.
const PEAKS_NM: [f64; 11] =
    [400.0, 431.0, 462.0, 493.0, 524.0, 555.0, 586.0, 617.0, 648.0, 679.0, 710.0];
const SHIFTS_NM: [f64; 4] = [15.0, 40.0, 75.0, 110.0];
/// A bucket of like fluorescences, and what each takes from a reflectance and adds to its color.
struct Variant {
    bucket: usize,
    fluorescence: Fluorescence,
    /// Which curves absorb, with their shares of the light.
    absorbers: [(usize, f64); 2],
    emitted: [f64; 3],
}

impl StartTable {
    /// The table for one model and light.
    pub(crate) fn new(model: &ModelOnGrid, sums: &Sums, slope_limit_per_nm: f64) -> Self {
        let shapes = shapes(slope_limit_per_nm);
        let (variants, absorbers) = variants(model, sums);
        let white = model.colorimetry().white();
        let mut sorted: Vec<(usize, Entry)> = Vec::new();
        let per_kind = shapes.len().div_ceil(PASSIVE_BUCKETS);
        for (index, &shape) in (0..).zip(&shapes) {
            let r = sums.reflectance(Shape::Free.numbers(shape));
            let reflected = sums.integrate(|i| r[i]);
            let taken: Vec<[f64; 3]> =
                absorbers.iter().map(|a| sums.integrate(|i| r[i] * a[i])).collect();
            for variant in &variants {
                let color = variant.color(reflected, &taken);
                let Lab { l, a, b } = lab_from_xyz(Xyz(color), white);
                let lab = [l, a, b].map(to_single);
                let fluorescence = variant.fluorescence;
                let bucket = match fluorescence {
                    Fluorescence::None => index as usize / per_kind,
                    _ => variant.bucket,
                };
                sorted.push((bucket, Entry { lab, shape: index, fluorescence }));
            }
        }
        sorted.sort_by_key(|(bucket, _)| *bucket);
        let count = sorted.last().map_or(0, |(bucket, _)| bucket + 1);
        let first = |bucket: usize| sorted.partition_point(|(b, _)| *b < bucket);
        let buckets = (0..=count).map(first).collect();
        Self { shapes, entries: sorted.into_iter().map(|(_, entry)| entry).collect(), buckets }
    }

    /// The nearest start of each bucket, nearest first.
    ///
    /// Near means CIEDE2000 as it is around the goal, a quadratic form: that finds the same starts
    /// as the full formula and costs a tenth.
    pub(crate) fn nearest(&self, goal: &Goal) -> Vec<Start> {
        let form = metric_at(goal);
        let Lab { l, a, b } = goal.lab();
        let center = [l, a, b].map(to_single);
        let mut best: Vec<(f32, &Entry)> = self
            .buckets
            .windows(2)
            .filter_map(|range| nearest_of(&self.entries[range[0]..range[1]], center, &form))
            .collect();
        best.sort_by(|x, y| x.0.total_cmp(&y.0));
        let start = |(_, entry): (f32, &Entry)| Start {
            reflectance: self.shapes[entry.shape as usize],
            fluorescence: entry.fluorescence,
        };
        best.into_iter().map(start).collect()
    }
}

/// The residuals' derivatives by Lab at the goal itself.
fn metric_at(goal: &Goal) -> [[f32; 3]; 3] {
    let (_, jacobian) = ciede2000_residuals(goal.lab(), goal.lab());
    jacobian.0.map(|row| row.map(to_single))
}

/// The entry of the smallest form; the first one where several are equal.
fn nearest_of<'e>(
    entries: &'e [Entry],
    center: [f32; 3],
    form: &[[f32; 3]; 3],
) -> Option<(f32, &'e Entry)> {
    let distance = |entry: &Entry| {
        let d = [0, 1, 2].map(|k| entry.lab[k] - center[k]);
        let row = |r: &[f32; 3]| r[0] * d[0] + r[1] * d[1] + r[2] * d[2];
        form.iter().map(row).map(|v| v * v).sum::<f32>()
    };
    let mut best = None;
    let mut least = f32::INFINITY;
    for entry in entries {
        let found = distance(entry);
        if found < least {
            (least, best) = (found, Some((found, entry)));
        }
    }
    best
}

impl Variant {
    fn color(&self, reflected: [f64; 3], taken: &[[f64; 3]]) -> [f64; 3] {
        [0, 1, 2].map(|k| {
            let absorbed: f64 = self
                .absorbers
                .iter()
                .filter(|(_, share)| *share > 0.0)
                .map(|&(curve, share)| share * taken[curve][k])
                .sum();
            reflected[k] - absorbed + self.emitted[k]
        })
    }
}

/// Edges over the visible range, rising and falling, of peaks and valleys of each width.
fn shapes(slope_limit_per_nm: f64) -> Vec<Edge> {
    let mut shapes = Vec::new();
    let mut slope = slope_limit_per_nm;
    loop {
        for width_nm in WIDTHS_NM {
            for sign in [1.0, -1.0] {
                for falling in [false, true] {
                    add_shapes(&mut shapes, slope, width_nm * sign, falling);
                }
            }
        }
        slope /= 3.0;
        if slope < SOFTEST_PER_NM {
            return shapes;
        }
    }
}

/// `signed_width_nm` is positive for valleys.
fn add_shapes(shapes: &mut Vec<Edge>, slope_per_nm: f64, signed_width_nm: f64, falling: bool) {
    let level = level_at(slope_per_nm, signed_width_nm);
    let direction = if falling { -1.0 } else { 1.0 };
    let [first, last, step] = EDGES_NM;
    for edge_nm in (first..=last).step_by(step as usize).map(f64::from) {
        // A rising edge of a valley has the valley's other edge below it.
        let other_nm = edge_nm - 2.0 * signed_width_nm * direction;
        // Where the other edge is in range too, the other direction lists the same shape.
        if falling && (f64::from(first)..=f64::from(last)).contains(&other_nm) {
            continue;
        }
        let edge = Edge { edge_nm, level, slope_per_nm: slope_per_nm * direction };
        shapes.push(edge.to_sigmoid().to_edge(MIDDLE_NM));
    }
}

/// The level P of a steepest point this far from the extremum: P√(1 + P²) = 1 / (6·s·w).
fn level_at(slope_per_nm: f64, signed_width_nm: f64) -> f64 {
    let product = 1.0 / (6.0 * slope_per_nm * signed_width_nm);
    let square = ((1.0 + 4.0 * product * product).sqrt() - 1.0) / 2.0;
    square.sqrt().copysign(product)
}

fn variants(model: &ModelOnGrid, sums: &Sums) -> (Vec<Variant>, Vec<Lanes>) {
    match model.model() {
        Model::Reflectance => (vec![passive()], Vec::new()),
        Model::Dyes(dyes) => dye_variants(model, dyes, sums),
        Model::Analytic(bells) => bell_variants(model, bells, sums),
    }
}

fn passive() -> Variant {
    let fluorescence = Fluorescence::None;
    Variant { bucket: 0, fluorescence, absorbers: [(0, 0.0); 2], emitted: [0.0; 3] }
}

fn dye_variants(model: &ModelOnGrid, dyes: &DyeModel, sums: &Sums) -> (Vec<Variant>, Vec<Lanes>) {
    let lanes = (0..dyes.curves().len()).map(|dye| sums.lanes(model.dye_absorption(dye))).collect();
    let dense = dyes.options().optical_density.is_some();
    let concentrations = if dense { DENSE_CONCENTRATIONS } else { CONCENTRATIONS };
    let mut variants = Vec::new();
    for first in 0..dyes.pairs() {
        for weight in WEIGHTS {
            let emitted = model.emitted_by_dyes(dyes, first, weight).color;
            for &concentration in concentrations {
                let absorbers = [
                    (first, concentration * (1.0 - weight)),
                    (dyes.partner(first), concentration * weight),
                ];
                variants.push(Variant {
                    bucket: 2 * first + usize::from(weight >= 0.5),
                    fluorescence: Fluorescence::Dyes { first, weight, concentration },
                    absorbers,
                    emitted: emitted.map(|v| concentration * v),
                });
            }
        }
    }
    (variants, lanes)
}

fn bell_variants(
    model: &ModelOnGrid,
    bells: &AnalyticModel,
    sums: &Sums,
) -> (Vec<Variant>, Vec<Lanes>) {
    let (mut variants, mut lanes) = (Vec::new(), Vec::new());
    for (p, emission_peak_nm) in PEAKS_NM.into_iter().enumerate() {
        for (s, stokes_shift_nm) in SHIFTS_NM.into_iter().enumerate() {
            let center_nm = emission_peak_nm - stokes_shift_nm;
            let [curve, _] = sums.sample(|nm| bells.absorption(center_nm, nm));
            lanes.push(curve);
            let emitted = model.emitted_by_bells(bells, emission_peak_nm, stokes_shift_nm).color;
            for &concentration in CONCENTRATIONS {
                variants.push(Variant {
                    bucket: 2 * p + s / 2,
                    fluorescence: Fluorescence::Analytic {
                        emission_peak_nm,
                        stokes_shift_nm,
                        concentration,
                    },
                    absorbers: [(lanes.len() - 1, concentration), (0, 0.0)],
                    emitted: emitted.map(|v| concentration * v),
                });
            }
        }
    }
    (variants, lanes)
}

/// The nearest number in single precision.
#[expect(clippy::cast_possible_truncation, reason = "rounding is what it is for")]
fn to_single(value: f64) -> f32 {
    value as f32
}
