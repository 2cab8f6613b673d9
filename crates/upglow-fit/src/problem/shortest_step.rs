//! The step of least length to where residuals are zero.

use super::solver::solve_positive;

/// Damping never falls below this, so that the system stays solvable in double precision.
pub(crate) const LEAST_DAMPING: f64 = 1e-8;

/// The unknowns after the shortest step that removes the residual, as far as bounds and damping allow.
///
/// With M = Σ jᵥjᵥᵀ over the unknowns that move, the step is −jᵥ·(M + μ)⁻¹r. An unknown that would
/// cross a bound is set to it, and the others compensate.
#[inline(always)]
pub(crate) fn shortest_step<const M: usize, const N: usize>(
    x: &[f64; N],
    residual: &[f64; M],
    by: &[[f64; M]; N],
    bounds: &[[f64; 2]; N],
    damping: f64,
) -> [f64; N] {
    let mut residual = *residual;
    // Unknowns that are set to a bound stay there, and have derivatives of 0.
    let (mut from, mut by) = (*x, *by);
    let (mut wanted, mut next) = (*x, *x);
    for _ in 0..N {
        let Some(y) = solve_positive(damped_squares(&by, damping), residual) else { return next };
        let mut has_crossed = false;
        for v in 0..N {
            wanted[v] = from[v] - dot(&by[v], &y);
            next[v] = within(wanted[v], &bounds[v]);
            has_crossed |= next[v] != wanted[v];
        }
        if !has_crossed {
            break;
        }
        for v in 0..N {
            if next[v] != wanted[v] {
                for i in 0..M {
                    residual[i] += by[v][i] * (next[v] - x[v]);
                }
                (from[v], by[v]) = (next[v], [0.0; M]);
            }
        }
    }
    next
}

/// The lower triangle of Σ jᵥjᵥᵀ + μ.
#[inline(always)]
fn damped_squares<const M: usize, const N: usize>(
    by: &[[f64; M]; N],
    damping: f64,
) -> [[f64; M]; M] {
    let mut matrix = [[0.0; M]; M];
    for v in 0..N {
        for i in 0..M {
            for k in 0..i + 1 {
                matrix[i][k] += by[v][i] * by[v][k];
            }
        }
    }
    let mut greatest = 0.0;
    for i in 0..M {
        greatest = if matrix[i][i] > greatest { matrix[i][i] } else { greatest };
    }
    for i in 0..M {
        matrix[i][i] += damping * greatest;
    }
    matrix
}

/// The value clamped to its bounds; the lower one for NaN.
#[inline(always)]
pub(crate) fn within(value: f64, &[least, greatest]: &[f64; 2]) -> f64 {
    // One instruction each; `f64::max` takes more, for NaN.
    let value = if value > least { value } else { least };
    if value < greatest { value } else { greatest }
}

#[inline(always)]
pub(crate) fn dot<const M: usize>(a: &[f64; M], b: &[f64; M]) -> f64 {
    let mut sum = 0.0;
    for i in 0..M {
        sum += a[i] * b[i];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    const BY: [[f64; 3]; 6] = [
        [3.0, 1.0, -1.0],
        [0.5, 2.0, 0.3],
        [1.0, -1.0, 4.0],
        [2.0, 0.1, 0.2],
        [0.0, 1.0, 1.0],
        [0.0; 3],
    ];

    fn left(x: &[f64; 6], residual: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| residual[i] + (0..6).map(|v| x[v] * BY[v][i]).sum::<f64>())
    }

    #[test]
    fn a_step_removes_the_residual_and_stays_within_bounds() {
        let residual = [1.0, -2.0, 0.7];
        for bound in [10.0, 0.7, 0.6] {
            let bounds = [[-bound, bound]; 6];
            let x = shortest_step(&[0.0; 6], &residual, &BY, &bounds, LEAST_DAMPING);
            assert!(x.iter().all(|v| v.abs() <= bound), "{x:?}");
            // The damping leaves a small residual.
            assert!(left(&x, residual).iter().all(|r| r.abs() < 1e-6), "{bound} {x:?}");
        }
    }

    #[test]
    fn a_color_out_of_reach_is_approached() {
        let residual = [10.0, -2.0, 0.7];
        let bounds = [[-0.3, 0.3]; 6];
        let x = shortest_step(&[0.0; 6], &residual, &BY, &bounds, LEAST_DAMPING);
        let norm = |r: [f64; 3]| dot(&r, &r).sqrt();
        assert!(norm(left(&x, residual)) < 0.9 * norm(residual), "{x:?}");
    }
}
