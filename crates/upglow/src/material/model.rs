//! What fluorescence is made of: measured dyes, or bells by formula.

use upglow_color::{Illuminant, MissingUltraviolet};

use crate::material::analytic_model::AnalyticModel;
use crate::material::dye_model::{DyeModel, QuantumYield};
use crate::material::film_model::FilmModel;
use crate::material::formula::Accounting;

/// How the fluorescence of a material is described, and by what rules it re-emits light.
///
/// It is not `#[non_exhaustive]`, nor are [`crate::Fluorescence`], [`crate::Mixing`],
/// [`crate::Accounting`] and [`crate::Interpolation`]: when one is added, the compiler names every
/// place that must handle it, in this workspace and in a renderer.
#[derive(Clone, Debug, PartialEq)]
pub enum Model {
    /// No fluorescence.
    Reflectance,
    /// Two neighbors of a ring of measured dyes.
    Dyes(DyeModel),
    /// Any two of a set of measured dyes, each at an optical density of its own.
    Film(FilmModel),
    /// Absorption and emission by formula.
    Analytic(AnalyticModel),
}

impl Model {
    /// The name that files and options use: `reflectance`, `dyes`, `film` or `analytic`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Reflectance => "reflectance",
            Self::Dyes(_) => "dyes",
            Self::Film(_) => "film",
            Self::Analytic(_) => "analytic",
        }
    }

    /// The measured dyes, if it has any.
    pub fn dyes(&self) -> Option<&DyeModel> {
        match self {
            Self::Dyes(dyes) => Some(dyes),
            Self::Film(film) => Some(film.dyes()),
            Self::Reflectance | Self::Analytic(_) => None,
        }
    }

    /// What is to say about materials of this model under a light: ultraviolet that is not known,
    /// where one of the dyes absorbs it.
    pub fn missing_ultraviolet(&self, light: &Illuminant) -> Option<MissingUltraviolet> {
        light.missing_ultraviolet().filter(|missing| match self {
            Self::Reflectance => false,
            // Bells may lie anywhere.
            Self::Analytic(_) => true,
            Self::Dyes(_) | Self::Film(_) => {
                let curves = self.dyes().into_iter().flat_map(DyeModel::curves);
                let below = missing.wavelengths_nm();
                below.clone().any(|nm| curves.clone().any(|dye| dye.absorption.at(nm) > 0.0))
            }
        })
    }

    /// What is conserved when absorbed light is re-emitted, if any is.
    pub fn accounting(&self) -> Option<Accounting> {
        match self {
            Self::Reflectance => None,
            Self::Analytic(bells) => Some(bells.accounting()),
            Self::Dyes(dyes) => Some(dyes.options().accounting),
            Self::Film(film) => Some(film.accounting()),
        }
    }

    /// The share of absorbed light that is re-emitted, if any is.
    pub fn quantum_yield(&self) -> Option<QuantumYield> {
        match self {
            Self::Reflectance => None,
            Self::Analytic(bells) => Some(QuantumYield::Fixed(bells.quantum_yield())),
            Self::Dyes(dyes) => Some(dyes.options().quantum_yield),
            Self::Film(film) => Some(film.quantum_yield()),
        }
    }
}
