//! What fluorescence is made of: measured dyes, or bells by formula.

use crate::material::analytic_model::AnalyticModel;
use crate::material::dye_model::DyeModel;

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
    /// Absorption and emission by formula.
    Analytic(AnalyticModel),
}

impl Model {
    /// The name that files and options use: `reflectance`, `dyes` or `analytic`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Reflectance => "reflectance",
            Self::Dyes(_) => "dyes",
            Self::Analytic(_) => "analytic",
        }
    }
}
