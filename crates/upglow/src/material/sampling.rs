//! Choosing between the reflection of a mixture and its fluorescent lobes.
//!
//! Both directions choose between the elastic part, which keeps the wavelength, and the lobes in
//! proportion to the light that each contributes, and then draw from the chosen lobe:
//!
//! - from the camera, W(λo) = r(λo) + Σ ê(λo)·∫ proposed(λ) dλ;
//! - from the light, W(λi) = r(λi) + Σ returned(λi), the albedo.
//!
//! Where a lobe proposes what it returns, every sample has the throughput W. In a film it proposes
//! what its dye would return alone, from a table, and the throughput is W·returned / proposed.

use crate::bispectral::{Draw, Sample};

/// A wavelength drawn from a lobe, with sums over all lobes between that and the known one.
pub(crate) struct Shifted {
    pub(crate) nm: f64,
    /// The re-radiation, 1/nm.
    pub(crate) carried_per_nm: f64,
    /// The curves that the wavelength was drawn from, 1/nm; their area is the lobes' part of W.
    pub(crate) drawn_per_nm: f64,
}

/// The contributions of reflection and of each fluorescent lobe `L` at one wavelength.
pub(crate) struct Shares<L> {
    elastic: f64,
    /// At most two lobes for each of four materials.
    lobes: [Option<(f64, L)>; 8],
}

impl<L: Copy> Shares<L> {
    /// The contributions of reflection and of at most eight lobes.
    pub(crate) fn new(elastic: f64, carried: impl Iterator<Item = (f64, L)>) -> Self {
        let mut lobes = [None; 8];
        lobes.iter_mut().zip(carried).for_each(|(slot, carried)| *slot = Some(carried));
        Self { elastic, lobes }
    }

    pub(crate) fn total(&self) -> f64 {
        self.elastic + self.lobes.iter().flatten().map(|(share, _)| share).sum::<f64>()
    }

    /// The lobe that `u` in 0..1 falls on; `None` is the elastic part.
    fn choose(&self, u: f64) -> Option<L> {
        let mut rest = u * self.total() - self.elastic;
        if rest < 0.0 {
            return None;
        }
        let mut last = None;
        for &(share, lobe) in self.lobes.iter().flatten().filter(|(share, _)| *share > 0.0) {
            last = Some(lobe);
            rest -= share;
            if rest < 0.0 {
                break;
            }
        }
        last
    }

    pub(crate) fn elastic_probability(&self) -> f64 {
        ratio(self.elastic, self.total())
    }

    /// Draws from one of the parts by two numbers in 0..1. `draw` gives a wavelength from a lobe.
    pub(crate) fn sample(
        &self,
        known_nm: f64,
        [choice, u]: [f64; 2],
        draw: impl Fn(L, f64) -> Shifted,
    ) -> Option<Sample<f64>> {
        let whole = self.total();
        // Not for NaN either.
        (whole > 0.0).then(|| match self.choose(choice) {
            None => {
                let draw = Draw::Elastic { probability: self.elastic / whole };
                Sample { nm: known_nm, throughput: whole, draw }
            }
            Some(lobe) => {
                let Shifted { nm, carried_per_nm, drawn_per_nm } = draw(lobe, u);
                let throughput = whole * ratio(carried_per_nm, drawn_per_nm);
                Sample { nm, throughput, draw: Draw::Fluorescent { per_nm: drawn_per_nm / whole } }
            }
        })
    }
}

/// `part / whole`, or 0 if `whole` is 0.
pub(crate) fn ratio(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use crate::bispectral::{Bispectral, Draw};
    use crate::material::mixture::Mixture;
    use crate::material::model::Model;
    use crate::random::{Random, assert_drawn_from, materials, models, place};
    use upglow_color::Grid;

    const DRAWS: usize = 20_000;
    /// Six standard deviations: of the hundreds of comparisons none is that far off by chance.
    const DEVIATIONS: f64 = 6.0;

    fn mixtures(model: &Model, seed: u64) -> Vec<Mixture<'_>> {
        let mut random = Random::new(seed);
        (0..2)
            .map(|_| {
                let parts = materials(model, &mut random);
                Mixture::new(model, parts)
            })
            .collect()
    }

    #[test]
    fn incident_wavelengths_have_the_density_that_is_said() {
        for (seed, model) in (0..).zip(models()) {
            for mixture in mixtures(&model, seed) {
                for out_nm in [450.3, 520.0, 590.7] {
                    let mut random = Random::new(seed);
                    assert_drawn_from(
                        DRAWS,
                        |_| mixture.sample_incident(out_nm, [random.unit(), random.unit()]),
                        |in_nm| mixture.incident_pdf_per_nm(in_nm, out_nm),
                        mixture.incident_elastic_probability(out_nm),
                    );
                }
            }
        }
    }

    #[test]
    fn outgoing_wavelengths_have_the_density_that_is_said() {
        for (seed, model) in (0..).zip(models()) {
            for mixture in mixtures(&model, seed) {
                for in_nm in [345.0, 450.3, 530.8] {
                    let mut random = Random::new(seed);
                    assert_drawn_from(
                        DRAWS,
                        |_| mixture.sample_outgoing(in_nm, [random.unit(), random.unit()]),
                        |out_nm| mixture.outgoing_pdf_per_nm(in_nm, out_nm),
                        mixture.outgoing_elastic_probability(in_nm),
                    );
                }
            }
        }
    }

    #[test]
    fn draws_from_the_light_converge_to_the_columns_of_the_matrix() {
        let grid = Grid::FIT;
        for (seed, model) in (0..).zip(models()) {
            for mixture in mixtures(&model, seed) {
                let matrix = mixture.reradiation_matrix(grid);
                for (column, in_nm) in grid.wavelengths_nm().enumerate().step_by(17) {
                    let mut random = Random::new(seed);
                    let mut sums = vec![0.0; grid.len()];
                    for _ in 0..DRAWS {
                        let u = [random.unit(), random.unit()];
                        let Some(sample) = mixture.sample_outgoing(in_nm, u) else { continue };
                        let band = ((sample.nm - 300.0) / 5.0).round().clamp(0.0, 106.0);
                        sums[place(band)] += sample.throughput;
                    }
                    for (row, sum) in matrix.iter().zip(sums) {
                        assert_estimate(sum / DRAWS as f64, row[column], mixture.albedo(in_nm));
                    }
                }
            }
        }
    }

    #[test]
    fn draws_from_the_camera_converge_to_the_rows_of_the_matrix() {
        // Bins of ten bands of 1 nm. The matrix takes the incident light at the bands' centers.
        const QUADRATURE: f64 = 2e-5;
        let grid = Grid::FINE;
        for (seed, model) in (0..).zip(models()) {
            for mixture in mixtures(&model, seed) {
                let matrix = mixture.reradiation_matrix(grid);
                for row in [120, 205, 303] {
                    let mut random = Random::new(seed);
                    let (mut sums, mut greatest) = (vec![0.0; 54], 0.0_f64);
                    for _ in 0..DRAWS {
                        let out_nm = 300.0 + row as f64 + random.unit() - 0.5;
                        let u = [random.unit(), random.unit()];
                        let Some(sample) = mixture.sample_incident(out_nm, u) else { continue };
                        if (309.5..829.5).contains(&sample.nm)
                            && matches!(sample.draw, Draw::Fluorescent { .. })
                        {
                            sums[place((sample.nm - 299.5) / 10.0)] += sample.throughput;
                            greatest = greatest.max(sample.throughput);
                        }
                    }
                    for (bin, sum) in sums.iter().enumerate().take(53).skip(1) {
                        let columns = (10 * bin..10 * bin + 10).filter(|&c| c != row);
                        let mut expected: f64 = columns.map(|c| matrix[row][c]).sum();
                        if row / 10 == bin {
                            let nm = 300.0 + row as f64;
                            expected += matrix[row][row] - mixture.reflectance(nm);
                        }
                        let found = sum / DRAWS as f64;
                        if (found - expected).abs() > QUADRATURE {
                            assert_estimate(found, expected, greatest);
                        }
                    }
                }
            }
        }
    }

    /// A mean of [`DRAWS`] numbers that are 0 or at most `greatest`.
    fn assert_estimate(found: f64, expected: f64, greatest: f64) {
        let variance = (greatest * expected - expected * expected).max(0.0) / DRAWS as f64;
        let limit = DEVIATIONS * variance.sqrt() + greatest * DEVIATIONS.powi(2) / DRAWS as f64;
        assert!((found - expected).abs() <= limit, "{found} {expected} ± {limit}");
    }

    #[test]
    fn every_sample_has_the_same_throughput_and_says_its_density() {
        for (seed, model) in (0..).zip(models()) {
            for mixture in mixtures(&model, seed) {
                let mut random = Random::new(seed);
                for _ in 0..100 {
                    let (nm, u) = (350.0 + 350.0 * random.unit(), [random.unit(), random.unit()]);
                    let sample = mixture.sample_incident(nm, u).unwrap();
                    if let Draw::Fluorescent { per_nm } = sample.draw {
                        assert_eq!(per_nm, mixture.incident_pdf_per_nm(sample.nm, nm));
                        let value = mixture.reradiation_per_nm(sample.nm, nm);
                        assert!((value / per_nm / sample.throughput - 1.0).abs() < 1e-12);
                    }
                    let sample = mixture.sample_outgoing(nm, u).unwrap();
                    if let Draw::Fluorescent { per_nm } = sample.draw {
                        assert_eq!(per_nm, mixture.outgoing_pdf_per_nm(nm, sample.nm));
                        let value = mixture.reradiation_per_nm(nm, sample.nm);
                        assert!((value / per_nm / sample.throughput - 1.0).abs() < 1e-12);
                    }
                }
            }
        }
    }

    #[test]
    fn no_number_makes_a_sampler_panic() {
        for (seed, model) in (0..).zip(models()) {
            for mixture in mixtures(&model, seed) {
                for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 2.0, 1e300] {
                    for (nm, u) in [(odd, [0.9, 0.5]), (500.0, [odd, 0.5]), (500.0, [0.99, odd])] {
                        mixture.sample_incident(nm, u);
                        mixture.sample_outgoing(nm, u);
                    }
                }
            }
        }
    }
}
