//! Given dyes over a sigmoid reflectance, fitted to a measured matrix.

use rayon::prelude::*;
use upglow::{Accounting, FilmModel, Sigmoid};
use upglow_color::{Diagonal, DonaldsonMatrix, MeasuredDye};

use super::goal::{MatrixGoal, ROWS};
use crate::problem::parabola::{MIDDLE_NM, edge_chart, scaled, sigmoid_of};
use crate::problem::solver::{Jacobian, Residuals, SolverOptions, solve};
use crate::problem::{EDGE_BOUND, LEVEL_BOUND};

/// Optical density and quantum yield of each dye, then the coordinates of the reflectance.
const UNKNOWNS: usize = 7;

/// The reflectance may be as steep as the steepest measured paint, several times over, 1/nm.
const STEEPEST_PER_NM: f64 = 0.1;

/// Optical densities and slopes (of [`STEEPEST_PER_NM`]) from which single dyes start; the densities of thin and of
/// loaded films, and reflectances that rise and fall. Edges start at the middle.
const FIRST_DENSITIES: [f64; 3] = [0.3, 1.5, 4.0];
const FIRST_SLOPES: [f64; 2] = [0.1, -0.1];
const FIRST_YIELD: f64 = 0.5;
/// A second dye starts with this optical density.
const SECOND_DENSITY: f64 = 0.3;

/// Dyes in a film over a reflectance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    /// Numbers of the dyes in the list; the same twice where there is one.
    pub(super) dyes: [usize; 2],
    pub(super) densities: [f64; 2],
    pub(super) yields: [f64; 2],
    pub(super) reflectance: Sigmoid,
    norm: f64,
}

impl Found {
    /// Root of the sum of squares of the differences that it leaves.
    pub(super) fn norm(&self) -> f64 {
        self.norm
    }
}

/// The dyes on the axes of a matrix.
pub(super) struct TableDyes<'a> {
    goal: &'a MatrixGoal,
    incident_nm: &'a [f64],
    dyes: Vec<OnAxes>,
    /// x̄, ȳ, z̄ of what is reflected in each incident band; zero where that is not measured.
    seen: Vec<[f64; 3]>,
}

/// A dye on the axes of a matrix.
struct OnAxes {
    absorption: Vec<f64>,
    /// The color that unit power, absorbed in each incident band by a dye with a yield of 1, makes.
    stimulus: Vec<[f64; 3]>,
}

impl<'a> TableDyes<'a> {
    pub(super) fn new(
        measured: &'a DonaldsonMatrix,
        goal: &'a MatrixGoal,
        dyes: &[MeasuredDye],
    ) -> Self {
        let mut seen = vec![[0.0; 3]; measured.incident_nm().len()];
        let mut diagonal = vec![None; seen.len()];
        for [o, i] in measured.diagonal_bands() {
            seen[i] = goal.matching[o];
            diagonal[i] = Some(o);
        }
        let on_axes = |dye: &MeasuredDye| OnAxes::of(dye, measured, goal, &diagonal);
        let dyes = dyes.iter().map(on_axes).collect();
        Self { goal, incident_nm: measured.incident_nm(), dyes, seen }
    }

    /// The best film of one dye.
    pub(super) fn best_of_one(&self) -> Option<Found> {
        best(self.singles())
    }

    /// The best film of at most two dyes: every pair starts from the better of its dyes.
    pub(super) fn best_of_two(&self) -> Option<Found> {
        let singles = self.singles();
        let pairs: Vec<[usize; 2]> =
            (0..singles.len()).flat_map(|i| (0..i).map(move |j| [i, j])).collect();
        let of_pair = |&[i, j]: &[usize; 2]| {
            let (one, two) = if singles[i].norm <= singles[j].norm { (i, j) } else { (j, i) };
            self.with_second(&singles[one], two)
        };
        let found: Vec<Found> = pairs.par_iter().map(of_pair).collect();
        best(singles.into_iter().chain(found))
    }

    /// The best film from given densities and yields of the first two dyes.
    pub(super) fn from(&self, densities: [f64; 2], yields: [f64; 2]) -> Option<Found> {
        let dyes = [0, self.dyes.len() - 1];
        let is_pair = dyes[0] != dyes[1];
        let solve = |slope: f64| {
            let [second, second_yield] = if is_pair { [densities[1], yields[1]] } else { [0.0; 2] };
            let start = [densities[0], second, yields[0], second_yield, 0.0, 0.0, slope];
            self.solve(dyes, is_pair, start)
        };
        best(FIRST_SLOPES.map(solve))
    }

    fn singles(&self) -> Vec<Found> {
        let of_dye = |dye: usize| {
            let starts = FIRST_DENSITIES.into_iter().flat_map(|a| FIRST_SLOPES.map(|s| (a, s)));
            let found = starts.map(|(density, slope)| {
                let start = [density, 0.0, FIRST_YIELD, 0.0, 0.0, 0.0, slope];
                self.solve([dye; 2], false, start)
            });
            best(found).expect("there are starts")
        };
        (0..self.dyes.len()).into_par_iter().map(of_dye).collect()
    }

    fn with_second(&self, single: &Found, second: usize) -> Found {
        let ([density, _], [quantum_yield, _]) = (single.densities, single.yields);
        let edge = single.reflectance.to_edge(MIDDLE_NM);
        let relative = edge.slope_per_nm / STEEPEST_PER_NM;
        let start = [
            density,
            SECOND_DENSITY,
            quantum_yield,
            FIRST_YIELD,
            scaled(edge.edge_nm),
            edge.level,
            relative,
        ];
        self.solve([single.dyes[0], second], true, start)
    }

    fn solve(&self, dyes: [usize; 2], is_pair: bool, start: [f64; UNKNOWNS]) -> Found {
        let problem = FilmProblem { dyes: self, pair: dyes, is_pair };
        let solved = solve(&problem, start, &SolverOptions::default());
        let [a, b, q, p, edge, level, slope] = solved.x;
        let (parabola, _) = edge_chart([edge, level, slope], STEEPEST_PER_NM);
        Found {
            dyes,
            densities: [a, b],
            yields: [q, p],
            reflectance: sigmoid_of(parabola),
            norm: solved.norm,
        }
    }
}

fn best(found: impl IntoIterator<Item = Found>) -> Option<Found> {
    found.into_iter().min_by(|a, b| a.norm.total_cmp(&b.norm))
}

impl OnAxes {
    fn of(
        dye: &MeasuredDye,
        measured: &DonaldsonMatrix,
        goal: &MatrixGoal,
        diagonal: &[Option<usize>],
    ) -> Self {
        let samples = dye.emission.grid().wavelengths_nm().zip(dye.emission.values());
        let (moment, sum) =
            samples.fold((0.0, 0.0), |(moment, sum), (nm, e)| (moment + nm * e, sum + e));
        let mean_nm = moment / sum;
        let area_nm = dye.emission.integral();
        let bands = measured.outgoing_nm().iter().zip(measured.outgoing_bands_nm());
        let emitted: Vec<f64> =
            bands.map(|(nm, width)| dye.emission.at(*nm) * width / area_nm).collect();
        let stimulus = |(nm, on_diagonal): (&f64, &Option<usize>)| {
            let share = Accounting::Photon.share(*nm, mean_nm);
            let left_out = on_diagonal.filter(|_| measured.diagonal() == Diagonal::Reflected);
            let mut color = [0.0; 3];
            for (o, (e, m)) in emitted.iter().zip(&goal.matching).enumerate() {
                if left_out != Some(o) {
                    (0..3).for_each(|k| color[k] += share * e * m[k]);
                }
            }
            color
        };
        let incident_nm = measured.incident_nm();
        Self {
            absorption: incident_nm.iter().map(|nm| dye.absorption.at(*nm)).collect(),
            stimulus: incident_nm.iter().zip(diagonal).map(stimulus).collect(),
        }
    }
}

/// The differences of a film of two dyes from the goal.
struct FilmProblem<'a> {
    dyes: &'a TableDyes<'a>,
    pair: [usize; 2],
    /// Whether there is a second dye.
    is_pair: bool,
}

impl Residuals<ROWS, UNKNOWNS> for FilmProblem<'_> {
    fn eval(&self, x: &[f64; UNKNOWNS]) -> ([f64; ROWS], Jacobian<ROWS, UNKNOWNS>) {
        let &[a, b, first_yield, second_yield, edge, level, slope] = x;
        let [one, two] = self.pair.map(|dye| &self.dyes.dyes[dye]);
        let (parabola, by_coordinates) = edge_chart([edge, level, slope], STEEPEST_PER_NM);
        let reflectance = sigmoid_of(parabola);
        let count = self.dyes.incident_nm.len();
        let mut colors = vec![[0.0; 3]; count];
        let mut by = vec![vec![[0.0; 3]; count]; UNKNOWNS];
        for (i, nm) in self.dyes.incident_nm.iter().enumerate() {
            let absorptions = [one.absorption[i], two.absorption[i]];
            let (passed, absorbed, by_density) = FilmModel::absorbed_by_two([a, b], absorptions);
            let (r, seen) = (reflectance.at(*nm), self.dyes.seen[i]);
            let [emits_one, emits_two] = [one.stimulus[i], two.stimulus[i]];
            // dr/dx of the sigmoid, and dx by each coordinate of the edge.
            let t = scaled(*nm);
            let x = parabola[0] + t * (parabola[1] + t * parabola[2]);
            let r_by_x = 0.5 / ((1.0 + x * x) * (1.0 + x * x).sqrt());
            for k in 0..3 {
                let yielded = [first_yield * emits_one[k], second_yield * emits_two[k]];
                colors[i][k] =
                    passed * r * seen[k] + absorbed[0] * yielded[0] + absorbed[1] * yielded[1];
                for d in 0..2 {
                    let passed_by = -(by_density[0][d] + by_density[1][d]);
                    by[d][i][k] = passed_by * r * seen[k]
                        + by_density[0][d] * yielded[0]
                        + by_density[1][d] * yielded[1];
                }
                by[2][i][k] = absorbed[0] * emits_one[k];
                by[3][i][k] = absorbed[1] * emits_two[k];
                for c in 0..3 {
                    let x_by = by_coordinates[0][c]
                        + t * (by_coordinates[1][c] + t * by_coordinates[2][c]);
                    by[4 + c][i][k] = passed * r_by_x * x_by * seen[k];
                }
            }
        }
        let mut jacobian = [[0.0; UNKNOWNS]; ROWS];
        for (unknown, by) in by.iter().enumerate() {
            let column = self.dyes.goal.change(by);
            jacobian.iter_mut().zip(column).for_each(|(row, value)| row[unknown] = value);
        }
        (self.dyes.goal.residuals(&colors), jacobian)
    }

    fn bounds(&self) -> [[f64; 2]; UNKNOWNS] {
        let second = |most: f64| [0.0, if self.is_pair { most } else { 0.0 }];
        let densest = FilmModel::DENSITIES[1];
        let edges = [-EDGE_BOUND, EDGE_BOUND];
        let levels = [-LEVEL_BOUND, LEVEL_BOUND];
        [[0.0, densest], second(densest), [0.0, 1.0], second(1.0), edges, levels, [-1.0, 1.0]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit_matrix::tests::film_matrix;
    use crate::problem::solver::jacobian_error;

    #[test]
    fn derivatives_are_the_slopes() {
        // Truncation of central differences.
        const TRUNCATION: f64 = 1e-5;
        let (measured, _) = film_matrix(0.0, 0);
        let goal = MatrixGoal::new(&measured).unwrap();
        let dyes: Vec<MeasuredDye> =
            ["ATTO_425", "BODIPY_FL"].map(|name| MeasuredDye::named(name).unwrap()).to_vec();
        let dyes = TableDyes::new(&measured, &goal, &dyes);
        let problem = FilmProblem { dyes: &dyes, pair: [0, 1], is_pair: true };
        let steps = [1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-6];
        for x in [[1.0, 0.5, 0.6, 0.3, -0.5, 0.4, 0.2], [4.0, 2.0, 0.1, 0.9, 0.7, -0.8, -0.1]] {
            let error = jacobian_error(&problem, &x, &steps);
            assert!(error < TRUNCATION, "{error}");
        }
    }
}
