//! The sums behind a material's color, with all that does not depend on the material precomputed.

use std::ops::Range;

use fearless_simd::{Level, Simd, dispatch};
use upglow_color::rounding::to_single;
use upglow_color::{Colorimetry, Xyz};

use crate::material::analytic_model::AnalyticModel;
use crate::material::dye_model::{DyeCurves, DyeModel, DyeOptions};
use crate::material::formula::{AbsorbedSlope, Accounting, Emitted, Emitter, Film};
use crate::material::model::Model;
use crate::material::{Fluorescence, Material};

/// A model under one light and observer.
///
/// The color of a material is
/// `k ∫ x̄ȳz̄ ((1 − c·a)·r·L + c·Q·A·ê) dλ`, with `A = ∫ a·L dλ`; here `k` is inside the weights.
#[derive(Clone, Debug)]
pub struct ModelOnGrid {
    model: Model,
    colorimetry: Colorimetry,
    wavelengths_nm: Vec<f64>,
    dyes: Vec<Emitter>,
    /// Dyes of films in single precision.
    singles: Vec<DyeSamples<Vec<f32>>>,
    simd_level: Level,
}

impl ModelOnGrid {
    /// Samples the model's curves at the wavelengths of `colorimetry`.
    pub fn new(model: &Model, colorimetry: &Colorimetry) -> Self {
        let dyes: Vec<Emitter> = model.dyes().map_or_else(Vec::new, |dyes| {
            let accounting = dyes.options().accounting;
            dyes.curves().iter().map(|c| Emitter::new(c, accounting, colorimetry)).collect()
        });
        let singles = match model {
            Model::Film(_) => dyes.iter().map(DyeSamples::in_single).collect(),
            _ => Vec::new(),
        };
        Self {
            model: model.clone(),
            colorimetry: colorimetry.clone(),
            wavelengths_nm: colorimetry.wavelengths_nm().to_vec(),
            dyes,
            singles,
            simd_level: Level::new(),
        }
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The light and observer.
    pub fn colorimetry(&self) -> &Colorimetry {
        &self.colorimetry
    }

    /// Wavelengths of the sums over incident light, nm.
    pub fn wavelengths_nm(&self) -> &[f64] {
        &self.wavelengths_nm
    }

    /// Absorptance of one dye at concentration 1, `[wavelength]`, 0..=1.
    pub fn dye_absorption(&self, dye: usize) -> &[f64] {
        &self.dyes[dye].absorption
    }

    /// What dye `first`, mixed with its neighbor by `weight`, emits at concentration 1; the
    /// parameter is the weight.
    pub fn emitted_by_dyes(&self, model: &DyeModel, first: usize, weight: f64) -> Emitted<1> {
        let (a, b) = (&self.dyes[first], &self.dyes[model.partner(first)]);
        let DyeOptions { mixing, accounting, .. } = model.options();
        mixing.emitted([a, b], weight, |dye, mean_nm| self.absorbed(dye, accounting, mean_nm))
    }

    /// Energy that one dye absorbs and may re-emit around `mean_nm`, and its derivative by
    /// `mean_nm`, 1/nm.
    fn absorbed(&self, dye: &Emitter, accounting: Accounting, mean_nm: f64) -> (f64, f64) {
        if accounting == Accounting::Energy {
            return (dye.absorbed, 0.0);
        }
        let samples = dye.absorption.iter().zip(self.colorimetry.irradiance());
        let (mut energy, mut below_mean) = (0.0, 0.0);
        for ((a, e), &nm) in samples.zip(&self.wavelengths_nm) {
            energy += a * e * accounting.share(nm, mean_nm);
            below_mean += if nm < mean_nm { a * e * nm } else { 0.0 };
        }
        (energy, -below_mean / (mean_nm * mean_nm))
    }

    /// What a film of two dyes emits at these optical densities; the parameters are the densities. The
    /// share of light that the film lets pass is written to `passed`, `[wavelength]`.
    pub fn emitted_by_film(
        &self,
        dyes: [usize; 2],
        densities: [f64; 2],
        passed: &mut [f64],
    ) -> Emitted<2> {
        let samples = dyes.map(|dye| self.dyes[dye].samples());
        let film = Film { densities };
        let energies = dispatch!(self.simd_level, simd => simd.vectorize(
            #[inline(always)]
            || film_energies::<f64, 4>(film, samples, passed),
        ));
        self.emitted_energies(dyes, energies)
    }

    /// [`ModelOnGrid::emitted_by_film`] by sums in single precision, in a third of the time. Bits do not
    /// depend on the processor. For a model other than a film it emits nothing.
    pub fn emitted_by_film_in_single(
        &self,
        dyes: [usize; 2],
        densities: [f64; 2],
        passed: &mut [f32],
    ) -> Emitted<2> {
        self.film_energies_in_single(dyes, densities, passed)
            .map_or(Emitted::DARK, |energies| self.emitted_energies(dyes, energies))
    }

    /// The same for each dye by itself.
    pub fn emitted_by_each_dye_in_single(
        &self,
        dyes: [usize; 2],
        densities: [f64; 2],
        passed: &mut [f32],
    ) -> [Emitted<2>; 2] {
        let Some(energies) = self.film_energies_in_single(dyes, densities, passed) else {
            return [Emitted::DARK; 2];
        };
        let FilmEnergies { returned, by_density } = energies;
        [[1.0, 0.0], [0.0, 1.0]].map(|of: [f64; 2]| {
            let own = |[a, b]: [f64; 2]| [of[0] * a, of[1] * b];
            let returned = own(returned);
            self.emitted_energies(dyes, FilmEnergies { returned, by_density: by_density.map(own) })
        })
    }

    fn film_energies_in_single(
        &self,
        dyes: [usize; 2],
        densities: [f64; 2],
        passed: &mut [f32],
    ) -> Option<FilmEnergies> {
        let Some([one, two]) = self.singles_of(dyes) else {
            passed.fill(1.0);
            return None;
        };
        let film = Film { densities: densities.map(to_single) };
        Some(dispatch!(self.simd_level, simd => simd.vectorize(
            #[inline(always)]
            || film_energies::<f32, 8>(film, [one, two], passed),
        )))
    }

    fn singles_of(&self, [one, two]: [usize; 2]) -> Option<[DyeSamples<&[f32]>; 2]> {
        Some([self.singles.get(one)?.borrowed(), self.singles.get(two)?.borrowed()])
    }

    fn emitted_energies(&self, dyes: [usize; 2], energies: FilmEnergies) -> Emitted<2> {
        let [one, two] = dyes.map(|dye| &self.dyes[dye]);
        let [one, two] = [one, two].map(|dye| dye.stimulus.map(|s| dye.quantum_yield * s));
        let color = |[a, b]: [f64; 2]| [0, 1, 2].map(|k| a * one[k] + b * two[k]);
        Emitted { color: color(energies.returned), derivatives: energies.by_density.map(color) }
    }

    /// How the emitted color of a film changes with the optical density of each dye of the set, `[dye]`,
    /// also of dyes that it does not hold.
    pub fn emitted_by_dyes_of_set(&self, dyes: [usize; 2], densities: [f64; 2]) -> Vec<[f64; 3]> {
        let [one, two] = dyes.map(|dye| &self.dyes[dye]);
        let film = Film { densities };
        let mut opened = vec![[0.0; 3]; self.wavelengths_nm.len()];
        for (i, opened) in opened.iter_mut().enumerate() {
            let (own, [first, second]) = film.opened([one.absorption[i], two.absorption[i]]);
            *opened = [own, first * one.usable[i], second * two.usable[i]];
        }
        let change = |dye: &Emitter| {
            let mut sums = [0.0; 3];
            for ((a, usable), opened) in dye.absorption.iter().zip(&dye.usable).zip(&opened) {
                sums[0] += a * usable * opened[0];
                sums[1] += a * opened[1];
                sums[2] += a * opened[2];
            }
            let emitters = [dye, one, two];
            [0, 1, 2].map(|k| {
                (0..3).map(|e| sums[e] * emitters[e].quantum_yield * emitters[e].stimulus[k]).sum()
            })
        };
        self.dyes.iter().map(change).collect()
    }

    /// What bells emit at concentration 1; the parameters are the emission's peak and the Stokes
    /// shift, nm.
    pub fn emitted_by_bells(
        &self,
        model: &AnalyticModel,
        emission_peak_nm: f64,
        stokes_shift_nm: f64,
    ) -> Emitted<2> {
        let absorption_nm = emission_peak_nm - stokes_shift_nm;
        let (mut energy, mut by_absorption, mut by_mean) = (0.0, 0.0, 0.0);
        for (e, &nm) in self.colorimetry.irradiance().iter().zip(&self.wavelengths_nm) {
            let (a, a_slope) = model.absorption(absorption_nm, nm);
            let share = model.accounting().share(nm, emission_peak_nm);
            energy += a * e * share;
            by_absorption += a_slope * e * share;
            if model.accounting() == Accounting::Photon && nm < emission_peak_nm {
                by_mean -= a * e * nm / (emission_peak_nm * emission_peak_nm);
            }
        }
        let grid = self.colorimetry.grid();
        let step_nm = f64::from(grid.step_nm());
        let (mut stimulus, mut stimulus_by_peak) = ([0.0; 3], [0.0; 3]);
        for (m, nm) in self.colorimetry.matching().iter().zip(grid.wavelengths_nm()) {
            let (g, g_slope) = model.emission(emission_peak_nm, nm);
            for k in 0..3 {
                stimulus[k] += g * m[k] * step_nm;
                stimulus_by_peak[k] += g_slope * m[k] * step_nm;
            }
        }
        let q = model.quantum_yield();
        let by_peak = [0, 1, 2]
            .map(|k| q * ((by_absorption + by_mean) * stimulus[k] + energy * stimulus_by_peak[k]));
        let by_shift = stimulus.map(|s| -q * by_absorption * s);
        Emitted { color: stimulus.map(|s| q * energy * s), derivatives: [by_peak, by_shift] }
    }

    /// The color of one material.
    pub fn color(&self, material: Material) -> Xyz {
        self.color_and_emission(material).0
    }

    /// The color of one material, and what of it is light that fluorescence emits.
    pub fn color_and_emission(&self, material: Material) -> (Xyz, Xyz) {
        let mut passed = vec![1.0; self.wavelengths_nm.len()];
        let emitted = self.emitted(material.fluorescence, &mut passed);
        let reflected =
            self.wavelengths_nm.iter().zip(&passed).map(|(&nm, t)| t * material.reflectance.at(nm));
        let mut color = self.colorimetry.xyz_from_reflectance(reflected).0;
        (0..3).for_each(|k| color[k] += emitted[k]);
        (Xyz(color), Xyz(emitted))
    }

    /// The color that fluorescence emits; what it absorbs is taken from `passed`.
    fn emitted(&self, fluorescence: Fluorescence, passed: &mut [f64]) -> [f64; 3] {
        match (fluorescence, &self.model) {
            (Fluorescence::Dyes { first, weight, concentration }, Model::Dyes(model)) => {
                let [a, b] = [first, model.partner(first)].map(|dye| &self.dyes[dye].absorption);
                let mixing = model.options().mixing;
                for (passed, (a, b)) in passed.iter_mut().zip(a.iter().zip(b)) {
                    *passed -= mixing.absorbed_in_all([*a, *b], concentration, weight);
                }
                let emitted = self.emitted_by_dyes(model, first, weight).color;
                emitted.map(|v| concentration * v)
            }
            (Fluorescence::Film { dyes, densities }, Model::Film(_)) => {
                self.emitted_by_film(dyes, densities, passed).color
            }
            (
                Fluorescence::Analytic { emission_peak_nm, stokes_shift_nm, concentration },
                Model::Analytic(model),
            ) => {
                let center_nm = emission_peak_nm - stokes_shift_nm;
                for (passed, &nm) in passed.iter_mut().zip(&self.wavelengths_nm) {
                    *passed -= concentration * model.absorption(center_nm, nm).0;
                }
                let emitted = self.emitted_by_bells(model, emission_peak_nm, stokes_shift_nm).color;
                emitted.map(|v| concentration * v)
            }
            _ => [0.0; 3],
        }
    }
}

/// The energies that two dyes in a film re-emit, and their derivatives.
struct FilmEnergies {
    returned: [f64; 2],
    /// `[density][dye]`.
    by_density: [[f64; 2]; 2],
}

/// Absorption of a dye and the light that it may re-emit, `[wavelength]`.
#[derive(Clone, Copy, Debug)]
struct DyeSamples<V> {
    absorption: V,
    usable: V,
}

impl DyeSamples<Vec<f32>> {
    fn in_single(dye: &Emitter) -> Self {
        let single = |curve: &[f64]| curve.iter().map(|&v| to_single(v)).collect();
        Self { absorption: single(&dye.absorption), usable: single(&dye.usable) }
    }

    fn borrowed(&self) -> DyeSamples<&[f32]> {
        DyeSamples { absorption: &self.absorption, usable: &self.usable }
    }
}

impl<T> DyeSamples<&[T]> {
    fn part(&self, range: Range<usize>) -> Self {
        Self { absorption: &self.absorption[range.clone()], usable: &self.usable[range] }
    }
}

/// The wavelengths of a block, whose terms are kept on the stack.
const BLOCK: usize = 128;

/// Two loops for each block, one without sums and one of sums only: both become vectors. Each sum has
/// `WIDTH` partial sums, a power of two, so that results have the same bits on every machine.
#[inline(always)]
fn film_energies<T, const WIDTH: usize>(
    film: Film<T>,
    dyes: [DyeSamples<&[T]>; 2],
    passed: &mut [T],
) -> FilmEnergies
where
    T: AbsorbedSlope + Default + Into<f64>,
{
    let zero = T::default();
    let mut sums = [[zero; WIDTH]; 6];
    for (block, passed) in passed.chunks_mut(BLOCK).enumerate() {
        let range = block * BLOCK..block * BLOCK + passed.len();
        let mut terms = [[zero; BLOCK]; 6];
        film_terms(film, dyes.each_ref().map(|dye| dye.part(range.clone())), passed, &mut terms);
        for (sums, terms) in sums.iter_mut().zip(&terms) {
            for part in terms.as_chunks::<WIDTH>().0 {
                (0..WIDTH).for_each(|i| sums[i] = sums[i] + part[i]);
            }
        }
    }
    let [a, b, a_by_first, b_by_first, a_by_second, b_by_second] = sums.map(|mut parts| {
        let mut count = WIDTH;
        while count > 1 {
            count /= 2;
            (0..count).for_each(|i| parts[i] = parts[2 * i] + parts[2 * i + 1]);
        }
        parts[0].into()
    });
    FilmEnergies {
        returned: [a, b],
        by_density: [[a_by_first, b_by_first], [a_by_second, b_by_second]],
    }
}

#[inline(always)]
fn film_terms<T: AbsorbedSlope>(
    film: Film<T>,
    [one, two]: [DyeSamples<&[T]>; 2],
    passed: &mut [T],
    terms: &mut [[T; BLOCK]; 6],
) {
    let count = passed.len().min(BLOCK);
    let (a, b) = (&one.absorption[..count], &two.absorption[..count]);
    let (usable_by_a, usable_by_b) = (&one.usable[..count], &two.usable[..count]);
    let [t0, t1, t2, t3, t4, t5] = terms;
    for i in 0..count {
        let (transmitted, absorbed, by) = film.with_derivatives([a[i], b[i]]);
        passed[i] = transmitted;
        t0[i] = usable_by_a[i] * absorbed[0];
        t1[i] = usable_by_b[i] * absorbed[1];
        t2[i] = usable_by_a[i] * by[0][0];
        t3[i] = usable_by_b[i] * by[1][0];
        t4[i] = usable_by_a[i] * by[0][1];
        t5[i] = usable_by_b[i] * by[1][1];
    }
}

impl Emitter {
    fn new(curves: &DyeCurves, accounting: Accounting, colorimetry: &Colorimetry) -> Self {
        let grid = colorimetry.grid();
        let emission = curves.emission.resampled(grid);
        // The sum over a coarse grid differs from the area: without this, energy is not conserved.
        let area: f64 = emission.values().iter().sum();
        let mut stimulus = [0.0; 3];
        for (e, m) in emission.values().iter().zip(colorimetry.matching()) {
            (0..3).for_each(|k| stimulus[k] += e / area * m[k]);
        }
        let absorption: Vec<f64> =
            colorimetry.wavelengths_nm().iter().map(|&nm| curves.absorption.at(nm)).collect();
        let absorbed = absorption.iter().zip(colorimetry.irradiance()).map(|(a, e)| a * e).sum();
        let light = colorimetry.wavelengths_nm().iter().zip(colorimetry.irradiance());
        let usable = light.map(|(&nm, e)| e * accounting.share(nm, curves.mean_emission_nm));
        Self {
            absorption,
            absorbed,
            usable: usable.collect(),
            stimulus,
            quantum_yield: curves.quantum_yield,
            mean_emission_nm: curves.mean_emission_nm,
        }
    }

    fn samples(&self) -> DyeSamples<&[f64]> {
        DyeSamples { absorption: &self.absorption, usable: &self.usable }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::dye_model::QuantumYield;
    use crate::material::dye_set::DyeSet;
    use crate::material::film_model::FilmModel;
    use crate::material::formula::Mixing;
    use upglow_color::{Contract, Grid};

    /// A central difference of this step errs by its square and by rounding over it.
    const STEP: f64 = 1e-5;
    const TOLERANCE: f64 = 1e-7;

    #[test]
    fn derivatives_by_the_weight_match_differences() {
        let colorimetry = Contract::default().on(Grid::FIT);
        for accounting in [Accounting::Energy, Accounting::Photon] {
            for mixing in [Mixing::Pooled, Mixing::Separate] {
                let quantum_yield = QuantumYield::Measured;
                let options =
                    DyeOptions { accounting, mixing, quantum_yield, optical_density: None };
                let set = DyeSet::named("wide14").unwrap();
                let dyes = DyeModel::new(set, options).unwrap();
                let model = Model::Dyes(dyes.clone());
                let sums = ModelOnGrid::new(&model, &colorimetry);
                for first in 0..dyes.pairs() {
                    let at = |w: f64| sums.emitted_by_dyes(&dyes, first, w);
                    let (low, high) = (at(0.3 - STEP).color, at(0.3 + STEP).color);
                    for k in 0..3 {
                        let quotient = (high[k] - low[k]) / (2.0 * STEP);
                        let exact = at(0.3).derivatives[0][k];
                        assert!((exact - quotient).abs() < TOLERANCE, "{accounting} {mixing}");
                    }
                }
            }
        }
    }

    #[test]
    fn derivatives_by_peak_and_shift_match_differences() {
        let colorimetry = Contract::default().on(Grid::FIT);
        for accounting in [Accounting::Energy, Accounting::Photon] {
            let bells = AnalyticModel::new(50.0, 45.0, accounting, 0.9).unwrap();
            let model = Model::Analytic(bells);
            let sums = ModelOnGrid::new(&model, &colorimetry);
            let at = |peak: f64, shift: f64| sums.emitted_by_bells(&bells, peak, shift);
            for (peak, shift) in [(431.3, 40.2), (552.7, 97.1), (677.2, 13.9)] {
                let exact = at(peak, shift).derivatives;
                let by_peak = [at(peak - STEP, shift).color, at(peak + STEP, shift).color];
                let by_shift = [at(peak, shift - STEP).color, at(peak, shift + STEP).color];
                for (exact, [low, high]) in exact.iter().zip([by_peak, by_shift]) {
                    for k in 0..3 {
                        let quotient = (high[k] - low[k]) / (2.0 * STEP);
                        assert!((exact[k] - quotient).abs() < TOLERANCE, "{peak} {shift}");
                    }
                }
            }
        }
    }
    #[test]
    fn films_are_the_same_in_single_precision() {
        // Single precision of sums of 107 terms that add up to at most 1.
        const SINGLE: f64 = 2e-6;
        // Derivatives lose the digits that `Number for f32` states.
        const OF_DERIVATIVES: f64 = 2e-5;
        let colorimetry = Contract::default().on(Grid::FIT);
        for accounting in [Accounting::Energy, Accounting::Photon] {
            let set = DyeSet::named("konig8").unwrap();
            let film = FilmModel::new(set, accounting, QuantumYield::Measured).unwrap();
            let sums = ModelOnGrid::new(&Model::Film(film), &colorimetry);
            let count = sums.wavelengths_nm().len();
            let (mut passed, mut passed_in_single) = (vec![0.0; count], vec![0.0; count]);
            for (dyes, densities) in [
                ([0, 3], [0.3, 0.0]),
                ([7, 2], [2.0, 0.7]),
                ([5, 5], [6.0, 0.0]),
                ([1, 6], [1e-4, 1e-5]),
            ] {
                let double = sums.emitted_by_film(dyes, densities, &mut passed);
                let single = sums.emitted_by_film_in_single(dyes, densities, &mut passed_in_single);
                for (a, b) in passed.iter().zip(&passed_in_single) {
                    assert!((a - f64::from(*b)).abs() < SINGLE, "{dyes:?} {densities:?}");
                }
                for k in 0..3 {
                    let off = double.color[k] - single.color[k];
                    assert!(off.abs() < SINGLE, "{dyes:?} {densities:?} {off:e}");
                    for d in 0..2 {
                        let off = double.derivatives[d][k] - single.derivatives[d][k];
                        assert!(off.abs() < OF_DERIVATIVES, "{dyes:?} {densities:?} {off:e}");
                    }
                }
            }
        }
    }
}
