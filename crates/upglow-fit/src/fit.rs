//! The material of one color, and what a search for it starts from.

use upglow::{Edge, Fluorescence, Material};
use upglow_color::Lab;

/// The material of one color.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
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

/// A color is matched, and needs no more fluorescence, at this CIEDE2000: a hundredth of what
/// an eye can tell.
pub(crate) const EXACT: f64 = 0.01;

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

/// A material to start from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Start {
    pub(crate) reflectance: Edge,
    pub(crate) fluorescence: Fluorescence,
}

impl From<Fit> for Start {
    fn from(fit: Fit) -> Self {
        Self { reflectance: fit.reflectance, fluorescence: fit.fluorescence }
    }
}
