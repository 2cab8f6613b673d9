//! The least sum of optical densities that still matches a color.

use super::job::Solve;
use crate::problem::FilmProblem;
use crate::problem::solver::{Jacobian, Residuals, SolverOptions, Summary, solve, solve_positive};

/// Keeps the color and lowers the sum of two optical densities, the unknowns [`DENSITIES`].
///
/// Each step minimizes the sum under the linearized residuals, the bounds, and a limit for each unknown:
/// a linear program, solved by looking at all its corners. The limits shrink from step to step, so that
/// a minimum that is not at a bound is approached too.
pub(crate) struct LeastDose;

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

impl Solve for LeastDose {
    fn solve<const N: usize>(&self, problem: &impl Residuals<3, N>, start: [f64; N]) -> Summary<N> {
        let bounds = problem.bounds();
        let mut x = start;
        let (mut residuals, mut jacobian) = problem.eval(&x);
        let mut evaluations = 1;
        for share in SHRINKAGE {
            let moved = [1.0, 0.3, 0.1].into_iter().find_map(|part| {
                let limits = limits(&x, &bounds, part * share);
                let step = least_step(&residuals, &jacobian, &limits)?;
                let next: [f64; N] =
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
        let last = SolverOptions { damping: 1e-6, step_limit: 20, ..SolverOptions::default() };
        let found = solve(problem, x, &last);
        Summary { evaluations: evaluations + found.evaluations, ..found }
    }
}

fn norm(residuals: &[f64; 3]) -> f64 {
    residuals.iter().map(|r| r * r).sum::<f64>().sqrt()
}

fn dose<const N: usize>(x: &[f64; N]) -> f64 {
    DENSITIES.iter().map(|&v| x[v]).sum()
}

/// The least and greatest step of each unknown.
fn limits<const N: usize>(x: &[f64; N], bounds: &[[f64; 2]; N], share: f64) -> [[f64; 2]; N] {
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
fn least_step<const N: usize>(
    residuals: &[f64; 3],
    jacobian: &Jacobian<3, N>,
    limits: &[[f64; 2]; N],
) -> Option<[f64; N]> {
    let column = |v: usize| [jacobian[0][v], jacobian[1][v], jacobian[2][v]];
    let mut best: Option<(f64, [f64; N])> = None;
    // At a corner, all unknowns but three are at a limit.
    for p in 0..N {
        for q in p + 1..N {
            let [a, b, c] = rest(p, q);
            let Some(inverse) = inverse([column(a), column(b), column(c)]) else { continue };
            for corner in 0..4 {
                let mut step = [0.0; N];
                step[p] = limits[p][corner & 1];
                step[q] = limits[q][corner >> 1];
                let (by_p, by_q) = (column(p), column(q));
                let right =
                    [0, 1, 2].map(|i| -residuals[i] - by_p[i] * step[p] - by_q[i] * step[q]);
                let solved = [0, 1, 2].map(|i| dot(&inverse[i], &right));
                for (v, value) in [a, b, c].into_iter().zip(solved) {
                    step[v] = value;
                }
                let inside = [a, b, c].iter().all(|&v| {
                    step[v] >= limits[v][0] - ROUNDING && step[v] <= limits[v][1] + ROUNDING
                });
                let dose = dose(&step);
                if inside && best.is_none_or(|(least, _)| dose < least) {
                    best = Some((dose, step));
                }
            }
        }
    }
    best.map(|(_, step)| step)
}

/// The three of five unknowns that are neither `p` nor `q`.
fn rest(p: usize, q: usize) -> [usize; 3] {
    let mut others = (0..5).filter(|&v| v != p && v != q);
    std::array::from_fn(|_| others.next().expect("five less two are three"))
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The rows of the inverse of the matrix with these columns; `None` if it has none.
fn inverse([a, b, c]: [[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let cross = |u: [f64; 3], v: [f64; 3]| {
        [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    };
    let rows = [cross(b, c), cross(c, a), cross(a, b)];
    let scale = 1.0 / dot(&a, &rows[0]);
    scale.is_finite().then(|| rows.map(|row| row.map(|v| v * scale)))
}

/// How much the dose changes with each residual, at a fit with the least dose: the multipliers of a
/// linear program, whose unknowns inside their bounds cost as much as they save.
pub(crate) fn multipliers(problem: &FilmProblem<'_>, x: &[f64; 5]) -> Option<[f64; 3]> {
    let (_, jacobian) = problem.eval(x);
    let bounds = problem.bounds();
    let is_free = |v: &usize| {
        let [least, most] = bounds[*v];
        x[*v] > least + ROUNDING && x[*v] < most - ROUNDING
    };
    let mut matrix = [[0.0; 3]; 3];
    let mut right = [0.0; 3];
    for v in (0..5).filter(is_free) {
        let cost = if DENSITIES.contains(&v) { 1.0 } else { 0.0 };
        for i in 0..3 {
            right[i] += jacobian[i][v] * cost;
            for j in 0..=i {
                matrix[i][j] += jacobian[i][v] * jacobian[j][v];
            }
        }
    }
    // Enough to solve it where fewer than three unknowns are free.
    (0..3).for_each(|i| matrix[i][i] += ROUNDING * (1.0 + matrix[i][i]));
    solve_positive(matrix, right)
}
