//! One dye of the compact form, and its attributes.

use upglow_color::DonaldsonMatrix;

use crate::exr::attribute::{Attribute, Attributes};
use crate::spectral::attribute_spectrum::{parse_spectrum, print_spectrum};
use crate::spectral::error::FormError;
use crate::spectral::stated::stated;

/// One dye on the bands of a file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CompactDye {
    /// Its name, as in the channel `dye.NAME`.
    pub(crate) name: String,
    /// Share of incident light that it absorbs at concentration 1, in each band, 0..=1.
    pub(super) absorption: Vec<f64>,
    /// Share of the re-emitted light that leaves in each band; the sum is at most 1.
    pub(super) emission: Vec<f64>,
    /// Share of the absorbed light that is re-emitted, 0..=1.
    pub(super) quantum_yield: f64,
    /// Mean wavelength of the emission, nm.
    pub(super) mean_emission_nm: f64,
}

impl CompactDye {
    /// The attributes of the dye, with curves on these wavelengths.
    pub(super) fn attributes(&self, wavelengths_nm: &[f64]) -> [(String, Attribute); 4] {
        let named = |what: &str, text: String| (dye_attribute(&self.name, what), text.into());
        [
            named("absorption", print_spectrum(wavelengths_nm, &self.absorption)),
            named("emission", print_spectrum(wavelengths_nm, &self.emission)),
            named("quantumYield", self.quantum_yield.to_string()),
            named("meanEmission", self.mean_emission_nm.to_string()),
        ]
    }

    /// Reads the dye of this name, whose curves must have these wavelengths.
    pub(super) fn stated(
        attributes: &Attributes,
        name: &str,
        wavelengths_nm: &[f64],
    ) -> Result<Self, FormError> {
        /// Longer than any wavelength of light in pictures, nm.
        const LONGEST_NM: f64 = 1e6;
        let number = |what: &str, most: f64| {
            let expected = format!("a number from 0 to {most}");
            let parse = |text: &str| text.parse().ok().filter(|v: &f64| (0.0..=most).contains(v));
            stated(attributes, &dye_attribute(name, what), &expected, parse)
        };
        let values = |what: &str| {
            curve(attributes, name, what, Some(wavelengths_nm)).map(|(_, values)| values)
        };
        Ok(Self {
            name: name.into(),
            absorption: values("absorption")?,
            emission: values("emission")?,
            quantum_yield: number("quantumYield", 1.0)?,
            mean_emission_nm: number("meanEmission", LONGEST_NM)?,
        })
    }
}

/// Wavelengths, nm, and values, 0..=1, of a curve of a dye. The wavelengths must be the given ones.
pub(super) fn curve(
    attributes: &Attributes,
    dye: &str,
    what: &str,
    wavelengths_nm: Option<&[f64]>,
) -> Result<(Vec<f64>, Vec<f64>), FormError> {
    const EXPECTED: &str = "numbers from 0 to 1 as 400nm:0.5;410nm:0.6, with ascending wavelengths, \
                            at most 1001, the same in all curves";
    stated(attributes, &dye_attribute(dye, what), EXPECTED, |text| {
        parse_spectrum(text).filter(|(nm, values)| {
            nm.len() <= DonaldsonMatrix::MOST_WAVELENGTHS
                && nm.is_sorted_by(|a, b| a < b)
                && wavelengths_nm.is_none_or(|expected| nm == expected)
                && values.iter().all(|v| (0.0..=1.0).contains(v))
        })
    })
}

/// The name of an attribute of a dye.
pub(super) fn dye_attribute(dye: &str, what: &str) -> String {
    format!("upglow.dye.{dye}.{what}")
}
