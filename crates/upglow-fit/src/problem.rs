//! The least-squares problems of fitting a material to a color.

use std::f64::consts::LN_10;

use upglow::{AnalyticModel, DyeModel, Edge, Emitted, FilmModel, ModelOnGrid};
use upglow_color::{Goal, Matrix3, Xyz};

pub(crate) mod parabola;
pub(crate) mod shortest_step;
pub(crate) mod single_sums;
pub(crate) mod solver;
pub(crate) mod sums;

use parabola::{
    Chart, MIDDLE_NM, UNIT_NM, edge_chart, edge_of, feature_chart, feature_numbers, free_chart,
    scaled, sigmoid_of, steepness,
};
use single_sums::{Shown, SingleLanes, SingleSums, in_double};
use solver::{Jacobian, Residuals};
use sums::{CLEAR, Lanes, Sums, lanes_from};

/// The coordinates of a reflectance in a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shape {
    /// The parabola's coefficients, without a slope limit.
    Free,
    /// Edge, level, and slope relative to the limit.
    Edge {
        /// The limit, 1/nm.
        slope_limit_per_nm: f64,
    },
    /// Shift, width, and slope relative to the limit; the slope keeps its sign.
    Features {
        /// The limit, 1/nm.
        slope_limit_per_nm: f64,
        /// 1 for valleys, −1 for peaks.
        sign: f64,
    },
}

/// Greatest coefficient. Larger ones make steps between two samples.
const FREE_BOUND: f64 = 1e3;
/// How far from 565 nm a steepest point may lie, in 100 nm: further away it is invisible.
pub(crate) const EDGE_BOUND: f64 = 4.0;
/// Greatest level of the steepest point: at the slope limit 0.01/nm the extremum is then 2.5 nm
/// away, half a step of the sums. Larger lets a fit hide a spike between two samples.
pub(crate) const LEVEL_BOUND: f64 = 2.5;
/// Range of the width of features, in 100 nm. Grays are wider.
const WIDTH_BOUNDS: [f64; 2] = [0.025, 30.0];
/// Least slope of features, relative to the limit; 0 has no features.
const LEAST_SLOPE: f64 = 1e-3;

/// Shift at 565 nm, width 100 nm, half the limit's slope.
const SOFT_FEATURES: [f64; 3] = [0.0, 1.0, 0.5];

impl Shape {
    fn chart(self, numbers: [f64; 3]) -> Chart {
        match self {
            Self::Free => free_chart(numbers),
            Self::Edge { slope_limit_per_nm } => edge_chart(numbers, slope_limit_per_nm),
            Self::Features { slope_limit_per_nm, .. } => feature_chart(numbers, slope_limit_per_nm),
        }
    }

    /// The coordinates of a reflectance.
    ///
    /// A flat reflectance gets the features of a soft one, and one of the other sign those of its
    /// mirror image.
    pub(crate) fn numbers(self, edge: Edge) -> [f64; 3] {
        match self {
            Self::Free => {
                let shape = Self::Edge { slope_limit_per_nm: 1.0 };
                shape.chart(shape.numbers(edge)).0
            }
            Self::Edge { slope_limit_per_nm } => {
                [scaled(edge.edge_nm), edge.level, edge.slope_per_nm / slope_limit_per_nm]
            }
            Self::Features { slope_limit_per_nm, sign } => {
                let [shift, width, slope] =
                    feature_numbers(edge, slope_limit_per_nm).unwrap_or(SOFT_FEATURES);
                [shift, width, sign * slope.abs()]
            }
        }
    }

    /// The reflectance with these coordinates.
    pub(crate) fn edge(self, numbers: [f64; 3]) -> Edge {
        match self {
            Self::Edge { slope_limit_per_nm } => edge_of(numbers, slope_limit_per_nm),
            Self::Free | Self::Features { .. } => {
                sigmoid_of(self.chart(numbers).0).to_edge(MIDDLE_NM)
            }
        }
    }

    fn bounds(self) -> [[f64; 2]; 3] {
        match self {
            Self::Free => [[-FREE_BOUND, FREE_BOUND]; 3],
            Self::Edge { .. } => {
                [[-EDGE_BOUND, EDGE_BOUND], [-LEVEL_BOUND, LEVEL_BOUND], [-1.0, 1.0]]
            }
            Self::Features { sign, .. } => {
                let slopes = if sign > 0.0 { [LEAST_SLOPE, 1.0] } else { [-1.0, -LEAST_SLOPE] };
                [[-EDGE_BOUND, EDGE_BOUND], WIDTH_BOUNDS, slopes]
            }
        }
    }
}

/// Index of the concentration among the unknowns of every fluorescent problem.
pub(crate) const CONCENTRATION: usize = 3;

const FRACTION: [f64; 2] = [0.0, 1.0];

/// Residuals of a color, and their derivatives from those of the color.
fn residuals_of<const N: usize>(
    goal: &Goal,
    color: Xyz,
    derivatives: [Xyz; N],
) -> ([f64; 3], Jacobian<3, N>) {
    let (residuals, by_color) = goal.residuals(color);
    let columns = derivatives.map(|d| by_color * d.0);
    (residuals, [0, 1, 2].map(|i| columns.map(|column| column[i])))
}

/// Derivatives of the color with respect to the shape's coordinates.
fn by_shape(by_parabola: [Xyz; 3], jacobian: [[f64; 3]; 3]) -> [Xyz; 3] {
    let by_parabola = Matrix3::from_columns(by_parabola.map(|by| by.0));
    [0, 1, 2].map(|v| Xyz(by_parabola * [0, 1, 2].map(|m| jacobian[m][v])))
}

/// Reflectance alone; the unknowns are the shape's coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PassiveProblem<'a> {
    pub(crate) sums: &'a Sums,
    pub(crate) goal: Goal,
    pub(crate) shape: Shape,
    /// How many times brighter the light is than the contract's.
    pub(crate) exposure: f64,
}

impl Residuals<3, 3> for PassiveProblem<'_> {
    fn eval(&self, x: &[f64; 3]) -> ([f64; 3], Jacobian<3, 3>) {
        let (parabola, jacobian) = self.shape.chart(*x);
        let reflected = self.sums.reflect(parabola, &CLEAR, []);
        let derivatives = by_shape(reflected.by_parabola, jacobian).map(|by| by * self.exposure);
        residuals_of(&self.goal, reflected.color * self.exposure, derivatives)
    }

    fn bounds(&self) -> [[f64; 2]; 3] {
        self.shape.bounds()
    }
}

/// Reflectance and a pair of dyes; the unknowns are the shape's coordinates, concentration, weight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DyeProblem<'a> {
    pub(crate) sums: &'a Sums,
    pub(crate) goal: Goal,
    pub(crate) shape: Shape,
    pub(crate) model: &'a ModelOnGrid,
    pub(crate) dyes: &'a DyeModel,
    pub(crate) first: usize,
    /// Absorption of the two dyes at concentration 1.
    pub(crate) absorption: [&'a Lanes; 2],
}

impl Residuals<3, 5> for DyeProblem<'_> {
    fn eval(&self, &[s0, s1, s2, c, w]: &[f64; 5]) -> ([f64; 3], Jacobian<3, 5>) {
        let (parabola, jacobian) = self.shape.chart([s0, s1, s2]);
        let [a, b] = self.absorption;
        let absorbed = lanes_from(|i| c * ((1.0 - w) * a[i] + w * b[i]));
        let reflected = self.sums.reflect(parabola, &absorbed, [a, b]);
        let Emitted { color: emitted, derivatives: [emitted_by_w] } =
            self.model.emitted_by_dyes(self.dyes, self.first, w);
        let (emitted, emitted_by_w) = (Xyz::from(emitted), Xyz::from(emitted_by_w));
        let [by_s0, by_s1, by_s2] = by_shape(reflected.by_parabola, jacobian);
        let [seen_a, seen_b] = reflected.seen_by;
        let color = reflected.color + c * emitted;
        let by_c = emitted - (1.0 - w) * seen_a - w * seen_b;
        let by_w = c * (emitted_by_w - seen_b + seen_a);
        residuals_of(&self.goal, color, [by_s0, by_s1, by_s2, by_c, by_w])
    }

    fn bounds(&self) -> [[f64; 2]; 5] {
        let [s0, s1, s2] = self.shape.bounds();
        // A single dye is its own partner: its weight has no effect.
        let weight = if self.dyes.curves().len() == 1 { [0.0, 0.0] } else { FRACTION };
        [s0, s1, s2, FRACTION, weight]
    }
}

/// Reflectance under a film of two dyes; the unknowns are the shape's coordinates and the optical
/// density of each dye. Sums are in single precision, right to 2e-6 in X, Y, Z; the color of what is found is
/// measured in double precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FilmProblem<'a> {
    pub(crate) sums: &'a SingleSums,
    pub(crate) goal: Goal,
    pub(crate) shape: Shape,
    pub(crate) model: &'a ModelOnGrid,
    pub(crate) dyes: [usize; 2],
}

/// The color under a film, its derivatives by the unknowns, and the light that passes the film.
struct FilmColor {
    color: Xyz,
    derivatives: [Xyz; 5],
    passed: SingleLanes,
}

impl FilmProblem<'_> {
    fn color(&self, &[s0, s1, s2, a0, a1]: &[f64; 5]) -> FilmColor {
        let (parabola, jacobian) = self.shape.chart([s0, s1, s2]);
        let (emitted, passed) = self.sums.film(self.model, self.dyes, [a0, a1]);
        let Shown { color, by, seen } =
            self.sums.reflect_under_film(0.0, &parabola, self.dyes, &passed);
        let [by_s0, by_s1, by_s2] = by_shape(by.map(|by| Xyz(in_double(by))), jacobian);
        let [by_a0, by_a1] = [0, 1]
            .map(|dye| Xyz::from(emitted.derivatives[dye]) - LN_10 * Xyz(in_double(seen[dye])));
        let color = Xyz(in_double(color)) + Xyz::from(emitted.color);
        FilmColor { color, derivatives: [by_s0, by_s1, by_s2, by_a0, by_a1], passed }
    }

    /// How the residuals change with each unknown, and with the optical density of each dye of the set.
    pub(crate) fn by_every_dye(&self, x: &[f64; 5]) -> ([[f64; 3]; 5], Vec<[f64; 3]>) {
        let FilmColor { color, derivatives, passed } = self.color(x);
        let &[s0, s1, s2, a0, a1] = x;
        let lost = self.sums.seen_by_dyes(&self.shape.chart([s0, s1, s2]).0, &passed);
        let emitted = self.model.emitted_by_dyes_of_set(self.dyes, [a0, a1]);
        let (_, by_color) = self.goal.residuals(color);
        let by_dye = emitted.into_iter().zip(lost).map(|(emitted, lost)| {
            by_color * (Xyz::from(emitted) - LN_10 * Xyz(in_double(lost))).0
        });
        (derivatives.map(|by| by_color * by.0), by_dye.collect())
    }
}

impl Residuals<3, 5> for FilmProblem<'_> {
    fn eval(&self, x: &[f64; 5]) -> ([f64; 3], Jacobian<3, 5>) {
        let FilmColor { color, derivatives, .. } = self.color(x);
        residuals_of(&self.goal, color, derivatives)
    }

    fn bounds(&self) -> [[f64; 2]; 5] {
        let [s0, s1, s2] = self.shape.bounds();
        let second = if self.dyes[0] == self.dyes[1] { [0.0; 2] } else { FilmModel::DENSITIES };
        [s0, s1, s2, FilmModel::DENSITIES, second]
    }
}

/// Reflectance and bells; the unknowns are the shape's coordinates, concentration, and emission peak
/// and Stokes shift in [`UNIT_NM`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct BellProblem<'a> {
    pub(crate) sums: &'a Sums,
    pub(crate) goal: Goal,
    pub(crate) shape: Shape,
    pub(crate) model: &'a ModelOnGrid,
    pub(crate) bells: &'a AnalyticModel,
}

impl Residuals<3, 6> for BellProblem<'_> {
    fn eval(&self, &[s0, s1, s2, c, peak, shift]: &[f64; 6]) -> ([f64; 3], Jacobian<3, 6>) {
        let (parabola, jacobian) = self.shape.chart([s0, s1, s2]);
        let (peak_nm, shift_nm) = (peak * UNIT_NM, shift * UNIT_NM);
        let [a, a_by_center] = self.sums.sample(|nm| self.bells.absorption(peak_nm - shift_nm, nm));
        let absorbed = lanes_from(|i| c * a[i]);
        let reflected = self.sums.reflect(parabola, &absorbed, [&a, &a_by_center]);
        let Emitted { color: emitted, derivatives: [by_peak_nm, by_shift_nm] } =
            self.model.emitted_by_bells(self.bells, peak_nm, shift_nm);
        let (emitted, by_peak_nm, by_shift_nm) =
            (Xyz::from(emitted), Xyz::from(by_peak_nm), Xyz::from(by_shift_nm));
        let [by_s0, by_s1, by_s2] = by_shape(reflected.by_parabola, jacobian);
        let [seen, seen_by_center] = reflected.seen_by;
        let color = reflected.color + c * emitted;
        let by_c = emitted - seen;
        let unit = c * UNIT_NM;
        let by_peak = unit * (by_peak_nm - seen_by_center);
        let by_shift = unit * (by_shift_nm + seen_by_center);
        residuals_of(&self.goal, color, [by_s0, by_s1, by_s2, by_c, by_peak, by_shift])
    }

    fn bounds(&self) -> [[f64; 2]; 6] {
        let [s0, s1, s2] = self.shape.bounds();
        let [peak, shift] = [AnalyticModel::EMISSION_PEAKS_NM, AnalyticModel::STOKES_SHIFTS_NM]
            .map(|range| range.map(|nm| nm / UNIT_NM));
        [s0, s1, s2, FRACTION, peak, shift]
    }
}

/// The same color with less fluorescence: multipliers are added to the residuals, and the weighted
/// concentration is a fourth one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeastProblem<'p, P> {
    pub(crate) problem: &'p P,
    pub(crate) multipliers: [f64; 3],
    pub(crate) concentration_weight: f64,
}

impl<const N: usize, P: Residuals<3, N>> Residuals<4, N> for LeastProblem<'_, P> {
    fn eval(&self, x: &[f64; N]) -> ([f64; 4], Jacobian<4, N>) {
        let ([r0, r1, r2], [j0, j1, j2]) = self.problem.eval(x);
        let [y0, y1, y2] = self.multipliers;
        let mut by_x = [0.0; N];
        by_x[CONCENTRATION] = self.concentration_weight;
        let cost = self.concentration_weight * x[CONCENTRATION];
        ([r0 + y0, r1 + y1, r2 + y2, cost], [j0, j1, j2, by_x])
    }

    fn bounds(&self) -> [[f64; 2]; N] {
        self.problem.bounds()
    }
}

/// A problem in free coefficients with a fourth residual, a penalty for exceeding the slope limit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LimitedProblem<'p, P> {
    pub(crate) problem: &'p P,
    pub(crate) slope_limit_per_nm: f64,
}

/// The penalty for a slope of twice the limit, in units of the metric. Larger makes the solver slow
/// along the limit; smaller leaves slopes too far above it.
const STEEPNESS_WEIGHT: f64 = 100.0;

impl<const N: usize, P: Residuals<3, N>> Residuals<4, N> for LimitedProblem<'_, P> {
    fn eval(&self, x: &[f64; N]) -> ([f64; 4], Jacobian<4, N>) {
        let ([r0, r1, r2], [j0, j1, j2]) = self.problem.eval(x);
        let (steepness, by_parabola) = steepness([x[0], x[1], x[2]], self.slope_limit_per_nm);
        let mut by_x = [0.0; N];
        if steepness <= 1.0 {
            return ([r0, r1, r2, 0.0], [j0, j1, j2, by_x]);
        }
        (0..3).for_each(|m| by_x[m] = STEEPNESS_WEIGHT * by_parabola[m]);
        ([r0, r1, r2, STEEPNESS_WEIGHT * (steepness - 1.0)], [j0, j1, j2, by_x])
    }

    fn bounds(&self) -> [[f64; 2]; N] {
        self.problem.bounds()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::solver::jacobian_error;
    use upglow::{Accounting, DyeOptions, DyeSet, Mixing, Model};
    use upglow_color::{Choice, Colorimetry, Contract, Grid, LinearRgb, Metric};

    /// A central difference with the steps below errs by their squares and by rounding over them.
    const TOLERANCE: f64 = 1e-6;
    const STEP: f64 = 1e-5;
    const SHAPES: [Shape; 2] = [Shape::Free, Shape::Edge { slope_limit_per_nm: 0.01 }];

    fn goals(colorimetry: &Colorimetry) -> Vec<Goal> {
        let target = colorimetry.xyz_from_rgb(LinearRgb([0.3, 0.6, 0.2]));
        Metric::ALL.iter().map(|metric| metric.goal(colorimetry, target)).collect()
    }

    #[test]
    fn derivatives_of_a_reflectance_match_differences() {
        let colorimetry = Contract::default().on(Grid::FIT);
        let model = ModelOnGrid::new(&Model::Reflectance, &colorimetry);
        let sums = Sums::new(&model);
        for goal in goals(&colorimetry) {
            for shape in SHAPES {
                let problem = PassiveProblem { sums: &sums, goal, shape, exposure: 1.0 };
                assert!(jacobian_error(&problem, &[0.2, -0.7, 0.5], &[STEP; 3]) < TOLERANCE);
            }
        }
    }

    #[test]
    fn derivatives_with_dyes_match_differences() {
        let colorimetry = Contract::default().on(Grid::FIT);
        for accounting in [Accounting::Energy, Accounting::Photon] {
            for mixing in [Mixing::Pooled, Mixing::Separate] {
                let options = DyeOptions { accounting, mixing, ..DyeOptions::default() };
                let dyes = DyeModel::new(DyeSet::named("konig8").unwrap(), options).unwrap();
                let model = Model::Dyes(dyes.clone());
                let model = ModelOnGrid::new(&model, &colorimetry);
                let sums = Sums::new(&model);
                let lanes = [2, 3].map(|dye| sums.lanes(model.dye_absorption(dye)));
                for goal in goals(&colorimetry) {
                    for shape in SHAPES {
                        let absorption = lanes.each_ref();
                        let model = &model;
                        let dyes = &dyes;
                        let sums = &sums;
                        let problem =
                            DyeProblem { sums, goal, shape, model, dyes, first: 2, absorption };
                        let x = [0.2, -0.7, 0.5, 0.6, 0.3];
                        assert!(jacobian_error(&problem, &x, &[STEP; 5]) < TOLERANCE);
                    }
                }
            }
        }
    }

    #[test]
    fn derivatives_with_bells_match_differences() {
        let colorimetry = Contract::default().on(Grid::FIT);
        for accounting in [Accounting::Energy, Accounting::Photon] {
            let bells = AnalyticModel::new(50.0, 45.0, accounting, 1.0).unwrap();
            let model = Model::Analytic(bells);
            let model = ModelOnGrid::new(&model, &colorimetry);
            let sums = Sums::new(&model);
            for goal in goals(&colorimetry) {
                for shape in SHAPES {
                    let problem =
                        BellProblem { sums: &sums, goal, shape, model: &model, bells: &bells };
                    let x = [0.2, -0.7, 0.5, 0.6, 5.432, 0.651];
                    assert!(jacobian_error(&problem, &x, &[STEP; 6]) < TOLERANCE);
                    let multipliers = [0.1, 0.2, 0.3];
                    let least =
                        LeastProblem { problem: &problem, multipliers, concentration_weight: 3.0 };
                    assert!(jacobian_error(&least, &x, &[STEP; 6]) < TOLERANCE);
                }
            }
        }
    }
}
