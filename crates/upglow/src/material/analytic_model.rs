//! Absorption and emission by formula.

use crate::material::bell::Bell;
use crate::material::formula::Accounting;
use crate::material::model_error::{MAX_FWHM_NM, MIN_FWHM_NM, ModelError, check_yield};

/// Absorption and emission as cubic B-splines, placed by the emission's peak and the Stokes shift.
///
/// # Source
///
/// `jung`; its widths are not published, so they are options here.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct AnalyticModel {
    absorption_fwhm_nm: f64,
    emission_fwhm_nm: f64,
    accounting: Accounting,
    quantum_yield: f64,
}

impl Default for AnalyticModel {
    fn default() -> Self {
        Self {
            absorption_fwhm_nm: 50.0,
            emission_fwhm_nm: 45.0,
            accounting: Accounting::Energy,
            quantum_yield: 1.0,
        }
    }
}

impl AnalyticModel {
    /// Smallest and greatest wavelength of the emission's peak, nm.
    pub const EMISSION_PEAKS_NM: [f64; 2] = [400.0, 710.0];
    /// Smallest and greatest distance from the absorption's peak to the emission's, nm.
    pub const STOKES_SHIFTS_NM: [f64; 2] = [10.0, 120.0];

    /// The model with these full widths at half maximum, nm, and rules.
    ///
    /// # Errors
    ///
    /// [`ModelError`] if a width is outside 15 to 80 nm or the quantum yield outside 0 to 1.
    pub fn new(
        absorption_fwhm_nm: f64,
        emission_fwhm_nm: f64,
        accounting: Accounting,
        quantum_yield: f64,
    ) -> Result<Self, ModelError> {
        for found_nm in [absorption_fwhm_nm, emission_fwhm_nm] {
            if !(MIN_FWHM_NM..=MAX_FWHM_NM).contains(&found_nm) {
                return Err(ModelError::Width { found_nm });
            }
        }
        check_yield(quantum_yield)?;
        Ok(Self { absorption_fwhm_nm, emission_fwhm_nm, accounting, quantum_yield })
    }

    /// Full width at half maximum of the absorption, nm.
    pub fn absorption_fwhm_nm(&self) -> f64 {
        self.absorption_fwhm_nm
    }

    /// Full width at half maximum of the emission, nm.
    pub fn emission_fwhm_nm(&self) -> f64 {
        self.emission_fwhm_nm
    }

    /// Energy or photons.
    pub fn accounting(&self) -> Accounting {
        self.accounting
    }

    /// Share of absorbed light that is re-emitted, 0..=1.
    pub fn quantum_yield(&self) -> f64 {
        self.quantum_yield
    }

    /// Absorption around `center_nm` at `lambda_nm`, 0..=1, and its derivative by the center.
    pub fn absorption(&self, center_nm: f64, lambda_nm: f64) -> (f64, f64) {
        Bell::new(center_nm, self.absorption_fwhm_nm).peak_one(lambda_nm)
    }

    /// Emission of unit area around `center_nm` at `lambda_nm`, 1/nm, and its derivative by the
    /// center.
    pub fn emission(&self, center_nm: f64, lambda_nm: f64) -> (f64, f64) {
        Bell::new(center_nm, self.emission_fwhm_nm).area_one(lambda_nm)
    }

    /// The absorption around `center_nm`: a bell with a peak of 1.
    pub(crate) fn absorption_bell(&self, center_nm: f64) -> Bell {
        Bell::new(center_nm, self.absorption_fwhm_nm)
    }

    /// The emission around `center_nm`.
    pub(crate) fn emission_bell(&self, center_nm: f64) -> Bell {
        Bell::new(center_nm, self.emission_fwhm_nm)
    }
}
