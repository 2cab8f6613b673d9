//! Drawing wavelengths in proportion to what a [`Blend`] makes of them: `sampling.rs` for inner
//! loops, with the same measure.

use crate::blend::{Blend, PerLobe, dye, sum};
use crate::lookup_table::to_single;
use crate::material::Lobe;
use crate::{Draw, Fluorescence, Model, Sample};

impl<'t> Blend<'t> {
    /// Draws the wavelength of incident light, given that of the light that leaves; see
    /// [`crate::Mixture::sample_incident`]. `u` are two independent numbers in 0..1.
    ///
    /// `None` where nothing can leave at `out_nm`.
    #[inline]
    pub fn sample_incident(&self, out_nm: f32, u: [f32; 2]) -> Option<Sample<f32>> {
        let emission = self.emission(out_nm);
        let shares = self.leaving(out_nm, &emission);
        self.sample(out_nm, shares, u, |lobe, u| {
            let in_nm = to_single(lobe.sample_absorbed(u));
            (in_nm, self.moved(&self.returned(in_nm), &emission))
        })
    }

    /// The density, 1/nm, with which [`Blend::sample_incident`] draws `in_nm` by fluorescence.
    #[inline]
    pub fn incident_pdf_per_nm(&self, in_nm: f32, out_nm: f32) -> f32 {
        let emission = self.emission(out_nm);
        let moved = self.moved(&self.returned(in_nm), &emission);
        ratio(moved, self.leaving(out_nm, &emission).total())
    }

    /// The probability, 0..=1, that [`Blend::sample_incident`] keeps the wavelength.
    #[inline]
    pub fn incident_elastic_probability(&self, out_nm: f32) -> f32 {
        let shares = self.leaving(out_nm, &self.emission(out_nm));
        ratio(shares.elastic, shares.total())
    }

    /// Draws the wavelength of the light that leaves, given that of incident light; see
    /// [`crate::Mixture::sample_outgoing`]. `u` are two independent numbers in 0..1.
    ///
    /// `None` where nothing of the light at `in_nm` leaves.
    #[inline]
    pub fn sample_outgoing(&self, in_nm: f32, u: [f32; 2]) -> Option<Sample<f32>> {
        let (returned, shares) = self.arriving(in_nm);
        self.sample(in_nm, shares, u, |lobe, u| {
            let out_nm = to_single(lobe.sample_emitted(u));
            (out_nm, self.moved(&returned, &self.emission(out_nm)))
        })
    }

    /// The density, 1/nm, with which [`Blend::sample_outgoing`] draws `out_nm` by fluorescence.
    #[inline]
    pub fn outgoing_pdf_per_nm(&self, in_nm: f32, out_nm: f32) -> f32 {
        let (returned, shares) = self.arriving(in_nm);
        ratio(self.moved(&returned, &self.emission(out_nm)), shares.total())
    }

    /// The probability, 0..=1, that [`Blend::sample_outgoing`] keeps the wavelength.
    #[inline]
    pub fn outgoing_elastic_probability(&self, in_nm: f32) -> f32 {
        let (_, shares) = self.arriving(in_nm);
        ratio(shares.elastic, shares.total())
    }

    #[inline(always)]
    fn leaving(&self, out_nm: f32, emission: &PerLobe) -> Shares {
        Shares { elastic: self.reflectance(out_nm), lobes: self.leaving_shares(emission) }
    }

    #[inline(always)]
    fn arriving(&self, in_nm: f32) -> (PerLobe, Shares) {
        let absorbed = self.pairs_absorbed(in_nm);
        let returned = self.returned_of(in_nm, &absorbed);
        let elastic = self.reflectance_through(in_nm, &absorbed);
        (returned, Shares { elastic, lobes: self.arriving_shares(&returned) })
    }

    #[inline(always)]
    fn sample(
        &self,
        known_nm: f32,
        shares: Shares,
        [choice, u]: [f32; 2],
        draw: impl Fn(Lobe<'t>, f64) -> (f32, f32),
    ) -> Option<Sample<f32>> {
        let throughput = shares.total();
        if throughput <= 0.0 {
            return None;
        }
        let lobe = shares.choose(choice).and_then(|number| self.lobe(number));
        Some(match lobe {
            None => {
                let probability = shares.elastic / throughput;
                Sample { nm: known_nm, throughput, draw: Draw::Elastic { probability } }
            }
            Some(lobe) => {
                let (nm, reradiation_per_nm) = draw(lobe, f64::from(u));
                let per_nm = reradiation_per_nm / throughput;
                Sample { nm, throughput, draw: Draw::Fluorescent { per_nm } }
            }
        })
    }

    /// Lobe `number` mod 2 of corner `number` / 2.
    fn lobe(&self, number: usize) -> Option<Lobe<'t>> {
        let [first, concentration, _, last] =
            self.fluorescence.map(|numbers| f64::from(numbers[number / 2]));
        let model = &self.table.model;
        let fluorescence = match model {
            Model::Reflectance => Fluorescence::None,
            Model::Dyes(_) => {
                Fluorescence::Dyes { first: dye(to_single(last)), weight: first, concentration }
            }
            Model::Analytic(_) => Fluorescence::Analytic {
                emission_peak_nm: first,
                stokes_shift_nm: first - last,
                concentration,
            },
        };
        fluorescence.lobes(model).nth(number % 2)
    }
}

/// What is carried at one wavelength by reflection and by each fluorescent lobe.
#[derive(Clone, Copy, Debug)]
struct Shares {
    elastic: f32,
    /// `[lobe + 2·corner]`.
    lobes: [f32; 8],
}

impl Shares {
    #[inline(always)]
    fn total(&self) -> f32 {
        let [a, b, c, d, e, f, g, h] = self.lobes;
        self.elastic + sum([a + b, c + d, e + f, g + h])
    }

    /// The lobe that `u` in 0..1 falls on; `None` is the elastic part.
    #[inline(always)]
    fn choose(&self, u: f32) -> Option<usize> {
        let mut rest = u * self.total() - self.elastic;
        if rest < 0.0 {
            return None;
        }
        let mut last = None;
        for (number, &share) in self.lobes.iter().enumerate() {
            if share > 0.0 {
                last = Some(number);
                rest -= share;
                if rest < 0.0 {
                    break;
                }
            }
        }
        last
    }
}

/// 0 where there is nothing to share.
#[inline(always)]
fn ratio(part: f32, whole: f32) -> f32 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Random, assert_drawn_from, models};
    use crate::{Cube, FitRecord, LookupTable};
    use upglow_color::Contract;

    const DRAWS: usize = 20_000;

    fn table(model: Model, random: &mut Random) -> LookupTable {
        let nodes = (0..27).map(|_| random.node(&model)).collect();
        let cube = Cube::new(Contract::default(), model, FitRecord::default(), 3, nodes);
        cube.expect("nodes are in range").lookup_table()
    }

    fn unit(random: &mut Random) -> f32 {
        // The greatest number below 1 in double precision is 1 in single.
        to_single(random.unit()).min(1.0_f32.next_down())
    }

    fn rgb(random: &mut Random) -> [f32; 3] {
        [unit(random), unit(random), unit(random)]
    }

    fn wide(sample: Sample<f32>) -> Sample<f64> {
        let draw = match sample.draw {
            Draw::Elastic { probability } => Draw::Elastic { probability: probability.into() },
            Draw::Fluorescent { per_nm } => Draw::Fluorescent { per_nm: per_nm.into() },
        };
        Sample { nm: sample.nm.into(), throughput: sample.throughput.into(), draw }
    }

    #[test]
    fn wavelengths_have_the_density_that_is_said() {
        for (seed, model) in (0..).zip(models()) {
            let mut random = Random::new(seed);
            let table = table(model, &mut random);
            for nm in [450.3, 520.0, 590.7] {
                let blend = table.blend(rgb(&mut random)).unwrap();
                assert_drawn_from(
                    DRAWS,
                    |_| blend.sample_incident(nm, [unit(&mut random), unit(&mut random)]).map(wide),
                    |in_nm| blend.incident_pdf_per_nm(to_single(in_nm), nm).into(),
                    blend.incident_elastic_probability(nm).into(),
                );
                assert_drawn_from(
                    DRAWS,
                    |_| blend.sample_outgoing(nm, [unit(&mut random), unit(&mut random)]).map(wide),
                    |out_nm| blend.outgoing_pdf_per_nm(nm, to_single(out_nm)).into(),
                    blend.outgoing_elastic_probability(nm).into(),
                );
            }
        }
    }

    #[test]
    fn a_sample_carries_re_radiation_over_its_density() {
        // Single precision of a sum of eight products.
        const SINGLE: f32 = 2e-6;
        for (seed, model) in (0..).zip(models()) {
            let mut random = Random::new(seed);
            let table = table(model, &mut random);
            for _ in 0..1000 {
                let blend = table.blend(rgb(&mut random)).unwrap();
                let nm = 350.0 + 350.0 * unit(&mut random);
                let u = [unit(&mut random), unit(&mut random)];
                let sample = blend.sample_incident(nm, u).unwrap();
                if let Draw::Fluorescent { per_nm } = sample.draw {
                    let value = blend.reradiation_per_nm(sample.nm, nm);
                    assert!((value / per_nm / sample.throughput - 1.0).abs() < SINGLE);
                    assert_eq!(per_nm, blend.incident_pdf_per_nm(sample.nm, nm));
                }
                let sample = blend.sample_outgoing(nm, u).unwrap();
                if let Draw::Fluorescent { per_nm } = sample.draw {
                    let value = blend.reradiation_per_nm(nm, sample.nm);
                    assert!((value / per_nm / sample.throughput - 1.0).abs() < SINGLE);
                    assert_eq!(per_nm, blend.outgoing_pdf_per_nm(nm, sample.nm));
                }
            }
        }
    }

    #[test]
    fn no_number_makes_a_sampler_panic() {
        for (seed, model) in (0..).zip(models()) {
            let mut random = Random::new(seed);
            let table = table(model, &mut random);
            let blend = table.blend([0.3, 0.4, 0.8]).unwrap();
            for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 2.0, 1e38] {
                for (nm, u) in [(odd, [0.9, 0.5]), (500.0, [odd, 0.5]), (500.0, [0.99, odd])] {
                    blend.sample_incident(nm, u);
                    blend.sample_outgoing(nm, u);
                }
                blend.reflectance8([odd; 8]);
            }
        }
    }
}
