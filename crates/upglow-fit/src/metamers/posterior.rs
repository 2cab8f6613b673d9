//! Where known colors and what is usual agree.

use rayon::prelude::*;
use upglow_color::{Matrix3, Xyz, difference_by_xyz};

use super::MOST_COLORS;
use super::lit::MetamerLight;
use super::prior::{self, Dyes, Numbers, PRIOR_ROWS, UNKNOWNS};
use crate::problem::solver::{Jacobian, Residuals, SolverOptions, solve};

/// Three numbers for each color, and what is usual.
const ROWS: usize = 3 * MOST_COLORS + PRIOR_ROWS;

/// Standard deviation of a known color, ΔE00: that under the light of the contract is to be matched; others are
/// measured, and the model shows real materials as well as this.
const OF_THE_FIRST: f64 = 0.03;
const OF_OTHERS: f64 = 0.4;

/// Searches for each pair of dyes.
const STARTS: usize = 6;

/// Materials of the same dyes nearer than this in each number, in standard deviations of what is usual, are one.
const SAME: f64 = 0.1;

/// A color that a material has under a light.
pub(super) struct Known<'s> {
    light: &'s MetamerLight,
    color: Xyz,
    /// Three numbers whose squares add up to that of the difference over its standard deviation.
    by_xyz: Matrix3,
}

impl<'s> Known<'s> {
    pub(super) fn new(light: &'s MetamerLight, color: Xyz, is_first: bool) -> Self {
        let deviation = if is_first { OF_THE_FIRST } else { OF_OTHERS };
        let scale = Matrix3::diagonal([deviation.recip(); 3]);
        Self { light, color, by_xyz: scale * difference_by_xyz(color, light.white()) }
    }
}

/// A material that may have the colors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    /// Its probability beside that of others.
    pub(super) weight: f64,
    pub(super) does: Dyes,
    /// Different dyes, or the same twice if there is one only.
    pub(super) dyes: [usize; 2],
    pub(super) numbers: Numbers,
}

/// The probability of materials of which these colors are known.
pub(super) struct Posterior<'s> {
    pub(super) known: &'s [Known<'s>],
    /// How many dyes there are.
    pub(super) dyes: usize,
    pub(super) does: Dyes,
}

impl Posterior<'_> {
    /// The most probable material of each pair of dyes, and others where the probability has more than one
    /// maximum. Their weights are the logarithms of the probability around them.
    pub(super) fn modes(&self) -> Vec<Found> {
        let pairs: Vec<[usize; 2]> = match self.dyes {
            1 => vec![[0, 0]],
            count => (0..count).flat_map(|i| (i + 1..count).map(move |j| [i, j])).collect(),
        };
        let of_pair = |(place, &dyes): (usize, &[usize; 2])| self.modes_of(dyes, place * STARTS);
        pairs.par_iter().enumerate().flat_map_iter(of_pair).collect()
    }

    /// The materials of two dyes.
    fn modes_of(&self, dyes: [usize; 2], first_start: usize) -> Vec<Found> {
        let problem = MetamerProblem { posterior: self, dyes };
        let mut modes: Vec<Found> = Vec::with_capacity(STARTS);
        for start in first_start..first_start + STARTS {
            let numbers = solve(&problem, prior::start(start), &SolverOptions::default()).x;
            let weight = problem.log_probability_around(&numbers);
            let mode = Found { weight, does: self.does, dyes, numbers };
            match modes
                .iter_mut()
                .find(|known| prior::distance(self.does, &known.numbers, &numbers) < SAME)
            {
                Some(known) if known.weight >= weight => {}
                Some(known) => *known = mode,
                None => modes.push(mode),
            }
        }
        modes
    }
}

impl Found {
    /// The same dyes over the reflectance nearby that has the known color exactly, if there is one.
    pub(super) fn exact(self, known: &Known<'_>) -> Self {
        let [edge, level, slope, ..] = self.numbers;
        let problem = ExactProblem { known, found: &self };
        let solved = solve(&problem, [edge, level, slope], &SolverOptions::near());
        Self { numbers: problem.with(solved.x), ..self }
    }
}

/// The reflectance under a film that has a color.
struct ExactProblem<'p> {
    known: &'p Known<'p>,
    found: &'p Found,
}

impl ExactProblem<'_> {
    fn with(&self, shape: [f64; 3]) -> Numbers {
        let mut numbers = self.found.numbers;
        numbers[..3].copy_from_slice(&shape);
        numbers
    }
}

impl Residuals<3, 3> for ExactProblem<'_> {
    fn eval(&self, x: &[f64; 3]) -> ([f64; 3], Jacobian<3, 3>) {
        let Known { light, color, by_xyz } = self.known;
        let (found, by) = light.color_by(self.found.dyes, &self.with(*x));
        let columns = [0, 1, 2].map(|v| *by_xyz * by[v].0);
        (*by_xyz * (found - *color).0, [0, 1, 2].map(|k| columns.map(|column| column[k])))
    }

    fn bounds(&self) -> [[f64; 2]; 3] {
        let [edge, level, slope, ..] = prior::bounds(self.found.does);
        [edge, level, slope]
    }
}

struct MetamerProblem<'p> {
    posterior: &'p Posterior<'p>,
    dyes: [usize; 2],
}

impl MetamerProblem<'_> {
    /// The logarithm of the integral of the probability around a maximum of it, but for a constant, by Laplace's
    /// method: the density of what is usual, times exp(−½·cost) / √det(`JᵀJ`).
    fn log_probability_around(&self, numbers: &Numbers) -> f64 {
        let (residuals, jacobian) = self.eval(numbers);
        let cost: f64 = residuals.iter().map(|r| r * r).sum();
        let mut matrix = [[0.0; UNKNOWNS]; UNKNOWNS];
        for v in 0..UNKNOWNS {
            for u in 0..=v {
                matrix[v][u] = jacobian.iter().map(|row| row[v] * row[u]).sum();
            }
        }
        let mut log = 0.0;
        for k in 0..UNKNOWNS {
            log += matrix[k][k].ln();
            for i in k + 1..UNKNOWNS {
                let factor = matrix[i][k] / matrix[k][k];
                for j in k + 1..=i {
                    matrix[i][j] -= factor * matrix[j][k];
                }
            }
        }
        prior::log_density(self.posterior.does) - 0.5 * (cost + log)
    }
}

impl Residuals<ROWS, UNKNOWNS> for MetamerProblem<'_> {
    fn eval(&self, x: &Numbers) -> ([f64; ROWS], Jacobian<ROWS, UNKNOWNS>) {
        let mut rows = [0.0; ROWS];
        let mut jacobian = [[0.0; UNKNOWNS]; ROWS];
        for (place, Known { light, color, by_xyz }) in self.posterior.known.iter().enumerate() {
            let (found, by) = light.color_by(self.dyes, x);
            rows[3 * place..3 * place + 3].copy_from_slice(&(*by_xyz * (found - *color).0));
            for (v, by) in by.into_iter().enumerate() {
                let column = *by_xyz * by.0;
                (0..3).for_each(|k| jacobian[3 * place + k][v] = column[k]);
            }
        }
        let (usual, by) = prior::residuals(self.posterior.does, x);
        rows[3 * MOST_COLORS..].copy_from_slice(&usual);
        jacobian[3 * MOST_COLORS..].copy_from_slice(&by);
        (rows, jacobian)
    }

    fn bounds(&self) -> [[f64; 2]; UNKNOWNS] {
        prior::bounds(self.posterior.does)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metamers::{MetamerSearch, PaintKind};
    use crate::problem::solver::jacobian_error;
    use upglow_color::{Contract, Illuminant};

    #[test]
    fn derivatives_are_the_slopes() {
        // Sums in single precision are off by 2e-6; their differences over this step by a thousandth.
        const STEP: f64 = 2e-3;
        const ROUNDING: f64 = 1e-3;
        let lights = ["A", "FL2"].map(|name| Illuminant::named(name).unwrap());
        let search =
            MetamerSearch::new(&Contract::default(), &lights, PaintKind::Fluorescent).unwrap();
        let color = Xyz([0.4, 0.3, 0.1]);
        let known: Vec<Known<'_>> =
            search.among.known.iter().map(|light| Known::new(light, color, false)).collect();
        for does in [Dyes::Absorb, Dyes::Emit] {
            let posterior = Posterior { known: &known, dyes: 28, does };
            let problem = MetamerProblem { posterior: &posterior, dyes: [3, 11] };
            for count in 0..8 {
                let error = jacobian_error(&problem, &prior::start(count), &[STEP; UNKNOWNS]);
                assert!(error < ROUNDING, "{error}");
            }
        }
    }
}
