//! The sums behind a material's color, with all that does not depend on the material precomputed.

use upglow_color::{Colorimetry, Xyz};

use crate::material::analytic_model::AnalyticModel;
use crate::material::dye_model::{DyeCurves, DyeModel, DyeOptions};
use crate::material::formula::{Accounting, Emitted, Emitter};
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
}

impl ModelOnGrid {
    /// Samples the model's curves at the wavelengths of `colorimetry`.
    pub fn new(model: &Model, colorimetry: &Colorimetry) -> Self {
        let dyes = match model {
            Model::Dyes(model) => {
                model.curves().iter().map(|c| Emitter::new(c, colorimetry)).collect()
            }
            _ => Vec::new(),
        };
        Self {
            model: model.clone(),
            colorimetry: colorimetry.clone(),
            wavelengths_nm: colorimetry.wavelengths_nm().to_vec(),
            dyes,
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
        let absorbed = self.absorbed_share(material.fluorescence);
        let reflected = self
            .wavelengths_nm
            .iter()
            .enumerate()
            .map(|(i, &nm)| (1.0 - absorbed(i)) * material.reflectance.at(nm));
        let mut color = self.colorimetry.xyz_from_reflectance(reflected).0;
        let emitted = match (material.fluorescence, &self.model) {
            (Fluorescence::Dyes { first, weight, .. }, Model::Dyes(model)) => {
                self.emitted_by_dyes(model, first, weight).color
            }
            (
                Fluorescence::Analytic { emission_peak_nm, stokes_shift_nm, .. },
                Model::Analytic(model),
            ) => self.emitted_by_bells(model, emission_peak_nm, stokes_shift_nm).color,
            _ => [0.0; 3],
        };
        let concentration = material.fluorescence.concentration();
        (0..3).for_each(|k| color[k] += concentration * emitted[k]);
        Xyz(color)
    }

    /// Share of light that the fluorescence absorbs at each wavelength of the grid.
    fn absorbed_share(&self, fluorescence: Fluorescence) -> impl Fn(usize) -> f64 + '_ {
        move |i| match (fluorescence, &self.model) {
            (Fluorescence::Dyes { first, weight, concentration }, Model::Dyes(model)) => {
                let dyes = [first, model.partner(first)];
                let absorptions = dyes.map(|dye| self.dyes[dye].absorption[i]);
                model.options().mixing.absorbed_in_all(absorptions, concentration, weight)
            }
            (
                Fluorescence::Analytic { emission_peak_nm, stokes_shift_nm, concentration },
                Model::Analytic(model),
            ) => {
                let center = emission_peak_nm - stokes_shift_nm;
                concentration * model.absorption(center, self.wavelengths_nm[i]).0
            }
            _ => 0.0,
        }
    }
}

impl Emitter {
    fn new(curves: &DyeCurves, colorimetry: &Colorimetry) -> Self {
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
        Self {
            absorption,
            absorbed,
            stimulus,
            quantum_yield: curves.quantum_yield,
            mean_emission_nm: curves.mean_emission_nm,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::dye_model::QuantumYield;
    use crate::material::dye_set::DyeSet;
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
}
