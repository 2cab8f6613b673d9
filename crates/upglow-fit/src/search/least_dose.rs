//! The least sum of optical densities that still matches a color.

use upglow_color::Matrix3;

use crate::problem::FilmProblem;
use crate::problem::solver::{Jacobian, Residuals, SolverOptions, Summary, solve, solve_positive};

/// Indices of the optical densities among the unknowns.
const DENSITIES: [usize; 2] = [3, 4];

/// The limit of each unknown in the first step: edge (100 nm), level, slope (relative to its limit), and
/// densities, to which a share of the dose is added.
const REACH: [f64; 5] = [0.3, 0.4, 0.4, 0.1, 0.1];
const REACH_OF_DOSE: f64 = 0.4;
/// What remains of the limits in each step.
const SHRINKAGE: [f64; 9] = [1.0, 1.0, 0.7, 0.5, 0.35, 0.25, 0.15, 0.1, 0.05];
/// A step that leads further from the color than this, in units of the metric, is tried at a third.
const FARTHEST: f64 = 2.0;
/// The search ends when a step from this near lowers the dose by a smaller share than this.
const SETTLED: (f64, f64) = (5e-3, 3e-3);

/// Keeps the color and lowers the sum of the two optical densities.
///
/// Each step minimizes the sum under the linearized residuals, the bounds, and a limit for each unknown:
/// a linear program, solved by looking at all its corners. The limits shrink from step to step, so that
/// a minimum that is not at a bound is approached too.
pub(crate) fn least_dose(problem: &FilmProblem<'_>, start: [f64; 5]) -> Summary<5> {
    let bounds = problem.bounds();
    let mut x = start;
    let (mut residuals, mut jacobian) = problem.eval(&x);
    let mut evaluations = 1;
    for share in SHRINKAGE {
        let moved = [1.0, 0.3, 0.1].into_iter().find_map(|part| {
            let limits = limits(&x, &bounds, part * share);
            let step = least_step(&residuals, &jacobian, &limits)?;
            let next: [f64; 5] =
                std::array::from_fn(|v| (x[v] + step[v]).clamp(bounds[v][0], bounds[v][1]));
            let there = problem.eval(&next);
            evaluations += 1;
            (norm(&there.0) <= FARTHEST).then_some((next, there))
        });
        let Some((next, there)) = moved else { break };
        let (before, after) = (dose(&x), dose(&next));
        let (near, share) = SETTLED;
        let is_settled = norm(&residuals) < near
            && norm(&there.0) < near
            && (before - after).abs() <= share * before;
        (x, (residuals, jacobian)) = (next, there);
        if is_settled {
            break;
        }
    }
    let found = solve(problem, x, &SolverOptions::near());
    Summary { evaluations: evaluations + found.evaluations, ..found }
}

fn norm(residuals: &[f64; 3]) -> f64 {
    residuals.iter().map(|r| r * r).sum::<f64>().sqrt()
}

fn dose(x: &[f64; 5]) -> f64 {
    DENSITIES.iter().map(|&v| x[v]).sum()
}

/// The least and greatest step of each unknown.
fn limits(x: &[f64; 5], bounds: &[[f64; 2]; 5], share: f64) -> [[f64; 2]; 5] {
    let of_dose = REACH_OF_DOSE * dose(x);
    std::array::from_fn(|v| {
        let reach = share * (REACH[v] + if DENSITIES.contains(&v) { of_dose } else { 0.0 });
        [(bounds[v][0] - x[v]).max(-reach), (bounds[v][1] - x[v]).min(reach)]
    })
}

/// Tolerance for a step at its limit: rounding only.
const ROUNDING: f64 = 1e-9;

/// The step within its limits that brings the linearized residuals to zero with the least dose; `None`
/// if there is none.
fn least_step(
    residuals: &[f64; 3],
    jacobian: &Jacobian<3, 5>,
    limits: &[[f64; 2]; 5],
) -> Option<[f64; 5]> {
    let column = |v: usize| jacobian.map(|row| row[v]);
    let mut best: Option<(f64, [f64; 5])> = None;
    // At a corner, all unknowns but three are at a limit.
    for [p, q, free @ ..] in CORNERS {
        let Some(inverse) = Matrix3::from_columns(free.map(column)).inverse() else { continue };
        for [at_p, at_q] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            let mut step = [0.0; 5];
            (step[p], step[q]) = (limits[p][at_p], limits[q][at_q]);
            let (by_p, by_q) = (column(p), column(q));
            let right = [0, 1, 2].map(|i| -residuals[i] - by_p[i] * step[p] - by_q[i] * step[q]);
            for (v, value) in free.into_iter().zip(inverse * right) {
                step[v] = value;
            }
            let is_inside = |&v: &usize| {
                step[v] >= limits[v][0] - ROUNDING && step[v] <= limits[v][1] + ROUNDING
            };
            let dose = dose(&step);
            if free.iter().all(is_inside) && best.is_none_or(|(least, _)| dose < least) {
                best = Some((dose, step));
            }
        }
    }
    best.map(|(_, step)| step)
}

/// The two unknowns at a limit, and the three others.
const CORNERS: [[usize; 5]; 10] = [
    [0, 1, 2, 3, 4],
    [0, 2, 1, 3, 4],
    [0, 3, 1, 2, 4],
    [0, 4, 1, 2, 3],
    [1, 2, 0, 3, 4],
    [1, 3, 0, 2, 4],
    [1, 4, 0, 2, 3],
    [2, 3, 0, 1, 4],
    [2, 4, 0, 1, 3],
    [3, 4, 0, 1, 2],
];

/// How much the dose changes with each residual, at a fit with the least dose: the multipliers of a
/// linear program, whose unknowns inside their bounds cost as much as they save.
///
/// `by` are the derivatives of the residuals by the unknowns `x`.
pub(crate) fn multipliers(
    x: &[f64; 5],
    by: &[[f64; 3]; 5],
    bounds: &[[f64; 2]; 5],
) -> Option<[f64; 3]> {
    let is_free = |v: &usize| {
        let [least, most] = bounds[*v];
        x[*v] > least + ROUNDING && x[*v] < most - ROUNDING
    };
    let mut matrix = [[0.0; 3]; 3];
    let mut right = [0.0; 3];
    for v in (0..5).filter(is_free) {
        let cost = if DENSITIES.contains(&v) { 1.0 } else { 0.0 };
        for i in 0..3 {
            right[i] += by[v][i] * cost;
            for j in 0..=i {
                matrix[i][j] += by[v][i] * by[v][j];
            }
        }
    }
    // Enough to solve it where fewer than three unknowns are free.
    (0..3).for_each(|i| matrix[i][i] += ROUNDING * (1.0 + matrix[i][i]));
    solve_positive(matrix, right)
}
