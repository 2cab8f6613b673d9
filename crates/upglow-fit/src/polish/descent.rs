//! Bounded steps of least length from a start to a color.

use crate::fit::EXACT;
use crate::problem::shortest_step::{LEAST_DAMPING, dot, shortest_step};

/// Unknowns of a material: three of the reflectance, concentration, two of the fluorescence.
pub(super) const UNKNOWNS: usize = 6;

/// A number for each unknown.
pub(super) type Unknowns = [f64; UNKNOWNS];
/// A color, or a residual.
pub(super) type Vector = [f64; 3];
/// Least and greatest value of each unknown.
pub(super) type Bounds = [[f64; 2]; UNKNOWNS];

/// Unknowns, their color, and its derivatives, `[unknown][X Y Z]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub(super) x: Unknowns,
    pub(super) color: Vector,
    pub(super) by: [Vector; UNKNOWNS],
}

/// The distance of colors from a target, linear in the color.
pub(super) trait Measure {
    /// Three numbers whose squares add up to the square of the distance.
    fn residual(&self, color: &Vector) -> Vector;
    /// Their change for a change of the color.
    fn change(&self, by: &Vector) -> Vector;
}

/// Descents stop at this distance.
const NORM_REACHED: f64 = 0.2 * EXACT;
/// Descents and rounds of descents that gain less than this share are the last.
pub(super) const LEAST_GAIN: f64 = 0.05;
/// First damping, relative to the greatest diagonal entry. Larger converges slowly; smaller overshoots
/// if the color cannot be reached.
const DAMPING: f64 = 1e-4;
/// Damping after a step that failed.
const FAILED_DAMPING: f64 = 1e-3;

impl Point {
    /// The distance from the target.
    #[inline(always)]
    pub(super) fn norm(&self, measure: &impl Measure) -> f64 {
        let residual = measure.residual(&self.color);
        dot(&residual, &residual).sqrt()
    }

    /// The residual, and its derivatives.
    #[inline(always)]
    pub(super) fn measured(&self, measure: &impl Measure) -> (Vector, [Vector; UNKNOWNS]) {
        let mut by = [[0.0; 3]; UNKNOWNS];
        for v in 0..UNKNOWNS {
            by[v] = measure.change(&self.by[v]);
        }
        (measure.residual(&self.color), by)
    }

    /// The best point of a descent from `self` by the Levenberg–Marquardt method.
    pub(super) fn descend(
        self,
        measure: &impl Measure,
        bounds: &Bounds,
        steps: usize,
        eval: impl Fn(Unknowns) -> Self,
    ) -> Self {
        let mut here = self;
        let mut damping = DAMPING;
        for _ in 0..steps {
            let norm = here.norm(measure);
            if norm <= NORM_REACHED {
                break;
            }
            let (residual, by) = here.measured(measure);
            let next = shortest_step(&here.x, &residual, &by, bounds, damping);
            if next == here.x {
                break;
            }
            let there = eval(next);
            let gain = 1.0 - there.norm(measure) / norm;
            if gain > 0.0 {
                here = there;
                damping = (damping * 0.1).max(LEAST_DAMPING);
                if gain < LEAST_GAIN {
                    break;
                }
            } else {
                damping = (damping * 30.0).max(FAILED_DAMPING);
            }
        }
        here
    }
}

/// Solves three linear equations, `m` in rows; `None` if they have no unique solution.
#[inline(always)]
pub(super) fn solve(m: &[Vector; 3], r: &Vector) -> Option<Vector> {
    let minors = [cross(&m[1], &m[2]), cross(&m[2], &m[0]), cross(&m[0], &m[1])];
    let inverse = 1.0 / dot(&m[0], &minors[0]);
    let x = |k: usize| inverse * (minors[0][k] * r[0] + minors[1][k] * r[1] + minors[2][k] * r[2]);
    inverse.is_finite().then(|| [x(0), x(1), x(2)])
}

#[inline(always)]
fn cross(a: &Vector, b: &Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_equations_are_solved() {
        let rows = [[3.0, 1.0, -1.0], [0.5, 2.0, 0.3], [1.0, -1.0, 4.0]];
        let x = solve(&rows, &[1.0, 2.0, 3.0]).unwrap();
        for (row, r) in rows.iter().zip([1.0, 2.0, 3.0]) {
            // Rounding only.
            assert!((dot(row, &x) - r).abs() < 1e-12);
        }
        assert_eq!(solve(&[[1.0; 3]; 3], &[1.0; 3]), None);
    }
}
