//! Spectra of dyes, and the colors of their emissions.

use upglow::DyeModel;
use upglow_color::{Grid, Observer, Spectrum, Xyz};

/// A dye with its spectra as the model uses them.
#[derive(Clone, Debug, PartialEq)]
pub struct DyeSpectra<'m> {
    /// The dye's name.
    pub name: &'m str,
    /// Fraction of the light that is absorbed at full concentration, 0..=1.
    pub absorption: &'m Spectrum,
    /// Emission of unit area, 1/nm.
    pub emission: &'m Spectrum,
    /// Wavelength of the greatest absorption, nm.
    pub absorption_peak_nm: f64,
    /// Wavelength of the greatest emission, nm.
    pub emission_peak_nm: f64,
    /// Chromaticity of the emission alone; `None` if the observer does not see it.
    pub emission_xy: Option<[f64; 2]>,
}

/// The dyes of a model in ring order, with the chromaticities of their emissions for `observer`.
pub fn dye_spectra<'m>(model: &'m DyeModel, observer: &Observer) -> Vec<DyeSpectra<'m>> {
    let matching = observer.on(Grid::FINE);
    let dyes = model.set().dyes().iter().zip(model.curves());
    dyes.map(|(dye, curves)| DyeSpectra {
        name: &dye.name,
        absorption: &curves.absorption,
        emission: &curves.emission,
        absorption_peak_nm: peak_nm(&curves.absorption),
        emission_peak_nm: peak_nm(&curves.emission),
        emission_xy: chromaticity(&curves.emission, &matching),
    })
    .collect()
}

/// Chromaticity of light on [`Grid::FINE`].
fn chromaticity(light: &Spectrum, matching: &[[f64; 3]]) -> Option<[f64; 2]> {
    let mut sum = [0.0; 3];
    for (e, m) in light.values().iter().zip(matching) {
        (0..3).for_each(|k| sum[k] += e * m[k]);
    }
    Xyz(sum).chromaticity()
}

fn peak_nm(curve: &Spectrum) -> f64 {
    let samples = curve.grid().wavelengths_nm().zip(curve.values());
    samples.max_by(|a, b| a.1.total_cmp(b.1)).map_or(0.0, |(nm, _)| nm)
}
