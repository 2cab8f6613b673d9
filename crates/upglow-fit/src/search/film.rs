//! The search for a film: a match with the least dose over all pairs of dyes.

use upglow::Fluorescence;

use super::job::Job;
use super::least_dose::{least_dose, multipliers};
use crate::fit::{Fit, Start, better, key};
use crate::problem::shortest_step::{LEAST_DAMPING, shortest_step};
use crate::problem::solver::{Residuals, SolverOptions, Summary, solve};
use crate::problem::{FilmProblem, Shape};

/// How many of the table's starts are followed for a color by itself: the nearest ones, and of those
/// that are near the ones with the least dose.
const STARTS_ALONE: [usize; 2] = [8, 16];
/// The same for one color whose dose matters more than the time: it ends within 1.08 times the least of
/// the exhaustive search in 95 colors of 100.
const STARTS_OF_ONE_COLOR: [usize; 2] = [16, 64];
/// The same if the neighbors' materials lead to no match.
const STARTS_BESIDE_A_MATCH: [usize; 2] = [3, 3];
const STARTS_BESIDE_MISSES: [usize; 2] = [1, 0];
/// How many starts of each bucket the exhaustive search follows, and how many of its best fits it tries
/// to improve.
const EXHAUSTIVE_STARTS: usize = 4;
const EXHAUSTIVE_EXCHANGES: usize = 16;
/// A start this near, ΔE00, may end at the color.
const NEAR: f64 = 25.0;

/// A neighbor's match is followed if its dose is at most this many times the least that is known.
const WORTH_FOLLOWING: f64 = 1.5;
/// How many neighbors' materials are followed.
const NEIGHBORS_FOLLOWED: usize = 4;

/// Most evaluations of a fit; those that match take fewer.
const STEPS: usize = 25;

/// The density with which each dye in turn is added to a reflectance that nearly matches.
const FIRST_DENSITY: f64 = 0.1;

/// How many dyes enter a film one after another, and how many are tried each time.
const EXCHANGES: usize = 3;
const DYES_TRIED: usize = 2;
/// A dye enters if the dose would fall by more than this per density of the dye.
const WORTH_ENTERING: f64 = 1e-3;
/// An exchange that lowers the dose by less than this share is not worth the next one.
const LEAST_GAIN: f64 = 0.01;
/// The density with which a dye enters beside a single one, as a share of the dose.
const ENTERING_SHARE: f64 = 1e-3;

/// How many kinds of its neighbors' materials are pulled towards their means.
const KINDS_PULLED: usize = 3;

impl Job<'_> {
    /// The match with the least dose, or else the nearest material, of fits from the materials `around`
    /// and from the nearest reflectance, and if these miss, from starts of the table.
    pub(crate) fn film(&self, around: &[Fit], passive: Fit) -> Fit {
        let leads = self.leads_of(around);
        let mut best = self.least_of(None, &leads);
        if leads.is_empty() {
            best = self.best_film_of(best, self.each_dye_over(passive));
        }
        if !best.is_some_and(|fit| fit.is_matched()) {
            let [near, light] = match around {
                [] => STARTS_ALONE,
                _ if around.iter().any(Fit::is_matched) => STARTS_BESIDE_A_MATCH,
                _ => STARTS_BESIDE_MISSES,
            };
            best = self.best_film_of(best, self.table_starts(near, light).into_iter());
        }
        self.exchanged(best.expect("there is at least one start"))
    }

    /// The best of the fits from many starts of the table.
    pub(crate) fn film_from_many_starts(&self) -> Fit {
        let [near, light] = STARTS_OF_ONE_COLOR;
        let best = self.best_film_of(None, self.table_starts(near, light).into_iter());
        self.exchanged(best.expect("there is at least one start"))
    }

    /// [`Job::film`] from the nearest starts of every bucket of the table, to compare with.
    pub(crate) fn film_exhaustively(&self) -> Fit {
        let starts = self.starts().nearest_of_each(&self.goal, EXHAUSTIVE_STARTS);
        let mut found: Vec<Fit> = starts.into_iter().map(|start| self.film_from(start)).collect();
        found.sort_by(|a, b| key(a).partial_cmp(&key(b)).expect("distances are numbers"));
        let exchanged = found.into_iter().take(EXHAUSTIVE_EXCHANGES).map(|fit| self.exchanged(fit));
        exchanged.reduce(|best, fit| better(Some(best), fit)).expect("there is at least one start")
    }

    /// The best of `known` and of the fits from the neighbors' materials.
    pub(crate) fn improve_film(&self, known: Fit, neighbors: &[Fit]) -> Fit {
        let mut leads = self.leads_of(neighbors);
        leads.retain(|fit| !super::is_alike(fit, &known));
        self.least_of(Some(known), &leads).unwrap_or(known)
    }

    /// The materials that fluoresce and are not alike, the best first.
    fn leads_of(&self, fits: &[Fit]) -> Vec<Fit> {
        let glowing = fits.iter().filter(|fit| fit.fluorescence != Fluorescence::None);
        let mut leads = self.distinct(glowing);
        leads.sort_by(|a, b| key(a).partial_cmp(&key(b)).expect("distances are numbers"));
        leads
    }

    /// The best of `known` and of the fits from some materials, the best first.
    fn least_of(&self, known: Option<Fit>, leads: &[Fit]) -> Option<Fit> {
        let mut best = known;
        for lead in leads.iter().take(NEIGHBORS_FOLLOWED) {
            let may_be_less = |best: Fit| {
                let limit = WORTH_FOLLOWING * best.fluorescence.dose();
                !best.is_matched() || lead.is_matched() && lead.fluorescence.dose() < limit
            };
            if best.is_none_or(may_be_less) {
                best = Some(better(best, self.film_from(Start::from(*lead))));
            }
        }
        best
    }

    fn best_film_of(&self, known: Option<Fit>, starts: impl Iterator<Item = Start>) -> Option<Fit> {
        starts.fold(known, |best, start| Some(better(best, self.film_from(start))))
    }

    /// A reflectance under a little of each dye.
    fn each_dye_over(&self, passive: Fit) -> impl Iterator<Item = Start> {
        let reflectance = passive.reflectance;
        (0..self.context.dye_lanes.len()).map(move |dye| {
            let fluorescence = Fluorescence::film((dye, FIRST_DENSITY), (dye, 0.0));
            Start { reflectance, fluorescence }
        })
    }

    /// The `near` nearest starts of the table, and of the others nearby the `light` ones with the least
    /// dose.
    fn table_starts(&self, near: usize, light: usize) -> Vec<Start> {
        let found = self.starts().nearest_with_distance(&self.goal);
        let (nearest, rest) = found.split_at(near.min(found.len()));
        let mut rest: Vec<Start> = rest
            .iter()
            .take_while(|(square, _)| f64::from(*square).sqrt() < NEAR)
            .map(|(_, start)| *start)
            .collect();
        rest.sort_by(|a, b| a.fluorescence.dose().total_cmp(&b.fluorescence.dose()));
        nearest.iter().map(|(_, start)| *start).chain(rest.into_iter().take(light)).collect()
    }

    /// The fit from a start, with the least dose of its dyes if it matches.
    fn film_from(&self, start: Start) -> Fit {
        let options = SolverOptions { step_limit: STEPS, ..SolverOptions::default() };
        let fit = self.follow(start, self.edge_shape(), &options);
        if fit.is_matched() { self.with_least_dose(fit) } else { fit }
    }

    /// The same color with as little of the same dyes as possible.
    fn with_least_dose(&self, known: Fit) -> Fit {
        let Some((problem, x)) = self.film_of(&known) else { return known };
        better(Some(known), self.film_found(&problem, least_dose(&problem, x)))
    }

    /// A match with the least dose that exchanging one dye after another leads to.
    fn exchanged(&self, fit: Fit) -> Fit {
        let mut best = fit;
        for _ in 0..EXCHANGES {
            let Some(next) = self.with_another_dye(&best) else { break };
            best = next;
        }
        best
    }

    /// A match with less dose in which one dye is replaced or added. As in the simplex method, a dye
    /// may enter if its cost, less what the others could be lowered by, is negative.
    fn with_another_dye(&self, fit: &Fit) -> Option<Fit> {
        let (problem, x) = self.film_of(fit).filter(|_| fit.is_matched())?;
        let (dyes, [.., a0, a1]) = (problem.dyes, x);
        let (by, by_dye) = problem.by_every_dye(&x);
        self.context.count(1);
        let multipliers = multipliers(&x, &by, &problem.bounds())?;
        let cost = |by: &[f64; 3]| 1.0 - (0..3).map(|i| multipliers[i] * by[i]).sum::<f64>();
        let mut entering: Vec<(f64, usize)> = by_dye
            .iter()
            .enumerate()
            .filter(|(dye, _)| !dyes.contains(dye))
            .map(|(dye, by)| (cost(by), dye))
            .filter(|(cost, _)| *cost < -WORTH_ENTERING)
            .collect();
        entering.sort_by(|a, b| a.0.total_cmp(&b.0));
        let starts = entering.into_iter().take(DYES_TRIED).flat_map(|(_, dye)| {
            if a1 == 0.0 {
                [Some([(dyes[0], a0), (dye, ENTERING_SHARE * a0)]), None]
            } else {
                [Some([(dyes[0], a0), (dye, a1)]), Some([(dyes[1], a1), (dye, a0)])]
            }
        });
        let found = starts.flatten().map(|[one, two]| {
            let fluorescence = Fluorescence::film(one, two);
            self.film_from(Start { reflectance: fit.reflectance, fluorescence })
        });
        let enough = (1.0 - LEAST_GAIN) * fit.fluorescence.dose();
        let mut matches = found.filter(Fit::is_matched);
        matches.find(|found| found.fluorescence.dose() < enough)
    }

    /// Matches of the kind of `known` and of some kinds of the `neighbors`, each pulled towards the mean of
    /// the neighbors of its kind.
    pub(crate) fn matches_near(&self, known: Fit, neighbors: &[Fit]) -> Vec<Fit> {
        let mut starts = vec![known];
        for lead in self.leads_of(neighbors) {
            if starts.len() <= KINDS_PULLED
                && starts.iter().all(|start| !super::is_alike(start, &lead))
            {
                starts.push(lead);
            }
        }
        starts.iter().filter_map(|start| self.pulled(start, neighbors)).collect()
    }

    /// The match nearest to the mean of the neighbors that are like `start`, where a reflectance alone
    /// counts as one with the same dyes at no density.
    fn pulled(&self, start: &Fit, neighbors: &[Fit]) -> Option<Fit> {
        let (problem, x) = self.film_of(start)?;
        let coordinates = |fit: &Fit| {
            let [s0, s1, s2] = problem.shape.numbers(fit.reflectance);
            let [a, b] = densities_of(fit.fluorescence, problem.dyes)?;
            Some([s0, s1, s2, a, b])
        };
        let is_like = |fit: &&Fit| {
            let (one, two) = (fit.reflectance, start.reflectance);
            (one.level > 0.0) == (two.level > 0.0)
                && (one.slope_per_nm > 0.0) == (two.slope_per_nm > 0.0)
        };
        let alike: Vec<[f64; 5]> =
            neighbors.iter().filter(is_like).filter_map(coordinates).collect();
        if alike.is_empty() {
            return None;
        }
        let mut target = [0.0; 5];
        for x in &alike {
            (0..5).for_each(|v| target[v] += x[v] / alike.len() as f64);
        }
        let fit = self.film_found(&problem, nearest_match(&problem, x, &target));
        fit.is_matched().then_some(fit)
    }

    /// The problem of a film's dyes, and its unknowns; `None` for other materials.
    fn film_of(&self, fit: &Fit) -> Option<(FilmProblem<'_>, [f64; 5])> {
        let Fluorescence::Film { dyes, densities: [a, b] } = fit.fluorescence else { return None };
        let problem = self.film_problem(self.edge_shape(), dyes);
        let [s0, s1, s2] = problem.shape.numbers(fit.reflectance);
        Some((problem, [s0, s1, s2, a, b]))
    }

    /// The fit of unknowns that were found.
    pub(super) fn film_found(&self, problem: &FilmProblem<'_>, found: Summary<5>) -> Fit {
        let [s0, s1, s2, a, b] = self.counted(found);
        let [i, j] = problem.dyes;
        self.measured(problem.shape.edge([s0, s1, s2]), Fluorescence::film((i, a), (j, b)))
    }

    pub(super) fn film_problem(&self, shape: Shape, dyes: [usize; 2]) -> FilmProblem<'_> {
        let context = self.context;
        FilmProblem {
            sums: &context.single_sums,
            goal: self.goal,
            shape,
            model: &context.model,
            dyes,
        }
    }
}

/// The optical densities of two dyes in a fluorescence; `None` if it has others.
fn densities_of(fluorescence: Fluorescence, dyes: [usize; 2]) -> Option<[f64; 2]> {
    match fluorescence {
        Fluorescence::None => Some([0.0; 2]),
        Fluorescence::Film { dyes: [i, j], densities: [a, b] } => {
            let mut of = [0.0; 2];
            for (dye, density) in [(i, a), (j, b)].into_iter().filter(|(_, density)| *density > 0.0)
            {
                of[dyes.iter().position(|d| *d == dye)?] += density;
            }
            Some(of)
        }
        _ => None,
    }
}

/// Units of the distance between materials: edge and density of 1 count as much as a level of 1 and a
/// slope of half the limit.
const UNITS: [f64; 5] = [0.5, 0.5, 0.5, 1.0, 1.0];
const PULLS: usize = 3;

/// The match nearest to `target`: steps from there to where the residuals, linearized around the last
/// result, are zero.
fn nearest_match(problem: &FilmProblem<'_>, start: [f64; 5], target: &[f64; 5]) -> Summary<5> {
    let scaled = |x: &[f64; 5]| std::array::from_fn(|v| x[v] / UNITS[v]);
    let bounds = problem.bounds();
    let scaled_bounds = std::array::from_fn(|v| bounds[v].map(|bound| bound / UNITS[v]));
    let mut x = start;
    for _ in 0..PULLS {
        let (residuals, jacobian) = problem.eval(&x);
        let by: [[f64; 3]; 5] = std::array::from_fn(|v| jacobian.map(|row| row[v] * UNITS[v]));
        let mut residual = residuals;
        for v in 0..5 {
            (0..3).for_each(|i| residual[i] += jacobian[i][v] * (target[v] - x[v]));
        }
        let from = scaled(target);
        let next = shortest_step(&from, &residual, &by, &scaled_bounds, LEAST_DAMPING);
        x = std::array::from_fn(|v| next[v] * UNITS[v]);
    }
    let found = solve(problem, x, &SolverOptions::near());
    Summary { evaluations: PULLS + found.evaluations, ..found }
}
