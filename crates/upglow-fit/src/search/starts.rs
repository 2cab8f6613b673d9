//! Where fits start: a table of materials, most at the slope limit, and those nearest to a color.

use std::ops::{Range, RangeInclusive};

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch, f32x16, u32x16};
use upglow::{AnalyticModel, DyeModel, Edge, FilmModel, Fluorescence, Model, ModelOnGrid};
use upglow_color::rounding::to_single;
use upglow_color::{Goal, Lab, Xyz, ciede2000, ciede2000_residuals, lab_from_xyz};

use crate::fit::Start;
use crate::problem::Shape;
use crate::problem::parabola::MIDDLE_NM;
use crate::problem::sums::{Lanes, Sums};

/// The start materials and their colors, in buckets of similar fluorescence, or of similar shape for
/// reflectances.
#[derive(Clone, Debug)]
pub(crate) struct StartTable {
    shapes: Vec<Edge>,
    entries: Vec<Entry>,
    /// CIELAB of each entry, `[L a b][entry]`.
    lab: [Vec<f32>; 3],
    simd_level: Level,
    /// First entry of each bucket, and the end of the last; all multiples of [`WIDTH`].
    buckets: Vec<usize>,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    shape: u32,
    fluorescence: Fluorescence,
}

/// Steepest points of the start shapes, nm.
const EDGES_NM: RangeInclusive<u32> = 390..=710;
/// Their distance, nm. A finer one finds no better materials; one of 40 nm misses some, but not of films,
/// where any two dyes at several densities make up for it.
const STEP_NM: usize = 20;
const STEP_UNDER_FILMS_NM: usize = 40;
/// Their widths, nm, from a spike to a straight edge.
const WIDTHS_NM: [f64; 6] = [4.0, 10.0, 25.0, 60.0, 150.0, 1000.0];
/// Start slopes are the limit, a third of it, and so on down to this, 1/nm: fits of softer ones succeed
/// without a limit.
const SOFTEST_PER_NM: f64 = 0.005;
/// Weights of the second dye.
const WEIGHTS: [f64; 3] = [0.0, 0.5, 1.0];
/// Concentrations for dyes in a thin solution, and for dense pigments, whose absorption is wide.
const CONCENTRATIONS: &[f64] = &[0.45, 1.0];
const DENSE_CONCENTRATIONS: &[f64] = &[0.2, 0.5, 1.0];
/// Number of buckets for starts without fluorescence.
const PASSIVE_BUCKETS: usize = 24;
/// Emission peaks and Stokes shifts of bells, nm.
const PEAKS_NM: [f64; 11] =
    [400.0, 431.0, 462.0, 493.0, 524.0, 555.0, 586.0, 617.0, 648.0, 679.0, 710.0];
const SHIFTS_NM: [f64; 4] = [15.0, 40.0, 75.0, 110.0];

/// A start fluorescence, its bucket, and how it changes the color of a reflectance.
struct Variant {
    bucket: usize,
    fluorescence: Fluorescence,
    filter: Filter,
    emitted: Xyz,
}

/// What a fluorescence takes of the light before the reflectance.
enum Filter {
    /// Absorption curves by index, with their concentrations.
    Absorbers([(usize, f64); 2]),
    /// A film that lets this share pass.
    Film(Box<Lanes>),
}

impl StartTable {
    /// The table for one model and light; `dye_lanes` are the absorptions of its dyes.
    pub(crate) fn new(
        model: &ModelOnGrid,
        sums: &Sums,
        dye_lanes: &[Lanes],
        slope_limit_per_nm: f64,
    ) -> Self {
        let step_nm = match model.model() {
            Model::Film(_) => STEP_UNDER_FILMS_NM,
            Model::Reflectance | Model::Dyes(_) | Model::Analytic(_) => STEP_NM,
        };
        let shapes = shapes(slope_limit_per_nm, step_nm);
        let (variants, bells) = variants(model, sums);
        let absorbers = match model.model() {
            Model::Dyes(_) => dye_lanes,
            Model::Reflectance | Model::Film(_) | Model::Analytic(_) => &bells,
        };
        let white = model.colorimetry().white();
        let mut sorted: Vec<(usize, Entry, Lab)> = Vec::new();
        let per_kind = shapes.len().div_ceil(PASSIVE_BUCKETS);
        for (index, &shape) in (0..).zip(&shapes) {
            let r = sums.reflectance(Shape::Free.numbers(shape));
            let reflected = sums.integrate(|i| r[i]);
            let taken: Vec<Xyz> =
                absorbers.iter().map(|a| sums.integrate(|i| r[i] * a[i])).collect();
            for variant in &variants {
                let passed = match &variant.filter {
                    Filter::Absorbers(absorbers) => reflected - absorbed(absorbers, &taken),
                    Filter::Film(passed) => sums.integrate(|i| r[i] * passed[i]),
                };
                let lab = lab_from_xyz(passed + variant.emitted, white);
                let fluorescence = variant.fluorescence;
                let bucket = match fluorescence {
                    Fluorescence::None => index as usize / per_kind,
                    Fluorescence::Film { .. } => {
                        variant.bucket
                            + usize::from(shape.level > 0.0)
                            + 2 * usize::from(shape.slope_per_nm > 0.0)
                    }
                    _ => variant.bucket,
                };
                sorted.push((bucket, Entry { shape: index, fluorescence }, lab));
            }
        }
        sorted.sort_by_key(|(bucket, ..)| *bucket);
        let mut table = Self {
            shapes,
            entries: Vec::new(),
            lab: [Vec::new(), Vec::new(), Vec::new()],
            simd_level: Level::new(),
            buckets: vec![0],
        };
        for bucket in sorted.chunk_by(|(a, ..), (b, ..)| a == b) {
            table.add_bucket(bucket);
        }
        table
    }

    /// Adds a bucket, padded to whole vectors with entries at an infinite distance.
    fn add_bucket(&mut self, bucket: &[(usize, Entry, Lab)]) {
        const NOWHERE: Lab = Lab { l: f64::INFINITY, a: 0.0, b: 0.0 };
        let filler = (0, Entry { shape: 0, fluorescence: Fluorescence::None }, NOWHERE);
        let fill = bucket.len().next_multiple_of(WIDTH) - bucket.len();
        for (_, entry, lab) in bucket.iter().chain(std::iter::repeat_n(&filler, fill)) {
            self.entries.push(*entry);
            for (values, value) in self.lab.iter_mut().zip([lab.l, lab.a, lab.b]) {
                values.push(to_single(value));
            }
        }
        self.buckets.push(self.entries.len());
    }

    /// The nearest start of each bucket, nearest first.
    ///
    /// Distance is CIEDE2000 linearized around the goal, a quadratic form: that finds the same starts
    /// as the full formula at a tenth of the cost.
    pub(crate) fn nearest(&self, goal: &Goal) -> Vec<Start> {
        self.nearest_with_distance(goal).into_iter().map(|(_, start)| start).collect()
    }

    pub(crate) fn nearest_with_distance(&self, goal: &Goal) -> Vec<(f32, Start)> {
        let form = Form::around(goal);
        let mut best: Vec<(f32, usize)> = Vec::with_capacity(self.buckets.len());
        dispatch!(self.simd_level, simd => simd.vectorize(
            #[inline(always)]
            || {
                for range in self.buckets.windows(2) {
                    best.extend(self.nearest_of(simd, range[0]..range[1], &form));
                }
            },
        ));
        best.sort_by(|x, y| x.0.total_cmp(&y.0));
        best.into_iter().map(|(at, index)| (at, self.start(index))).collect()
    }

    /// The nearest few starts of each bucket, by exact CIEDE2000.
    pub(crate) fn nearest_of_each(&self, goal: &Goal, count: usize) -> Vec<Start> {
        let distance = |index: usize| {
            let [l, a, b] = self.lab.each_ref().map(|v| f64::from(v[index]));
            let finite = l.is_finite();
            if finite { ciede2000(goal.lab(), Lab { l, a, b }) } else { f64::INFINITY }
        };
        let of_bucket = |range: &[usize]| {
            let mut near: Vec<(f64, usize)> =
                (range[0]..range[1]).map(|index| (distance(index), index)).collect();
            near.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
            near.truncate(count);
            near.into_iter().filter(|(at, _)| at.is_finite()).map(|(_, index)| self.start(index))
        };
        self.buckets.windows(2).flat_map(of_bucket).collect()
    }

    fn start(&self, index: usize) -> Start {
        let Entry { shape, fluorescence } = self.entries[index];
        Start { reflectance: self.shapes[shape as usize], fluorescence }
    }

    /// The least value of the form in a bucket, and the first entry that has it.
    #[inline(always)]
    fn nearest_of<S: Simd>(
        &self,
        simd: S,
        bucket: Range<usize>,
        form: &Form,
    ) -> Option<(f32, usize)> {
        let mut least = f32x16::splat(simd, f32::INFINITY);
        let mut block_of = u32x16::splat(simd, 0);
        for (block, at) in (0_u32..).zip(bucket.clone().step_by(WIDTH)) {
            let lab = self.lab.each_ref().map(|v| f32x16::from_slice(simd, &v[at..at + WIDTH]));
            let value = form.at(lab);
            let is_less = value.simd_lt(least);
            least = is_less.select(value, least);
            block_of = is_less.select(u32x16::splat(simd, block), block_of);
        }
        let places = (0..WIDTH).map(|k| (least[k], block_of[k] as usize * WIDTH + k));
        let (at, index) = places.min_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)))?;
        at.is_finite().then_some((at, bucket.start + index))
    }
}

/// How many entries are compared in parallel.
const WIDTH: usize = 16;

/// CIEDE2000 squared, linearized around a color: a quadratic form in Lab.
struct Form {
    center: [f32; 3],
    /// Derivative of the first residual with respect to L.
    by_l: f32,
    /// Derivatives of the second and third with respect to a and b.
    by_ab: [[f32; 2]; 2],
}

impl Form {
    fn around(goal: &Goal) -> Self {
        let Lab { l, a, b } = goal.lab();
        let (_, jacobian) = ciede2000_residuals(goal.lab(), goal.lab());
        let [[by_l, ..], [_, second @ ..], [_, third @ ..]] = jacobian.0;
        Self {
            center: [l, a, b].map(to_single),
            by_l: to_single(by_l),
            by_ab: [second, third].map(|row| row.map(to_single)),
        }
    }

    #[inline(always)]
    fn at<S: Simd>(&self, [l, a, b]: [f32x16<S>; 3]) -> f32x16<S> {
        let [l0, a0, b0] = self.center;
        let (dl, da, db) = ((l - l0) * self.by_l, a - a0, b - b0);
        let [second, third] = self.by_ab.map(|row| da * row[0] + db * row[1]);
        dl * dl + second * second + third * third
    }
}

/// The color that absorbers take, where each curve alone would take `taken`.
fn absorbed(absorbers: &[(usize, f64); 2], taken: &[Xyz]) -> Xyz {
    let absorbers = absorbers.iter().filter(|(_, share)| *share > 0.0);
    absorbers.map(|&(curve, share)| share * taken[curve]).sum()
}

/// Rising and falling edges over the visible range, of peaks and valleys of each width.
fn shapes(slope_limit_per_nm: f64, step_nm: usize) -> Vec<Edge> {
    let mut shapes = Vec::new();
    let mut slope = slope_limit_per_nm;
    loop {
        for width_nm in WIDTHS_NM {
            for sign in [1.0, -1.0] {
                for falling in [false, true] {
                    shapes.extend(edges(slope, width_nm * sign, falling, step_nm));
                }
            }
        }
        slope /= 3.0;
        if slope < SOFTEST_PER_NM {
            return shapes;
        }
    }
}

/// A shape for each edge; `signed_width_nm` is positive for valleys.
fn edges(
    slope_per_nm: f64,
    signed_width_nm: f64,
    falling: bool,
    step_nm: usize,
) -> impl Iterator<Item = Edge> {
    let level = level_at(slope_per_nm, signed_width_nm);
    let direction = if falling { -1.0 } else { 1.0 };
    let visible = f64::from(*EDGES_NM.start())..=f64::from(*EDGES_NM.end());
    EDGES_NM.step_by(step_nm).map(f64::from).filter_map(move |edge_nm| {
        // The other edge of a valley is at shorter wavelengths for a rising edge. If it is visible too,
        // the other direction adds the same shape.
        let other_nm = edge_nm - 2.0 * signed_width_nm * direction;
        let edge = Edge { edge_nm, level, slope_per_nm: slope_per_nm * direction };
        let is_repeated = falling && visible.contains(&other_nm);
        (!is_repeated).then(|| edge.to_sigmoid().to_edge(MIDDLE_NM))
    })
}

/// The level P of a steepest point at this distance from the extremum: P√(1 + P²) = 1 / (6·s·w).
fn level_at(slope_per_nm: f64, signed_width_nm: f64) -> f64 {
    let product = 1.0 / (6.0 * slope_per_nm * signed_width_nm);
    let square = ((1.0 + 4.0 * product * product).sqrt() - 1.0) / 2.0;
    square.sqrt().copysign(product)
}

/// The variants, and their absorption curves if these are not those of dyes.
fn variants(model: &ModelOnGrid, sums: &Sums) -> (Vec<Variant>, Vec<Lanes>) {
    match model.model() {
        Model::Reflectance => {
            let (filter, emitted) = (Filter::Absorbers([(0, 0.0); 2]), Xyz::default());
            let fluorescence = Fluorescence::None;
            (vec![Variant { bucket: 0, fluorescence, filter, emitted }], Vec::new())
        }
        Model::Dyes(dyes) => (dye_variants(model, dyes), Vec::new()),
        Model::Film(film) => (film_variants(model, film, sums), Vec::new()),
        Model::Analytic(bells) => bell_variants(model, bells, sums),
    }
}

fn dye_variants(model: &ModelOnGrid, dyes: &DyeModel) -> Vec<Variant> {
    let dense = dyes.options().optical_density.is_some();
    let concentrations = if dense { DENSE_CONCENTRATIONS } else { CONCENTRATIONS };
    let mut variants = Vec::new();
    for first in 0..dyes.pairs() {
        for weight in WEIGHTS {
            let emitted = Xyz::from(model.emitted_by_dyes(dyes, first, weight).color);
            for &concentration in concentrations {
                let absorbers = [
                    (first, concentration * (1.0 - weight)),
                    (dyes.partner(first), concentration * weight),
                ];
                variants.push(Variant {
                    bucket: 2 * first + usize::from(weight >= 0.5),
                    fluorescence: Fluorescence::Dyes { first, weight, concentration },
                    filter: Filter::Absorbers(absorbers),
                    emitted: concentration * emitted,
                });
            }
        }
    }
    variants
}

/// Optical densities of one dye, and of each of two.
const SINGLE_DENSITIES: [f64; 4] = [0.15, 0.6, 1.8, 5.0];
const PAIR_DENSITIES: [f64; 3] = [0.2, 0.9, 3.5];

fn film_variants(model: &ModelOnGrid, film: &FilmModel, sums: &Sums) -> Vec<Variant> {
    let count = film.dyes().curves().len();
    let mut variants = Vec::new();
    let mut passed = vec![0.0; model.wavelengths_nm().len()];
    let mut add = |bucket: usize, first: (usize, f64), second: (usize, f64)| {
        let fluorescence = Fluorescence::film(first, second);
        let Fluorescence::Film { dyes, densities } = fluorescence else { return };
        let emitted = Xyz::from(model.emitted_by_film(dyes, densities, &mut passed).color);
        let filter = Filter::Film(Box::new(sums.lanes(&passed)));
        variants.push(Variant { bucket, fluorescence, filter, emitted });
    };
    let mut bucket = 0;
    for i in 0..count {
        for density in SINGLE_DENSITIES {
            add(bucket, (i, density), (i, 0.0));
        }
        bucket += 4;
        for j in i + 1..count {
            for a in PAIR_DENSITIES {
                for b in PAIR_DENSITIES {
                    add(bucket, (i, a), (j, b));
                }
            }
            bucket += 4;
        }
    }
    variants
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
            let emitted = Xyz::from(emitted);
            for &concentration in CONCENTRATIONS {
                variants.push(Variant {
                    bucket: 2 * p + s / 2,
                    fluorescence: Fluorescence::Analytic {
                        emission_peak_nm,
                        stokes_shift_nm,
                        concentration,
                    },
                    filter: Filter::Absorbers([(lanes.len() - 1, concentration), (0, 0.0)]),
                    emitted: concentration * emitted,
                });
            }
        }
    }
    (variants, lanes)
}
