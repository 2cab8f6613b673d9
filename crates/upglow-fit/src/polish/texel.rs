//! Finds the material of one texel.

use upglow::{Edge, Fluorescence, Node, Sigmoid};
use upglow_color::{Goal, LinearRgb, Matrix3, Metric, Xyz};

use crate::fit::EXACT;
use crate::polish::Polisher;
use crate::polish::candidate::{
    Candidate, STEEPNESS_WEIGHT, Steepness, ValueShape, bounds, edge_of_unknowns, inside, unknowns,
    value_bounds,
};
use crate::polish::corner::{Corners, all, mean};
use crate::polish::descent::{Bounds, LEAST_GAIN, Measure, Point, Unknowns, Vector, solve};
use crate::polish::start::{self, Family, Glow};
use crate::problem::parabola::MIDDLE_NM;
use crate::problem::shortest_step::{LEAST_DAMPING, dot, shortest_step, within};
use crate::problem::single_sums::Shown;

/// CIEDE2000 is at most this many times a small distance in Lab: 1.5 near gray, where it stretches a*,
/// and slightly more in the blue, where it rotates. A test looks for more.
const DE2000_PER_LAB: f64 = 1.8;
/// A material at this distance in linearized Lab matches: CIEDE2000 is below three quarters of
/// [`EXACT`], and the rest is for the rounding of stored numbers.
const NEAR: f64 = 0.75 * EXACT / DE2000_PER_LAB;
/// Most evaluations for a reflectance; two are nearly always enough.
const PASSIVE_STEPS: usize = 6;
/// Most evaluations with fluorescence; the mean is three.
const GLOWING_STEPS: usize = 7;
/// From a color this near, in Lab, the derivatives are not computed again: each further step leaves a
/// few hundredths of the residual. Larger takes more steps; smaller takes more derivatives.
const DERIVATIVES_HOLD: f64 = 1.5;
/// How many steps in the chart of values may increase the distance. With none, a sixth more texels need
/// the chart of edges.
const MOST_SETBACKS: usize = 1;
/// Rounds, each with CIEDE2000 linearized around the current color.
const ROUNDS: usize = 4;
/// Evaluations in each round. With more, the linearization is out of date.
const ROUND_STEPS: usize = 2;
/// How much further from the color than the blend a material may be before other starts are tried,
/// ΔE00: half of a visible difference. Smaller tries them in vain, as blends reach more colors than
/// single materials.
const WORSE_THAN_BLEND: f64 = 0.5;
/// If a material misses by this much more than the blend, ΔE00, all starts are tried.
const PLAIN_TO_SEE: f64 = 2.0;

/// Corners that exceed the limit of fits by no more than this are not steeper: fits keep a margin of half
/// of it, and rounding to single precision is a tenth of that.
const STEEPER: f64 = 1.0 + 2e-6;

/// One texel.
pub(super) struct Texel<'p, 'c, 'n> {
    pub(super) polisher: &'p Polisher<'c>,
    pub(super) rgb: LinearRgb,
    target: Vector,
    lab: LabAround,
    corners: &'p Corners<'n>,
}

/// Lab, linearized around a color.
#[derive(Clone, Copy, Debug)]
struct LabAround {
    target: Vector,
    /// 500, 116 or 200 times the derivatives of the compressed responses by X, Y, Z.
    a_by_x: f64,
    l_by_y: f64,
    a_by_y: f64,
    b_by_y: f64,
    b_by_z: f64,
}

impl LabAround {
    #[inline(always)]
    fn new(target: Vector, per_white: &Vector) -> Self {
        let mut slopes = [0.0; 3];
        for k in 0..3 {
            slopes[k] = response_slope(target[k] * per_white[k]) * per_white[k];
        }
        let [x, y, z] = slopes;
        Self {
            target,
            a_by_x: 500.0 * x,
            l_by_y: 116.0 * y,
            a_by_y: 500.0 * y,
            b_by_y: 200.0 * y,
            b_by_z: 200.0 * z,
        }
    }
}

impl Measure for LabAround {
    #[inline(always)]
    fn residual(&self, color: &Vector) -> Vector {
        let t = &self.target;
        self.change(&[color[0] - t[0], color[1] - t[1], color[2] - t[2]])
    }

    #[inline(always)]
    fn change(&self, [x, y, z]: &Vector) -> Vector {
        [self.l_by_y * y, self.a_by_x * x - self.a_by_y * y, self.b_by_y * y - self.b_by_z * z]
    }
}

/// The slope of Lab's compressed response, 1/3·v^(−2/3), and constant below (6/29)³. One part in a
/// thousand is accurate enough for distances.
#[inline(always)]
fn response_slope(v: f64) -> f64 {
    const KNEE: f64 = 216.0 / 24389.0;
    const THIRD: f64 = 1.0 / 3.0;
    let v = if v > KNEE { v } else { KNEE };
    // An inverse cube root from a third of the exponent, and two Newton steps.
    let mut root = f64::from_bits(0x553e_f0ff_289d_d796 - v.to_bits() / 3);
    for _ in 0..2 {
        root *= THIRD * (4.0 - v * root * root * root);
    }
    THIRD * root * root
}

/// CIEDE2000, linearized around a color.
#[derive(Clone, Copy, Debug)]
struct Linear {
    center: Vector,
    residual: Vector,
    by_color: Matrix3,
}

impl Linear {
    fn new(goal: &Goal, center: Vector) -> Self {
        let (residual, by_color) = goal.residuals(Xyz(center));
        Self { center, residual, by_color }
    }
}

impl Measure for Linear {
    #[inline(always)]
    fn residual(&self, color: &Vector) -> Vector {
        let (c, r) = (&self.center, &self.residual);
        let [x, y, z] = self.change(&[color[0] - c[0], color[1] - c[1], color[2] - c[2]]);
        [r[0] + x, r[1] + y, r[2] + z]
    }

    #[inline(always)]
    fn change(&self, by: &Vector) -> Vector {
        let [x, y, z] = &self.by_color.0;
        [dot(x, by), dot(y, by), dot(z, by)]
    }
}

impl<'p, 'c, 'n> Texel<'p, 'c, 'n> {
    #[inline(always)]
    pub(super) fn new(
        polisher: &'p Polisher<'c>,
        rgb: LinearRgb,
        corners: &'p Corners<'n>,
    ) -> Self {
        let mut target = [0.0; 3];
        for (row, sum) in polisher.xyz_from_rgb.0.iter().zip(&mut target) {
            *sum = dot(row, &rgb.0);
        }
        let lab = LabAround::new(target, &polisher.per_white);
        Self { polisher, rgb, target, lab, corners }
    }

    /// The material of the texel, with its distance.
    pub(super) fn polish(&self) -> Node {
        if let Some(gray) = self.gray() {
            return gray;
        }
        let glow = start::glow(self.corners, self.polisher.cube.model());
        let is_hopeless = self.is_hopeless();
        let direct = match glow.family {
            _ if is_hopeless => None,
            Family::Passive => self.passive(),
            _ => self.glowing(&glow),
        };
        direct.unwrap_or_else(|| self.nearest(&glow, is_hopeless))
    }

    /// The slope limit: that of the cube for this family, or that of the steepest corner, 1/nm.
    #[inline(always)]
    fn slope_limit_per_nm(&self, family: Family) -> f64 {
        let limits = &self.polisher.slope_limits_per_nm;
        let limit = if family == Family::Passive { limits.alone } else { limits.under_dyes };
        let mut steepest = limit * STEEPER;
        let mut found = limit;
        for (weight, corner) in self.corners {
            let slope = corner.steepest_slope_per_nm();
            if *weight > 0.0 && slope > steepest {
                (steepest, found) = (slope, slope);
            }
        }
        found
    }

    /// The mean of the corners' materials after one step to the color; its distance is not known.
    pub(super) fn interpolate(&self) -> Node {
        if let Some(gray) = self.gray() {
            return gray;
        }
        let polisher = self.polisher;
        let glow = start::glow(self.corners, polisher.cube.model());
        if self.is_hopeless() {
            return self.within_limit(start::edge(self.corners), &glow);
        }
        let [a, b, d] = inside(self.mean_values());
        if glow.family == Family::Passive {
            let shape = polisher.shape(&[a, b, d]);
            let shown = polisher.sums().reflect_chart(&shape.parabola);
            let next = self.passive_step(&[a, b, d], &shape, &shown);
            let shape = next.map_or(shape, |values| polisher.shape(&values));
            return self.within_limit(shape.edge(), &glow);
        }
        let [c, u, v] = glow.numbers;
        let limit = self.slope_limit_per_nm(glow.family);
        let candidate = polisher.candidate([a, b, d, c, u, v], limit);
        let here = polisher.point_of_values(glow.family, &candidate);
        let bounds = bounds(glow.family, polisher.cube.model());
        let candidate = self.glowing_step(&here, &candidate, bounds, limit);
        let [.., c, u, v] = candidate.x;
        let glow = Glow { family: glow.family, numbers: [c, u, v] };
        self.within_limit(candidate.shape.edge(), &glow)
    }

    /// A material with its slope reduced to the limit.
    fn within_limit(&self, edge: Edge, glow: &Glow) -> Node {
        let limit = self.slope_limit_per_nm(glow.family);
        let slope_per_nm = edge.slope_per_nm.clamp(-limit, limit);
        Node::new(Edge { slope_per_nm, ..edge }, glow.fluorescence(), f64::NAN)
    }

    /// A flat reflectance if the color is a gray.
    fn gray(&self) -> Option<Node> {
        let [r, g, b] = self.rgb.0;
        (self.polisher.grays_are_flat && r == g && g == b)
            .then(|| Node::new(Sigmoid::flat(r).to_edge(MIDDLE_NM), Fluorescence::None, 0.0))
    }

    /// Whether no corner matches its color.
    fn is_hopeless(&self) -> bool {
        all(self.corners, |c| f64::from(c.de2000) > EXACT)
    }

    /// A reflectance that matches, found from the mean of the corners without bounds.
    fn passive(&self) -> Option<Node> {
        let sums = self.polisher.sums();
        let mut values = inside(self.mean_values());
        for _ in 0..PASSIVE_STEPS {
            let shape = self.polisher.shape(&values);
            let shown = sums.reflect_chart(&shape.parabola);
            let [x, y, z] = shown.color;
            let lab = self.lab.residual(&[f64::from(x), f64::from(y), f64::from(z)]);
            let squared = dot(&lab, &lab);
            if squared <= NEAR * NEAR {
                let limit = self.slope_limit_per_nm(Family::Passive);
                if Steepness::of(&shape.parabola, limit).squared > 1.0 {
                    return None;
                }
                return Some(node(shape.edge(), Fluorescence::None, squared.sqrt()));
            }
            values = self.passive_step(&values, &shape, &shown)?;
        }
        None
    }

    /// A Newton step from `values`.
    #[inline(always)]
    fn passive_step(&self, values: &Vector, shape: &ValueShape, shown: &Shown) -> Option<Vector> {
        let mut rows = [[0.0; 3]; 3];
        let mut residual = [0.0; 3];
        for k in 0..3 {
            residual[k] = f64::from(shown.color[k]) - self.target[k];
            for i in 0..3 {
                rows[k][i] = shape.scale[i] * f64::from(shown.by[i][k]);
            }
        }
        let step = solve(&rows, &residual)?;
        let mut next = *values;
        for i in 0..3 {
            next[i] = within(values[i] - step[i], &value_bounds(values[i]));
        }
        Some(next)
    }

    /// A fluorescent material that matches, found from the mean of the corners in the chart of values.
    fn glowing(&self, glow: &Glow) -> Option<Node> {
        let polisher = self.polisher;
        let family = glow.family;
        let limit = self.slope_limit_per_nm(family);
        let bounds = bounds(family, polisher.cube.model());
        let ([a, b, d], [c, u, v]) = (inside(self.mean_values()), glow.numbers);
        let mut candidate = polisher.candidate([a, b, d, c, u, v], limit);
        let mut here = polisher.point_of_values(family, &candidate);
        let mut norm = here.norm(&self.lab);
        let mut setbacks = 0;
        for _ in 0..GLOWING_STEPS {
            let steep = candidate.steepness.squared;
            if norm <= NEAR && steep <= 1.0 {
                let [.., c, u, v] = candidate.x;
                let fluorescence = Glow { family, numbers: [c, u, v] }.fluorescence();
                return Some(node(candidate.shape.edge(), fluorescence, norm));
            }
            let next = self.glowing_step(&here, &candidate, bounds, limit);
            let there = if norm <= DERIVATIVES_HOLD {
                let color = polisher.color_of_values(family, &next);
                Point { x: next.x, color, by: here.by }
            } else {
                polisher.point_of_values(family, &next)
            };
            let next_norm = there.norm(&self.lab);
            if merit(next_norm, next.steepness.squared) >= merit(norm, steep) {
                setbacks += 1;
                if setbacks > MOST_SETBACKS {
                    return None;
                }
            }
            (here, candidate, norm) = (there, next, next_norm);
        }
        None
    }

    /// The candidate after a step in the chart of values; `bounds` are those of the fluorescence.
    #[inline(always)]
    fn glowing_step(
        &self,
        here: &Point,
        candidate: &Candidate,
        mut bounds: Bounds,
        slope_limit_per_nm: f64,
    ) -> Candidate {
        let polisher = self.polisher;
        for i in 0..3 {
            bounds[i] = value_bounds(candidate.x[i]);
        }
        if candidate.steepness.squared <= 1.0 {
            let (residual, by) = here.measured(&self.lab);
            let next = shortest_step(&here.x, &residual, &by, &bounds, LEAST_DAMPING);
            let next = polisher.candidate(next, slope_limit_per_nm);
            if next.steepness.squared <= 1.0 {
                return next;
            }
        }
        let next =
            polisher.step_along_limit(here, candidate, &self.lab, &bounds, slope_limit_per_nm);
        polisher.candidate(next, slope_limit_per_nm)
    }

    /// The nearest material found from several starts, in the chart of edges.
    fn nearest(&self, glow: &Glow, is_hopeless: bool) -> Node {
        let colorimetry = self.polisher.fitter.model().colorimetry();
        let goal = Metric::De2000.goal(colorimetry, Xyz(self.target));
        let mut best = self.approach(&goal, start::edge(self.corners), glow);
        let blend = [0, 1, 2].map(|k| mean(self.corners, |c| c.xyz[k]));
        let blended = goal.distance(Xyz(blend));
        // If the blend matches, a material should; else few get nearer than the blend.
        let good = if blended <= EXACT { EXACT } else { blended + WORSE_THAN_BLEND };
        let is_good = |found: &Found| found.de2000 <= good;
        if is_good(&best) {
            return best.node;
        }
        if !is_hopeless {
            let [a, b, d] = inside(self.mean_values());
            let edge = self.polisher.shape(&[a, b, d]).edge();
            best = best.or(self.approach(&goal, edge, glow));
        }
        let heaviest = self.corners.iter().fold(0.0, |most: f64, (weight, _)| most.max(*weight));
        for (weight, corner) in self.corners {
            let is_worth_it = *weight == heaviest
                || *weight > 0.0 && (blended <= EXACT || best.de2000 > blended + PLAIN_TO_SEE);
            if is_worth_it && !is_good(&best) {
                let glow = start::glow_of(corner, self.polisher.cube.model());
                best = best.or(self.approach(&goal, corner.edge(), &glow));
            }
        }
        let may_glow = !all(self.corners, |c| c.dose == 0.0);
        if may_glow && blended <= EXACT && !is_good(&best) {
            let fit = self.polisher.fitter.fit_among(self.rgb, &[]);
            let node = Node::new(fit.reflectance, fit.fluorescence, fit.de2000);
            best = best.or(Found { node, de2000: fit.de2000 });
        }
        best.node
    }

    /// The material found from one start.
    fn approach(&self, goal: &Goal, edge: Edge, glow: &Glow) -> Found {
        let polisher = self.polisher;
        let family = glow.family;
        let bounds = bounds(family, polisher.cube.model());
        let limit = self.slope_limit_per_nm(family);
        let x = unknowns(edge, glow, &bounds, limit);
        let mut best: Option<(Unknowns, f64)> = None;
        let mut here = polisher.point_of_edge(family, x, limit);
        for round in 0..=ROUNDS {
            let around = Linear::new(goal, here.color);
            let norm = dot(&around.residual, &around.residual).sqrt();
            let gain = best.map_or(1.0, |(_, known)| 1.0 - norm / known);
            if gain > 0.0 {
                best = Some((here.x, norm));
            }
            if round == ROUNDS || norm <= 0.5 * EXACT || gain < LEAST_GAIN {
                break;
            }
            let eval = |x| polisher.point_of_edge(family, x, limit);
            here = here.descend(&around, &bounds, ROUND_STEPS, eval);
        }
        let (x, de2000) = best.unwrap_or((x, f64::INFINITY));
        let [.., c, u, v] = x;
        let fluorescence = Glow { family, numbers: [c, u, v] }.fluorescence();
        let edge = edge_of_unknowns(&x, limit);
        Found { node: Node::new(edge, fluorescence, de2000), de2000 }
    }

    #[inline(always)]
    fn mean_values(&self) -> Vector {
        let mut values = [0.0; 3];
        for (weight, corner) in self.corners {
            for i in 0..3 {
                values[i] += weight * f64::from(corner.values[i]);
            }
        }
        values
    }
}

/// A material and its distance.
#[derive(Clone, Copy, Debug)]
struct Found {
    node: Node,
    de2000: f64,
}

impl Found {
    /// The nearer of two.
    fn or(self, other: Self) -> Self {
        if other.de2000 < self.de2000 { other } else { self }
    }
}

/// The distance of a candidate, with a penalty for its slope.
fn merit(norm: f64, steepness_squared: f64) -> f64 {
    norm + STEEPNESS_WEIGHT * (steepness_squared - 1.0).max(0.0)
}

fn node(edge: Edge, fluorescence: Fluorescence, lab_distance: f64) -> Node {
    Node::new(edge, fluorescence, DE2000_PER_LAB * lab_distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow_color::{Lab, ciede2000};

    #[test]
    fn ciede2000_is_never_much_more_than_a_small_distance_in_lab() {
        let mut greatest: f64 = 0.0;
        for i in 0..200_000_u32 {
            let turn = |share: f64| (f64::from(i) * share).fract();
            let (hue, direction) = (turn(0.618_034) * 6.3, turn(0.754_878) * 6.3);
            let (chroma, height) = (150.0 * turn(0.569_841).powi(2), turn(0.819_173) * 2.0 - 1.0);
            let lab = Lab { l: 100.0 * turn(0.4143), a: chroma * hue.cos(), b: chroma * hue.sin() };
            let flat = 0.01 * (1.0 - height * height).sqrt();
            let moved = Lab {
                l: lab.l + 0.01 * height,
                a: lab.a + flat * direction.cos(),
                b: lab.b + flat * direction.sin(),
            };
            greatest = greatest.max(ciede2000(lab, moved) / 0.01);
        }
        assert!(greatest > 1.4 && greatest < DE2000_PER_LAB, "{greatest}");
    }

    #[test]
    fn the_slope_of_the_response_equals_that_of_lab() {
        for i in 1..300 {
            let v = f64::from(i) * 0.01;
            // Two Newton steps from a start within 4 %.
            assert!((response_slope(v) * 3.0 * v.cbrt().powi(2) - 1.0).abs() < 1e-4, "{v}");
        }
        assert_eq!(response_slope(-0.1), response_slope(0.0));
    }
}
