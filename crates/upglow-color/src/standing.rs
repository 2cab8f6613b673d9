//! Which kind of material can reach a color. The only test of reachability in the workspace.

use std::fmt;

use crate::color_solid::{ColorSolid, Nearest};
use crate::colorimetry::Colorimetry;
use crate::values::Xyz;

/// The kind of material that a color needs. Arrays store it as the number of the variant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum StandingKind {
    /// A reflectance reaches it.
    Reflectance = 0,
    /// No reflectance reaches it, but a fluorescent material does.
    NeedsFluorescence = 1,
    /// No material reaches it.
    Unreachable = 2,
}

/// Which kind of material a color needs, and the nearest colors that materials reach.
///
/// This is the physical limit, not that of a fit. It knows no slope limit and no dyes, so a fit may
/// miss a color that is within reach. And it counts photons: with energy accounting, light that moves
/// to longer wavelengths keeps its energy, which takes more than one photon for each one absorbed, so
/// such a material can reach colors slightly beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Standing {
    /// The kind of material that the color needs.
    pub kind: StandingKind,
    /// The nearest color of a reflectance.
    pub reflectance: Nearest,
    /// The nearest color of any material.
    pub fluorescence: Nearest,
}

/// The colors that materials reach under one light.
#[derive(Clone, Debug)]
#[must_use]
pub struct ColorSolids {
    /// The colors of all reflectances.
    pub reflectance: ColorSolid,
    /// The colors of all materials, fluorescent or not.
    pub fluorescence: ColorSolid,
}

impl Standing {
    /// The nearest color of the solid that the color is outside of: that of all materials if it is
    /// unreachable, else that of reflectances.
    pub fn beyond(&self) -> Nearest {
        match self.kind {
            StandingKind::Reflectance | StandingKind::NeedsFluorescence => self.reflectance,
            StandingKind::Unreachable => self.fluorescence,
        }
    }
}

/// What reaches the color, after "reachable": "by a reflectance".
impl fmt::Display for Standing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Nearest { distance, de2000, .. } = self.beyond();
        let off = format_args!("{distance:.4} away in XYZ, ΔE00 {de2000:.2}");
        match self.kind {
            StandingKind::Reflectance => f.write_str("by a reflectance"),
            StandingKind::NeedsFluorescence => {
                write!(f, "only with fluorescence: the nearest reflectance is {off}")
            }
            StandingKind::Unreachable => write!(f, "by no material: the nearest is {off}"),
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

    /// The kind of material that `color` needs.
    pub fn kind(&self, color: Xyz) -> StandingKind {
        if self.reflectance.contains(color) {
            StandingKind::Reflectance
        } else if self.fluorescence.contains(color) {
            StandingKind::NeedsFluorescence
        } else {
            StandingKind::Unreachable
        }
    }

    /// The kind of material that `color` needs, and the nearest colors that materials reach.
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
    fn grays_black_and_white_need_only_a_reflectance() {
        for v in [0.0, 0.18, 1.0] {
            let standing = standing([v; 3]);
            assert_eq!(standing.kind, StandingKind::Reflectance, "{v}");
            assert_eq!((standing.beyond().distance, standing.beyond().de2000), (0.0, 0.0));
        }
    }

    #[test]
    fn colors_brighter_than_white_need_fluorescence_or_are_unreachable() {
        assert_eq!(standing([1.01; 3]).kind, StandingKind::NeedsFluorescence);
        assert_eq!(standing([9.0; 3]).kind, StandingKind::Unreachable);
    }

    #[test]
    fn colors_outside_have_a_distance() {
        let green = standing([0.0, 1.0, 0.0]);
        assert_eq!(green.kind, StandingKind::Unreachable);
        assert!(green.reflectance.distance > green.fluorescence.distance);
        assert!(green.beyond().distance > 1e-3 && green.beyond().de2000 > 1.0);
        let magenta = standing([0.9, 0.0, 0.9]);
        assert_eq!(magenta.kind, StandingKind::NeedsFluorescence);
        assert!(magenta.beyond().distance > 1e-3 && magenta.fluorescence.distance == 0.0);
    }
}
