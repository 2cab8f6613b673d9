//! Bounded least squares by the Levenberg–Marquardt method.

/// Derivatives of `M` residuals with respect to `N` unknowns, `[residual][unknown]`.
pub(crate) type Jacobian<const M: usize, const N: usize> = [[f64; N]; M];

/// A least-squares problem: `M` residuals of `N` bounded unknowns.
pub(crate) trait Residuals<const M: usize, const N: usize> {
    /// Residuals at `x`, and their derivatives.
    fn eval(&self, x: &[f64; N]) -> ([f64; M], Jacobian<M, N>);

    /// Least and greatest value of each unknown.
    fn bounds(&self) -> [[f64; 2]; N];
}

/// Stopping rules, and the first damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SolverOptions {
    /// Stop when the norm of the residuals is at or below this. Default: 1e-4.
    pub(crate) norm_reached: f64,
    /// Stop when two accepted steps in a row lower the cost by less than this share. Default: 1e-4.
    pub(crate) stationary_share: f64,
    /// Stop after this many evaluations. Default: 60.
    pub(crate) step_limit: usize,
    /// First damping, as a share of the diagonal of `JᵀJ`. Default: 0.01.
    pub(crate) damping: f64,
}

impl Default for SolverOptions {
    fn default() -> Self {
        Self { norm_reached: 1e-4, stationary_share: 1e-4, step_limit: 60, damping: 1e-2 }
    }
}

/// The result of a solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Summary<const N: usize> {
    /// The unknowns.
    pub(crate) x: [f64; N],
    /// Norm of the residuals there.
    pub(crate) norm: f64,
    /// Evaluations used.
    pub(crate) evaluations: usize,
}

impl SolverOptions {
    /// To end a search whose steps were linear, near its result.
    pub(crate) const fn near() -> Self {
        Self { norm_reached: 1e-4, stationary_share: 1e-4, step_limit: 20, damping: 1e-6 }
    }
}

/// Damping never falls below this share, so that a singular `JᵀJ` stays solvable.
const LEAST_DAMPING: f64 = 1e-9;
/// Added to the diagonal, for unknowns that have no effect.
const NO_EFFECT: f64 = 1e-12;
/// Beyond this damping a step is shorter than rounding.
const MOST_DAMPING: f64 = 1e12;

/// Minimizes the sum of squares from `start`.
///
/// # Source
///
/// `levenberg`, `marquardt`; bounds by an active set: an unknown at a bound is fixed if the descent
/// direction points outward, and an unknown that a step would carry across a bound is set to it and
/// the step of the others solved again.
pub(crate) fn solve<const M: usize, const N: usize>(
    problem: &impl Residuals<M, N>,
    start: [f64; N],
    options: &SolverOptions,
) -> Summary<N> {
    let bounds = problem.bounds();
    let mut x = start;
    (0..N).for_each(|v| x[v] = x[v].clamp(bounds[v][0], bounds[v][1]));
    let mut here = Point::at(problem, x);
    let mut evaluations = 1;
    let mut damping = options.damping;
    let mut small_steps = 0;
    while here.cost.sqrt() > options.norm_reached && evaluations < options.step_limit {
        let free = here.free(&bounds);
        if damping > MOST_DAMPING || small_steps >= 2 || !free.contains(&true) {
            break;
        }
        let next = here.step(free, &bounds, damping);
        let predicted = here.cost - here.predicted_cost(&next);
        if predicted <= 1e-9 * here.cost {
            // If several unknowns were set to their bounds at once, the rest may not descend. A
            // shorter step may, and costs no evaluation.
            damping = (damping * 10.0).max(1e-3);
            continue;
        }
        let there = Point::at(problem, next);
        evaluations += 1;
        if there.cost < here.cost {
            damping = adapt(damping, (here.cost - there.cost) / predicted);
            let is_small = here.cost - there.cost < options.stationary_share * here.cost;
            small_steps = if is_small { small_steps + 1 } else { 0 };
            here = there;
        } else {
            damping = (damping * 6.0).max(1e-4);
        }
    }
    Summary { x: here.x, norm: here.cost.sqrt(), evaluations }
}

/// The damping after an accepted step; `gain` is the actual over the predicted decrease of the cost.
fn adapt(damping: f64, gain: f64) -> f64 {
    let factor = match gain {
        g if g > 0.75 => 0.1,
        g if g > 0.4 => 0.4,
        g if g < 0.2 => 3.0,
        _ => 1.0,
    };
    (damping * factor).max(LEAST_DAMPING)
}

/// The problem evaluated at `x`.
struct Point<const M: usize, const N: usize> {
    x: [f64; N],
    residuals: [f64; M],
    jacobian: Jacobian<M, N>,
    cost: f64,
}

impl<const M: usize, const N: usize> Point<M, N> {
    fn at(problem: &impl Residuals<M, N>, x: [f64; N]) -> Self {
        let (residuals, jacobian) = problem.eval(&x);
        let cost: f64 = residuals.iter().map(|r| r * r).sum();
        // NaN must not look like progress.
        let cost = if cost.is_nan() { f64::INFINITY } else { cost };
        Self { x, residuals, jacobian, cost }
    }

    /// Which unknowns can move without leaving their bounds.
    fn free(&self, bounds: &[[f64; 2]; N]) -> [bool; N] {
        std::array::from_fn(|v| {
            let slope: f64 = (0..M).map(|i| self.jacobian[i][v] * self.residuals[i]).sum();
            let [least, most] = bounds[v];
            !(self.x[v] <= least && slope > 0.0 || self.x[v] >= most && slope < 0.0)
        })
    }

    /// The unknowns after the damped step of the free ones, within the bounds.
    fn step(&self, free: [bool; N], bounds: &[[f64; 2]; N], damping: f64) -> [f64; N] {
        let mut moving = free;
        let mut next = self.x;
        loop {
            let Some(step) = self.damped_step(moving, &next, damping) else {
                return next;
            };
            let mut crossed = false;
            for v in (0..N).filter(|&v| moving[v]) {
                let [least, most] = bounds[v];
                let wanted = self.x[v] + step[v];
                next[v] = wanted.clamp(least, most);
                if next[v] != wanted {
                    crossed = true;
                }
            }
            if !crossed {
                return next;
            }
            let inside = |v: usize| next[v] > bounds[v][0] && next[v] < bounds[v][1];
            (0..N).for_each(|v| moving[v] = moving[v] && inside(v));
            (0..N).filter(|&v| moving[v]).for_each(|v| next[v] = self.x[v]);
        }
    }

    /// Solves `(JᵀJ + damping·diag)·step = −Jᵀr` for the moving unknowns, where r includes the moves of
    /// the others; `None` if nothing moves.
    fn damped_step(&self, moving: [bool; N], next: &[f64; N], damping: f64) -> Option<[f64; N]> {
        if !moving.contains(&true) {
            return None;
        }
        let mut residuals = self.residuals;
        for v in (0..N).filter(|&v| !moving[v]) {
            (0..M).for_each(|i| residuals[i] += self.jacobian[i][v] * (next[v] - self.x[v]));
        }
        let mut matrix = [[0.0; N]; N];
        let mut right = [0.0; N];
        for v in 0..N {
            if !moving[v] {
                matrix[v][v] = 1.0;
                continue;
            }
            right[v] = -(0..M).map(|i| self.jacobian[i][v] * residuals[i]).sum::<f64>();
            for u in (0..=v).filter(|&u| moving[u]) {
                matrix[v][u] = (0..M).map(|i| self.jacobian[i][v] * self.jacobian[i][u]).sum();
            }
            matrix[v][v] += damping * matrix[v][v] + NO_EFFECT;
        }
        solve_positive(matrix, right)
    }

    /// The cost at `next` if the residuals were linear.
    fn predicted_cost(&self, next: &[f64; N]) -> f64 {
        (0..M)
            .map(|i| {
                let moved: f64 = (0..N).map(|v| self.jacobian[i][v] * (next[v] - self.x[v])).sum();
                (self.residuals[i] + moved).powi(2)
            })
            .sum()
    }
}

/// Solves a symmetric system given by its lower triangle, by L·D·Lᵀ; `None` if it is not positive
/// definite.
#[inline(always)]
pub(crate) fn solve_positive<const N: usize>(
    mut a: [[f64; N]; N],
    mut b: [f64; N],
) -> Option<[f64; N]> {
    let mut inverse = [0.0; N];
    for k in 0..N {
        inverse[k] = 1.0 / a[k][k];
        if !(a[k][k] > 0.0 && inverse[k].is_finite()) {
            return None;
        }
        for i in k + 1..N {
            let factor = a[i][k] * inverse[k];
            for j in k + 1..i + 1 {
                a[i][j] -= factor * a[j][k];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..N).rev() {
        for i in k + 1..N {
            b[k] -= a[i][k] * b[i];
        }
        b[k] *= inverse[k];
    }
    Some(b)
}

/// The greatest difference between a problem's derivatives and central differences at `x`,
/// relative to the greatest derivative.
#[cfg(test)]
pub(crate) fn jacobian_error<const M: usize, const N: usize>(
    problem: &impl Residuals<M, N>,
    x: &[f64; N],
    steps: &[f64; N],
) -> f64 {
    let (_, jacobian) = problem.eval(x);
    let greatest = jacobian.iter().flatten().fold(0.0_f64, |m, d| m.max(d.abs()));
    let mut error: f64 = 0.0;
    for v in 0..N {
        let moved = |by: f64| {
            let mut y = *x;
            y[v] += by;
            problem.eval(&y).0
        };
        let (low, high) = (moved(-steps[v]), moved(steps[v]));
        for i in 0..M {
            let quotient = (high[i] - low[i]) / (2.0 * steps[v]);
            error = error.max((jacobian[i][v] - quotient).abs() / greatest);
        }
    }
    error
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley: 10(y − x²), 1 − x.
    struct Valley {
        bounds: [[f64; 2]; 2],
    }

    impl Residuals<2, 2> for Valley {
        fn eval(&self, &[x, y]: &[f64; 2]) -> ([f64; 2], Jacobian<2, 2>) {
            ([10.0 * (y - x * x), 1.0 - x], [[-20.0 * x, 10.0], [-1.0, 0.0]])
        }

        fn bounds(&self) -> [[f64; 2]; 2] {
            self.bounds
        }
    }

    #[test]
    fn the_bottom_of_the_valley_is_found() {
        let valley = Valley { bounds: [[-5.0, 5.0]; 2] };
        let found = solve(&valley, [-1.2, 1.0], &SolverOptions::default());
        assert!(found.norm <= SolverOptions::default().norm_reached);
        assert!((found.x[0] - 1.0).abs() < 1e-3 && (found.x[1] - 1.0).abs() < 1e-3);
        assert!(jacobian_error(&valley, &[0.3, -0.7], &[1e-5; 2]) < 1e-9);
    }

    #[test]
    fn the_best_point_on_a_bound_across_the_valley_is_found() {
        let valley = Valley { bounds: [[-5.0, 0.5], [-5.0, 5.0]] };
        let found = solve(&valley, [-1.2, 1.0], &SolverOptions::default());
        // It stops because it converged, not at the step limit.
        let SolverOptions { norm_reached, step_limit, .. } = SolverOptions::default();
        assert!(found.norm > norm_reached && found.evaluations < step_limit);
        assert!((found.x[0] - 0.5).abs() < 1e-9 && (found.x[1] - 0.25).abs() < 1e-4);
    }

    #[test]
    fn a_start_outside_the_bounds_is_moved_inside() {
        let valley = Valley { bounds: [[2.0, 3.0], [2.0, 3.0]] };
        let found = solve(&valley, [-10.0, 10.0], &SolverOptions::default());
        assert!(found.x.iter().all(|v| (2.0..=3.0).contains(v)), "{found:?}");
    }
}
