//! Colors of single materials in single precision, with their derivatives.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch, f32x8};
use upglow::{AnalyticModel, Emitted, Model, ModelOnGrid};
use upglow_color::Grid;
use upglow_color::rounding::to_single;

use super::parabola::{Parabola, scaled};

/// Samples of a curve at the visible wavelengths, padded to whole vectors.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct SingleLanes([f32; LANES]);

/// 360, 365 … 830 nm are 95 samples of the 5 nm grid.
const LANES: usize = 96;
/// Partial sums per sum. The number is the same on every machine, and no product is fused with a sum,
/// so results have the same bits everywhere.
const WIDTH: usize = 8;

/// The three wavelengths, nm, of the chart of values: where the observer is most sensitive to blue, green
/// and red, so that colors are nearly linear in the values and nearly separate.
pub(crate) const CHART_NM: [f64; 3] = [455.0, 545.0, 610.0];

/// An absorption, and its product with the weights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Absorber {
    curve: SingleLanes,
    weighted: [SingleLanes; 3],
}

/// What lies over a reflectance and takes light from it.
trait Veil {
    /// The light that its derivatives are sums of, `r` being what the reflectance returns of all light.
    fn seen<S: Simd>(&self, simd: S, at: usize, r: f32x8<S>) -> f32x8<S>;

    /// The share of the light that it lets pass.
    fn passed<S: Simd>(&self, simd: S, at: usize) -> f32x8<S>;
}

/// Two absorbers with their concentrations.
#[derive(Clone, Copy, Debug)]
struct Diluted<'a> {
    absorbers: [&'a Absorber; 2],
    shares: [f32; 2],
}

impl Veil for Diluted<'_> {
    #[inline(always)]
    fn seen<S: Simd>(&self, _: S, _: usize, r: f32x8<S>) -> f32x8<S> {
        r
    }

    #[inline(always)]
    fn passed<S: Simd>(&self, simd: S, at: usize) -> f32x8<S> {
        let [first, second] = &self.absorbers;
        let [share_a, share_b] = self.shares.map(|share| f32x8::splat(simd, share));
        let absorbed = share_a * first.curve.at(simd, at) + share_b * second.curve.at(simd, at);
        f32x8::splat(simd, 1.0) - absorbed
    }
}

/// A film: the share of light that it lets pass.
impl Veil for SingleLanes {
    #[inline(always)]
    fn seen<S: Simd>(&self, simd: S, at: usize, r: f32x8<S>) -> f32x8<S> {
        r * self.at(simd, at)
    }

    #[inline(always)]
    fn passed<S: Simd>(&self, simd: S, at: usize) -> f32x8<S> {
        self.at(simd, at)
    }
}

/// Curves and weights of the sums.
#[derive(Clone, Debug)]
pub(crate) struct SingleSums {
    simd_level: Level,
    /// The first visible wavelength's place in the grid.
    first: usize,
    t: SingleLanes,
    weights: [SingleLanes; 3],
    /// The weights times the parabola that is 1 at one chart wavelength and 0 at the others,
    /// `[chart wavelength][X Y Z]`.
    chart_weights: [[SingleLanes; 3]; 3],
    /// Those parabolas, `[chart wavelength][coefficient]`.
    pub(crate) chart: [Parabola; 3],
    /// Dyes in the order of their set.
    pub(crate) dyes: Vec<Absorber>,
    pub(crate) clear: Absorber,
    bells: Option<Bells>,
}

/// The color of a reflectance, and derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shown {
    pub(crate) color: [f32; 3],
    /// Derivatives of the color with respect to the parabola's coefficients of 1, d, d², or to its values
    /// at the chart wavelengths.
    pub(crate) by: [[f32; 3]; 3],
    /// ∫ w·absorption·r for two absorbers; in a film r is what passes.
    pub(crate) seen: [[f32; 3]; 2],
}

impl SingleLanes {
    const ZERO: Self = Self([0.0; LANES]);

    fn from_fn(f: impl Fn(usize) -> f32) -> Self {
        Self(std::array::from_fn(f))
    }

    /// The sum of products, in [`WIDTH`] partial sums.
    fn dot(&self, other: &Self) -> f32 {
        let mut parts = [0.0; WIDTH];
        let pairs = self.0.as_chunks::<WIDTH>().0.iter().zip(other.0.as_chunks::<WIDTH>().0);
        for (a, b) in pairs {
            (0..WIDTH).for_each(|i| parts[i] += a[i] * b[i]);
        }
        parts.iter().sum()
    }

    #[inline(always)]
    fn at<S: Simd>(&self, simd: S, at: usize) -> f32x8<S> {
        f32x8::from_slice(simd, &self.0[at..at + WIDTH])
    }
}

impl SingleSums {
    pub(crate) fn new(model: &ModelOnGrid) -> Self {
        let all = model.colorimetry().weights();
        let first = all.iter().position(|w| w.iter().any(|v| *v != 0.0)).unwrap_or(0);
        assert!(all.len() - first <= LANES, "fits run on the 5 nm grid");
        let visible = |of: &dyn Fn(usize) -> f64| {
            SingleLanes::from_fn(
                |i| if first + i < all.len() { to_single(of(first + i)) } else { 0.0 },
            )
        };
        let t = |i: usize| scaled(model.wavelengths_nm()[i]);
        let weights = [0, 1, 2].map(|k| visible(&|i| all[i][k]));
        let chart = [0, 1, 2].map(lagrange);
        let chart_weights = chart.map(|[q0, q1, q2]| {
            [0, 1, 2].map(|k| visible(&|i| all[i][k] * (q0 + t(i) * (q1 + t(i) * q2))))
        });
        let absorber = |curve: SingleLanes| Absorber::new(curve, &weights);
        let dyes = model.model().dyes().map_or(0, |dyes| dyes.curves().len());
        let dyes = (0..dyes).map(|dye| absorber(visible(&|i| model.dye_absorption(dye)[i])));
        let bells = match model.model() {
            Model::Analytic(bells) => Some(Bells::new(bells, model, first)),
            _ => None,
        };
        Self {
            simd_level: Level::new(),
            first,
            t: visible(&t),
            weights,
            chart_weights,
            chart,
            dyes: dyes.collect(),
            clear: absorber(SingleLanes::ZERO),
            bells,
        }
    }

    /// The parabola that has these values at the chart wavelengths.
    #[inline(always)]
    pub(crate) fn parabola(&self, [a, b, c]: [f64; 3]) -> Parabola {
        let [to_a, to_b, to_c] = &self.chart;
        let mut parabola = [0.0; 3];
        for m in 0..3 {
            parabola[m] = a * to_a[m] + b * to_b[m] + c * to_c[m];
        }
        parabola
    }

    /// The color of a reflectance, and its derivatives with respect to the parabola's values at the chart
    /// wavelengths.
    pub(crate) fn reflect_chart(&self, parabola: &Parabola) -> Shown {
        let parabola = single_parabola(parabola);
        dispatch!(self.simd_level, simd => simd.vectorize(
            #[inline(always)]
            || self.reflect_chart_in_vectors(simd, parabola),
        ))
    }

    #[inline(always)]
    fn reflect_chart_in_vectors<S: Simd>(&self, simd: S, parabola: [f32; 3]) -> Shown {
        let splat = |v: f32| f32x8::splat(simd, v);
        let [q0, q1, q2] = parabola;
        let [q0, q1, q2] = [splat(q0), splat(q1), splat(q2)];
        let (half, one, zero) = (splat(0.5), splat(1.0), splat(0.0));
        let mut color = [zero; 3];
        let mut by = [[zero; 3]; 3];
        for at in (0..LANES).step_by(WIDTH) {
            let t = self.t.at(simd, at);
            let x = q0 + t * (q1 + t * q2);
            let inverse = one / (one + x * x).sqrt();
            let half_inverse = half * inverse;
            let r = half + x * half_inverse;
            let slope = half_inverse * (inverse * inverse);
            for k in 0..3 {
                color[k] += r * self.weights[k].at(simd, at);
                for i in 0..3 {
                    by[i][k] += slope * self.chart_weights[i][k].at(simd, at);
                }
            }
        }
        Shown { color: totals(color), by: by_totals(by), seen: [[0.0; 3]; 2] }
    }

    /// What a film of two dyes emits at these optical densities, and the share of light that it lets pass.
    pub(crate) fn film(
        &self,
        model: &ModelOnGrid,
        dyes: [usize; 2],
        densities: [f64; 2],
    ) -> (Emitted<2>, SingleLanes) {
        self.passing(|passed| model.emitted_by_film_in_single(dyes, densities, passed))
    }

    /// The same for each dye by itself.
    pub(crate) fn film_by_dye(
        &self,
        model: &ModelOnGrid,
        dyes: [usize; 2],
        densities: [f64; 2],
    ) -> ([Emitted<2>; 2], SingleLanes) {
        self.passing(|passed| model.emitted_by_each_dye_in_single(dyes, densities, passed))
    }

    /// What is emitted, and what of the light that passes is visible.
    fn passing<E>(&self, emit: impl FnOnce(&mut [f32]) -> E) -> (E, SingleLanes) {
        const GRID: usize = Grid::FIT.len();
        let mut passed = [0.0; GRID + LANES];
        let emitted = emit(&mut passed[..GRID]);
        let mut visible = SingleLanes::ZERO;
        visible.0.copy_from_slice(&passed[self.first..self.first + LANES]);
        (emitted, visible)
    }

    /// The color of a reflectance behind two absorbers with these concentrations, in half the time that
    /// derivatives take.
    pub(crate) fn color(
        &self,
        parabola: &Parabola,
        absorbers: [&Absorber; 2],
        shares: [f64; 2],
    ) -> [f32; 3] {
        let shares = [to_single(shares[0]), to_single(shares[1])];
        self.color_behind(parabola, &Diluted { absorbers, shares })
    }

    /// The color of a reflectance behind a film that lets this share of light pass.
    pub(crate) fn color_under_film(&self, parabola: &Parabola, passed: &SingleLanes) -> [f32; 3] {
        self.color_behind(parabola, passed)
    }

    #[inline(always)]
    fn color_behind(&self, parabola: &Parabola, veil: &impl Veil) -> [f32; 3] {
        let parabola = single_parabola(parabola);
        dispatch!(self.simd_level, simd => simd.vectorize(
            #[inline(always)]
            || self.color_in_vectors(simd, parabola, veil),
        ))
    }

    #[inline(always)]
    fn color_in_vectors<S: Simd>(
        &self,
        simd: S,
        [q0, q1, q2]: [f32; 3],
        veil: &impl Veil,
    ) -> [f32; 3] {
        let splat = |v: f32| f32x8::splat(simd, v);
        let [q0, q1, q2] = [splat(q0), splat(q1), splat(q2)];
        let (half, one, zero) = (splat(0.5), splat(1.0), splat(0.0));
        let mut color = [zero; 3];
        for at in (0..LANES).step_by(WIDTH) {
            let t = self.t.at(simd, at);
            let x = q0 + t * (q1 + t * q2);
            let r = half + x * (half * (one / (one + x * x).sqrt()));
            let left = r * veil.passed(simd, at);
            for k in 0..3 {
                color[k] += left * self.weights[k].at(simd, at);
            }
        }
        totals(color)
    }

    /// The color of the reflectance with the parabola `p + d·(b + d·k)`, d = t − `center`, behind
    /// two absorbers with these concentrations, and its derivatives with respect to p, b and k.
    pub(crate) fn reflect(
        &self,
        center: f64,
        parabola: &Parabola,
        absorbers: [&Absorber; 2],
        shares: [f64; 2],
    ) -> Shown {
        let shares = [to_single(shares[0]), to_single(shares[1])];
        let veil = Diluted { absorbers, shares };
        let mut shown = self.reflect_behind(center, parabola, absorbers, &veil);
        let Shown { color, seen, .. } = &mut shown;
        for k in 0..3 {
            color[k] -= shares[0] * seen[0][k] + shares[1] * seen[1][k];
        }
        shown
    }

    /// The same behind a film of two dyes that lets this share of light pass.
    pub(crate) fn reflect_under_film(
        &self,
        center: f64,
        parabola: &Parabola,
        dyes: [usize; 2],
        passed: &SingleLanes,
    ) -> Shown {
        self.reflect_behind(center, parabola, dyes.map(|dye| &self.dyes[dye]), passed)
    }

    #[inline(always)]
    fn reflect_behind(
        &self,
        center: f64,
        parabola: &Parabola,
        absorbers: [&Absorber; 2],
        veil: &impl Veil,
    ) -> Shown {
        let (center, parabola) = (to_single(center), single_parabola(parabola));
        dispatch!(self.simd_level, simd => simd.vectorize(
            #[inline(always)]
            || self.reflect_in_vectors(simd, center, parabola, absorbers, veil),
        ))
    }

    /// The color is that of [`Veil::seen`].
    #[inline(always)]
    fn reflect_in_vectors<S: Simd>(
        &self,
        simd: S,
        center: f32,
        parabola: [f32; 3],
        [first, second]: [&Absorber; 2],
        veil: &impl Veil,
    ) -> Shown {
        let splat = |v: f32| f32x8::splat(simd, v);
        let ([p, b, k], center) = (parabola, splat(center));
        let [p, b, k] = [splat(p), splat(b), splat(k)];
        let (half, one, zero) = (splat(0.5), splat(1.0), splat(0.0));
        let mut slopes = [zero; LANES / WIDTH];
        let mut color = [zero; 3];
        let mut seen = [[zero; 3]; 2];
        for (lane, slope) in slopes.iter_mut().enumerate() {
            let at = lane * WIDTH;
            let d = self.t.at(simd, at) - center;
            let x = p + d * (b + d * k);
            let inverse = one / (one + x * x).sqrt();
            let half_inverse = half * inverse;
            let r = veil.seen(simd, at, half + x * half_inverse);
            *slope = half_inverse * (inverse * inverse) * veil.passed(simd, at);
            for k in 0..3 {
                color[k] += r * self.weights[k].at(simd, at);
                seen[0][k] += r * first.weighted[k].at(simd, at);
                seen[1][k] += r * second.weighted[k].at(simd, at);
            }
        }
        let mut by = [[zero; 3]; 3];
        for (lane, slope) in slopes.into_iter().enumerate() {
            let at = lane * WIDTH;
            let d = self.t.at(simd, at) - center;
            let slope_d = slope * d;
            let slope_dd = slope_d * d;
            for k in 0..3 {
                let w = self.weights[k].at(simd, at);
                by[0][k] += slope * w;
                by[1][k] += slope_d * w;
                by[2][k] += slope_dd * w;
            }
        }
        Shown { color: totals(color), by: by_totals(by), seen: [totals(seen[0]), totals(seen[1])] }
    }

    /// ∫ w·absorption·passed·r of each dye of the set, `[dye][X Y Z]`.
    pub(crate) fn seen_by_dyes(&self, parabola: &Parabola, passed: &SingleLanes) -> Vec<[f32; 3]> {
        let [q0, q1, q2] = single_parabola(parabola);
        let seen = SingleLanes::from_fn(|i| {
            let t = self.t.0[i];
            let x = q0 + t * (q1 + t * q2);
            passed.0[i] * (0.5 + x * (0.5 * (1.0 / (1.0 + x * x).sqrt())))
        });
        self.dyes.iter().map(|dye| dye.weighted.each_ref().map(|lanes| seen.dot(lanes))).collect()
    }

    /// The absorption of a bell around `center_nm`, and its derivative with respect to the center, 1/nm.
    pub(crate) fn bell_absorbers(&self, center_nm: f64) -> [Absorber; 2] {
        let Some(bells) = &self.bells else { return [self.clear; 2] };
        let (center_nm, step_nm) = (to_single(center_nm), bells.absorption_step_nm);
        dispatch!(self.simd_level, simd => simd.vectorize(
            #[inline(always)]
            || {
                let (mut curve, mut by_center) = (SingleLanes::ZERO, SingleLanes::ZERO);
                for i in 0..LANES {
                    let (b, slope) = bell((bells.visible_nm.0[i] - center_nm) / step_nm);
                    curve.0[i] = 1.5 * b;
                    by_center.0[i] = -1.5 / step_nm * slope;
                }
                [Absorber::new(curve, &self.weights), Absorber::new(by_center, &self.weights)]
            },
        ))
    }
}

impl Absorber {
    #[inline(always)]
    fn new(curve: SingleLanes, weights: &[SingleLanes; 3]) -> Self {
        let weighted = weights.each_ref().map(|w| {
            let mut weighted = SingleLanes::ZERO;
            for i in 0..LANES {
                weighted.0[i] = curve.0[i] * w.0[i];
            }
            weighted
        });
        Self { curve, weighted }
    }
}

/// The bells of the analytic model.
#[derive(Clone, Debug)]
pub(crate) struct Bells {
    visible_nm: SingleLanes,
    absorption_step_nm: f32,
}

impl Bells {
    fn new(bells: &AnalyticModel, model: &ModelOnGrid, first: usize) -> Self {
        // A bell of unit area and knot step h has a peak of 2/(3h); steps are proportional to widths.
        let emission_step_nm = 2.0 / 3.0 / bells.emission(550.0, 550.0).0;
        let share = bells.absorption_fwhm_nm() / bells.emission_fwhm_nm();
        let nm = model.wavelengths_nm();
        Self {
            visible_nm: SingleLanes::from_fn(|i| {
                nm.get(first + i).map_or(0.0, |&nm| to_single(nm))
            }),
            absorption_step_nm: to_single(emission_step_nm * share),
        }
    }
}

/// The uniform cubic B-spline of knot step 1 and area 1 at `u`, and its slope.
#[inline(always)]
fn bell(u: f32) -> (f32, f32) {
    let v = u.abs();
    let outer = if v < 2.0 { 2.0 - v } else { 0.0 };
    let inner = if v < 1.0 { 1.0 - v } else { 0.0 };
    let value = (outer * outer * outer - 4.0 * inner * inner * inner) / 6.0;
    let slope = 0.5 * (4.0 * inner * inner - outer * outer);
    (value, if u < 0.0 { -slope } else { slope })
}

/// The parabola in t that is 1 at chart wavelength `i` and 0 at the others.
fn lagrange(i: usize) -> Parabola {
    let t = CHART_NM.map(scaled);
    let (a, b, here) = (t[(i + 1) % 3], t[(i + 2) % 3], t[i]);
    let scale = 1.0 / ((here - a) * (here - b));
    [a * b * scale, -(a + b) * scale, scale]
}

/// The sums of the lanes of three vectors, in an order that is the same on every machine.
#[inline(always)]
fn totals<S: Simd>(vectors: [f32x8<S>; 3]) -> [f32; 3] {
    let mut totals = [0.0; 3];
    for k in 0..3 {
        let (low, high) = vectors[k].split();
        let four = low + high;
        totals[k] = (four[0] + four[2]) + (four[1] + four[3]);
    }
    totals
}

#[inline(always)]
fn by_totals<S: Simd>([a, b, c]: [[f32x8<S>; 3]; 3]) -> [[f32; 3]; 3] {
    [totals(a), totals(b), totals(c)]
}

#[inline(always)]
pub(crate) fn in_double([x, y, z]: [f32; 3]) -> [f64; 3] {
    [f64::from(x), f64::from(y), f64::from(z)]
}

#[inline(always)]
fn single_parabola([q0, q1, q2]: &Parabola) -> [f32; 3] {
    [to_single(*q0), to_single(*q1), to_single(*q2)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow::{
        Accounting, DyeModel, DyeOptions, DyeSet, Edge, FilmModel, Fluorescence, Material,
        QuantumYield,
    };
    use upglow_color::{Contract, Grid};

    fn dyes() -> ModelOnGrid {
        let dyes = DyeModel::new(DyeSet::named("konig8").unwrap(), DyeOptions::default()).unwrap();
        ModelOnGrid::new(&Model::Dyes(dyes), &Contract::default().on(Grid::FIT))
    }

    fn film() -> ModelOnGrid {
        let set = DyeSet::named("konig8").unwrap();
        let film = FilmModel::new(set, Accounting::Photon, QuantumYield::Measured).unwrap();
        ModelOnGrid::new(&Model::Film(film), &Contract::default().on(Grid::FIT))
    }

    /// Edge (t), level, slope (1/nm), and shares of two dyes.
    const MATERIALS: [([f64; 3], [f64; 2]); 4] = [
        ([0.3, 0.5, 0.01], [0.0, 0.0]),
        ([-1.2, -1.5, -0.007], [0.3, 0.6]),
        ([0.0, -0.4, 0.0], [0.0, 1.0]),
        ([1.1, 2.4, 0.009], [0.5, 0.1]),
    ];

    fn parabola([_, level, slope_per_nm]: [f64; 3]) -> Parabola {
        let [p, b, k] = Edge { edge_nm: 0.0, level, slope_per_nm }.parabola();
        [p, 100.0 * b, 1e4 * k]
    }

    #[test]
    fn results_have_the_same_bits_with_and_without_wide_vectors() {
        let sums = SingleSums::new(&dyes());
        let plain = SingleSums { simd_level: Level::baseline(), ..sums.clone() };
        for (numbers, shares) in MATERIALS {
            let colors = [&sums, &plain].map(|sums| {
                let absorbers = [&sums.dyes[2], &sums.dyes[3]];
                let shown = sums.reflect(numbers[0], &parabola(numbers), absorbers, shares);
                let chart = sums.reflect_chart(&parabola(numbers));
                let color = sums.color(&parabola(numbers), absorbers, shares);
                (shown.color, shown.by, shown.seen, chart.color, chart.by, color)
            });
            assert_eq!(colors[0], colors[1]);
        }
    }

    #[test]
    fn films_have_the_same_bits_with_and_without_wide_vectors() {
        let model = film();
        let sums = SingleSums::new(&model);
        let plain = SingleSums { simd_level: Level::baseline(), ..sums.clone() };
        for (numbers, densities) in MATERIALS {
            let (_, passed) = sums.film(&model, [2, 6], densities);
            let colors = [&sums, &plain].map(|sums| {
                let parabola = parabola(numbers);
                let shown = sums.reflect_under_film(numbers[0], &parabola, [2, 6], &passed);
                (shown.color, shown.by, shown.seen, sums.color_under_film(&parabola, &passed))
            });
            assert_eq!(colors[0], colors[1]);
        }
    }

    #[test]
    fn colors_of_films_are_those_of_the_model() {
        // Single precision of numbers near 10 under the root.
        const SINGLE: f64 = 2e-6;
        let model = film();
        let sums = SingleSums::new(&model);
        for (numbers, [a, b]) in MATERIALS {
            let [e, level, slope_per_nm] = numbers;
            let edge = Edge { edge_nm: 565.0 + 100.0 * e, level, slope_per_nm };
            for densities in [[a, b], [5.0 * a, 3.0 * b]] {
                let (emitted, passed) = sums.film(&model, [2, 6], densities);
                let shown = sums.reflect_under_film(e, &parabola(numbers), [2, 6], &passed);
                let fluorescence = Fluorescence::film((2, densities[0]), (6, densities[1]));
                let material = Material { reflectance: edge.to_sigmoid(), fluorescence };
                let expected = model.color(material).0;
                for k in 0..3 {
                    let off = f64::from(shown.color[k]) + emitted.color[k] - expected[k];
                    assert!(off.abs() < SINGLE, "{numbers:?} {off}");
                }
            }
        }
    }

    #[test]
    fn a_color_is_the_same_without_its_derivatives() {
        // Single precision of a sum of 95 numbers that adds up to 1.
        const SINGLE: f32 = 1e-6;
        let sums = SingleSums::new(&dyes());
        for (numbers, shares) in MATERIALS {
            let (parabola, absorbers) = (parabola(numbers), [&sums.dyes[2], &sums.dyes[3]]);
            let color = sums.color(&parabola, absorbers, shares);
            let shown = sums.reflect(0.0, &parabola, absorbers, shares);
            for k in 0..3 {
                assert!((color[k] - shown.color[k]).abs() < SINGLE, "{numbers:?}");
            }
        }
    }

    #[test]
    fn colors_are_those_of_the_model() {
        // Single precision of numbers near 10 under the root.
        const SINGLE: f64 = 2e-6;
        let model = dyes();
        let sums = SingleSums::new(&model);
        for (numbers, [a, b]) in MATERIALS {
            let [e, level, slope_per_nm] = numbers;
            let edge = Edge { edge_nm: 565.0 + 100.0 * e, level, slope_per_nm };
            let shown = sums.reflect(e, &parabola(numbers), [&sums.dyes[2], &sums.dyes[3]], [a, b]);
            let expected = match a + b {
                0.0 => model.color(Material::passive(edge.to_sigmoid())).0,
                c => {
                    let weight = b / c;
                    let Model::Dyes(dyes) = model.model() else { unreachable!() };
                    let emitted = model.emitted_by_dyes(dyes, 2, weight).color;
                    let fluorescence = Fluorescence::Dyes { first: 2, weight, concentration: c };
                    let material = Material { reflectance: edge.to_sigmoid(), fluorescence };
                    let color = model.color(material).0;
                    [0, 1, 2].map(|k| color[k] - c * emitted[k])
                }
            };
            for k in 0..3 {
                let off = f64::from(shown.color[k]) - expected[k];
                assert!(off.abs() < SINGLE, "{numbers:?} {off}");
            }
        }
    }

    #[test]
    fn bells_are_those_of_the_model() {
        let analytic = AnalyticModel::default();
        let contract = Contract::default().on(Grid::FIT);
        let sums = SingleSums::new(&ModelOnGrid::new(&Model::Analytic(analytic), &contract));
        let [absorber, by_center] = sums.bell_absorbers(480.3);
        for i in 0..95 {
            let nm = f64::from(sums.bells.as_ref().unwrap().visible_nm.0[i]);
            let (value, slope) = analytic.absorption(480.3, nm);
            // Single precision of numbers up to 1 and of slopes near 0.05.
            assert!((f64::from(absorber.curve.0[i]) - value).abs() < 1e-5, "{nm}");
            assert!((f64::from(by_center.curve.0[i]) - slope).abs() < 1e-6, "{nm}");
        }
    }
}
