//! Colors of materials as functions of the unknowns, in two charts of the reflectance.

use std::f64::consts::LN_10;

use upglow::{AnalyticModel, Edge, FilmModel, Model};

use crate::polish::Polisher;
use crate::polish::descent::{Bounds, Measure, Point, UNKNOWNS, Unknowns, Vector};
use crate::polish::start::{Family, Glow};
use crate::problem::parabola::{MIDDLE_NM, Parabola, UNIT_NM, edge_of, scaled, sigmoid_of};
use crate::problem::shortest_step::{LEAST_DAMPING, dot, shortest_step, within};
use crate::problem::single_sums::{Shown, in_double};
use crate::problem::{EDGE_BOUND, LEVEL_BOUND};

/// The color of a material, and its derivatives.
struct Shaded {
    color: Vector,
    by_parabola: [Vector; 3],
    by_glow: [Vector; 3],
}

/// Values of a reflectance stay this far from 0 and 1, where the parabola is infinite. Smaller exceeds
/// single precision; larger is not black.
const LEAST_VALUE: f64 = 1e-7;
/// A step leaves at least this share of a value's distance from 0 and from 1: nearer, the derivatives
/// are no longer valid.
const VALUE_SHARE: f64 = 0.2;
/// The penalty for a slope of twice the limit, in units of Lab: the greatest color difference.
pub(super) const STEEPNESS_WEIGHT: f64 = 100.0;
/// Steep reflectances are brought to this share of the limit: the slope is not quite linear in the
/// unknowns, and a margin saves another step.
const STEEPNESS_GOAL: f64 = 0.999;

/// A reflectance in the chart of values: given by its values at three wavelengths. Colors are nearly
/// linear in them, but the slope limit is a curved bound.
#[derive(Clone, Copy, Debug)]
pub(super) struct ValueShape {
    pub(super) parabola: Parabola,
    /// Derivatives of the parabola at each of the wavelengths with respect to the value there.
    pub(super) scale: Vector,
}

/// A material in the chart of values.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) x: Unknowns,
    pub(super) shape: ValueShape,
    pub(super) steepness: Steepness,
}

/// The greatest slope of a reflectance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steepness {
    /// Its square, relative to the limit's.
    pub(super) squared: f64,
    /// The value of the parabola where the slope is greatest.
    level: f64,
}

/// The values moved to where they have a parabola.
#[inline(always)]
pub(super) fn inside(mut values: Vector) -> Vector {
    for r in &mut values {
        *r = within(*r, &[LEAST_VALUE, 1.0 - LEAST_VALUE]);
    }
    values
}

/// The range of a value after a step.
#[inline(always)]
pub(super) fn value_bounds(value: f64) -> [f64; 2] {
    [VALUE_SHARE * value, 1.0 - VALUE_SHARE * (1.0 - value)]
}

/// The ranges of the unknowns in the chart of edges.
pub(super) fn bounds(family: Family, model: &Model) -> Bounds {
    let fraction = [0.0, 1.0];
    let fixed = [0.0, 0.0];
    let [c, u, v] = match (family, model) {
        (Family::Pair(_), Model::Dyes(dyes)) if dyes.curves().len() > 1 => {
            [fraction, fraction, fixed]
        }
        (Family::Film([one, two]), _) => {
            let second = if one == two { fixed } else { FilmModel::DENSITIES };
            [FilmModel::DENSITIES, second, fixed]
        }
        (Family::Bells, _) => {
            let ranges_nm = [AnalyticModel::EMISSION_PEAKS_NM, AnalyticModel::STOKES_SHIFTS_NM];
            let [u, v] = ranges_nm.map(|range| range.map(|nm| nm / UNIT_NM));
            [fraction, u, v]
        }
        _ => [fraction, fixed, fixed],
    };
    let level = [-LEVEL_BOUND, LEVEL_BOUND];
    [[-EDGE_BOUND, EDGE_BOUND], level, [-1.0, 1.0], c, u, v]
}

/// The unknowns of a material in the chart of edges, moved into the bounds.
pub(super) fn unknowns(
    edge: Edge,
    glow: &Glow,
    bounds: &Bounds,
    slope_limit_per_nm: f64,
) -> Unknowns {
    let [c, u, v] = glow.numbers;
    let slope = edge.slope_per_nm / slope_limit_per_nm;
    let mut x = [scaled(edge.edge_nm), edge.level, slope, c, u, v];
    for v in 0..UNKNOWNS {
        x[v] = x[v].clamp(bounds[v][0], bounds[v][1]);
    }
    x
}

/// The edge of a material in the chart of edges.
pub(super) fn edge_of_unknowns([e, level, slope, ..]: &Unknowns, slope_limit_per_nm: f64) -> Edge {
    edge_of([*e, *level, slope * slope_limit_per_nm], 1.0)
}

impl Polisher<'_> {
    /// The reflectance with these values at the chart wavelengths.
    #[inline(always)]
    pub(super) fn shape(&self, values: &Vector) -> ValueShape {
        let (mut at, mut scale) = ([0.0; 3], [0.0; 3]);
        for i in 0..3 {
            let r = values[i];
            let inverse = 1.0 / (r * (1.0 - r)).sqrt();
            at[i] = (r - 0.5) * inverse;
            scale[i] = 0.25 * inverse * inverse * inverse;
        }
        ValueShape { parabola: self.sums().parabola(at), scale }
    }

    /// The material with these unknowns.
    #[inline(always)]
    pub(super) fn candidate(&self, x: Unknowns, slope_limit_per_nm: f64) -> Candidate {
        let shape = self.shape(&[x[0], x[1], x[2]]);
        let steepness = Steepness::of(&shape.parabola, slope_limit_per_nm);
        Candidate { x, shape, steepness }
    }

    /// The color of a candidate, and its derivatives.
    pub(super) fn point_of_values(&self, family: Family, candidate: &Candidate) -> Point {
        let x = candidate.x;
        let ValueShape { parabola, scale } = &candidate.shape;
        let shaded = self.shade(family, 0.0, parabola, &[x[3], x[4], x[5]]);
        let mut by = [[0.0; 3]; UNKNOWNS];
        for i in 0..3 {
            let chart = &self.sums().chart[i];
            for k in 0..3 {
                let mut sum = 0.0;
                for m in 0..3 {
                    sum += chart[m] * shaded.by_parabola[m][k];
                }
                by[i][k] = scale[i] * sum;
            }
            by[3 + i] = shaded.by_glow[i];
        }
        Point { x, color: shaded.color, by }
    }

    /// The color of a candidate without derivatives.
    pub(super) fn color_of_values(&self, family: Family, candidate: &Candidate) -> Vector {
        let [.., c, u, v] = candidate.x;
        let parabola = &candidate.shape.parabola;
        let (mut color, emitted) = match (family, self.cube.model()) {
            (Family::Film(dyes), _) => {
                let (emitted, passed) = self.sums().film(self.fitter.model(), dyes, [c, u]);
                let mut color = in_double(self.sums().color_under_film(parabola, &passed));
                for k in 0..3 {
                    color[k] += emitted.color[k];
                }
                return color;
            }
            (Family::Pair(first), Model::Dyes(dyes)) => {
                let absorbers = [&self.sums().dyes[first], &self.sums().dyes[dyes.partner(first)]];
                let shares = [c * (1.0 - u), c * u];
                let color = self.sums().color(parabola, absorbers, shares);
                (in_double(color), self.emissions[first].at(u).0)
            }
            (Family::Bells, Model::Analytic(bells)) => {
                let (peak_nm, shift_nm) = (u * UNIT_NM, v * UNIT_NM);
                let [absorption, _] = &self.sums().bell_absorbers(peak_nm - shift_nm);
                let color = self.sums().color(parabola, [absorption, absorption], [c, 0.0]);
                let emitted = self.fitter.model().emitted_by_bells(bells, peak_nm, shift_nm);
                (in_double(color), emitted.color)
            }
            _ => {
                let clear = &self.sums().clear;
                (in_double(self.sums().color(parabola, [clear, clear], [0.0; 2])), [0.0; 3])
            }
        };
        for k in 0..3 {
            color[k] += c * emitted[k];
        }
        color
    }

    /// A material in the chart of edges: edge (t), level, slope relative to the limit.
    pub(super) fn point_of_edge(
        &self,
        family: Family,
        x: Unknowns,
        slope_limit_per_nm: f64,
    ) -> Point {
        let [e, p, slope, ..] = x;
        let unit = slope_limit_per_nm * UNIT_NM;
        let s = slope * unit;
        let g = 1.0 + p * p;
        let root = g.sqrt();
        let b = 2.0 * s * g * root;
        let k = 6.0 * s * s * p * g * g;
        let b_by = [6.0 * s * p * root, 2.0 * g * root * unit];
        let k_by = [6.0 * s * s * g * (g + 4.0 * p * p), 12.0 * s * p * g * g * unit];
        let shaded = self.shade(family, e, &[p, b, k], &[x[3], x[4], x[5]]);
        let [by_p, by_b, by_k] = &shaded.by_parabola;
        let (mut by_edge, mut by_level, mut by_slope) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        for i in 0..3 {
            // d = t − e: ∂x/∂e = −(b + 2kd).
            by_edge[i] = -b * by_p[i] - 2.0 * k * by_b[i];
            by_level[i] = by_p[i] + b_by[0] * by_b[i] + k_by[0] * by_k[i];
            by_slope[i] = b_by[1] * by_b[i] + k_by[1] * by_k[i];
        }
        let [by_c, by_u, by_v] = shaded.by_glow;
        Point { x, color: shaded.color, by: [by_edge, by_level, by_slope, by_c, by_u, by_v] }
    }

    /// The unknowns after the shortest step in the chart of values that removes the residual and brings
    /// the slope to its limit.
    pub(super) fn step_along_limit(
        &self,
        here: &Point,
        candidate: &Candidate,
        measure: &impl Measure,
        bounds: &Bounds,
        slope_limit_per_nm: f64,
    ) -> Unknowns {
        let ValueShape { parabola, scale } = &candidate.shape;
        let (steep, by_parabola) = candidate.steepness.derived(parabola, slope_limit_per_nm);
        let ([r0, r1, r2], by_color) = here.measured(measure);
        let residual = [r0, r1, r2, STEEPNESS_WEIGHT * (steep - STEEPNESS_GOAL)];
        let mut by = [[0.0; 4]; UNKNOWNS];
        for v in 0..UNKNOWNS {
            let [l, a, b] = by_color[v];
            by[v] = [l, a, b, 0.0];
        }
        for i in 0..3 {
            by[i][3] = STEEPNESS_WEIGHT * scale[i] * dot(&self.sums().chart[i], &by_parabola);
        }
        shortest_step(&here.x, &residual, &by, bounds, LEAST_DAMPING)
    }

    #[inline(always)]
    fn shade(&self, family: Family, center: f64, parabola: &Parabola, glow: &Vector) -> Shaded {
        let &[c, u, v] = glow;
        match (family, self.cube.model()) {
            (Family::Pair(first), Model::Dyes(dyes)) => {
                let absorbers = [&self.sums().dyes[first], &self.sums().dyes[dyes.partner(first)]];
                let shares = [c * (1.0 - u), c * u];
                let shown = self.sums().reflect(center, parabola, absorbers, shares);
                let (emitted, by_weight) = self.emissions[first].at(u);
                let mut shaded = Shaded::of(&shown);
                for k in 0..3 {
                    let (a, b) = (f64::from(shown.seen[0][k]), f64::from(shown.seen[1][k]));
                    shaded.color[k] += c * emitted[k];
                    shaded.by_glow[0][k] = emitted[k] - (1.0 - u) * a - u * b;
                    shaded.by_glow[1][k] = c * (by_weight[k] - b + a);
                }
                shaded
            }
            (Family::Film(dyes), _) => {
                let (emitted, passed) = self.sums().film(self.fitter.model(), dyes, [c, u]);
                let shown = self.sums().reflect_under_film(center, parabola, dyes, &passed);
                let mut shaded = Shaded::of(&shown);
                for k in 0..3 {
                    shaded.color[k] += emitted.color[k];
                    for dye in 0..2 {
                        let seen = f64::from(shown.seen[dye][k]);
                        shaded.by_glow[dye][k] = emitted.derivatives[dye][k] - LN_10 * seen;
                    }
                }
                shaded
            }
            (Family::Bells, Model::Analytic(bells)) => {
                let (peak_nm, shift_nm) = (u * UNIT_NM, v * UNIT_NM);
                let [absorption, by_center] = self.sums().bell_absorbers(peak_nm - shift_nm);
                let absorbers = [&absorption, &by_center];
                let shown = self.sums().reflect(center, parabola, absorbers, [c, 0.0]);
                let emitted = self.fitter.model().emitted_by_bells(bells, peak_nm, shift_nm);
                let [by_peak, by_shift] = emitted.derivatives;
                let mut shaded = Shaded::of(&shown);
                for k in 0..3 {
                    let [seen, by_center] = [0, 1].map(|i| f64::from(shown.seen[i][k]));
                    shaded.color[k] += c * emitted.color[k];
                    shaded.by_glow[0][k] = emitted.color[k] - seen;
                    shaded.by_glow[1][k] = c * UNIT_NM * (by_peak[k] - by_center);
                    shaded.by_glow[2][k] = c * UNIT_NM * (by_shift[k] + by_center);
                }
                shaded
            }
            _ => {
                let clear = &self.sums().clear;
                Shaded::of(&self.sums().reflect(center, parabola, [clear, clear], [0.0; 2]))
            }
        }
    }
}

impl ValueShape {
    /// The reflectance by its steepest point.
    #[inline(always)]
    pub(super) fn edge(&self) -> Edge {
        sigmoid_of(self.parabola).to_edge(MIDDLE_NM)
    }
}

impl Steepness {
    /// The greatest slope of a reflectance.
    #[inline(always)]
    pub(super) fn of(&[q0, q1, q2]: &Parabola, slope_limit_per_nm: f64) -> Self {
        let d = q1 * q1 - 4.0 * q2 * q0;
        let r = (9.0 / 16.0 * d * d + 5.0 * q2 * q2).sqrt();
        if r == 0.0 {
            return Self { squared: 0.0, level: q0 };
        }
        // As `Sigmoid::steepest_slope_per_nm`, without its root.
        let (over, under) = if d > 0.0 { (q2, r + 0.75 * d) } else { (r - 0.75 * d, 5.0 * q2) };
        let level = over / under;
        let g = 1.0 + level * level;
        let limit = slope_limit_per_nm * UNIT_NM;
        Self { squared: (0.5 * d + r) / (5.0 * g * g * g * limit * limit), level }
    }

    /// The greatest slope relative to the limit, and its derivatives with respect to the parabola's
    /// coefficients. At its maximum the slope is stationary in wavelength, so that the shift of the
    /// maximum does not contribute.
    #[inline(always)]
    fn derived(self, [q0, q1, _]: &Parabola, slope_limit_per_nm: f64) -> (f64, [f64; 3]) {
        let steep = self.squared.sqrt();
        let p = self.level;
        let g = 1.0 + p * p;
        // The slope is 0.5·x'(t)·g^(-3/2), and t the nearer of the two points where it is greatest.
        let by_linear = 0.5 / (g * g.sqrt() * slope_limit_per_nm * UNIT_NM);
        let x_slope = (steep / by_linear).copysign(*q1);
        let sum = q1 + x_slope;
        let t = if sum == 0.0 { 0.0 } else { 2.0 * (p - q0) / sum };
        let by_linear = by_linear.copysign(*q1);
        let by_value = -3.0 * p * x_slope / g * by_linear;
        (steep, [by_value, by_value * t + by_linear, (by_value * t + 2.0 * by_linear) * t])
    }
}

impl Shaded {
    #[inline(always)]
    fn of(shown: &Shown) -> Self {
        let (mut color, mut by_parabola) = ([0.0; 3], [[0.0; 3]; 3]);
        for k in 0..3 {
            color[k] = f64::from(shown.color[k]);
            for m in 0..3 {
                by_parabola[m][k] = f64::from(shown.by[m][k]);
            }
        }
        Self { color, by_parabola, by_glow: [[0.0; 3]; 3] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::parabola::steepness;
    use upglow::{Accounting, Cube, DyeSet, FitRecord, Node, QuantumYield};
    use upglow_color::Contract;

    const VALUES: [Vector; 4] =
        [[0.1, 0.5, 0.9], [0.8, 0.2, 0.6], [0.3, 0.3, 0.31], [0.999, 0.02, 0.5]];

    fn black() -> Cube {
        let (contract, fit) = (Contract::default(), FitRecord::default());
        Cube::new(contract, Model::Reflectance, fit, 2, vec![Node::default(); 8]).unwrap()
    }

    #[test]
    fn the_steepness_and_its_derivatives_equal_those_of_fits() {
        // Rounding only, of roots of numbers up to 1000.
        const ROUNDING: f64 = 1e-7;
        let cube = black();
        let polisher = Polisher::new(&cube).unwrap();
        let limit = 0.01;
        for values in VALUES {
            let parabola = polisher.shape(&values).parabola;
            let (found, by) = Steepness::of(&parabola, limit).derived(&parabola, limit);
            let (expected, expected_by) = steepness(parabola, limit);
            assert!((found - expected).abs() < ROUNDING * expected, "{values:?}");
            for m in 0..3 {
                let off = (by[m] - expected_by[m]).abs();
                assert!(off < ROUNDING * expected_by[m].abs().max(1.0), "{values:?} {m}");
            }
        }
    }

    #[test]
    fn derivatives_of_the_parabola_match_differences() {
        // Central differences, whose error grows with the cube of the step.
        const STEP: f64 = 1e-6;
        let cube = black();
        let polisher = Polisher::new(&cube).unwrap();
        for values in VALUES {
            let shape = polisher.shape(&values);
            for i in 0..3 {
                let moved = |by: f64| {
                    let mut values = values;
                    values[i] += by;
                    polisher.shape(&values).parabola
                };
                let (low, high) = (moved(-STEP), moved(STEP));
                for m in 0..3 {
                    let quotient = (high[m] - low[m]) / (2.0 * STEP);
                    let told = shape.scale[i] * polisher.sums().chart[i][m];
                    assert!((told - quotient).abs() < 1e-4 * (1.0 + quotient.abs()), "{values:?}");
                }
            }
        }
    }

    #[test]
    fn derivatives_by_the_densities_of_a_film_match_differences() {
        // Single precision of colors near 1, 1e-6, over the step, and the square of the step.
        const STEP: f64 = 1e-2;
        const TOLERANCE: f64 = 3e-4;
        let set = DyeSet::named("konig8").unwrap();
        let film = FilmModel::new(set, Accounting::Photon, QuantumYield::Measured).unwrap();
        let (contract, fit) = (Contract::default(), FitRecord::default());
        let nodes = vec![Node::default(); 8];
        let cube = Cube::new(contract, Model::Film(film), fit, 2, nodes).unwrap();
        let polisher = Polisher::new(&cube).unwrap();
        let at = |x: Unknowns| {
            let candidate = polisher.candidate(x, 0.2);
            let point = polisher.point_of_values(Family::Film([6, 3]), &candidate);
            let color = polisher.color_of_values(Family::Film([6, 3]), &candidate);
            // Rounding only.
            assert!((0..3).all(|k| (color[k] - point.color[k]).abs() < 1e-6), "{x:?}");
            point
        };
        for ([a, b, d], [first, second]) in VALUES.into_iter().zip([[0.5, 0.3], [3.0, 0.1]]) {
            let x = [a, b, d, first, second, 0.0];
            for v in 3..5 {
                let moved = |by: f64| {
                    let mut x = x;
                    x[v] += by;
                    at(x).color
                };
                let (low, high) = (moved(-STEP), moved(STEP));
                for k in 0..3 {
                    let off = at(x).by[v][k] - (high[k] - low[k]) / (2.0 * STEP);
                    assert!(off.abs() < TOLERANCE, "{x:?} {v} {off:e}");
                }
            }
        }
    }
}
