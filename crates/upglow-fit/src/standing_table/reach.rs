//! What reflectances and what fluorescent materials show under one contract, and proofs for boxes.

use upglow_color::{
    ColorSolid, ColorSolids, Colorimetry, Contract, Grid, LinearRgb, StandingKind, Xyz,
};

#[derive(Debug)]
pub(super) struct Reach {
    pub(super) colorimetry: Colorimetry,
    pub(super) solids: ColorSolids,
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

impl Reach {
    pub(super) fn new(contract: &Contract) -> Self {
        let colorimetry = contract.on(Grid::FIT);
        let solids = ColorSolids::new(&colorimetry);
        let middle = colorimetry.white() / 2.0;
        Self { colorimetry, solids, middle }
    }

    /// What it takes to show `rgb`, by search.
    pub(super) fn kind(&self, rgb: LinearRgb) -> StandingKind {
        self.solids.kind(self.colorimetry.xyz_from_rgb(rgb))
    }

    /// The color a little further from the middle of both solids: where a solid holds it, it holds
    /// some room around `color`.
    pub(super) fn further_out(&self, color: Xyz) -> Xyz {
        color + WELL_INSIDE * (color - self.middle)
    }
}

/// Whether a plane with this normal of about unit length parts all `points` from `solid`.
pub(super) fn parted(solid: &ColorSolid, normal: [f64; 3], points: &[Xyz]) -> bool {
    let height = |p: Xyz| (0..3).map(|k| normal[k] * p.0[k]).sum::<f64>();
    let surface = height(solid.support(normal));
    points.iter().all(|&point| height(point) - surface > WELL_OUTSIDE)
}
