//! One dye of the compact form, and its attributes.

use super::stated::{Stated, wrong};
use crate::exr::attribute::Attribute;
use crate::spectral::attribute_spectrum::print_spectrum;
use crate::spectral::error::FormError;

/// One dye on the bands of a file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CompactDye {
    /// Its name, as in the channel `dye.NAME`.
    pub(crate) name: String,
    /// Share of incident light that it absorbs at concentration 1, in each band, 0..=1.
    pub(super) absorption: Vec<f64>,
    /// Share of what it gives back that leaves in each band; adds up to 1 at most.
    pub(super) emission: Vec<f64>,
    /// Share of absorbed light that comes out, 0..=1.
    pub(super) quantum_yield: f64,
    /// Mean wavelength of the emission, nm.
    pub(super) mean_emission_nm: f64,
}

impl CompactDye {
    /// What a file states of the dye, on these wavelengths.
    pub(super) fn attributes(&self, wavelengths_nm: &[f64]) -> [(String, Attribute); 4] {
        let named = |what: &str, text: String| (dye_attribute(&self.name, what), text.into());
        [
            named("absorption", print_spectrum(wavelengths_nm, &self.absorption)),
            named("emission", print_spectrum(wavelengths_nm, &self.emission)),
            named("quantumYield", self.quantum_yield.to_string()),
            named("meanEmission", self.mean_emission_nm.to_string()),
        ]
    }

    /// The dye of this name, and the wavelengths of its curves, nm.
    pub(super) fn stated(stated: &Stated<'_>, name: &str) -> Result<(Vec<f64>, Self), FormError> {
        /// Longer than any wavelength of light that a picture holds, nm.
        const LONGEST_NM: f64 = 1e6;
        let [absorption, emission, quantum_yield, mean_emission] =
            ["absorption", "emission", "quantumYield", "meanEmission"]
                .map(|what| dye_attribute(name, what));
        let (nm, absorption) = stated.curve(&absorption)?;
        let (other_nm, values) = stated.curve(&emission)?;
        if nm != other_nm {
            return Err(wrong(&emission, "on others", "the absorption's wavelengths"));
        }
        let dye = Self {
            name: name.into(),
            absorption,
            emission: values,
            quantum_yield: stated.number(&quantum_yield, 1.0)?,
            mean_emission_nm: stated.number(&mean_emission, LONGEST_NM)?,
        };
        Ok((nm, dye))
    }
}

/// The attribute that states something of a dye.
pub(super) fn dye_attribute(dye: &str, what: &str) -> String {
    format!("upglow.dye.{dye}.{what}")
}
