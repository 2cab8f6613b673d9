//! The least fluorescence that still matches a color.

use super::job::Solve;
use crate::problem::solver::{Residuals, SolverOptions, Summary, solve};
use crate::problem::{CONCENTRATION, LeastProblem};

/// The cost of a concentration of 1, in units of the metric. Larger loses the color sooner; smaller takes
/// more rounds.
const CONCENTRATION_WEIGHT: f64 = 3.0;
/// Rounds of that search.
const LEAST_ROUNDS: usize = 12;
/// Evaluations of its first round and of each later one.
const LEAST_STEPS: [usize; 2] = [40, 8];
/// The search ends when a round is this near to the color and changes the concentration by less.
const LEAST_SETTLED: (f64, f64) = (3e-3, 2e-3);

/// Keeps the color and lowers the concentration: minimizes the squares of the residuals and of the
/// weighted concentration, with multipliers that drive the residuals to zero over several rounds; then
/// fits the color alone.
///
/// # Source
///
/// The method of multipliers: `hestenes`.
pub(crate) struct LeastConcentration;

impl Solve for LeastConcentration {
    fn solve<const N: usize>(&self, problem: &impl Residuals<3, N>, start: [f64; N]) -> Summary<N> {
        let mut x = start;
        let mut multipliers = [0.0; 3];
        let mut evaluations = 0;
        for round in 0..LEAST_ROUNDS {
            let before = x[CONCENTRATION];
            let found = one_round(problem, x, multipliers, round == 0);
            x = found.x;
            evaluations += found.evaluations + 1;
            let (residuals, _) = problem.eval(&x);
            (0..3).for_each(|i| multipliers[i] += residuals[i]);
            let norm = residuals.iter().map(|r| r * r).sum::<f64>().sqrt();
            let (near, still) = LEAST_SETTLED;
            if round > 0 && norm < near && (x[CONCENTRATION] - before).abs() < still {
                break;
            }
        }
        let found = solve(problem, x, &SolverOptions::near());
        Summary { evaluations: evaluations + found.evaluations, ..found }
    }
}

fn one_round<const N: usize>(
    problem: &impl Residuals<3, N>,
    x: [f64; N],
    multipliers: [f64; 3],
    is_first: bool,
) -> Summary<N> {
    let least = LeastProblem { problem, multipliers, concentration_weight: CONCENTRATION_WEIGHT };
    let [first_steps, later_steps] = LEAST_STEPS;
    let options = SolverOptions {
        norm_reached: 0.0,
        stationary_share: 1e-2,
        step_limit: if is_first { first_steps } else { later_steps },
        damping: if is_first { 1e-2 } else { 1e-4 },
    };
    solve(&least, x, &options)
}
