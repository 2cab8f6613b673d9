//! Why a color has the material it has: what physics allows, the direct fit, and the nearest reflectance.

use serde::{Deserialize, Serialize};
use upglow::{Cube, Mixture, Model, ModelOnGrid};
use upglow_color::{Choice as _, Colorimetry, Grid, Nearest, StandingKind, Xyz};
use upglow_fit::{Fit, FitOptions, Fitter, MaterialKind, StandingTable};

use super::answer::Refusal;
use crate::borders::{all_colors, passive_fitter};
use crate::sampled::Sampled;

/// A color beside a cube.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Question {
    pub(super) cube: u32,
    xyz: [f64; 3],
}

/// Beyond this nothing is a color of a material.
const BRIGHTEST_XYZ: f64 = 100.0;

#[derive(Debug, Serialize)]
pub(super) struct Explanation {
    standing: &'static str,
    sentence: String,
    /// The nearest color of a reflectance.
    reflectance: NearestColor,
    /// The nearest color of any material.
    material: NearestColor,
    /// The material that the cube's options give to exactly this color.
    fitted: Option<Fitted>,
    /// Why `fitted` is null.
    fitted_refusal: Option<String>,
    /// The nearest reflectance within the cube's slope limit.
    passive: Option<Fitted>,
    /// Why `passive` is null.
    passive_refusal: Option<String>,
}

#[derive(Debug, Serialize)]
struct NearestColor {
    xyz: Xyz,
    de2000: f64,
    distance: f64,
}

#[derive(Debug, Serialize)]
struct Fitted {
    #[serde(flatten)]
    sampled: Sampled,
    xyz: Xyz,
    de2000: f64,
    kind: &'static str,
    kind_text: &'static str,
}

/// Explains colors beside one cube.
#[derive(Debug)]
pub(super) struct Explainer {
    table: StandingTable,
    fitter: Fitter,
    passive: Fitter,
    /// In the space of `passive`.
    passive_sums: ModelOnGrid,
}

impl Explainer {
    pub(super) fn new(cube: &Cube) -> Result<Self, String> {
        let contract = cube.contract();
        let refused = |error: &dyn std::error::Error| error.to_string();
        let options = FitOptions::try_from(cube.fit()).map_err(|error| refused(&error))?;
        let fitter =
            Fitter::new(contract, cube.model(), options).map_err(|error| refused(&error))?;
        let wide = all_colors(contract);
        let passive =
            passive_fitter(&wide, cube.fit().slope_max_per_nm).map_err(|error| refused(&error))?;
        let passive_sums = ModelOnGrid::new(&Model::Reflectance, &wide.on(Grid::FIT));
        Ok(Self { table: StandingTable::new(contract), fitter, passive, passive_sums })
    }

    pub(super) fn explain(&self, cube: &Cube, question: &Question) -> Result<Explanation, Refusal> {
        let is_possible = |v: &f64| (-BRIGHTEST_XYZ..=BRIGHTEST_XYZ).contains(v);
        if let Some(found) = question.xyz.iter().find(|v| !is_possible(v)) {
            let error = format!("xyz: {found}, expected -{BRIGHTEST_XYZ} to {BRIGHTEST_XYZ}");
            return Err(Refusal::bad(error));
        }
        let xyz = Xyz(question.xyz);
        let standing = self.table.standing(self.table.colorimetry().rgb_from_xyz(xyz));
        let fitted = self.fitted(cube, xyz);
        let passive = self.passive(cube, xyz);
        Ok(Explanation {
            standing: match standing.kind {
                StandingKind::Reflectance => "reflectance",
                StandingKind::NeedsFluorescence => "needs_fluorescence",
                StandingKind::Unreachable => "unreachable",
            },
            sentence: format!("Reachable {standing}."),
            reflectance: standing.reflectance.into(),
            material: standing.fluorescence.into(),
            fitted_refusal: fitted.as_ref().err().cloned(),
            fitted: fitted.ok(),
            passive_refusal: passive.as_ref().err().cloned(),
            passive: passive.ok(),
        })
    }

    fn fitted(&self, cube: &Cube, xyz: Xyz) -> Result<Fitted, String> {
        let fit = fit(&self.fitter, self.fitter.model().colorimetry(), xyz)?;
        Ok(Fitted::new(fit, self.fitter.model(), cube, "fitted directly"))
    }

    fn passive(&self, cube: &Cube, xyz: Xyz) -> Result<Fitted, String> {
        let fit = fit(&self.passive, self.passive_sums.colorimetry(), xyz)?;
        Ok(Fitted::new(fit, &self.passive_sums, cube, "nearest reflectance"))
    }
}

fn fit(fitter: &Fitter, colorimetry: &Colorimetry, xyz: Xyz) -> Result<Fit, String> {
    let rgb = colorimetry.rgb_from_xyz(xyz);
    // What conversion leaves of 0.
    let rgb = rgb.0.map(|v| if v.abs() < ROUNDING { 0.0 } else { v });
    fitter.fit(upglow_color::LinearRgb(rgb)).map_err(|error| error.to_string())
}

/// Components of XYZ come as printed by the page, from RGB and back.
const ROUNDING: f64 = 1e-9;

impl Fitted {
    fn new(fit: Fit, sums: &ModelOnGrid, cube: &Cube, label: &str) -> Self {
        let mixture = Mixture::of(sums.model(), fit.material());
        let kind = MaterialKind::of_fit(&fit, cube.fit());
        Self {
            sampled: Sampled::of(&mixture, &cube.contract().observer, label),
            xyz: mixture.color(sums),
            de2000: fit.de2000,
            kind: kind.name(),
            kind_text: kind.label(),
        }
    }
}

impl From<Nearest> for NearestColor {
    fn from(Nearest { color, de2000, distance, .. }: Nearest) -> Self {
        Self { xyz: color, de2000, distance }
    }
}
