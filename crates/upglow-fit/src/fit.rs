//! The material of one color, and what a search for it starts from.

use upglow::{Edge, Fluorescence, Material};
use upglow_color::Lab;

use crate::cube::CubeSummary;

/// The material of one color, and how well it matches.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Fit {
    /// The reflectance, given by its steepest point.
    pub reflectance: Edge,
    /// The fluorescence.
    pub fluorescence: Fluorescence,
    /// Distance from the target by the metric of the fit.
    pub distance: f64,
    /// CIEDE2000 from the target under the contract, by sums over 5 nm.
    pub de2000: f64,
    /// CIELAB of the material under the contract, by sums over 5 nm.
    pub lab: Lab,
}

/// A fit within this CIEDE2000 matches its color and gets no more fluorescence: a hundredth of a
/// visible difference.
pub(crate) const EXACT: f64 = CubeSummary::EXACT_DE2000;

impl Fit {
    /// Whether the material matches its color.
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

/// The better of two fits: a match before a miss, of two matches the one with less dose, of two misses
/// the nearer; the first where they are equal.
pub(crate) fn better(known: Option<Fit>, found: Fit) -> Fit {
    known.filter(|known| key(known) <= key(&found)).unwrap_or(found)
}

/// What makes a fit better; less is better.
pub(crate) fn key(fit: &Fit) -> (bool, f64) {
    let is_missed = !fit.is_matched();
    (is_missed, if is_missed { fit.distance } else { fit.fluorescence.dose() })
}
