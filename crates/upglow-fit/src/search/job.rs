//! One target color: what all search methods have in common.

use upglow::{Edge, Fluorescence, Model, Sigmoid};
use upglow_color::{Goal, Metric};

use super::context::{Context, Stage};
use super::starts::StartTable;
use crate::fit::{Fit, Start};
use crate::problem::parabola::{MIDDLE_NM, UNIT_NM};
use crate::problem::solver::{Residuals, SolverOptions, Summary, solve};
use crate::problem::{BellProblem, DyeProblem, PassiveProblem, Shape};

/// A target color, and what the search for its material needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Job<'c> {
    pub(crate) context: &'c Context,
    /// The slope limit, and the starts within it.
    pub(crate) stage: &'c Stage,
    pub(crate) goal: Goal,
}

/// A color this near to a multiple of white, in XYZ, is a gray: rounding only.
const GRAY: f64 = 1e-9;

impl Job<'_> {
    /// A flat reflectance if the color is a gray no brighter than white.
    pub(crate) fn gray(&self) -> Option<Fit> {
        let white = self.context.model.colorimetry().white();
        let color = self.goal.xyz();
        let value = color.0[1] / white.0[1];
        let off = (color - value * white).0.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let value = if (value - 1.0).abs() < GRAY { 1.0 } else { value };
        if off > GRAY || !(0.0..=1.0).contains(&value) {
            return None;
        }
        Some(self.measured(Sigmoid::flat(value).to_edge(MIDDLE_NM), Fluorescence::None))
    }

    /// A material as a fit, with its color differences.
    pub(crate) fn measured(&self, reflectance: Edge, fluorescence: Fluorescence) -> Fit {
        let fluorescence = match fluorescence.dose() {
            c if c > 0.0 => fluorescence,
            _ => Fluorescence::None,
        };
        let color = self.context.color(reflectance, fluorescence);
        let de2000 = self.goal.under(Metric::De2000).distance(color);
        let distance = match self.goal.metric() {
            Metric::De2000 => de2000,
            _ => self.goal.distance(color),
        };
        let lab = self.context.model.colorimetry().lab_from_xyz(color);
        Fit { reflectance, fluorescence, distance, de2000, lab }
    }

    /// The materials to start from.
    pub(crate) fn starts(&self) -> &StartTable {
        self.context.starts(self.stage)
    }

    /// The coordinates in which the slope limit is a bound on one unknown.
    pub(crate) fn edge_shape(&self) -> Shape {
        Shape::Edge { slope_limit_per_nm: self.stage.slope_limit_per_nm }
    }

    /// Fits a material with `solve` from `start`, in the coordinates `shape`.
    pub(crate) fn follow(&self, start: Start, shape: Shape, solve: &impl Solve) -> Fit {
        let numbers = shape.numbers(start.reflectance);
        let [s0, s1, s2] = numbers;
        let Self { goal, context: Context { model, sums, .. }, .. } = *self;
        match (start.fluorescence, self.context.model.model()) {
            (Fluorescence::Dyes { first, weight, concentration }, Model::Dyes(dyes)) => {
                let lanes = &self.context.dye_lanes;
                let absorption = [&lanes[first], &lanes[dyes.partner(first)]];
                let problem = DyeProblem { sums, goal, shape, model, dyes, first, absorption };
                let x = [s0, s1, s2, concentration, weight];
                let [s0, s1, s2, concentration, weight] = self.counted(solve.solve(&problem, x));
                let fluorescence = Fluorescence::Dyes { first, weight, concentration };
                self.measured(shape.edge([s0, s1, s2]), fluorescence)
            }
            (Fluorescence::Film { dyes, densities: [a, b] }, Model::Film(_)) => {
                let problem = self.film_problem(shape, dyes);
                self.film_found(&problem, solve.solve(&problem, [s0, s1, s2, a, b]))
            }
            (
                Fluorescence::Analytic { emission_peak_nm, stokes_shift_nm, concentration },
                Model::Analytic(bells),
            ) => {
                let [peak, shift] = [emission_peak_nm, stokes_shift_nm].map(|v| v / UNIT_NM);
                let problem = BellProblem { sums, goal, shape, model, bells };
                let x = [s0, s1, s2, concentration, peak, shift];
                let [s0, s1, s2, concentration, peak, shift] =
                    self.counted(solve.solve(&problem, x));
                let fluorescence = Fluorescence::Analytic {
                    emission_peak_nm: peak * UNIT_NM,
                    stokes_shift_nm: shift * UNIT_NM,
                    concentration,
                };
                self.measured(shape.edge([s0, s1, s2]), fluorescence)
            }
            _ => {
                let x = self.counted(solve.solve(&self.passive_problem(shape), numbers));
                self.measured(shape.edge(x), Fluorescence::None)
            }
        }
    }

    /// The solution; adds its evaluations to the fitter's count.
    pub(super) fn counted<const N: usize>(&self, found: Summary<N>) -> [f64; N] {
        self.context.count(found.evaluations);
        found.x
    }

    pub(crate) fn passive_problem(&self, shape: Shape) -> PassiveProblem<'_> {
        PassiveProblem { sums: &self.context.sums, goal: self.goal, shape, exposure: 1.0 }
    }
}

/// A solver for the problems of a color.
pub(crate) trait Solve {
    /// The solution from `start`.
    fn solve<const N: usize>(&self, problem: &impl Residuals<3, N>, start: [f64; N]) -> Summary<N>;
}

/// Minimizes the distance alone.
impl Solve for SolverOptions {
    fn solve<const N: usize>(&self, problem: &impl Residuals<3, N>, start: [f64; N]) -> Summary<N> {
        solve(problem, start, self)
    }
}
