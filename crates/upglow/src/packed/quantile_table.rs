//! The curves of dyes as densities for drawing wavelengths, in single precision.

use fearless_simd::Simd;
use upglow_color::Grid;
use upglow_color::rounding::to_single;

use crate::packed::vector::{greater_of, smaller_of, whole};

/// The range of [`Grid::FINE`], whose step is 1 nm.
pub(crate) const FIRST_NM: f32 = 300.0;
pub(crate) const BINS: usize = Grid::FINE.len() - 1;

/// Starts of searches, one for each 1/256 of the area. More take cache, fewer leave more bins of
/// 1 nm to step over.
const GUIDES: usize = 256;

/// Bins that a search steps over without a branch. Where a curve is high, a bin is wider than a
/// guide's share and no more are needed; each more costs every draw.
const STEPS: usize = 2;

/// The curves of a ring of dyes on [`Grid::FINE`] as densities: straight lines
/// between samples, of unit area. [`crate::material::distribution::Distribution`] for inner loops.
#[derive(Clone, Debug, Default)]
pub(crate) struct QuantileTable {
    /// The bin that g / [`GUIDES`] of the area is in, `[dye][g]`.
    guides: Vec<u16>,
    /// The area up to each sample and the density there (1/nm), `[dye][sample][area, density]`. The
    /// last area is infinite, so that every search ends there.
    samples: Vec<f32>,
}

impl QuantileTable {
    /// The table of several curves on [`Grid::FINE`].
    pub(crate) fn new<'c>(curves: impl Iterator<Item = &'c [f64]>) -> Self {
        let mut table = Self::default();
        curves.for_each(|curve| table.push(curve));
        table
    }

    fn push(&mut self, density: &[f64]) {
        let mut areas = vec![0.0; density.len()];
        for i in 1..density.len() {
            areas[i] = areas[i - 1] + 0.5 * (density[i - 1] + density[i]);
        }
        let total = areas[BINS];
        let share = |value: f64| to_single(if total > 0.0 { value / total } else { 0.0 });
        for (i, (&area, &density)) in areas.iter().zip(density).enumerate() {
            self.samples.push(if i < BINS { share(area) } else { f32::INFINITY });
            self.samples.push(share(density));
        }
        self.guides.extend((0..GUIDES).map(|g| {
            let target = g as f32 / GUIDES as f32;
            let bin = areas[..BINS].partition_point(|&area| share(area) <= target);
            u16::try_from(bin.saturating_sub(1)).expect("the grid has fewer than 2¹⁶ bins")
        }));
    }

    /// The wavelength, nm, below which `u` of the area of a dye's curve lies; `u` is clamped to
    /// 0..=1.
    #[inline(always)]
    pub(crate) fn quantile<S: Simd>(&self, simd: S, dye: u32, u: f32) -> f32 {
        let u = greater_of(smaller_of(u, 1.0), 0.0);
        let guides = &self.guides[dye as usize * GUIDES..][..GUIDES];
        let guide = (whole(simd, u * GUIDES as f32) as usize).min(GUIDES - 1);
        let mut bin = usize::from(guides[guide]);
        let samples = &self.samples[dye as usize * SAMPLES..][..SAMPLES];
        for _ in 0..STEPS {
            bin += usize::from(samples[2 * bin + 2] <= u);
        }
        while samples[2 * bin + 2] <= u {
            bin += 1;
        }
        let [area, low, high] = [samples[2 * bin], samples[2 * bin + 1], samples[2 * bin + 3]];
        FIRST_NM + (bin as f32 + solve_trapezoid(low, high, u - area))
    }
}

/// Numbers of a curve.
const SAMPLES: usize = 2 * (BINS + 1);

/// The t in 0..=1 at which a density that goes from `low` to `high` over 0..=1 has the area
/// `area`.
#[inline(always)]
fn solve_trapezoid(low: f32, high: f32, area: f32) -> f32 {
    // The root of low·t + ½(high − low)·t² = area in the form without cancellation.
    let root = greater_of(low * low + 2.0 * area * (high - low), 0.0).sqrt();
    // NaN, of an empty bin, becomes 0.
    greater_of(smaller_of(2.0 * area / (low + root), 1.0), 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::distribution::Distribution;
    use crate::material::dye_model::{DyeCurves, DyeModel, DyeOptions};
    use crate::material::dye_set::DyeSet;
    use fearless_simd::{Level, dispatch};
    use upglow_color::Spectrum;

    fn quantile(table: &QuantileTable, dye: u32, u: f32) -> f32 {
        dispatch!(Level::baseline(), simd => table.quantile(simd, dye, u))
    }

    #[test]
    fn quantiles_are_those_of_the_distribution() {
        // Rounding to single precision of areas below 1, three times, and of wavelengths.
        const SINGLE_AREA: f64 = 2e-7;
        const SINGLE_NM: f64 = 1e-4;
        let set = DyeSet::named("konig8").unwrap();
        let model = DyeModel::new(set, DyeOptions::default()).unwrap();
        let of = |curve: fn(&DyeCurves) -> &Spectrum| {
            model.curves().iter().map(curve).collect::<Vec<_>>()
        };
        for curves in [of(|dye| &dye.absorption), of(|dye| &dye.emission)] {
            let table = QuantileTable::new(curves.iter().map(|curve| curve.values()));
            for (dye, curve) in (0..).zip(&curves) {
                let exact = Distribution::new(curve);
                for i in 0..10_000 {
                    let u = (i as f32 + 0.5) / 10_000.0;
                    let found = f64::from(quantile(&table, dye, u));
                    let expected = exact.sample(u.into());
                    let [low, high] = [found.min(expected), found.max(expected)];
                    let between = curve.area(low, high) / curve.area(300.0, 830.0);
                    assert!(between < SINGLE_AREA || high - low < SINGLE_NM, "{u} {low} {high}");
                }
            }
        }
    }

    #[test]
    fn every_draw_is_in_the_range_of_the_curves() {
        let empty = Spectrum::new(Grid::FINE, vec![0.0; BINS + 1]).unwrap();
        let set = DyeSet::named("konig8").unwrap();
        let model = DyeModel::new(set, DyeOptions::default()).unwrap();
        let table = QuantileTable::new(
            [&empty, &model.curves()[0].absorption].map(Spectrum::values).into_iter(),
        );
        for dye in [0, 1] {
            for u in [0.0, 1.0_f32.next_down(), 1.0, 2.0, -1.0, f32::NAN, f32::INFINITY] {
                let nm = quantile(&table, dye, u);
                assert!((300.0..=830.0).contains(&nm), "{u} {nm}");
            }
        }
    }
}
