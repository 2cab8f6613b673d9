//! What must be agreed before RGB means a color.

use crate::adaptation::Adaptation;
use crate::colorimetry::Colorimetry;
use crate::grid::Grid;
use crate::illuminant::Illuminant;
use crate::observer::Observer;
use crate::rgb_space::RgbSpace;

/// The agreement that turns RGB into a color: nothing in upglow guesses any part of it.
///
/// The default is ACEScg under D65 for the CIE 1931 2° observer, Bradford-adapted.
///
/// # Other observers
///
/// XYZ, whites and Lab are those of the contract's observer. An RGB space is standardized by
/// chromaticities of the CIE 1931 observer only; what another eye sees of a display's primaries would
/// take their spectra, which no standard gives. The space's numbers are therefore kept as they are: its
/// matrix is nominal, and RGB names the color whose tristimulus values *for this observer* are the
/// matrix's. The white of the light is computed for the observer, and adaptation goes from the
/// space's nominal white to it. With [`Adaptation::Bradford`] RGB (1, 1, 1) is thus the perfect
/// diffuser and grays are flat for every observer; with [`Adaptation::None`] they are where the
/// numbers put them.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Contract {
    /// Primaries and white of the RGB numbers.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub space: RgbSpace,
    /// The light that the material is seen under.
    pub illuminant: Illuminant,
    /// The eye that sees it.
    pub observer: Observer,
    /// What happens where the space's white is not the illuminant's.
    pub adaptation: Adaptation,
}

/// Why the parts of a contract do not go together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContractError {
    /// The observer sees nothing of the light.
    #[error(
        "the observer {observer} sees no light of {illuminant} in steps of {step_nm} nm, expected some"
    )]
    Dark {
        /// Name of the observer.
        observer: String,
        /// Name of the light.
        illuminant: String,
        /// Step of the sums, nm.
        step_nm: u32,
    },
    /// Nothing can be compared with the light's white: X, Y or Z of it is zero, or no matrix leads back
    /// from XYZ to RGB.
    #[error("the white of {illuminant} for {observer} is XYZ {white:?}, expected one to adapt to")]
    White {
        /// Name of the observer.
        observer: String,
        /// Name of the light.
        illuminant: String,
        /// X, Y, Z of the white.
        white: [f64; 3],
    },
}

impl Contract {
    /// Whether the parts go together on both grids: the observer sees the light, and colors can be
    /// converted both ways. Contracts of built-in lights and observers always do.
    ///
    /// # Errors
    ///
    /// [`ContractError`] says what does not.
    pub fn check(&self) -> Result<(), ContractError> {
        for grid in [Grid::FIT, Grid::FINE] {
            Colorimetry::try_new(self, grid)?;
        }
        Ok(())
    }

    /// The contract with its sums taken over `grid`.
    ///
    /// # Panics
    ///
    /// If the contract's light or observer is not built in and [`Contract::check`] refuses it.
    pub fn on(&self, grid: Grid) -> Colorimetry {
        Colorimetry::try_new(self, grid).unwrap_or_else(|error| panic!("{error}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::Spectrum;

    #[test]
    fn contracts_of_what_is_built_in_hold() {
        for name in Illuminant::NAMES {
            let illuminant = Illuminant::named(name).unwrap();
            assert_eq!(Contract { illuminant, ..Contract::default() }.check(), Ok(()), "{name}");
        }
    }

    #[test]
    fn a_light_between_the_samples_of_a_sum_is_refused() {
        let illuminant = Illuminant::line("needle", 562.0, 0.01);
        let refused = Contract { illuminant, ..Contract::default() }.check().unwrap_err();
        assert_eq!(
            refused.to_string(),
            "the observer CIE 1931 2° sees no light of needle in steps of 5 nm, expected some"
        );
    }

    #[test]
    fn a_light_without_short_wavelengths_is_no_white() {
        let values =
            Grid::FINE.wavelengths_nm().map(|nm| f64::from(u8::from(nm > 700.0))).collect();
        let red = Illuminant::from_spectrum("red", &Spectrum::new(Grid::FINE, values).unwrap());
        let contract = Contract { illuminant: red.unwrap(), ..Contract::default() };
        let refused = contract.check().unwrap_err().to_string();
        assert!(refused.starts_with("the white of red for CIE 1931 2° is XYZ [2."), "{refused}");
    }

    #[test]
    fn a_lamp_that_an_observer_does_not_see_is_refused() {
        let known = Observer::default();
        let nm: Vec<f64> = (400..=830).map(f64::from).collect();
        let rows: Vec<[f64; 3]> =
            nm.iter().map(|&nm| known.matching().each_ref().map(|m| m.at(nm))).collect();
        let observer = Observer::from_samples("from 400", &nm, &rows).unwrap();
        let illuminant = Illuminant::line("uv", 365.0, 2.0);
        let lit = Contract { illuminant: illuminant.clone(), ..Contract::default() };
        assert_eq!(lit.check(), Ok(()));
        let contract = Contract { illuminant, observer, ..Contract::default() };
        assert!(matches!(contract.check(), Err(ContractError::Dark { step_nm: 5, .. })));
    }
}
