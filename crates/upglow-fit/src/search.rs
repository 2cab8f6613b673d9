//! Our way to the material of a color: reflectance first, then the most promising starts.

use upglow::{DyeModel, Fluorescence, Model};
use upglow_color::Metric;

use crate::Fit;
use crate::fitter::EXACT;
use crate::job::{Job, Solve};
use crate::least::LeastConcentration;
use crate::parabola::{MIDDLE_NM, sigmoid_of};
use crate::problem::Shape;
use crate::solver::{Residuals, SolverOptions, Summary, solve};
use crate::starts::Start;

/// Evaluations for a reflectance without limits: it takes 5, and 10 where it goes astray.
const PASSIVE_STEPS: usize = 12;

/// A reflectance too steep by less than this factor, and matched within this distance, may have a
/// neighbor within the limit that matches too.
const NEARLY_WITHIN: (f64, f64) = (1.5, 2.0);

/// How many start materials are followed. More cost time; with fewer, some nodes end more than
/// 0.02 ΔE00 from the best that an exhaustive search finds.
const STARTS_FOLLOWED: usize = 10;

/// How many start reflectances are followed where nothing may fluoresce.
const PASSIVE_STARTS: usize = 3;

/// How many starts of each bucket the exhaustive search follows: 192 in all with eight dyes. Forty
/// of each find nothing on 500 nodes of ACEScg that twelve miss by 0.001 ΔE00.
const EXHAUSTIVE_STARTS: usize = 12;

/// How many neighbors' materials are followed.
const NEIGHBORS_FOLLOWED: usize = 2;

/// How often a fit whose weight reaches its end goes on with the next pair of dyes.
const MOST_HOPS: usize = 2;

/// The nearest color, by the solver's defaults.
struct NearestColor;

impl Solve for NearestColor {
    fn solve<const N: usize>(&self, problem: &impl Residuals<3, N>, start: [f64; N]) -> Summary<N> {
        solve(problem, start, &SolverOptions::default())
    }
}

impl Job<'_> {
    /// Reflectance alone if that shows the color; else the best of the nearest starts, with as
    /// little fluorescence as the color needs.
    pub(crate) fn search(&self) -> Fit {
        let mut best = self.without_fluorescence();
        if let Some(passive) = best
            && passive.de2000 <= EXACT
        {
            return passive;
        }
        let starts = self.fitter.starts.nearest(&self.goal);
        let followed = match self.fitter.model.model() {
            Model::Reflectance => PASSIVE_STARTS,
            _ => STARTS_FOLLOWED,
        };
        for start in starts.into_iter().take(followed) {
            let found = self.lead_on(start);
            if found.de2000 <= EXACT {
                return self.with_least_fluorescence(found);
            }
            best = Some(nearer(best, found));
        }
        best.expect("there is at least one start")
    }

    /// The best that many starts lead to: the yardstick for [`Job::search`].
    pub(crate) fn search_exhaustively(&self) -> Fit {
        let mut best = self.without_fluorescence();
        if let Some(passive) = best
            && passive.de2000 <= EXACT
        {
            return passive;
        }
        for start in self.fitter.starts.nearest_of_each(&self.goal, EXHAUSTIVE_STARTS) {
            best = Some(nearer(best, self.lead_on(start)));
        }
        best.expect("there is at least one start")
    }

    /// The best of `known` and of what the nearest of some materials lead to.
    pub(crate) fn improve(&self, known: Fit, neighbors: &[Fit]) -> Fit {
        let mut near: Vec<Fit> = Vec::with_capacity(neighbors.len());
        for neighbor in neighbors {
            let is_new = |other: &Fit| !is_alike(other, neighbor);
            if is_new(&known) && near.iter().all(is_new) {
                near.push(self.judge(neighbor.reflectance, neighbor.fluorescence));
            }
        }
        near.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        let mut best = known;
        for neighbor in near.into_iter().take(NEIGHBORS_FOLLOWED) {
            let found = self.lead_on(Start::from(neighbor));
            if found.de2000 <= EXACT {
                return self.with_least_fluorescence(found);
            }
            best = nearer(Some(best), found);
        }
        best
    }

    /// A reflectance that shows the color, or nearly, within the slope limit.
    pub(crate) fn without_fluorescence(&self) -> Option<Fit> {
        let in_lab = Self { goal: self.goal.under(Metric::De76), ..*self };
        let problem = in_lab.passive_problem(Shape::Free);
        let options = SolverOptions { step_limit: PASSIVE_STEPS, ..SolverOptions::default() };
        let free = solve(&problem, [0.0; 3], &options);
        self.fitter.count(free.evaluations);
        let reflectance = sigmoid_of(free.x).to_edge(MIDDLE_NM);
        let steepness = reflectance.slope_per_nm.abs() / self.fitter.slope_limit_per_nm;
        if steepness <= 1.0 {
            return Some(self.judge(reflectance, Fluorescence::None));
        }
        let (factor, distance) = NEARLY_WITHIN;
        let start = Start { reflectance, fluorescence: Fluorescence::None };
        (steepness < factor && free.norm < distance)
            .then(|| self.follow(start, self.edge_shape(), &NearestColor))
    }

    /// Where a start leads, over to the next pairs of dyes too.
    fn lead_on(&self, start: Start) -> Fit {
        let mut best = self.follow(start, self.edge_shape(), &NearestColor);
        if let Model::Dyes(dyes) = self.fitter.model.model() {
            for _ in 0..MOST_HOPS {
                let Some(next) = next_pair(dyes, best) else { break };
                let found = self.follow(next, self.edge_shape(), &NearestColor);
                if found.distance >= best.distance {
                    break;
                }
                best = found;
            }
        }
        best
    }

    /// The same color with as little of the same fluorescence as possible.
    fn with_least_fluorescence(&self, known: Fit) -> Fit {
        if known.fluorescence == Fluorescence::None {
            return known;
        }
        let least = self.follow(Start::from(known), self.edge_shape(), &LeastConcentration);
        if least.de2000 <= known.de2000.max(EXACT / 10.0) { least } else { known }
    }
}

/// The nearer of two fits; the first where they are equally near.
fn nearer(known: Option<Fit>, found: Fit) -> Fit {
    known.filter(|known| known.distance <= found.distance).unwrap_or(found)
}

/// Whether two materials lead to the same place: nothing is gained by following both.
fn is_alike(a: &Fit, b: &Fit) -> bool {
    /// Weights nearer than this end in the same mixture; smaller follows more and gains nothing.
    const WEIGHTS: f64 = 0.3;
    /// Emission peaks and Stokes shifts nearer than this, nm.
    const BELLS_NM: f64 = 20.0;
    let same_shape = (a.reflectance.level > 0.0) == (b.reflectance.level > 0.0);
    same_shape
        && match (a.fluorescence, b.fluorescence) {
            (Fluorescence::None, Fluorescence::None) => true,
            (
                Fluorescence::Dyes { first: i, weight: v, .. },
                Fluorescence::Dyes { first: j, weight: w, .. },
            ) => i == j && (v - w).abs() < WEIGHTS,
            (
                Fluorescence::Analytic { emission_peak_nm: p, stokes_shift_nm: s, .. },
                Fluorescence::Analytic { emission_peak_nm: q, stokes_shift_nm: t, .. },
            ) => (p - q).abs() < BELLS_NM && (s - t).abs() < BELLS_NM,
            _ => false,
        }
}

/// A material whose weight is at its end, as a start for the other pair of that dye; `None` for
/// one that is matched or uses both its dyes.
fn next_pair(dyes: &DyeModel, fit: Fit) -> Option<Start> {
    let Fluorescence::Dyes { first, weight, concentration } = fit.fluorescence else {
        return None;
    };
    let pairs = dyes.pairs();
    if fit.de2000 <= EXACT || pairs < 3 {
        return None;
    }
    let (first, weight) = match weight {
        w if w <= 0.0 => ((first + pairs - 1) % pairs, 1.0),
        w if w >= 1.0 => ((first + 1) % pairs, 0.0),
        _ => return None,
    };
    let fluorescence = Fluorescence::Dyes { first, weight, concentration };
    Some(Start { reflectance: fit.reflectance, fluorescence })
}
