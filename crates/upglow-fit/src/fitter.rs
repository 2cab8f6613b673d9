//! Fits the material of one color.

use upglow::{AnalyticModel, DyeModel, Edge, Fluorescence, Material, Model, ModelOnGrid, Sigmoid};
use upglow_color::{Contract, Goal, Grid, LinearRgb, Metric, Xyz};

use crate::parabola::{edge_numbers, edge_of, scaled, sigmoid_of};
use crate::problem::{
    BELL_UNIT_NM, BellProblem, CONCENTRATION, DyeProblem, LeastProblem, PassiveProblem, Shape,
};
use crate::solver::{Residuals, SolverOptions, Summary, solve};
use crate::starts::{MIDDLE_NM, Start, StartTable};
use crate::sums::{Lanes, Sums};
use crate::{FitOptions, FitOptionsError};

/// Everything that fits under one contract, with one model, share.
#[derive(Clone, Debug)]
pub struct Fitter {
    model: ModelOnGrid,
    options: FitOptions,
    slope_limit_per_nm: f64,
    sums: Sums,
    starts: StartTable,
    dye_lanes: Vec<Lanes>,
}

/// The material of one color.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The reflectance, by its steepest point.
    pub reflectance: Edge,
    /// The fluorescence.
    pub fluorescence: Fluorescence,
    /// Distance from the color by the metric of the fit.
    pub distance: f64,
    /// CIEDE2000 of the material against the color, under the contract, sums over 5 nm.
    pub de2000: f64,
}

/// Why a color cannot be fitted.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ColorError {
    /// A component is not a number in the range.
    #[error("{channel} is {value}, expected 0 to {}", Fitter::BRIGHTEST)]
    Outside {
        /// red, green or blue.
        channel: &'static str,
        /// The value given.
        value: f64,
    },
}

/// A color is matched, and needs no more fluorescence, at this CIEDE2000: a fiftieth of what an
/// eye can tell.
pub(crate) const EXACT: f64 = 0.01;

/// A color this near to a multiple of white, in XYZ, is gray: rounding only.
const GRAY: f64 = 1e-9;

/// Single precision rounds a slope by 6e-8 of itself; fits stay below the limit by more.
const SLOPE_MARGIN: f64 = 1e-6;

/// Evaluations for a reflectance without limits: it takes 5, and 10 where it goes astray.
const PASSIVE_STEPS: usize = 12;

/// A reflectance too steep by less than this factor, and matched within this distance, may have a
/// neighbor within the limit that matches too.
const NEARLY_WITHIN: (f64, f64) = (1.5, 2.0);

/// How many start materials are followed. Six leave 33 of 32768 nodes 0.02 ΔE00 or more from the
/// best known, ten leave 7.
const STARTS_FOLLOWED: usize = 10;

/// How many neighbors' materials are followed.
const NEIGHBORS_FOLLOWED: usize = 2;

/// How often a fit whose weight reaches its end goes on with the next pair of dyes.
const MOST_HOPS: usize = 2;

impl Fit {
    /// The material.
    pub fn material(&self) -> Material {
        Material { reflectance: self.reflectance.to_sigmoid(), fluorescence: self.fluorescence }
    }
}

impl Fitter {
    /// The greatest value of an RGB component: no fluorescent material is ten times white.
    pub const BRIGHTEST: f64 = 10.0;

    /// Prepares fits under a contract, with a model.
    ///
    /// # Errors
    ///
    /// [`FitOptionsError`] if an option is out of range.
    pub fn new(
        contract: &Contract,
        model: &Model,
        options: FitOptions,
    ) -> Result<Self, FitOptionsError> {
        let slope_limit_per_nm = options.slope_limit_per_nm()? * (1.0 - SLOPE_MARGIN);
        let model = ModelOnGrid::new(model, &contract.on(Grid::FIT));
        let sums = Sums::new(&model);
        let starts = StartTable::new(&model, &sums, slope_limit_per_nm);
        let dyes = match model.model() {
            Model::Dyes(dyes) => dyes.curves().len(),
            _ => 0,
        };
        let dye_lanes = (0..dyes).map(|dye| sums.lanes(model.dye_absorption(dye))).collect();
        Ok(Self { model, options, slope_limit_per_nm, sums, starts, dye_lanes })
    }

    /// The model and the contract, on the grid of the fit.
    pub fn model(&self) -> &ModelOnGrid {
        &self.model
    }

    /// The material of `rgb`, which may be brighter than white.
    ///
    /// Reflectance alone where that shows the color within 0.01 ΔE00; else with as little
    /// fluorescence as the color needs; else the nearest material that the search finds.
    ///
    /// # Errors
    ///
    /// [`ColorError`] if a component is not a number in 0..=10.
    pub fn fit(&self, rgb: LinearRgb) -> Result<Fit, ColorError> {
        for (channel, value) in ["red", "green", "blue"].into_iter().zip(rgb.0) {
            if !(0.0..=Self::BRIGHTEST).contains(&value) {
                return Err(ColorError::Outside { channel, value });
            }
        }
        let color = self.model.colorimetry().xyz_from_rgb(rgb);
        let job = self.job(color);
        Ok(job.gray().unwrap_or_else(|| job.search()))
    }

    /// Follows the materials of neighbors towards `color` and keeps the best of them and `known`.
    pub(crate) fn improve(&self, color: Xyz, known: Fit, neighbors: &[Fit]) -> Fit {
        self.job(color).improve(known, neighbors)
    }

    fn job(&self, color: Xyz) -> Job<'_> {
        Job { fitter: self, goal: self.options.metric.goal(self.model.colorimetry(), color) }
    }

    fn edge_shape(&self) -> Shape {
        Shape::Edge { slope_limit_per_nm: self.slope_limit_per_nm }
    }
}

/// The search for the material of one color.
struct Job<'f> {
    fitter: &'f Fitter,
    goal: Goal,
}

impl Job<'_> {
    /// A flat reflectance where the color is a gray no brighter than white.
    fn gray(&self) -> Option<Fit> {
        let white = self.fitter.model.colorimetry().white().0;
        let color = self.goal.xyz().0;
        let value = color[1] / white[1];
        let off = (0..3).map(|k| (color[k] - value * white[k]).abs()).fold(0.0, f64::max);
        let value = if (value - 1.0).abs() < GRAY { 1.0 } else { value };
        if off > GRAY || !(0.0..=1.0).contains(&value) {
            return None;
        }
        Some(self.judge(Sigmoid::flat(value).to_edge(MIDDLE_NM), Fluorescence::None))
    }

    fn search(&self) -> Fit {
        let mut best = self.without_fluorescence();
        if best.is_some_and(|fit| fit.de2000 <= EXACT) {
            return best.expect("just looked at");
        }
        let starts = self.fitter.starts.nearest(&self.goal);
        for start in starts.into_iter().take(STARTS_FOLLOWED) {
            let found = self.follow(start);
            if best.is_none_or(|known| found.distance < known.distance) {
                best = Some(found);
            }
            if found.de2000 <= EXACT {
                return self.with_least_fluorescence(found);
            }
        }
        best.expect("there is at least one start")
    }

    /// A reflectance that shows the color, or nearly, within the slope limit.
    fn without_fluorescence(&self) -> Option<Fit> {
        let fitter = self.fitter;
        let goal = self.goal.under(Metric::De76);
        let problem = PassiveProblem { sums: &fitter.sums, goal, shape: Shape::Free };
        let options = SolverOptions { step_limit: PASSIVE_STEPS, ..SolverOptions::default() };
        let free = solve(&problem, [0.0; 3], &options);
        let steepness = sigmoid_of(free.x).steepest_slope_per_nm() / fitter.slope_limit_per_nm;
        if steepness <= 1.0 {
            return Some(self.judge(sigmoid_of(free.x).to_edge(MIDDLE_NM), Fluorescence::None));
        }
        let (factor, distance) = NEARLY_WITHIN;
        let worth_it = steepness < factor && free.norm < distance;
        worth_it.then(|| {
            self.follow_passive(edge_numbers(free.x, MIDDLE_NM, fitter.slope_limit_per_nm))
        })
    }

    /// Where the solver leads from a start material.
    fn follow(&self, start: Start) -> Fit {
        match (start.fluorescence, self.fitter.model.model()) {
            (Fluorescence::Dyes { .. }, Model::Dyes(dyes)) => self.follow_dyes(start, dyes),
            (Fluorescence::Analytic { .. }, Model::Analytic(bells)) => {
                let x = self.bell_unknowns(start);
                let found = solve(&self.bell_problem(bells), x, &SolverOptions::default());
                self.judge_bells(&found)
            }
            _ => self.follow_passive(start.shape),
        }
    }

    fn follow_passive(&self, shape: [f64; 3]) -> Fit {
        let fitter = self.fitter;
        let problem =
            PassiveProblem { sums: &fitter.sums, goal: self.goal, shape: fitter.edge_shape() };
        let found = solve(&problem, shape, &SolverOptions::default());
        self.judge(edge_of(found.x, fitter.slope_limit_per_nm), Fluorescence::None)
    }

    /// As [`Job::follow`]; a weight at its end is the start of the next pair's fit, because the
    /// dye there belongs to both.
    fn follow_dyes(&self, start: Start, dyes: &DyeModel) -> Fit {
        let Fluorescence::Dyes { mut first, weight, concentration } = start.fluorescence else {
            return self.follow_passive(start.shape);
        };
        let [s0, s1, s2] = start.shape;
        let mut x = [s0, s1, s2, concentration, weight];
        let mut best: Option<Fit> = None;
        for _ in 0..=MOST_HOPS {
            let problem = self.dye_problem(dyes, first);
            let found = solve(&problem, x, &SolverOptions::default());
            let fit = self.judge_dyes(&found, first);
            let better = best.is_none_or(|known| fit.distance < known.distance);
            if better {
                best = Some(fit);
            }
            let pairs = dyes.pairs();
            if !better || fit.de2000 <= EXACT || pairs < 3 {
                break;
            }
            x = found.x;
            (first, x[4]) = match found.x[4] {
                w if w <= 0.0 => ((first + pairs - 1) % pairs, 1.0),
                w if w >= 1.0 => ((first + 1) % pairs, 0.0),
                _ => break,
            };
        }
        best.expect("the first round sets it")
    }

    fn dye_problem<'a>(&'a self, dyes: &'a DyeModel, first: usize) -> DyeProblem<'a> {
        let lanes = &self.fitter.dye_lanes;
        DyeProblem {
            sums: &self.fitter.sums,
            goal: self.goal,
            shape: self.fitter.edge_shape(),
            model: &self.fitter.model,
            dyes,
            first,
            absorption: [&lanes[first], &lanes[dyes.partner(first)]],
        }
    }

    fn bell_problem<'a>(&'a self, bells: &'a AnalyticModel) -> BellProblem<'a> {
        BellProblem {
            sums: &self.fitter.sums,
            goal: self.goal,
            shape: self.fitter.edge_shape(),
            model: &self.fitter.model,
            bells,
        }
    }

    fn bell_unknowns(&self, start: Start) -> [f64; 6] {
        let [s0, s1, s2] = start.shape;
        match start.fluorescence {
            Fluorescence::Analytic { emission_peak_nm, stokes_shift_nm, concentration } => {
                let [peak, shift] = [emission_peak_nm, stokes_shift_nm].map(|v| v / BELL_UNIT_NM);
                [s0, s1, s2, concentration, peak, shift]
            }
            _ => [s0, s1, s2, 0.0, 5.0, 0.5],
        }
    }

    /// The same color with as little of the same fluorescence as possible.
    fn with_least_fluorescence(&self, known: Fit) -> Fit {
        let shape = self.shape_of(known.reflectance);
        let start = Start { shape, fluorescence: known.fluorescence };
        let least = match (known.fluorescence, self.fitter.model.model()) {
            (Fluorescence::Dyes { first, weight, concentration }, Model::Dyes(dyes)) => {
                let [s0, s1, s2] = shape;
                let problem = self.dye_problem(dyes, first);
                let x = least_concentration(&problem, [s0, s1, s2, concentration, weight]);
                self.judge_dyes(&x, first)
            }
            (Fluorescence::Analytic { .. }, Model::Analytic(bells)) => {
                let problem = self.bell_problem(bells);
                let x = least_concentration(&problem, self.bell_unknowns(start));
                self.judge_bells(&x)
            }
            _ => return known,
        };
        if least.de2000 <= known.de2000.max(EXACT / 10.0) { least } else { known }
    }

    /// Edge, level and relative slope of a reflectance.
    fn shape_of(&self, edge: Edge) -> [f64; 3] {
        let Edge { edge_nm, level, slope_per_nm } = edge;
        [scaled(edge_nm), level, slope_per_nm / self.fitter.slope_limit_per_nm]
    }

    fn judge_dyes(&self, found: &Summary<5>, first: usize) -> Fit {
        let [s0, s1, s2, concentration, weight] = found.x;
        let fluorescence = if concentration > 0.0 {
            Fluorescence::Dyes { first, weight, concentration }
        } else {
            Fluorescence::None
        };
        self.judge(edge_of([s0, s1, s2], self.fitter.slope_limit_per_nm), fluorescence)
    }

    fn judge_bells(&self, found: &Summary<6>) -> Fit {
        let [s0, s1, s2, concentration, peak, shift] = found.x;
        let fluorescence = if concentration > 0.0 {
            Fluorescence::Analytic {
                emission_peak_nm: peak * BELL_UNIT_NM,
                stokes_shift_nm: shift * BELL_UNIT_NM,
                concentration,
            }
        } else {
            Fluorescence::None
        };
        self.judge(edge_of([s0, s1, s2], self.fitter.slope_limit_per_nm), fluorescence)
    }

    /// The fit that a material is, with its color differences.
    fn judge(&self, reflectance: Edge, fluorescence: Fluorescence) -> Fit {
        let mut fit = Fit { reflectance, fluorescence, distance: 0.0, de2000: 0.0 };
        let color = self.fitter.model.color(fit.material());
        fit.distance = self.goal.distance(color);
        fit.de2000 = self.goal.under(Metric::De2000).distance(color);
        fit
    }

    fn improve(&self, known: Fit, neighbors: &[Fit]) -> Fit {
        let mut near: Vec<Fit> =
            neighbors.iter().map(|n| self.judge(n.reflectance, n.fluorescence)).collect();
        near.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        let mut best = known;
        for neighbor in near.into_iter().take(NEIGHBORS_FOLLOWED) {
            let shape = self.shape_of(neighbor.reflectance);
            let found = self.follow(Start { shape, fluorescence: neighbor.fluorescence });
            if found.distance < best.distance {
                best = found;
            }
            if found.de2000 <= EXACT {
                return self.with_least_fluorescence(found);
            }
        }
        best
    }
}

/// What a concentration of 1 counts in the search for the least one, in units of the metric.
/// Larger leaves the color earlier, smaller takes more rounds.
const CONCENTRATION_WEIGHT: f64 = 3.0;
/// Rounds of that search.
const LEAST_ROUNDS: usize = 12;
/// Evaluations of its first round and of each later one.
const LEAST_STEPS: [usize; 2] = [40, 8];
/// It ends when a round is this near to the color and changes the concentration by less than this.
const LEAST_SETTLED: (f64, f64) = (3e-3, 2e-3);

/// The least concentration that still shows the color: the residuals' squares plus the weighted
/// concentration's, with multipliers that take the rest of the residuals away round by round; then
/// the color alone.
///
/// # Source
///
/// The method of multipliers: [hestenes].
fn least_concentration<const N: usize>(
    problem: &impl Residuals<3, N>,
    start: [f64; N],
) -> Summary<N> {
    let mut x = start;
    let mut multipliers = [0.0; 3];
    for round in 0..LEAST_ROUNDS {
        let least =
            LeastProblem { problem, multipliers, concentration_weight: CONCENTRATION_WEIGHT };
        let first = round == 0;
        let options = SolverOptions {
            norm_reached: 0.0,
            stationary_share: 1e-2,
            step_limit: LEAST_STEPS[usize::from(!first)],
            damping: if first { 1e-2 } else { 1e-4 },
        };
        let before = x[CONCENTRATION];
        x = solve(&least, x, &options).x;
        let (residuals, _) = problem.eval(&x);
        (0..3).for_each(|i| multipliers[i] += residuals[i]);
        let norm = residuals.iter().map(|r| r * r).sum::<f64>().sqrt();
        let (near, still) = LEAST_SETTLED;
        if !first && norm < near && (x[CONCENTRATION] - before).abs() < still {
            break;
        }
    }
    let polish = SolverOptions { damping: 1e-6, step_limit: 20, ..SolverOptions::default() };
    solve(problem, x, &polish)
}
