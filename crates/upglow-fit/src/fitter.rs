//! Fits the material of one color.
use upglow::{Material, Model};
use upglow_color::{Contract, LinearRgb};

use crate::{FitOptions, FitOptionsError};

/// Everything that fits of one contract and model share.
#[derive(Debug)]
pub struct Fitter {}

/// The material of one color.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The material.
    pub material: Material,
    /// CIEDE2000 of the material against the color, under the contract, sums over 5 nm.
    pub de2000: f64,
}

/// Why a color cannot be fitted.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ColorError {
    /// A component is not a number in the range.
    #[error("{channel} is {value}, expected 0 to {}", Fitter::BRIGHTEST)]
    Outside {
        /// red, green or blue.
        channel: &'static str,
        /// The value given.
        value: f64,
    },
}

impl Fitter {
    /// The greatest value of an RGB component: no fluorescent material is ten times white.
    pub const BRIGHTEST: f64 = 10.0;

    /// Prepares fits under a contract, with a model.
    ///
    /// # Errors
    ///
    /// [`FitOptionsError`] if an option is out of range.
    pub fn new(
        _contract: &Contract,
        _model: &Model,
        _options: FitOptions,
    ) -> Result<Self, FitOptionsError> {
        Ok(Self {})
    }

    /// The material of `rgb`, which may be brighter than white.
    ///
    /// # Errors
    ///
    /// [`ColorError`] if a component is not a number in 0..=10.
    pub fn fit(&self, _rgb: LinearRgb) -> Result<Fit, ColorError> {
        Ok(Fit { material: Material::default(), de2000: 0.0 })
    }
}
