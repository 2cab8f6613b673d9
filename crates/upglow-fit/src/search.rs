//! Our search for the material of a color: reflectance first, then the most promising starts.

pub(crate) mod context;
mod film;
pub(crate) mod job;
pub(crate) mod konig2020;
mod least;
mod least_dose;
mod starts;

use upglow::{DyeModel, Edge, Fluorescence, Model};
use upglow_color::{Metric, ciede2000};

use crate::fit::{EXACT, Fit, Start, better};
use crate::problem::Shape;
use crate::problem::parabola::{MIDDLE_NM, sigmoid_of};
use crate::problem::solver::{SolverOptions, solve};
use job::Job;
use least::LeastConcentration;

/// Greatest number of evaluations for a reflectance without slope limit: most take 5, detours 10.
const PASSIVE_STEPS: usize = 12;

/// The same where a miss would add a dye. Nearly black colors take most.
const PATIENT_STEPS: usize = 60;

/// A reflectance that is too steep by less than this factor and matches within this distance may have
/// a neighbor within the limit that matches too.
const NEARLY_WITHIN: (f64, f64) = (1.5, 2.0);

/// How many of the table's starts are tried. More cost time; with fewer, some nodes end more than
/// 0.02 ΔE00 from the best of the exhaustive search.
const STARTS_FOLLOWED: usize = 10;

/// How many are tried if a node misses its color but a neighbor matches its own, and if it misses and
/// the neighbors' materials differ. With 3 and 3, a dozen nodes of 32³ end more than 0.02 ΔE00 worse
/// than with ten starts for each node; with these, two do. More cost time and improve nothing.
const STARTS_BESIDE_A_MATCH: usize = 5;
const STARTS_WHERE_NEIGHBORS_DIFFER: usize = 3;

/// The same for cubes of reflectances. With 0, a node of 9³ that need not ends beyond 1 ΔE00.
const PASSIVE_STARTS_BESIDE_A_MATCH: usize = 1;

/// If a neighbor needs no more concentration than this, a reflectance may match.
const NEARLY_PASSIVE: f64 = 0.1;

/// How many starts of each bucket the exhaustive search tries: 192 in all with eight dyes. Forty of
/// each improve none of 500 nodes of ACEScg by 0.001 ΔE00.
const EXHAUSTIVE_STARTS: usize = 12;

/// How many neighbors' materials are tried as starts.
const NEIGHBORS_FOLLOWED: usize = 2;

/// How often a fit whose weight reaches a bound continues with the next pair of dyes.
const MOST_HOPS: usize = 2;

impl Job<'_> {
    /// A reflectance if one matches; else the best fit from the materials of the colors `around`, and,
    /// if there are none or their fits may be improved, from the nearest starts of the table. A match
    /// has as little fluorescence as the color needs.
    pub(crate) fn search(&self, around: &[Fit]) -> Fit {
        let leading = self.distinct(around.iter().filter(|fit| self.leads(fit)));
        if leading.is_empty() {
            let best = self.without_fluorescence();
            return self.try_starts(best, STARTS_FOLLOWED).expect("there is at least one start");
        }
        let count = self.starts_to_add(around, leading.len());
        let mut best = None;
        let is_nearly_passive =
            |fit: &Fit| fit.is_matched() && fit.fluorescence.dose() < NEARLY_PASSIVE;
        if around.iter().any(is_nearly_passive) {
            best = self.without_fluorescence();
        }
        best = self.best_of(best, leading.into_iter().take(NEIGHBORS_FOLLOWED).map(Start::from));
        self.try_starts(best, count).expect("there is at least one neighbor")
    }

    /// The best of `known` and of the fits from some of the nearest starts.
    fn try_starts(&self, known: Option<Fit>, count: usize) -> Option<Fit> {
        if count == 0 || known.is_some_and(|fit| fit.is_matched()) {
            return known;
        }
        self.best_of(known, self.starts().nearest(&self.goal).into_iter().take(count))
    }

    /// The best of `known` and of the fits from `starts`. Stops at the first match, with as little
    /// fluorescence as it needs.
    fn best_of(&self, known: Option<Fit>, starts: impl Iterator<Item = Start>) -> Option<Fit> {
        let mut best = known;
        for start in starts {
            if best.is_some_and(|fit| fit.is_matched()) {
                break;
            }
            let found = self.fit_from(start);
            if found.is_matched() {
                return Some(self.with_least_fluorescence(found));
            }
            best = Some(nearer(best, found));
        }
        best
    }

    /// Whether a neighbor's material is a useful start: a gray cannot move in the coordinates of its
    /// edge, and a reflectance is no better a start than the table's for a fluorescent material.
    fn leads(&self, fit: &Fit) -> bool {
        let may_fluoresce = *self.context.model.model() != Model::Reflectance;
        fit.reflectance.slope_per_nm != 0.0
            && (fit.fluorescence != Fluorescence::None || !may_fluoresce)
    }

    /// How many starts of the table are tried if the fits from the neighbors' materials miss.
    fn starts_to_add(&self, around: &[Fit], kinds: usize) -> usize {
        let is_beside_a_match = around.iter().any(Fit::is_matched);
        match self.context.model.model() {
            Model::Reflectance if is_beside_a_match => PASSIVE_STARTS_BESIDE_A_MATCH,
            Model::Reflectance => 0,
            _ if is_beside_a_match => STARTS_BESIDE_A_MATCH,
            _ if kinds > 1 => STARTS_WHERE_NEIGHBORS_DIFFER,
            _ => 0,
        }
    }

    /// The best fit from many starts, to compare [`Job::search`] with.
    pub(crate) fn search_exhaustively(&self) -> Fit {
        let mut best = self.without_fluorescence();
        if let Some(passive) = best
            && passive.is_matched()
        {
            return passive;
        }
        for start in self.starts().nearest_of_each(&self.goal, EXHAUSTIVE_STARTS) {
            let found = self.fit_from(start);
            let found =
                if found.is_matched() { self.with_least_fluorescence(found) } else { found };
            best = Some(better(best, found));
        }
        best.expect("there is at least one start")
    }

    /// The best of `known` and of the fits from the nearest of the neighbors' materials.
    pub(crate) fn improve(&self, known: Fit, neighbors: &[Fit]) -> Fit {
        let leads_on = |fit: &&Fit| {
            !is_alike(&known, fit) || ciede2000(self.goal.lab(), fit.lab) < known.de2000
        };
        let near = self.distinct(neighbors.iter().filter(leads_on));
        let starts = near.into_iter().take(NEIGHBORS_FOLLOWED).map(Start::from);
        self.best_of(Some(known), starts).unwrap_or(known)
    }

    /// The materials that are not alike, nearest in CIELAB first, of those alike the nearest.
    fn distinct<'a>(&self, fits: impl Iterator<Item = &'a Fit>) -> Vec<Fit> {
        let mut sorted: Vec<(f64, Fit)> =
            fits.map(|fit| (fit.lab.de76(self.goal.lab()), *fit)).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut distinct: Vec<Fit> = Vec::with_capacity(sorted.len());
        for (_, fit) in sorted {
            if distinct.iter().all(|other| !is_alike(other, &fit)) {
                distinct.push(fit);
            }
        }
        distinct
    }

    /// A reflectance within the slope limit that matches, or nearly matches, the color.
    pub(crate) fn without_fluorescence(&self) -> Option<Fit> {
        let (reflectance, norm) = self.free_reflectance(PASSIVE_STEPS);
        let steepness = self.steepness(reflectance);
        if steepness <= 1.0 {
            return Some(self.measured(reflectance, Fluorescence::None));
        }
        let (factor, distance) = NEARLY_WITHIN;
        let start = Start { reflectance, fluorescence: Fluorescence::None };
        (steepness < factor && norm < distance)
            .then(|| self.follow(start, self.edge_shape(), &SolverOptions::default()))
    }

    /// The nearest reflectance without a slope limit.
    pub(crate) fn reflectance_without_limit(&self) -> Edge {
        self.free_reflectance(PATIENT_STEPS).0
    }

    /// The nearest reflectance within the slope limit that is found from the one without a limit.
    pub(crate) fn reflectance_near(&self, free: Edge) -> Fit {
        if self.steepness(free) <= 1.0 {
            let fit = self.measured(free, Fluorescence::None);
            if fit.is_matched() {
                return fit;
            }
        }
        let start = Start { reflectance: free, fluorescence: Fluorescence::None };
        self.follow(start, self.edge_shape(), &SolverOptions::default())
    }

    /// The nearest reflectance without a slope limit, and its distance in CIELAB.
    fn free_reflectance(&self, step_limit: usize) -> (Edge, f64) {
        let in_lab = Self { goal: self.goal.under(Metric::De76), ..*self };
        let problem = in_lab.passive_problem(Shape::Free);
        let options = SolverOptions { step_limit, ..SolverOptions::default() };
        let free = solve(&problem, [0.0; 3], &options);
        self.context.count(free.evaluations);
        (sigmoid_of(free.x).to_edge(MIDDLE_NM), free.norm)
    }

    /// The slope of a reflectance as a share of the limit.
    fn steepness(&self, reflectance: Edge) -> f64 {
        reflectance.slope_per_nm.abs() / self.stage.slope_limit_per_nm
    }

    /// The fit from a start, continued with the next pairs of dyes.
    fn fit_from(&self, start: Start) -> Fit {
        let mut best = self.follow(start, self.edge_shape(), &SolverOptions::default());
        if let Model::Dyes(dyes) = self.context.model.model() {
            for _ in 0..MOST_HOPS {
                let Some(next) = next_pair(dyes, best) else { break };
                let found = self.follow(next, self.edge_shape(), &SolverOptions::default());
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

/// Whether fits from two materials probably end at the same material.
fn is_alike(a: &Fit, b: &Fit) -> bool {
    /// Weights nearer than this end in the same mixture; smaller tries more and improves nothing.
    const WEIGHTS: f64 = 0.3;
    /// Emission peaks and Stokes shifts nearer than this, nm.
    const BELLS_NM: f64 = 20.0;
    let same_shape = (a.reflectance.level > 0.0) == (b.reflectance.level > 0.0);
    let same_slope = (a.reflectance.slope_per_nm > 0.0) == (b.reflectance.slope_per_nm > 0.0);
    same_shape
        && match (a.fluorescence, b.fluorescence) {
            (Fluorescence::None, Fluorescence::None) => true,
            (
                Fluorescence::Dyes { first: i, weight: v, .. },
                Fluorescence::Dyes { first: j, weight: w, .. },
            ) => i == j && (v - w).abs() < WEIGHTS,
            (Fluorescence::Film { dyes: [a, b], .. }, Fluorescence::Film { dyes: [c, d], .. }) => {
                same_slope && ((a, b) == (c, d) || (a, b) == (d, c))
            }
            (
                Fluorescence::Analytic { emission_peak_nm: p, stokes_shift_nm: s, .. },
                Fluorescence::Analytic { emission_peak_nm: q, stokes_shift_nm: t, .. },
            ) => (p - q).abs() < BELLS_NM && (s - t).abs() < BELLS_NM,
            _ => false,
        }
}

/// A material with one dye of its pair, as a start for the other pair of that dye; `None` if it matches
/// or uses both dyes.
fn next_pair(dyes: &DyeModel, fit: Fit) -> Option<Start> {
    let Fluorescence::Dyes { first, weight, concentration } = fit.fluorescence else {
        return None;
    };
    let pairs = dyes.pairs();
    if fit.is_matched() || pairs < 3 {
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
