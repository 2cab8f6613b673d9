//! What is usual for paint.

use upglow_color::choices;

use crate::problem::parabola::{edge_chart, scaled};
use crate::problem::solver::Jacobian;
use crate::problem::{EDGE_BOUND, LEVEL_BOUND};

/// What is known of a paint beside its colors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PaintKind {
    /// Nothing: one paint of twenty is taken to fluoresce, before its colors are looked at.
    #[default]
    Any,
    /// It does not fluoresce.
    Ordinary,
    /// It fluoresces.
    Fluorescent,
}

choices!(
    PaintKind,
    "kind of paint",
    Any = "any",
    Ordinary = "ordinary",
    Fluorescent = "fluorescent",
);

/// Share of the paints that fluoresce, where nothing is known.
const FLUORESCENT_SHARE: f64 = 0.05;

impl PaintKind {
    /// Whether dyes may emit, and the probability of that before colors are known.
    pub(super) fn hypotheses(self) -> Vec<(Dyes, f64)> {
        match self {
            Self::Any => {
                vec![(Dyes::Absorb, 1.0 - FLUORESCENT_SHARE), (Dyes::Emit, FLUORESCENT_SHARE)]
            }
            Self::Ordinary => vec![(Dyes::Absorb, 1.0)],
            Self::Fluorescent => vec![(Dyes::Emit, 1.0)],
        }
    }
}

/// What the dyes of a film do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dyes {
    /// They absorb, like any pigment: their yields are 0.
    Absorb,
    /// They absorb and emit.
    Emit,
}

impl Dyes {
    fn usual(self) -> &'static Usual {
        match self {
            Self::Absorb => &ORDINARY,
            Self::Emit => &FLUORESCENT,
        }
    }
}

/// Edge, level and slope of the reflectance as [`edge_chart`] has them, the natural logarithms of both optical
/// densities, and both quantum yields.
pub(super) type Numbers = [f64; UNKNOWNS];
pub(super) const UNKNOWNS: usize = 7;

/// One residual for each number, and one for the reflectance at [`RED_NM`].
pub(super) const PRIOR_ROWS: usize = UNKNOWNS + 1;

/// No reflectance under dyes is steeper, 1/nm: as in the preset `natural`, and as measured paint.
pub(super) const SLOPE_MAX_PER_NM: f64 = 0.02;

/// Means and standard deviations of [`Numbers`]. All are weak: they say what is out of the ordinary, not what is
/// right.
type Usual = [Numbers; 2];

/// A film may be thin or loaded; half of what is absorbed comes back, more or less; the reflectance below is smooth.
const FLUORESCENT: Usual =
    [[0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.5], [1.2, 0.7, 0.004 / SLOPE_MAX_PER_NM, 3.0, 3.0, 0.3, 0.3]];

/// The reflectance makes the color, and thin films change it: with these numbers, the band of nine of ten materials
/// holds the truth for nine of ten of the 99 object colors of CIE 224:2017, of which the color under D65 is known.
const ORDINARY: Usual = [
    [0.0, 0.0, 0.0, -1.2, -1.2, 0.0, 0.0],
    [1.2, 0.7, 0.006 / SLOPE_MAX_PER_NM, 0.8, 0.8, 0.3, 0.3],
];

/// Mean and standard deviation of the reflectance at a wavelength, nm, where dyes show least of themselves: bright or
/// dark.
const RED_NM: f64 = 720.0;
const RED: [f64; 2] = [0.7, 0.5];

/// Optical densities: below the least a dye is not seen; the greatest is that of a film.
const DENSITIES: [f64; 2] = [0.01, upglow::FilmModel::DENSITIES[1]];

pub(super) fn densities(numbers: &Numbers) -> [f64; 2] {
    let &[_, _, _, first, second, _, _] = numbers;
    [first.exp(), second.exp()]
}

pub(super) fn bounds(dyes: Dyes) -> [[f64; 2]; UNKNOWNS] {
    let density = DENSITIES.map(f64::ln);
    let edge = [-EDGE_BOUND, EDGE_BOUND];
    let level = [-LEVEL_BOUND, LEVEL_BOUND];
    let yields = match dyes {
        Dyes::Absorb => [0.0; 2],
        Dyes::Emit => [0.0, 1.0],
    };
    [edge, level, [-1.0, 1.0], density, density, yields, yields]
}

/// How far the numbers are from the means, in standard deviations.
pub(super) fn residuals(
    dyes: Dyes,
    numbers: &Numbers,
) -> ([f64; PRIOR_ROWS], Jacobian<PRIOR_ROWS, UNKNOWNS>) {
    let [means, deviations] = dyes.usual();
    let mut rows = [0.0; PRIOR_ROWS];
    let mut jacobian = [[0.0; UNKNOWNS]; PRIOR_ROWS];
    for v in 0..UNKNOWNS {
        rows[v] = (numbers[v] - means[v]) / deviations[v];
        jacobian[v][v] = deviations[v].recip();
    }
    let &[edge, level, slope, ..] = numbers;
    let ([q0, q1, q2], by_numbers) = edge_chart([edge, level, slope], SLOPE_MAX_PER_NM);
    let t = scaled(RED_NM);
    let x = q0 + t * (q1 + t * q2);
    let root = (1.0 + x * x).sqrt();
    let [mean, deviation] = RED;
    rows[UNKNOWNS] = (0.5 + 0.5 * x / root - mean) / deviation;
    let by_x = 0.5 / (root * root * root) / deviation;
    for v in 0..3 {
        let x_by = by_numbers[0][v] + t * (by_numbers[1][v] + t * by_numbers[2][v]);
        jacobian[UNKNOWNS][v] = by_x * x_by;
    }
    (rows, jacobian)
}

/// The logarithm of the probability density of the means, but for a constant.
pub(super) fn log_density(dyes: Dyes) -> f64 {
    let [_, deviations] = dyes.usual();
    -deviations.iter().map(|deviation| deviation.ln()).sum::<f64>()
}

/// A start for each of any count: numbers within what is usual, evenly spread.
///
/// # Source
///
/// Additive recurrence by the powers of the root of x⁸ = x + 1, which generalizes the golden ratio to seven
/// dimensions.
pub(super) fn start(count: usize) -> Numbers {
    const ROOT: f64 = 1.112_775_684_278_706;
    let mut power = 1.0;
    let spread: Numbers = std::array::from_fn(|_| {
        power /= ROOT;
        2.0 * (0.5 + power * (count as f64 + 1.0)).fract() - 1.0
    });
    let [edge, level, slope, first, second, one, two] = spread;
    let [q, p] = [one, two].map(|v| 0.5 + 0.3 * v);
    [1.5 * edge, 1.5 * level, 0.8 * slope, 1.2 * first, 1.2 * second, q, p]
}

/// The greatest difference of two numbers, in standard deviations.
pub(super) fn distance(dyes: Dyes, one: &Numbers, two: &Numbers) -> f64 {
    let [_, deviations] = dyes.usual();
    (0..UNKNOWNS).map(|v| ((one[v] - two[v]) / deviations[v]).abs()).fold(0.0, f64::max)
}
