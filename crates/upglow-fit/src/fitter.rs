//! Fits the material of one color.

use std::sync::atomic::{AtomicU64, Ordering};

use upglow::{Edge, Fluorescence, Material, Model, ModelOnGrid};
use upglow_color::{Contract, Grid, Lab, LinearRgb, Xyz};

use crate::job::Job;
use crate::konig2020::Parameters;
use crate::problem::Shape;
use crate::starts::StartTable;
use crate::sums::{CLEAR, Lanes, Sums, lanes_from};
use crate::{FitOptions, FitOptionsError, Method};

/// Everything that fits under one contract, with one model, share.
#[derive(Debug)]
pub struct Fitter {
    pub(crate) model: ModelOnGrid,
    pub(crate) slope_limit_per_nm: f64,
    pub(crate) sums: Sums,
    pub(crate) starts: StartTable,
    pub(crate) dye_lanes: Vec<Lanes>,
    options: FitOptions,
    evaluations: AtomicU64,
}

/// The material of one color.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The reflectance, by its steepest point.
    pub reflectance: Edge,
    /// The fluorescence.
    pub fluorescence: Fluorescence,
    /// Distance from the color by the metric of the fit.
    pub distance: f64,
    /// CIEDE2000 of the material against the color, under the contract, sums over 5 nm.
    pub de2000: f64,
    /// CIELAB of the material under the contract, sums over 5 nm.
    pub lab: Lab,
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

/// A color is matched, and needs no more fluorescence, at this CIEDE2000: a hundredth of what
/// an eye can tell.
pub(crate) const EXACT: f64 = 0.01;

/// Single precision rounds a slope by 6e-8 of itself; fits stay below the limit by more.
const SLOPE_MARGIN: f64 = 1e-6;

impl Fit {
    /// Whether an eye sees no difference at all from the color.
    pub(crate) fn is_matched(&self) -> bool {
        self.de2000 <= EXACT
    }

    /// The material.
    pub fn material(&self) -> Material {
        Material { reflectance: self.reflectance.to_sigmoid(), fluorescence: self.fluorescence }
    }
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
        contract: &Contract,
        model: &Model,
        options: FitOptions,
    ) -> Result<Self, FitOptionsError> {
        let slope_limit_per_nm = options.slope_limit_per_nm()? * (1.0 - SLOPE_MARGIN);
        let model = ModelOnGrid::new(model, &contract.on(Grid::FIT));
        let sums = Sums::new(&model);
        let starts = StartTable::new(&model, &sums, slope_limit_per_nm);
        let dyes = match model.model() {
            Model::Dyes(dyes) => dyes.curves().len(),
            _ => 0,
        };
        let dye_lanes = (0..dyes).map(|dye| sums.lanes(model.dye_absorption(dye))).collect();
        let evaluations = AtomicU64::new(0);
        Ok(Self { model, slope_limit_per_nm, sums, starts, dye_lanes, options, evaluations })
    }

    /// The model and the contract, on the grid of the fit.
    pub fn model(&self) -> &ModelOnGrid {
        &self.model
    }

    /// How often residuals and derivatives were evaluated so far, in all fits.
    pub fn evaluations(&self) -> u64 {
        self.evaluations.load(Ordering::Relaxed)
    }

    /// The color of a material, by the sums of the fit.
    pub(crate) fn color(&self, reflectance: Edge, fluorescence: Fluorescence) -> Xyz {
        let parabola = Shape::Free.numbers(reflectance);
        let (absorbed, emitted) = match (fluorescence, self.model.model()) {
            (Fluorescence::Dyes { first, weight, concentration: c }, Model::Dyes(dyes)) => {
                let [a, b] = [first, dyes.partner(first)].map(|dye| &self.dye_lanes[dye]);
                let absorbed = lanes_from(|i| c * ((1.0 - weight) * a[i] + weight * b[i]));
                (absorbed, self.model.emitted_by_dyes(dyes, first, weight).color)
            }
            (
                Fluorescence::Analytic { emission_peak_nm, stokes_shift_nm, concentration: c },
                Model::Analytic(bells),
            ) => {
                let center_nm = emission_peak_nm - stokes_shift_nm;
                let [a, _] = self.sums.sample(|nm| bells.absorption(center_nm, nm));
                let emitted = self.model.emitted_by_bells(bells, emission_peak_nm, stokes_shift_nm);
                (lanes_from(|i| c * a[i]), emitted.color)
            }
            _ => (CLEAR, [0.0; 3]),
        };
        let reflected = self.sums.reflect(parabola, &absorbed, []).color;
        let c = fluorescence.concentration();
        Xyz([0, 1, 2].map(|k| reflected[k] + c * emitted[k]))
    }

    pub(crate) fn count(&self, evaluations: usize) {
        self.evaluations.fetch_add(evaluations as u64, Ordering::Relaxed);
    }

    /// The material of `rgb`, which may be brighter than white.
    ///
    /// Reflectance alone where that shows the color within 0.01 ΔE00; else with as little
    /// fluorescence as the color needs; else the nearest material that the search finds.
    ///
    /// # Errors
    ///
    /// [`ColorError`] if a component is not a number in 0..=10.
    pub fn fit(&self, rgb: LinearRgb) -> Result<Fit, ColorError> {
        for (channel, value) in ["red", "green", "blue"].into_iter().zip(rgb.0) {
            if !(0.0..=Self::BRIGHTEST).contains(&value) {
                return Err(ColorError::Outside { channel, value });
            }
        }
        Ok(self.fit_among(rgb, &[]))
    }

    /// The material of `rgb`, which is in 0..=1, found from those of colors around it.
    pub(crate) fn fit_among(&self, rgb: LinearRgb, around: &[Fit]) -> Fit {
        let job = self.job(self.model.colorimetry().xyz_from_rgb(rgb));
        job.gray().unwrap_or_else(|| match self.options.method {
            Method::Search => job.search(around),
            Method::Exhaustive => job.search_exhaustively(),
            Method::Konig2020 => job.konig2020_first(Parameters::Coefficients),
            Method::Konig2020Features => job.konig2020_first(Parameters::Features),
        })
    }

    /// The best of `known` and of what the materials of neighbors lead to.
    pub(crate) fn improve(&self, rgb: LinearRgb, known: Fit, neighbors: &[Fit]) -> Fit {
        let job = self.job(self.model.colorimetry().xyz_from_rgb(rgb));
        match self.options.method {
            Method::Search | Method::Exhaustive => job.improve(known, neighbors),
            Method::Konig2020 => job.konig2020_again(Parameters::Coefficients, known, neighbors),
            Method::Konig2020Features => {
                job.konig2020_again(Parameters::Features, known, neighbors)
            }
        }
    }

    fn job(&self, color: Xyz) -> Job<'_> {
        Job { fitter: self, goal: self.options.metric.goal(self.model.colorimetry(), color) }
    }
}
