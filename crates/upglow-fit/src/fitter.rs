//! Fits a material to one color.

use std::sync::atomic::Ordering;

use upglow::{Model, ModelOnGrid};
use upglow_color::{Contract, LinearRgb};

use crate::fit::Fit;
use crate::options::{FitOptions, FitOptionsError, Method};
use crate::search::context::Context;
use crate::search::job::Job;
use crate::search::konig2020::Parameters;

/// Fits materials to colors under one contract, with one model.
#[derive(Debug)]
pub struct Fitter {
    pub(crate) context: Context,
    options: FitOptions,
}

/// Why a color cannot be fitted.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ColorError {
    /// A component is out of range or NaN.
    #[error("{channel} is {value}, expected 0 to {}", Fitter::BRIGHTEST)]
    Outside {
        /// red, green or blue.
        channel: &'static str,
        /// The value given.
        value: f64,
    },
}

/// Fits stay below the slope limit by this share of it, so that rounding to single precision, 6e-8, does
/// not exceed it.
const SLOPE_MARGIN: f64 = 1e-6;

impl Fitter {
    /// The greatest RGB component that is fitted: no fluorescent material is ten times as bright as white.
    pub const BRIGHTEST: f64 = 10.0;

    /// Prepares fits under a contract, with a model.
    ///
    /// # Errors
    ///
    /// [`FitOptionsError`] if an option is out of range.
    pub fn new(
        contract: &Contract,
        model: &Model,
        options: FitOptions,
    ) -> Result<Self, FitOptionsError> {
        let slope_limit_per_nm = options.slope_limit_per_nm()? * (1.0 - SLOPE_MARGIN);
        Ok(Self { context: Context::new(contract, model, slope_limit_per_nm), options })
    }

    /// The model and the contract, on the grid of the fit.
    pub fn model(&self) -> &ModelOnGrid {
        &self.context.model
    }

    /// How often residuals and derivatives were evaluated so far, in all fits.
    pub fn evaluations(&self) -> u64 {
        self.context.evaluations.load(Ordering::Relaxed)
    }

    /// The material of `rgb`, which may be brighter than white.
    ///
    /// A reflectance if one matches the color within 0.01 ΔE00; else a match with as little fluorescence
    /// as the color needs; else the nearest material that the search finds.
    ///
    /// # Errors
    ///
    /// [`ColorError`] if a component is not in 0..=10.
    pub fn fit(&self, rgb: LinearRgb) -> Result<Fit, ColorError> {
        for (channel, value) in ["red", "green", "blue"].into_iter().zip(rgb.0) {
            if !(0.0..=Self::BRIGHTEST).contains(&value) {
                return Err(ColorError::Outside { channel, value });
            }
        }
        Ok(self.fit_among(rgb, &[]))
    }

    /// The material of `rgb`, which is in 0..=1, with those of colors around it as starts.
    pub(crate) fn fit_among(&self, rgb: LinearRgb, around: &[Fit]) -> Fit {
        let job = self.job(rgb);
        job.gray().unwrap_or_else(|| match self.options.method {
            Method::Search => job.search(around),
            Method::Exhaustive => job.search_exhaustively(),
            Method::Konig2020 => job.konig2020_first(Parameters::Coefficients),
            Method::Konig2020Features => job.konig2020_first(Parameters::Features),
        })
    }

    /// The best of `known` and of the fits that start from the neighbors' materials.
    pub(crate) fn improve(&self, rgb: LinearRgb, known: Fit, neighbors: &[Fit]) -> Fit {
        let job = self.job(rgb);
        match self.options.method {
            Method::Search | Method::Exhaustive => job.improve(known, neighbors),
            Method::Konig2020 => job.konig2020_again(Parameters::Coefficients, known, neighbors),
            Method::Konig2020Features => {
                job.konig2020_again(Parameters::Features, known, neighbors)
            }
        }
    }

    fn job(&self, rgb: LinearRgb) -> Job<'_> {
        let colorimetry = self.model().colorimetry();
        let goal = self.options.metric.goal(colorimetry, colorimetry.xyz_from_rgb(rgb));
        Job { context: &self.context, goal }
    }
}
