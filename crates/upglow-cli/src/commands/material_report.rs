//! The parameters of one material in reports.

use serde::Serialize;
use upglow::{Fluorescence, Model, Sigmoid};

/// A reflectance by its coefficients, for λ in nm.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct ReflectanceReport {
    #[serde(flatten)]
    pub(super) coefficients: Sigmoid,
    /// The greatest |dr/dλ|, 0 for a flat reflectance, 1/nm.
    pub(super) steepest_per_nm: f64,
}

impl From<Sigmoid> for ReflectanceReport {
    fn from(sigmoid: Sigmoid) -> Self {
        Self {
            coefficients: unsigned_zeros(sigmoid),
            steepest_per_nm: sigmoid.steepest_slope_per_nm(),
        }
    }
}

/// The same coefficients with negative zeros replaced by zeros.
pub(super) fn unsigned_zeros(Sigmoid { c0, c1, c2 }: Sigmoid) -> Sigmoid {
    Sigmoid { c0: c0 + 0.0, c1: c1 + 0.0, c2: c2 + 0.0 }
}

/// The names of the two dyes of a material, the same twice for a film of one dye; `None` if it has no
/// dyes.
pub(super) fn dye_names(fluorescence: Fluorescence, model: &Model) -> Option<[&str; 2]> {
    let numbers = match (fluorescence, model) {
        (Fluorescence::Dyes { first, .. }, Model::Dyes(ring)) => [first, ring.partner(first)],
        (Fluorescence::Film { dyes, .. }, Model::Film(_)) => dyes,
        _ => return None,
    };
    let set = model.dyes()?.set().dyes();
    let [first, second] = numbers.map(|dye| set.get(dye).map(|dye| dye.name.as_str()));
    Some([first?, second?])
}
