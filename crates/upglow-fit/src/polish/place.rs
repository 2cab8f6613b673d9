//! Colors of materials by the solver's unknowns, in two charts of the reflectance.

use upglow::{Edge, Model};

use crate::parabola::{MIDDLE_NM, Parabola, edge_of, scaled, sigmoid_of, steepness};
use crate::polish::descent::{
    Bounds, EDGE_BOUND, LEVEL_BOUND, Measure, Point, UNKNOWNS, Unknowns, Vector, dot, shortest_step,
};
use crate::polish::shine::Shown;
use crate::polish::start::{Family, Glow};
use crate::polish::{BELL_RANGES_NM, Polisher, UNIT_NM};

/// A color of fluorescence and reflectance: itself, and derivatives.
struct Shaded {
    color: Vector,
    by_parabola: [Vector; 3],
    by_glow: [Vector; 3],
}

/// A value of a reflectance stays this far from 0 and 1, where the parabola is infinite. Smaller is
/// beyond single precision, larger cannot be black.
const LEAST_VALUE: f64 = 1e-7;
/// A step leaves a value at least this share of its distance from 0 and from 1: derivatives there
/// say little of what is nearer.
const VALUE_SHARE: f64 = 0.2;
/// What a slope of twice the limit counts, in units of Lab: as much as the greatest color difference.
pub(super) const STEEPNESS_WEIGHT: f64 = 100.0;
/// Steep reflectances are brought to this share of the limit: no further step is needed where the
/// slope is not quite linear in the unknowns.
const STEEPNESS_GOAL: f64 = 0.999;

/// The chart of values: a reflectance by its values at three wavelengths. Colors are nearly linear
/// in them, but the slope limit is a curved bound.
pub(super) fn parabola_values(values: &Vector) -> Vector {
    values.map(|r| (r - 0.5) / (r * (1.0 - r)).sqrt())
}

/// Values that have a parabola.
pub(super) fn inside(values: Vector) -> Vector {
    values.map(|r| r.clamp(LEAST_VALUE, 1.0 - LEAST_VALUE))
}

/// How far a step may carry values.
pub(super) fn value_bounds(values: &Vector) -> [[f64; 2]; 3] {
    values.map(|r| [VALUE_SHARE * r, 1.0 - VALUE_SHARE * (1.0 - r)])
}

/// Derivatives of [`parabola_values`]: 2(1 + x²)^(3/2).
#[inline(always)]
pub(super) fn by_values(x: &Vector) -> Vector {
    x.map(|x| {
        let g = 1.0 + x * x;
        2.0 * g * g.sqrt()
    })
}

/// The ranges of the unknowns in the chart of edges.
pub(super) fn bounds(family: Family, model: &Model) -> Bounds {
    let fraction = [0.0, 1.0];
    let fixed = [0.0, 0.0];
    let [u, v] = match (family, model) {
        (Family::Pair(_), Model::Dyes(dyes)) if dyes.curves().len() > 1 => [fraction, fixed],
        (Family::Bells, _) => BELL_RANGES_NM.map(|range| range.map(crate::polish::in_units)),
        _ => [fixed, fixed],
    };
    let level = [-LEVEL_BOUND, LEVEL_BOUND];
    [[-EDGE_BOUND, EDGE_BOUND], level, [-1.0, 1.0], fraction, u, v]
}

impl Polisher<'_> {
    /// The square of the greatest slope relative to the limit.
    pub(super) fn steepness_squared(&self, &[q0, q1, q2]: &Parabola) -> f64 {
        let d = q1 * q1 - 4.0 * q2 * q0;
        let r = (9.0 / 16.0 * d * d + 5.0 * q2 * q2).sqrt();
        if r == 0.0 {
            return 0.0;
        }
        // As `Sigmoid::steepest_slope_per_nm`, without its root.
        let p = if d > 0.0 { q2 / (r + 0.75 * d) } else { (r - 0.75 * d) / (5.0 * q2) };
        let g = 1.0 + p * p;
        let limit = self.slope_limit_per_nm * UNIT_NM;
        (0.5 * d + r) / (5.0 * g * g * g * limit * limit)
    }

    /// The parabola of a place in the chart of values.
    #[inline(always)]
    pub(super) fn parabola_at(&self, x: &Unknowns) -> Parabola {
        self.sums.parabola(parabola_values(&[x[0], x[1], x[2]]))
    }

    /// The edge of a place in the chart of values.
    pub(super) fn edge_of_values(&self, x: &Unknowns) -> Edge {
        sigmoid_of(self.parabola_at(x)).to_edge(MIDDLE_NM)
    }

    /// A place in the chart of values.
    pub(super) fn point_of_values(&self, family: Family, x: Unknowns) -> Point {
        let at = parabola_values(&[x[0], x[1], x[2]]);
        let shaded = self.shade(family, 0.0, &self.sums.parabola(at), &[x[3], x[4], x[5]]);
        let scale = by_values(&at);
        let mut by = [[0.0; 3]; UNKNOWNS];
        for i in 0..3 {
            let chart = self.sums.chart(i);
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

    /// A place in the chart of edges: edge (t), level, slope relative to the limit.
    pub(super) fn point_of_edge(&self, family: Family, x: Unknowns) -> Point {
        let [e, p, slope, ..] = x;
        let unit = self.slope_limit_per_nm * UNIT_NM;
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

    /// The unknowns of a material in the chart of edges, as near as bounds let it.
    pub(super) fn unknowns(&self, edge: Edge, glow: &Glow, bounds: &Bounds) -> Unknowns {
        let slope = edge.slope_per_nm / self.slope_limit_per_nm;
        let [c, u, v] = glow.numbers;
        let mut x = [scaled(edge.edge_nm), edge.level, slope, c, u, v];
        for v in 0..UNKNOWNS {
            x[v] = x[v].clamp(bounds[v][0], bounds[v][1]);
        }
        x
    }

    /// The edge of a place in the chart of edges.
    pub(super) fn edge_of_unknowns(&self, [e, level, slope, ..]: &Unknowns) -> Edge {
        edge_of([*e, *level, slope * self.slope_limit_per_nm], 1.0)
    }

    /// Where the shortest step in the chart of values leads that takes away the residual and what
    /// the slope is above its limit.
    pub(super) fn step_along_limit(
        &self,
        here: &Point,
        measure: &impl Measure,
        bounds: &Bounds,
        damping: f64,
    ) -> Unknowns {
        let at = parabola_values(&[here.x[0], here.x[1], here.x[2]]);
        let (steep, by_parabola) = steepness(self.sums.parabola(at), self.slope_limit_per_nm);
        let ([r0, r1, r2], by_color) = here.measured(measure);
        let residual = [r0, r1, r2, STEEPNESS_WEIGHT * (steep - STEEPNESS_GOAL)];
        let scale = by_values(&at);
        let mut by = [[0.0; 4]; UNKNOWNS];
        for v in 0..UNKNOWNS {
            by[v][..3].copy_from_slice(&by_color[v]);
        }
        for i in 0..3 {
            by[i][3] = STEEPNESS_WEIGHT * scale[i] * dot(self.sums.chart(i), &by_parabola);
        }
        shortest_step(&here.x, &residual, &by, bounds, damping)
    }

    #[inline(always)]
    fn shade(&self, family: Family, center: f64, parabola: &Parabola, glow: &Vector) -> Shaded {
        let &[c, u, v] = glow;
        match (family, self.cube.model()) {
            (Family::Pair(first), Model::Dyes(dyes)) => {
                let absorbers = [first, dyes.partner(first)].map(|dye| self.sums.dye(dye));
                let shares = [c * (1.0 - u), c * u];
                let shown = self.sums.reflect(center, parabola, absorbers, shares);
                let (emitted, by_weight) = self.emissions[first].at(u);
                let mut shaded = Shaded::of(&shown);
                for k in 0..3 {
                    let [a, b] = [0, 1].map(|i| f64::from(shown.seen[i][k]));
                    shaded.color[k] += c * emitted[k];
                    shaded.by_glow[0][k] = emitted[k] - (1.0 - u) * a - u * b;
                    shaded.by_glow[1][k] = c * (by_weight[k] - b + a);
                }
                shaded
            }
            (Family::Bells, Model::Analytic(bells)) => {
                let (peak_nm, shift_nm) = (u * UNIT_NM, v * UNIT_NM);
                let [absorption, by_center] = self.sums.bell_absorbers(peak_nm - shift_nm);
                let absorbers = [&absorption, &by_center];
                let shown = self.sums.reflect(center, parabola, absorbers, [c, 0.0]);
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
                let clear = self.sums.clear();
                Shaded::of(&self.sums.reflect(center, parabola, [clear, clear], [0.0; 2]))
            }
        }
    }
}

impl Shaded {
    #[inline(always)]
    fn of(shown: &Shown) -> Self {
        Self {
            color: shown.color.map(f64::from),
            by_parabola: shown.by.map(|by| by.map(f64::from)),
            by_glow: [[0.0; 3]; 3],
        }
    }
}
