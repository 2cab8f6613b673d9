//! What defines which color an RGB triple is.

use crate::adaptation::Adaptation;
use crate::colorimetry::{Colorimetry, LEAST_SHARE};
use crate::grid::Grid;
use crate::illuminant::Illuminant;
use crate::matrix::Matrix3;
use crate::observer::Observer;
use crate::rgb_space::RgbSpace;
use crate::values::Xyz;

/// What defines which color an RGB triple is. No part of it is guessed.
///
/// The default is ACEScg under D65 for the CIE 1931 2° observer with Bradford adaptation.
///
/// # Other observers
///
/// XYZ, whites and Lab are those of the contract's observer. Standards define RGB spaces by
/// chromaticities for the CIE 1931 observer only; to convert them to another observer would take the
/// spectra of the primaries, which no standard gives. The chromaticities are therefore used unchanged
/// for every observer: RGB means the color whose tristimulus values *for this observer* are the
/// space's matrix times RGB. The white of the light is computed for the observer, and adaptation goes
/// from the space's nominal white to it. With [`Adaptation::Bradford`] RGB (1, 1, 1) is therefore the
/// perfect diffuser, and grays are flat, for every observer; with [`Adaptation::None`] they may not be.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Contract {
    /// Primaries and white of RGB.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub space: RgbSpace,
    /// The light that the material is seen under.
    pub illuminant: Illuminant,
    /// Whose color vision counts.
    pub observer: Observer,
    /// What happens where the space's white is not the illuminant's.
    pub adaptation: Adaptation,
}

/// Why a contract is rejected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContractError {
    /// The observer does not see the light.
    #[error(
        "the observer {observer} sees nothing of the light {illuminant} in sums over {step_nm} nm, expected Y > 0"
    )]
    Dark {
        /// Name of the observer.
        observer: String,
        /// Name of the light.
        illuminant: String,
        /// Step of the sums, nm.
        step_nm: u32,
    },
    /// Nearly all of the light is invisible to the observer.
    #[error(
        "the observer {observer} sees {share:e} of the power of the light {illuminant}, expected at least {LEAST_SHARE:e}"
    )]
    Dim {
        /// Name of the observer.
        observer: String,
        /// Name of the light.
        illuminant: String,
        /// Luminance over the power of all wavelengths, where it would be 1 at the peak of ȳ.
        share: f64,
    },
    /// Colors cannot be adapted to the light's white: its X or Z is nearly zero or too great, or the
    /// matrix from RGB to XYZ has no inverse.
    #[error(
        "the white of {illuminant} for {observer} is XYZ {white:?}, expected X and Z from {LEAST_SHARE:e} to {:e}",
        LEAST_SHARE.recip()
    )]
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
    /// Checks on both grids that the observer sees the light and that colors can be converted in both
    /// directions. Contracts of built-in lights and observers always pass.
    ///
    /// # Errors
    ///
    /// [`ContractError`] if one of these fails.
    pub fn check(&self) -> Result<(), ContractError> {
        for grid in [Grid::FIT, Grid::FINE] {
            Colorimetry::try_new(self, grid)?;
        }
        Ok(())
    }

    /// White, matrices and weights of the contract by sums over `grid`.
    ///
    /// # Panics
    ///
    /// If [`Contract::check`] fails, which it can only for lights and observers that are not built in.
    pub fn on(&self, grid: Grid) -> Colorimetry {
        Colorimetry::try_new(self, grid).unwrap_or_else(|error| panic!("{error}"))
    }

    /// How a material of this contract looks under another light, by sums over `grid`.
    ///
    /// # Panics
    ///
    /// If [`Contract::check`] fails.
    #[must_use]
    pub fn seen_under(&self, light: &Illuminant, grid: Grid) -> SeenUnder {
        let own = self.on(grid);
        let relit = own.relit(&self.observer, light);
        let contract = Self { illuminant: light.clone(), ..self.clone() };
        match Colorimetry::try_new(&contract, grid) {
            Ok(colorimetry) if relit.white().0[1] >= DARK => {
                SeenUnder { white: colorimetry.white(), colorimetry, is_adapted: true }
            }
            _ => SeenUnder { white: own.white(), colorimetry: relit, is_adapted: false },
        }
    }
}

/// A light under which white is darker than this beside equally powerful light of the contract is no
/// light to see by. Ultraviolet lamps are far below (365 nm: 6e-5), all lamps for rooms far above.
pub(crate) const DARK: f64 = 0.01;

/// How materials look under a light.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenUnder {
    /// Weights of the light, and the matrices of the contract's RGB. If the observer is adapted to the
    /// light, its white has Y = 1; otherwise it is [`Colorimetry::relit`].
    pub colorimetry: Colorimetry,
    /// What the observer sees as white: the perfect diffuser under the light, or under the contract's
    /// own if nobody could adapt to a light that is nearly invisible.
    pub white: Xyz,
    /// Whether this is the white of the light itself.
    pub is_adapted: bool,
}

impl SeenUnder {
    /// The matrix from colors under this light to the colors that look like them under the light of `own`: both
    /// relative to what the observer sees as white, by Bradford's adaptation.
    pub fn own_from_seen(&self, own: &Colorimetry) -> Matrix3 {
        Adaptation::Bradford.target_from_source(self.white, own.white())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::Spectrum;

    #[test]
    fn every_built_in_light_and_observer_make_a_valid_contract() {
        let pairs = |name| Observer::NAMES.map(|observer| (name, observer));
        for (light, observer) in Illuminant::names().into_iter().flat_map(pairs) {
            let illuminant = Illuminant::named(light).unwrap();
            let seen_by = Observer::named(observer).unwrap();
            let contract = Contract { illuminant, observer: seen_by, ..Contract::default() };
            assert_eq!(contract.check(), Ok(()), "{light} {observer}");
        }
    }

    #[test]
    fn the_observer_adapts_to_lights_of_rooms_and_not_to_ultraviolet_lamps() {
        let contract = Contract::default();
        let own = contract.on(Grid::FIT);
        for name in Illuminant::names() {
            let light = Illuminant::named(name).unwrap();
            let seen = contract.seen_under(&light, Grid::FIT);
            assert!(seen.is_adapted && seen.white.0[1] == seen.colorimetry.white().0[1], "{name}");
        }
        for (peak_nm, is_adapted) in [(365.0, false), (405.0, false), (589.0, true)] {
            let light = Illuminant::line("lamp", peak_nm, 2.0).unwrap();
            let seen = contract.seen_under(&light, Grid::FIT);
            assert_eq!(seen.is_adapted, is_adapted, "{peak_nm} {:?}", seen.colorimetry.white());
            assert_eq!(seen.white == own.white(), !is_adapted);
        }
    }

    #[test]
    fn a_line_between_the_samples_of_a_sum_has_the_same_white_in_all_sums() {
        // Sums over 5 nm see the line at its center of power, those over 1 nm as well.
        const ROUNDING: f64 = 1e-12;
        for (peak_nm, fwhm_nm) in [(562.0, 0.01), (546.1, 0.5), (577.9, 1.5)] {
            let illuminant = Illuminant::line("needle", peak_nm, fwhm_nm).unwrap();
            let contract = Contract { illuminant, ..Contract::default() };
            assert_eq!(contract.check(), Ok(()));
            let [fit, fine] = [Grid::FIT, Grid::FINE].map(|grid| contract.on(grid).white().0);
            assert!((0..3).all(|k| (fit[k] - fine[k]).abs() < ROUNDING), "{fit:?} {fine:?}");
        }
    }

    #[test]
    fn a_light_that_is_nearly_all_ultraviolet_is_refused() {
        let lamp = |share: f64| {
            let power = |nm: f64| if nm < 360.0 { 1.0 } else { share };
            let values = Grid::FINE.wavelengths_nm().map(power).collect();
            let power = Spectrum::new(Grid::FINE, values).unwrap();
            let illuminant = Illuminant::from_spectrum("lamp", &power).unwrap();
            Contract { illuminant, ..Contract::default() }.check()
        };
        assert_eq!(lamp(1e-9), Ok(()));
        assert!(matches!(lamp(1e-14), Err(ContractError::Dim { .. })));
    }

    #[test]
    fn a_light_without_short_wavelengths_is_refused() {
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
        let illuminant = Illuminant::line("uv", 365.0, 2.0).unwrap();
        let lit = Contract { illuminant: illuminant.clone(), ..Contract::default() };
        assert_eq!(lit.check(), Ok(()));
        let contract = Contract { illuminant, observer, ..Contract::default() };
        assert!(matches!(contract.check(), Err(ContractError::Dark { step_nm: 5, .. })));
    }
}
