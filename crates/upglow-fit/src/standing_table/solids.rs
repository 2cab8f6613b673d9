//! What reflectances and what fluorescent materials show under one contract, and proofs for boxes.

use upglow_color::{ColorSolid, Colorimetry, Contract, Grid, LinearRgb, Xyz};

use super::StandingKind;
use crate::Standing;

#[derive(Debug)]
pub(super) struct Solids {
    pub(super) colorimetry: Colorimetry,
    pub(super) reflectance: ColorSolid,
    pub(super) fluorescence: ColorSolid,
    /// Half of white, deep inside both solids.
    middle: Xyz,
}

/// Where a whole box is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Side {
    /// All of it inside the solid.
    Inside,
    /// All of it outside.
    Outside,
    /// Neither is proven.
    Unknown,
}

/// A point is well inside if it still is when it moves away from the middle by this share. It must
/// keep proofs far from the 1e-9 in XYZ at which a search stops, or an answer could differ from the
/// search's; a larger one only sends more colors there, and overstates distances by as much.
const WELL_INSIDE: f64 = 1e-6;

/// A box is well outside if a plane parts it from the solid by this much in XYZ; for the same reason.
const WELL_OUTSIDE: f64 = 1e-7;

impl Solids {
    pub(super) fn new(contract: &Contract) -> Self {
        let colorimetry = contract.on(Grid::FIT);
        let reflectance = ColorSolid::reflectance(&colorimetry);
        let fluorescence = ColorSolid::fluorescence(&colorimetry);
        let middle = Xyz(colorimetry.white().0.map(|v| v / 2.0));
        Self { colorimetry, reflectance, fluorescence, middle }
    }

    /// [`Standing::of`], with what the contract has in common for all colors computed once.
    pub(super) fn standing(&self, rgb: LinearRgb) -> Standing {
        let color = self.colorimetry.xyz_from_rgb(rgb);
        if self.reflectance.contains(color) {
            return Standing::Reflectance;
        }
        if self.fluorescence.contains(color) {
            return Standing::NeedsFluorescence { reflectance: self.reflectance.nearest(color) };
        }
        Standing::Unreachable { fluorescence: self.fluorescence.nearest(color) }
    }

    /// The kind of [`Standing::of`], without the distance.
    pub(super) fn kind(&self, rgb: LinearRgb) -> StandingKind {
        let color = self.colorimetry.xyz_from_rgb(rgb);
        if self.reflectance.contains(color) {
            return StandingKind::Reflectance;
        }
        if self.fluorescence.contains(color) {
            return StandingKind::NeedsFluorescence;
        }
        StandingKind::Unreachable
    }

    /// The color a little further from the middle of both solids: where a solid holds it, it holds
    /// some room around `color`.
    pub(super) fn further_out(&self, color: Xyz) -> Xyz {
        let middle = self.middle.0;
        Xyz([0, 1, 2].map(|k| color.0[k] + WELL_INSIDE * (color.0[k] - middle[k])))
    }
}

/// Whether a plane with this normal of about unit length parts all `points` from `solid`.
pub(super) fn parted(solid: &ColorSolid, normal: [f64; 3], points: &[Xyz]) -> bool {
    let height = |p: Xyz| (0..3).map(|k| normal[k] * p.0[k]).sum::<f64>();
    let surface = height(solid.support(normal));
    points.iter().all(|&point| height(point) - surface > WELL_OUTSIDE)
}
