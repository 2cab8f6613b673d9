//! A blend of few of many materials that is near to the mean of all.

use crate::problem::solver::{Jacobian, Residuals, SolverOptions, solve};

/// Parts of a blend.
const PARTS: usize = 4;
/// Most lights: three known, and eight that people have.
const MOST_LIGHTS: usize = 11;
/// Three for each light, and the sum of the weights.
const ROWS: usize = 3 * MOST_LIGHTS + 1;
/// What a sum of weights that is off by 1 counts, ΔE00.
const OF_THE_SUM: f64 = 1e3;

/// Up to four materials by number, with their weights, whose blend is nearest to the mean: the first is the one that is
/// nearest by itself, each other the one that brings the blend nearest. `differences[light][material]` is how a
/// material differs from the mean.
pub(super) fn weights(differences: &[Vec<[f64; 3]>]) -> Vec<(usize, f64)> {
    let count = differences.first().map_or(0, Vec::len);
    let mut chosen: Vec<usize> = Vec::new();
    let mut best = (f64::INFINITY, [0.0; PARTS]);
    for _ in 0..PARTS.min(count) {
        let with = |added: usize| {
            let parts: Vec<usize> = chosen.iter().copied().chain([added]).collect();
            let problem = BlendProblem { differences, parts: &parts };
            let found = solve(&problem, [1.0 / PARTS as f64; PARTS], &SolverOptions::default());
            (found.norm, found.x, added)
        };
        let others = (0..count).filter(|k| !chosen.contains(k)).map(with);
        let Some((norm, x, added)) = others.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        if norm >= best.0 {
            break;
        }
        best = (norm, x);
        chosen.push(added);
    }
    let sum: f64 = best.1[..chosen.len()].iter().sum();
    let parts = chosen.into_iter().zip(best.1).map(|(number, weight)| (number, weight / sum));
    parts.filter(|(_, weight)| *weight > 0.0).collect()
}

struct BlendProblem<'a> {
    differences: &'a [Vec<[f64; 3]>],
    parts: &'a [usize],
}

impl Residuals<ROWS, PARTS> for BlendProblem<'_> {
    fn eval(&self, x: &[f64; PARTS]) -> ([f64; ROWS], Jacobian<ROWS, PARTS>) {
        let mut rows = [0.0; ROWS];
        let mut jacobian = [[0.0; PARTS]; ROWS];
        for (light, of_light) in self.differences.iter().enumerate() {
            for (part, &number) in self.parts.iter().enumerate() {
                for k in 0..3 {
                    rows[3 * light + k] += x[part] * of_light[number][k];
                    jacobian[3 * light + k][part] = of_light[number][k];
                }
            }
        }
        let sum: f64 = x[..self.parts.len()].iter().sum();
        rows[ROWS - 1] = OF_THE_SUM * (sum - 1.0);
        jacobian[ROWS - 1][..self.parts.len()].fill(OF_THE_SUM);
        (rows, jacobian)
    }

    fn bounds(&self) -> [[f64; 2]; PARTS] {
        std::array::from_fn(|part| if part < self.parts.len() { [0.0, 1.0] } else { [0.0; 2] })
    }
}
