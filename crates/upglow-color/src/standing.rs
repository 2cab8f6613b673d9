//! Where a color stands among those that materials can show: the one test of what is reachable.

use crate::color_solid::{ColorSolid, Nearest};
use crate::colorimetry::Colorimetry;
use crate::values::Xyz;

/// The least that it takes to show a color. The numbers of the variants are those of arrays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum StandingKind {
    /// Some reflectance shows it.
    Reflectance = 0,
    /// No reflectance shows it, some fluorescent material does.
    NeedsFluorescence = 1,
    /// No material shows it.
    Unreachable = 2,
}

/// Where a color stands, and the nearest colors that materials show.
///
/// This is the limit of physics, not of a fit. The solids behind it hold materials that no one can
/// make: they know no slope limit and no dyes, so a fit may miss a color that stands inside. And
/// they count photons: a model with energy accounting lets absorbed light keep its energy when it
/// moves to longer waves, more than a photon for a photon, so such a material can show colors a
/// little outside.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Standing {
    /// What it takes to show the color.
    pub kind: StandingKind,
    /// The nearest color that a reflectance shows.
    pub reflectance: Nearest,
    /// The nearest color that any material shows.
    pub fluorescence: Nearest,
}

/// What reflectances and what fluorescent materials show under one light.
#[derive(Clone, Debug)]
#[must_use]
pub struct ColorSolids {
    /// The colors of all reflectances.
    pub reflectance: ColorSolid,
    /// The colors of all materials, fluorescent or not.
    pub fluorescence: ColorSolid,
}

impl Standing {
    /// How far the color is from what it is beyond: from any material if it is unreachable, else
    /// from a reflectance.
    pub fn beyond(&self) -> Nearest {
        match self.kind {
            StandingKind::Reflectance | StandingKind::NeedsFluorescence => self.reflectance,
            StandingKind::Unreachable => self.fluorescence,
        }
    }
}

impl ColorSolids {
    /// The solids of a light and an observer.
    ///
    /// # Examples
    ///
    /// ```
    /// use upglow_color::{ColorSolids, Contract, Grid, LinearRgb, StandingKind};
    ///
    /// let colorimetry = Contract::default().on(Grid::FIT);
    /// let solids = ColorSolids::new(&colorimetry);
    /// let standing = |rgb| solids.standing(colorimetry.xyz_from_rgb(LinearRgb(rgb)));
    /// assert_eq!(standing([0.5, 0.4, 0.3]).kind, StandingKind::Reflectance);
    /// assert_eq!(standing([0.9, 0.0, 0.9]).kind, StandingKind::NeedsFluorescence);
    /// assert!(standing([0.0, 1.0, 0.0]).fluorescence.de2000 > 1.0);
    /// ```
    pub fn new(colorimetry: &Colorimetry) -> Self {
        Self {
            reflectance: ColorSolid::reflectance(colorimetry),
            fluorescence: ColorSolid::fluorescence(colorimetry),
        }
    }

    /// What it takes to show `color`.
    pub fn kind(&self, color: Xyz) -> StandingKind {
        if self.reflectance.contains(color) {
            StandingKind::Reflectance
        } else if self.fluorescence.contains(color) {
            StandingKind::NeedsFluorescence
        } else {
            StandingKind::Unreachable
        }
    }

    /// What it takes to show `color`, and how far it is beyond.
    pub fn standing(&self, color: Xyz) -> Standing {
        self.standing_of_kind(color, self.kind(color))
    }

    /// [`ColorSolids::standing`] of a color whose kind is known.
    pub fn standing_of_kind(&self, color: Xyz, kind: StandingKind) -> Standing {
        let nearest = |solid: &ColorSolid, first_beyond| {
            if kind >= first_beyond { solid.nearest(color) } else { Nearest::itself(color) }
        };
        Standing {
            kind,
            reflectance: nearest(&self.reflectance, StandingKind::NeedsFluorescence),
            fluorescence: nearest(&self.fluorescence, StandingKind::Unreachable),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contract::Contract;
    use crate::grid::Grid;
    use crate::values::LinearRgb;

    fn standing(rgb: [f64; 3]) -> Standing {
        let colorimetry = Contract::default().on(Grid::FIT);
        ColorSolids::new(&colorimetry).standing(colorimetry.xyz_from_rgb(LinearRgb(rgb)))
    }

    #[test]
    fn grays_black_and_white_are_reflectances() {
        for v in [0.0, 0.18, 1.0] {
            let standing = standing([v; 3]);
            assert_eq!(standing.kind, StandingKind::Reflectance, "{v}");
            assert_eq!((standing.beyond().distance, standing.beyond().de2000), (0.0, 0.0));
        }
    }

    #[test]
    fn brighter_than_white_takes_fluorescence_or_is_out_of_reach() {
        assert_eq!(standing([1.01; 3]).kind, StandingKind::NeedsFluorescence);
        assert_eq!(standing([9.0; 3]).kind, StandingKind::Unreachable);
    }

    #[test]
    fn what_lies_outside_has_its_distance() {
        let green = standing([0.0, 1.0, 0.0]);
        assert_eq!(green.kind, StandingKind::Unreachable);
        assert!(green.reflectance.distance > green.fluorescence.distance);
        assert!(green.beyond().distance > 1e-3 && green.beyond().de2000 > 1.0);
        let magenta = standing([0.9, 0.0, 0.9]);
        assert_eq!(magenta.kind, StandingKind::NeedsFluorescence);
        assert!(magenta.beyond().distance > 1e-3 && magenta.fluorescence.distance == 0.0);
    }
}
