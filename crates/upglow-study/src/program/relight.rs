//! How materials that were made from a color look under other lights, beside the surfaces that had the color.

use rayon::prelude::*;
use upglow::{Fluorescence, Model, ModelOnGrid};
use upglow_color::{Choice, Contract, Illuminant, LinearRgb, Xyz, ciede2000};
use upglow_fit::{Fit, FitOptions, FitOptionsError, Fitter, GivenOptions, Preset};

use crate::bispectral::Measured;
use crate::lights::{lamps, smooth_lights};
use crate::samples::{Sample, SampleSet};
use crate::spread::Spread;

/// A way to make a material from a color alone.
#[derive(Debug)]
pub(crate) struct Way {
    /// What reports call it.
    pub(crate) name: String,
    contract: Contract,
    fitter: Fitter,
}

impl Way {
    /// A fit of each color by itself.
    ///
    /// # Errors
    ///
    /// [`FitOptionsError`] if an option is out of range.
    pub(crate) fn try_new(
        name: impl Into<String>,
        contract: Contract,
        model: &Model,
        options: FitOptions,
    ) -> Result<Self, FitOptionsError> {
        let fitter = Fitter::new(&contract, model, options)?;
        Ok(Self { name: name.into(), contract, fitter })
    }

    /// The fit of a preset.
    pub(crate) fn preset(preset: Preset, contract: Contract) -> Self {
        Self::try_new(preset.to_string(), contract, &preset.model(), preset.options())
            .expect("a preset is in range")
    }

    /// The material of a color under the contract's light.
    pub(crate) fn material(&self, color: Xyz) -> Fit {
        self.nearest(self.fitter.model().colorimetry().rgb_from_xyz(color))
    }

    /// The materials of the samples' colors under the contract's light. RGB is by sums over the grid of the
    /// samples, so that a gray one has R = G = B.
    fn materials(&self, set: &SampleSet) -> Vec<Fit> {
        let home = self.contract.on(set.grid);
        let material = |sample: &Sample| self.nearest(home.rgb_from_xyz(sample.color(&home)));
        set.samples.par_iter().map(material).collect()
    }

    /// The material of the nearest RGB that can be asked for.
    fn nearest(&self, rgb: LinearRgb) -> Fit {
        let rgb = LinearRgb(rgb.0.map(|value| value.clamp(0.0, Fitter::BRIGHTEST)));
        self.fitter.fit(rgb).expect("the color is in range")
    }

    /// ΔE00 between each sample and its material, both under `light` and against its white.
    fn differences(&self, set: &SampleSet, made: &[Fit], light: &Illuminant) -> Vec<f64> {
        let contract = Contract { illuminant: light.clone(), ..self.contract.clone() };
        let colorimetry = contract.on(set.grid);
        let sums = ModelOnGrid::new(self.fitter.model().model(), &colorimetry);
        let difference = |sample: &Sample, fit: &Fit| {
            let colors = [sample.color(&colorimetry), sums.color(fit.material())];
            let [one, two] = colors.map(|xyz| colorimetry.lab_from_xyz(xyz));
            ciede2000(one, two)
        };
        set.samples.iter().zip(made).map(|(sample, fit)| difference(sample, fit)).collect()
    }
}

/// How far the materials of one way are from a set of samples.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Relit {
    /// ΔE00 of each sample under the contract's light.
    pub(crate) home: Vec<f64>,
    /// The same under each of the other lights, `[light][sample]`.
    pub(crate) away: Vec<Vec<f64>>,
    /// How many materials have a dye.
    pub(crate) dyed: usize,
}

impl Relit {
    pub(crate) fn of(set: &SampleSet, way: &Way, lights: &[Illuminant]) -> Self {
        let made = way.materials(set);
        let under = |light| way.differences(set, &made, light);
        Self {
            home: under(&way.contract.illuminant),
            away: lights.iter().map(under).collect(),
            dyed: made.iter().filter(|fit| fit.fluorescence != Fluorescence::None).count(),
        }
    }

    /// The mean over the other lights of each sample.
    pub(crate) fn means(&self) -> Vec<f64> {
        let of = |sample: usize| Spread::of(self.away.iter().map(|light| light[sample])).mean;
        (0..self.home.len()).map(of).collect()
    }
}

/// Sets of samples with the lights that each is seen under. Without measured materials there is no set of
/// these.
pub(crate) fn sets(measured: &[Measured]) -> Vec<(SampleSet, Vec<Illuminant>)> {
    let mut sets = vec![(SampleSet::object_colors(), lamps()), (SampleSet::paints(), lamps())];
    if !measured.is_empty() {
        sets.push((SampleSet::fluorescent(measured), smooth_lights()));
    }
    sets
}

/// Slope limits beside those of the preset `natural`: of a reflectance alone and under dyes, 1/nm.
const OTHER_LIMITS_PER_NM: [[f64; 2]; 7] = [
    [0.065, 0.01],
    [0.065, 0.03],
    [0.05, 0.01],
    [0.05, 0.02],
    [0.05, 0.03],
    [0.02, 0.02],
    [0.01, 0.01],
];

/// Every preset, then `natural` with other limits.
pub(crate) fn ways(contract: &Contract) -> Vec<Way> {
    let presets = Preset::ALL.iter().map(|preset| Way::preset(*preset, contract.clone()));
    let limited = |[alone, under_dyes]: [f64; 2]| {
        let given = GivenOptions {
            slope_max_per_nm: Some(Some(alone)),
            slope_under_dyes_per_nm: Some(Some(under_dyes)),
            ..GivenOptions::default()
        };
        let (model, options) = (Preset::Natural.model(), Preset::Natural.options().with(given));
        let name = format!("{}, {alone} and {under_dyes}/nm", Preset::Natural);
        Way::try_new(name, contract.clone(), &model, options).expect("the limits are in range")
    };
    presets.chain(OTHER_LIMITS_PER_NM.map(limited)).collect()
}
