//! Why a model of fluorescence cannot be made.

use crate::material::dye_model::DyeModel;

/// Why a model cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The quantum yield is not a fraction.
    #[error("quantum yield {found}, expected 0 to 1")]
    QuantumYield {
        /// The number given.
        found: f64,
    },
    /// The optical density is not above 0, or too great.
    #[error("optical density {found}, expected > 0 and at most {most}", most = DyeModel::MOST_DENSE)]
    OpticalDensity {
        /// The number given.
        found: f64,
    },
    /// A width of the analytic model is out of range.
    #[error("width {found_nm} nm, expected {MIN_FWHM_NM} to {MAX_FWHM_NM} nm")]
    Width {
        /// The width given, nm.
        found_nm: f64,
    },
}

/// Below this a bell falls between the samples of a 5 nm sum.
pub(crate) const MIN_FWHM_NM: f64 = 15.0;
/// Above this an emission at [`crate::AnalyticModel::EMISSION_PEAKS_NM`] leaves the range of the
/// tables.
pub(crate) const MAX_FWHM_NM: f64 = 80.0;

pub(crate) fn check_yield(found: f64) -> Result<(), ModelError> {
    if (0.0..=1.0).contains(&found) { Ok(()) } else { Err(ModelError::QuantumYield { found }) }
}
