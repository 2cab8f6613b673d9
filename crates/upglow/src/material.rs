//! Materials: a reflectance and what fluoresces in it.

pub(crate) mod analytic_model;
pub(crate) mod bell;
pub(crate) mod distribution;
pub(crate) mod dye_model;
pub(crate) mod dye_set;
pub(crate) mod edge;
pub(crate) mod features;
pub(crate) mod film_model;
pub(crate) mod formula;
pub(crate) mod lobe;
pub(crate) mod mixture;
pub(crate) mod model;
pub(crate) mod model_error;
pub(crate) mod model_on_grid;
pub(crate) mod reduced_model;
pub(crate) mod sampling;
pub(crate) mod sigmoid;

use dye_model::DyeModel;
use sigmoid::Sigmoid;

/// One material in at most six numbers, to be read with the [`crate::Model`] it was made for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Material {
    /// Reflectance before the fluorescence absorbs its share.
    pub reflectance: Sigmoid,
    /// What it absorbs and re-emits at other wavelengths.
    pub fluorescence: Fluorescence,
}

/// The fluorescent part of a [`Material`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Fluorescence {
    /// Nothing fluoresces.
    #[default]
    None,
    /// A dye of the model's ring mixed with its neighbor.
    Dyes {
        /// Number of the first dye in the ring.
        first: usize,
        /// Share of the neighbor, 0..=1.
        weight: f64,
        /// Share of the light at the absorption's peak that is absorbed, 0..=1.
        concentration: f64,
    },
    /// Two dyes of the model's set in one film, the denser first; [`Fluorescence::film`] makes it.
    Film {
        /// Numbers of the dyes; the same twice where there is one.
        dyes: [usize; 2],
        /// Optical density of each where its absorption is 1, 0..=6.
        densities: [f64; 2],
    },
    /// Bell-shaped absorption and emission by formula.
    Analytic {
        /// Wavelength of the emission's peak, nm.
        emission_peak_nm: f64,
        /// Distance from the absorption's peak to the emission's, nm.
        stokes_shift_nm: f64,
        /// Share of the light at the absorption's peak that is absorbed, 0..=1.
        concentration: f64,
    },
}

impl Fluorescence {
    /// A film of two dyes by number and optical density: the denser dye first, a dye without density
    /// left out, and nothing where neither has any.
    pub fn film(first: (usize, f64), second: (usize, f64)) -> Self {
        let second_leads = second.1 > first.1 || second.1 == first.1 && second.0 < first.0;
        let (first, second) = if second_leads { (second, first) } else { (first, second) };
        match (first, second) {
            ((_, most), _) if most <= 0.0 => Self::None,
            ((dye, most), (_, least)) if least <= 0.0 => {
                Self::Film { dyes: [dye; 2], densities: [most, 0.0] }
            }
            ((i, a), (j, b)) => Self::Film { dyes: [i, j], densities: [a, b] },
        }
    }

    /// How much of the dyes there is: the sum of a film's optical densities, otherwise the
    /// concentration, 0..=1; 0 where nothing fluoresces.
    pub fn dose(self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Dyes { concentration, .. } | Self::Analytic { concentration, .. } => {
                concentration
            }
            Self::Film { densities: [first, second], .. } => first + second,
        }
    }

    /// The dyes of `model` by number and how much of each there is, which add up to the dose; (0, 0) in
    /// place of a dye that is absent. Bells by formula are none of the model's dyes.
    pub fn dyes(self, model: &DyeModel) -> [(usize, f64); 2] {
        match self {
            Self::None | Self::Analytic { .. } => [(0, 0.0); 2],
            Self::Dyes { first, weight, concentration } => {
                let partner = model.partner(first);
                [(first, concentration * (1.0 - weight)), (partner, concentration * weight)]
            }
            Self::Film { dyes: [i, j], densities: [a, b] } => [(i, a), (j, b)],
        }
    }
}

impl Material {
    /// A material that only reflects.
    pub fn passive(reflectance: Sigmoid) -> Self {
        Self { reflectance, fluorescence: Fluorescence::None }
    }
}
