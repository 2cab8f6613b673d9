//! Choosing between the reflection of a [`crate::PackedMixture`] and its lobes, and drawing from a
//! lobe, with the densities of [`crate::Bispectral`].

use fearless_simd::{Simd, f32x4};
use upglow_color::rounding::to_single;

use crate::bispectral::{Draw, Sample};
use crate::material::Fluorescence;
use crate::material::formula::{Accounting, Mixing, PerLobe};
use crate::material::lobe::Lobe;
use crate::material::model::Model;
use crate::packed::curve_table::DyeNumbers;
use crate::packed::model::{PackedModel, Rule};
use crate::packed::node::{PackedBells, PackedDyes, PackedFilm};
use crate::packed::vector::{sum, whole};

/// A lobe that wavelengths are drawn from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DrawnLobe<'t> {
    pub(crate) model: &'t PackedModel,
    /// [`crate::PackedNode::fluorescence`] of the lobe's corner.
    pub(crate) numbers: [f32; 4],
    /// Which of the corner's, 0 or 1.
    pub(crate) lobe: usize,
}

impl<'t> DrawnLobe<'t> {
    /// An incident wavelength with the density of what the lobe returns, or of the curve that stands for
    /// it in a film, from `u` in 0..1.
    #[inline(always)]
    pub(crate) fn draw_incident<S: Simd>(&self, simd: S, u: f32) -> f32 {
        match &self.model.model {
            Model::Dyes(model) if model.options().accounting == Accounting::Energy => {
                let (dye, u) = self.pick_dye(simd, |dye| dye.absorbed_nm, u);
                self.model.curves.absorbing.quantile(simd, dye, u)
            }
            Model::Film(_) => {
                let (dye, density) = self.film_dye(simd);
                self.model.curves.proposals.draw(simd, dye, density, u)
            }
            _ => self.in_double(simd, Lobe::sample_incident, u),
        }
    }

    /// An outgoing wavelength with the density of the lobe's emission, from `u` in 0..1.
    #[inline(always)]
    pub(crate) fn draw_emitted<S: Simd>(&self, simd: S, u: f32) -> f32 {
        match &self.model.model {
            Model::Dyes(_) => {
                let (dye, u) = self.pick_dye(simd, |dye| dye.emitted, u);
                self.model.curves.emitting.quantile(simd, dye, u)
            }
            Model::Film(_) => {
                let (dye, _) = self.film_dye(simd);
                self.model.curves.emitting.quantile(simd, dye, u)
            }
            _ => self.in_double(simd, Lobe::sample_emitted, u),
        }
    }

    /// The number of the dye that is this lobe of a film, and its optical density.
    #[inline(always)]
    fn film_dye<S: Simd>(&self, simd: S) -> (u32, f32) {
        let PackedFilm { second_density, first_density, second, first } = self.numbers.into();
        if self.lobe == 0 {
            (whole(simd, first), first_density)
        } else {
            (whole(simd, second), second_density)
        }
    }

    /// One of the lobe's dyes in proportion to an area of its curve, and what is left of `u` to draw
    /// from it.
    #[inline(always)]
    fn pick_dye<S: Simd>(&self, simd: S, area: impl Fn(&DyeNumbers) -> f32, u: f32) -> (u32, f32) {
        let PackedDyes { weight, first, .. } = self.numbers.into();
        let first = whole(simd, first);
        if self.model.rule == Rule::Ring(Mixing::Separate) {
            return (first + u32::from(self.lobe > 0), u);
        }
        let [one, two] = self.model.curves.pair([first, first + 1]);
        let [one, two] = [(1.0 - weight) * area(one), weight * area(two)];
        let target = u * (one + two);
        // Selected without a branch, which could not be predicted.
        let second = target >= one && two > 0.0;
        let (start, share) = if second { (one, two) } else { (0.0, one) };
        (first + u32::from(second), (target - start) / share)
    }

    /// A wavelength drawn from the lobe in double precision: a function of its own, so that other
    /// draws need not save registers for it.
    #[inline(never)]
    fn in_double<S: Simd>(&self, simd: S, draw: fn(&Lobe<'t>, f64) -> f64, u: f32) -> f32 {
        to_single(self.lobe(simd).map_or(0.0, |lobe| draw(&lobe, u.into())))
    }

    /// The lobe in double precision.
    fn lobe<S: Simd>(&self, simd: S) -> Option<Lobe<'t>> {
        let numbers = self.numbers.map(f64::from);
        let fluorescence = match &self.model.model {
            Model::Reflectance => Fluorescence::None,
            Model::Dyes(_) => {
                let PackedDyes { weight, concentration, first, .. } = numbers.into();
                let first = whole(simd, to_single(first)) as usize;
                Fluorescence::Dyes { first, weight, concentration }
            }
            Model::Film(_) => {
                let PackedFilm { second_density, first_density, second, first } = numbers.into();
                let dyes = [first, second].map(|dye| whole(simd, to_single(dye)) as usize);
                Fluorescence::Film { dyes, densities: [first_density, second_density] }
            }
            Model::Analytic(_) => {
                let PackedBells { emission_nm, concentration, absorption_nm, .. } = numbers.into();
                Fluorescence::Analytic {
                    emission_peak_nm: emission_nm,
                    stokes_shift_nm: emission_nm - absorption_nm,
                    concentration,
                }
            }
        };
        fluorescence.lobes(&self.model.model).nth(self.lobe)
    }
}

#[inline(always)]
pub(crate) fn elastic(nm: f32, share: f32, throughput: f32) -> Sample<f32> {
    Sample { nm, throughput, draw: Draw::Elastic { probability: share / throughput } }
}

#[inline(always)]
pub(crate) fn shifted(nm: f32, reradiation_per_nm: f32, throughput: f32) -> Sample<f32> {
    let per_nm = reradiation_per_nm / throughput;
    Sample { nm, throughput, draw: Draw::Fluorescent { per_nm } }
}

/// The contributions of reflection and of each fluorescent lobe at one wavelength.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shares<V> {
    pub(crate) elastic: f32,
    pub(crate) lobes: PerLobe<V>,
}

impl<S: Simd> Shares<f32x4<S>> {
    #[inline(always)]
    pub(crate) fn total(&self) -> f32 {
        self.elastic + sum(self.lobes[0] + self.lobes[1])
    }

    /// The part that `u` in 0..1 chooses, `Some(None)` for the elastic one; `None` if there is no
    /// light.
    #[inline(always)]
    pub(crate) fn choose(
        &self,
        lobes: usize,
        throughput: f32,
        u: f32,
    ) -> Option<Option<ChosenLobe>> {
        let rest = u * throughput - self.elastic;
        // Not for NaN either.
        (throughput > 0.0).then(|| if rest < 0.0 { None } else { self.choose_lobe(lobes, rest) })
    }

    /// The lobe that `rest` falls on, or the last one that contributes. Counted without branches,
    /// which could not be predicted.
    #[inline(always)]
    fn choose_lobe(&self, lobes: usize, rest: f32) -> Option<ChosenLobe> {
        let mut chosen = None;
        let mut end = 0.0;
        for lobe in 0..lobes {
            let shares: [f32; 4] = self.lobes[lobe].into();
            let (mut passed, mut last) = (0, 0);
            for corner in 0..4 {
                end += shares[corner];
                passed += usize::from(rest >= end);
                last = if shares[corner] > 0.0 { corner + 1 } else { last };
            }
            if last > 0 {
                chosen = Some(ChosenLobe { corner: passed.min(last - 1), lobe });
            }
            if rest < end {
                break;
            }
        }
        chosen
    }
}

/// A lobe of a [`crate::PackedMixture`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChosenLobe {
    pub(crate) corner: usize,
    /// Which of the corner's, 0 or 1.
    pub(crate) lobe: usize,
}

/// `part / whole`, or 0 if `whole` is 0.
#[inline(always)]
pub(crate) fn ratio(part: f32, whole: f32) -> f32 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bispectral::Bispectral;
    use crate::cube::{Cube, FitRecord};
    use crate::packed::lookup_table::LookupTable;
    use crate::random::{Random, assert_drawn_from, models};
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
    fn wavelengths_have_the_stated_density() {
        for (seed, model) in (0..).zip(models()) {
            let mut random = Random::new(seed);
            let table = table(model, &mut random);
            for nm in [450.3, 520.0, 590.7] {
                let blend = table.lookup(rgb(&mut random)).unwrap();
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
                let blend = table.lookup(rgb(&mut random)).unwrap();
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
    fn no_input_makes_a_sampler_panic() {
        for (seed, model) in (0..).zip(models()) {
            let mut random = Random::new(seed);
            let table = table(model, &mut random);
            let blend = table.lookup([0.3, 0.4, 0.8]).unwrap();
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
