//! The search of König et al. 2020: from gray, then from the neighbors' materials, with each pair of
//! dyes.
//!
//! The paper does not say where the unknowns start, how the slope limit applies to coefficients, and
//! whether a color that a reflectance matches gets fluorescence; here it does not.

use upglow::{Edge, Fluorescence, Model, Sigmoid};
use upglow_color::Metric;

use super::job::{Job, Solve};
use crate::fit::{EXACT, Fit, Start};
use crate::problem::parabola::MIDDLE_NM;
use crate::problem::solver::{Residuals, SolverOptions, Summary, solve};
use crate::problem::{LimitedProblem, Shape};

/// The unknowns of a reflectance.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Parameters {
    /// c0, c1, c2; the slope limit is a penalty.
    Coefficients,
    /// Shift, width, slope; the slope limit is a bound.
    Features,
}

/// Start of fluorescence: half concentration, half of each dye, the middle of the bells' ranges.
const START_CONCENTRATION: f64 = 0.5;
const START_WEIGHT: f64 = 0.5;
const START_BELLS_NM: [f64; 2] = [555.0, 65.0];

/// Start of features: a valley and a peak around the middle, half as steep as the limit.
const START_WIDTH_NM: f64 = 100.0;

/// Evaluations of one solve.
const STEPS: usize = 40;

impl Job<'_> {
    /// The first material, from a gray start.
    pub(crate) fn konig2020_first(&self, parameters: Parameters) -> Fit {
        let passive = self.passive(parameters);
        if passive.de2000 <= EXACT {
            return passive;
        }
        self.best_variant(parameters, passive, passive)
    }

    /// The best of `known` and of the fits that start from `known` and from the neighbors.
    pub(crate) fn konig2020_again(
        &self,
        parameters: Parameters,
        known: Fit,
        neighbors: &[Fit],
    ) -> Fit {
        let mut best = known;
        for start in [known].iter().chain(neighbors) {
            best = self.best_variant(parameters, *start, best);
            if best.de2000 <= EXACT {
                break;
            }
        }
        best
    }

    /// Reflectance alone. CIEDE2000 has no derivative at gray, so a fit by CIELAB goes first.
    fn passive(&self, parameters: Parameters) -> Fit {
        let gray = Sigmoid::flat(0.5).to_edge(MIDDLE_NM);
        let slope_per_nm = self.stage.slope_limit_per_nm / 2.0;
        let starts = match parameters {
            Parameters::Coefficients => vec![gray],
            Parameters::Features => {
                [1.0, -1.0].map(|sign| soft_shape(sign * START_WIDTH_NM, slope_per_nm)).to_vec()
            }
        };
        let begin = Self { goal: self.goal.under(Metric::De76), ..*self };
        let fits = starts.into_iter().map(|reflectance| {
            let start = Start { reflectance, fluorescence: Fluorescence::None };
            let begun = begin.followed(parameters, start);
            self.followed(parameters, Start::from(begun))
        });
        fits.min_by(|a, b| a.distance.total_cmp(&b.distance)).expect("there is a start")
    }

    /// The best of `known` and of the fits that start from `from` with each pair of dyes.
    fn best_variant(&self, parameters: Parameters, from: Fit, known: Fit) -> Fit {
        let mut best = known;
        for fluorescence in variants(self.context.model.model(), from.fluorescence) {
            let start = Start { reflectance: from.reflectance, fluorescence };
            let found = self.followed(parameters, start);
            if found.distance < best.distance {
                best = found;
            }
            if best.de2000 <= EXACT {
                break;
            }
        }
        best
    }

    fn followed(&self, parameters: Parameters, start: Start) -> Fit {
        let slope_limit_per_nm = self.stage.slope_limit_per_nm;
        match parameters {
            Parameters::Coefficients => {
                let fit = self.follow(start, Shape::Free, &Penalized { slope_limit_per_nm });
                self.held_at_limit(fit)
            }
            Parameters::Features => {
                let sign = if start.reflectance.level >= 0.0 { 1.0 } else { -1.0 };
                self.follow(start, Shape::Features { slope_limit_per_nm, sign }, &options())
            }
        }
    }

    /// A fit with its slope reduced to the limit, which the penalty may let it exceed.
    fn held_at_limit(&self, fit: Fit) -> Fit {
        let limit = self.stage.slope_limit_per_nm;
        let Edge { slope_per_nm, .. } = fit.reflectance;
        if slope_per_nm.abs() <= limit {
            return fit;
        }
        let slope_per_nm = slope_per_nm.clamp(-limit, limit);
        self.measured(Edge { slope_per_nm, ..fit.reflectance }, fit.fluorescence)
    }
}

/// A valley, or for a negative width a peak, around the middle.
fn soft_shape(signed_width_nm: f64, slope_per_nm: f64) -> Edge {
    let features = upglow::Features {
        shift_nm: MIDDLE_NM,
        width_nm: signed_width_nm.abs(),
        slope_per_nm: slope_per_nm.copysign(signed_width_nm),
    };
    features.to_sigmoid().expect("width and slope are not zero").to_edge(MIDDLE_NM)
}

/// A fluorescence with each pair of dyes in turn.
fn variants(model: &Model, fluorescence: Fluorescence) -> Vec<Fluorescence> {
    match model {
        Model::Reflectance | Model::Film(_) => vec![Fluorescence::None],
        Model::Dyes(dyes) => {
            let (weight, concentration) = match fluorescence {
                Fluorescence::Dyes { weight, concentration, .. } => (weight, concentration),
                _ => (START_WEIGHT, START_CONCENTRATION),
            };
            let pair = |first| Fluorescence::Dyes { first, weight, concentration };
            (0..dyes.pairs()).map(pair).collect()
        }
        Model::Analytic(_) => match fluorescence {
            Fluorescence::Analytic { .. } => vec![fluorescence],
            _ => {
                let [emission_peak_nm, stokes_shift_nm] = START_BELLS_NM;
                let concentration = START_CONCENTRATION;
                vec![Fluorescence::Analytic { emission_peak_nm, stokes_shift_nm, concentration }]
            }
        },
    }
}

/// Coefficients, with the slope limit as a penalty.
struct Penalized {
    slope_limit_per_nm: f64,
}

impl Solve for Penalized {
    fn solve<const N: usize>(&self, problem: &impl Residuals<3, N>, start: [f64; N]) -> Summary<N> {
        let limited = LimitedProblem { problem, slope_limit_per_nm: self.slope_limit_per_nm };
        solve(&limited, start, &options())
    }
}

fn options() -> SolverOptions {
    SolverOptions { step_limit: STEPS, ..SolverOptions::default() }
}
