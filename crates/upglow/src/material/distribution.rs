//! Sampled curves as densities for drawing wavelengths.

use upglow_color::Spectrum;
use upglow_color::rounding::whole;

use crate::material::formula::Accounting;

/// Entries of the table that starts a search. More entries take cache, fewer leave more bins of
/// 1 nm to step through.
const GUIDES: usize = 128;

/// A sampled curve as a density: straight lines between samples, zero outside, any area.
///
/// Everything is exact for that polygon: areas are sums of trapezoids, and a draw solves the
/// quadratic of its bin (the cubic, where the curve is weighted by wavelength).
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Distribution {
    first_nm: f64,
    step_nm: f64,
    /// The curve, `[sample]`.
    density: Vec<f64>,
    /// ∫ curve dλ up to each sample, nm times the curve's unit.
    area: Vec<f64>,
    /// ∫ curve·λ dλ up to each sample.
    moment: Vec<f64>,
    /// The last sample whose area is at most g / [`GUIDES`] of the whole, `[g]`.
    guides: Vec<usize>,
}

impl Distribution {
    /// The density of a curve without negative samples.
    pub(crate) fn new(curve: &Spectrum) -> Self {
        let first_nm = f64::from(curve.grid().first_nm());
        let step_nm = f64::from(curve.grid().step_nm());
        let density = curve.values().to_vec();
        let mut distribution = Self {
            first_nm,
            step_nm,
            area: vec![0.0; density.len()],
            moment: vec![0.0; density.len()],
            guides: Vec::new(),
            density,
        };
        for i in 1..distribution.density.len() {
            distribution.area[i] = distribution.area[i - 1] + distribution.area_in(i - 1, 1.0);
            distribution.moment[i] =
                distribution.moment[i - 1] + distribution.moment_in(i - 1, 1.0);
        }
        let total = distribution.total();
        distribution.guides = (0..GUIDES)
            .map(|g| {
                let target = total * g as f64 / GUIDES as f64;
                distribution.area.partition_point(|&a| a <= target).saturating_sub(1)
            })
            .collect();
        distribution
    }

    /// The curve on its grid.
    pub(crate) fn densities(&self) -> &[f64] {
        &self.density
    }

    /// The curve at a wavelength.
    pub(crate) fn at(&self, nm: f64) -> f64 {
        let position = (nm - self.first_nm) / self.step_nm;
        if !(0.0..=(self.density.len() - 1) as f64).contains(&position) {
            return 0.0;
        }
        let (bin, t) = self.bin(nm);
        let (low, rise) = self.line(bin);
        low + t * rise
    }

    /// ∫ curve dλ, nm times the curve's unit.
    pub(crate) fn total(&self) -> f64 {
        self.area[self.area.len() - 1]
    }

    /// ∫ curve·share dλ, with the share of energy that may be emitted around `mean_nm`.
    pub(crate) fn shared_total(&self, accounting: Accounting, mean_nm: f64) -> f64 {
        match accounting {
            Accounting::Energy => self.total(),
            Accounting::Photon => {
                let (bin, t) = self.bin(mean_nm);
                let area = self.area[bin] + self.area_in(bin, t);
                (self.moment[bin] + self.moment_in(bin, t)) / mean_nm + self.total() - area
            }
        }
    }

    /// A wavelength with the density of the curve, from `u` in 0..1.
    pub(crate) fn sample(&self, u: f64) -> f64 {
        let target = u * self.total();
        let mut bin = self.guides[guide(u)];
        while bin + 2 < self.area.len() && self.area[bin + 1] <= target {
            bin += 1;
        }
        self.position(bin, self.solve_area(bin, target - self.area[bin]))
    }

    /// A wavelength with the density of the curve times the share of energy that may be
    /// emitted around `mean_nm`, from `u` in 0..1.
    pub(crate) fn sample_shared(&self, accounting: Accounting, mean_nm: f64, u: f64) -> f64 {
        if accounting == Accounting::Energy {
            return self.sample(u);
        }
        let (bin, t) = self.bin(mean_nm);
        let below = (self.moment[bin] + self.moment_in(bin, t)) / mean_nm;
        let above = self.area[bin] + self.area_in(bin, t);
        let target = u * (below + self.total() - above);
        if target < below {
            let bin = last_at_most(&self.moment, target * mean_nm);
            self.position(bin, self.solve_moment(bin, target * mean_nm - self.moment[bin]))
        } else {
            let bin = last_at_most(&self.area, above + target - below);
            self.position(bin, self.solve_area(bin, above + target - below - self.area[bin]))
        }
    }

    fn position(&self, bin: usize, t: f64) -> f64 {
        self.first_nm + self.step_nm * (bin as f64 + t)
    }

    /// The bin that holds a wavelength, and how far into it, 0..=1; the ends for those outside.
    fn bin(&self, nm: f64) -> (usize, f64) {
        let last = (self.density.len() - 1) as f64;
        let position = ((nm - self.first_nm) / self.step_nm).clamp(0.0, last);
        let bin = whole(position).min(self.density.len() - 2);
        (bin, position - bin as f64)
    }

    /// ∫ curve dλ over the first `t` of a bin, `t` in 0..=1.
    fn area_in(&self, bin: usize, t: f64) -> f64 {
        let (low, rise) = self.line(bin);
        self.step_nm * t * (low + 0.5 * t * rise)
    }

    /// ∫ curve·λ dλ over the first `t` of a bin, `t` in 0..=1.
    fn moment_in(&self, bin: usize, t: f64) -> f64 {
        let (low, rise) = self.line(bin);
        let within = t * t * (low / 2.0 + t * rise / 3.0);
        self.position(bin, 0.0) * self.area_in(bin, t) + self.step_nm * self.step_nm * within
    }

    fn line(&self, bin: usize) -> (f64, f64) {
        (self.density[bin], self.density[bin + 1] - self.density[bin])
    }

    /// How far into a bin its area is `area`, 0..=1.
    fn solve_area(&self, bin: usize, area: f64) -> f64 {
        solve_trapezoid(self.density[bin], self.density[bin + 1], area / self.step_nm)
    }

    /// How far into a bin its moment is `moment`, 0..=1: the root for a density that is straight
    /// after it was weighted, then Newton's step for the curve that it leaves out.
    fn solve_moment(&self, bin: usize, moment: f64) -> f64 {
        let (low_nm, high_nm) = (self.position(bin, 0.0), self.position(bin, 1.0));
        let [low, high] = [self.density[bin] * low_nm, self.density[bin + 1] * high_nm];
        let t = solve_trapezoid(low, high, moment / self.step_nm);
        let (start, rise) = self.line(bin);
        let slope = (start + t * rise) * (low_nm + t * self.step_nm) * self.step_nm;
        let newton = t - (self.moment_in(bin, t) - moment) / slope;
        if newton.is_finite() { newton.clamp(0.0, 1.0) } else { t }
    }
}

/// The t in 0..=1 at which a density that goes from `low` to `high` over 0..=1 has the area
/// `area`.
fn solve_trapezoid(low: f64, high: f64, area: f64) -> f64 {
    // The root of low·t + ½(high − low)·t² = area in the form without cancellation.
    let root = (low * low + 2.0 * area * (high - low)).max(0.0).sqrt();
    if low + root > 0.0 { (2.0 * area / (low + root)).clamp(0.0, 1.0) } else { 0.0 }
}

/// The last bin that begins at or below `target`.
fn last_at_most(ascending: &[f64], target: f64) -> usize {
    ascending.partition_point(|&v| v <= target).clamp(1, ascending.len() - 1) - 1
}

fn guide(u: f64) -> usize {
    whole(u * GUIDES as f64).min(GUIDES - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow_color::Grid;

    /// Rounding only, of wavelengths found by one quadratic and one Newton step.
    const ROUNDING_NM: f64 = 1e-6;

    fn curve() -> Spectrum {
        let value = |nm: f64| {
            let d = (nm - 500.0) / 40.0;
            if nm < 350.0 { 0.0 } else { (-d * d).exp() * (1.2 + (nm / 3.0).sin()) }
        };
        Spectrum::new(Grid::FINE, Grid::FINE.wavelengths_nm().map(value).collect()).unwrap()
    }

    fn shared_area_below(curve: &Spectrum, mean_nm: f64, nm: f64) -> f64 {
        // Midpoints of a piecewise quadratic: the error is the square of the step.
        let n = 40_000;
        let step = (nm - 300.0) / f64::from(n);
        let value = |i: u32| {
            let at = 300.0 + step * (f64::from(i) + 0.5);
            curve.at(at) * Accounting::Photon.share(at, mean_nm)
        };
        (0..n).map(value).sum::<f64>() * step
    }

    #[test]
    fn a_draw_is_where_the_area_is_its_share() {
        let (curve, n) = (curve(), 1000);
        let distribution = Distribution::new(&curve);
        for i in 0..n {
            let u = (f64::from(i) + 0.5) / f64::from(n);
            let nm = distribution.sample(u);
            let share = curve.area(300.0, nm) / curve.area(300.0, 830.0);
            assert!((share - u).abs() < 1e-12, "{u} {nm} {share}");
            let nearly_energy = distribution.sample_shared(Accounting::Photon, 1e-3, u);
            assert!((nearly_energy - nm).abs() < ROUNDING_NM);
        }
    }

    #[test]
    fn a_shared_draw_is_where_the_shared_area_is_its_share() {
        const QUADRATURE: f64 = 1e-5;
        let curve = curve();
        let distribution = Distribution::new(&curve);
        for mean_nm in [380.3, 490.0, 520.7, 900.0] {
            let total = distribution.shared_total(Accounting::Photon, mean_nm);
            let sum = shared_area_below(&curve, mean_nm, 830.0);
            assert!((total / sum - 1.0).abs() < QUADRATURE, "{mean_nm}");
            for u in [0.001, 0.1, 0.25, 0.5, 0.77, 0.999] {
                let nm = distribution.sample_shared(Accounting::Photon, mean_nm, u);
                let share = shared_area_below(&curve, mean_nm, nm) / sum;
                assert!((share - u).abs() < QUADRATURE, "{mean_nm} {u} {nm}");
            }
        }
    }

    #[test]
    fn every_draw_is_in_the_range_of_the_curve() {
        let distribution = Distribution::new(&curve());
        for u in [0.0, 1.0_f64.next_down(), 1.0, 2.0, -1.0, f64::NAN, f64::INFINITY] {
            let drawn =
                [distribution.sample(u), distribution.sample_shared(Accounting::Photon, 500.0, u)];
            assert!(drawn.iter().all(|nm| (300.0..=830.0).contains(nm)), "{u} {drawn:?}");
        }
    }
}
