//! Where a color stands: what kind of material can show it at all.

use upglow_color::{ColorSolid, Contract, Grid, LinearRgb, Nearest};

/// The least that it takes to show a color under a contract's light.
///
/// This is the limit of physics, not of a fit. The solids behind it hold materials that no one can
/// make: they know no slope limit and no dyes, so a fit may miss a color that stands inside. And
/// they count photons: a model with energy accounting lets absorbed light keep its energy when it
/// moves to longer waves, more than a photon for a photon, so such a material can show colors a
/// little outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Standing {
    /// Some reflectance shows it.
    Reflectance,
    /// No reflectance shows it, some fluorescent material does.
    NeedsFluorescence {
        /// The nearest color of a reflectance, and how far it is in XYZ.
        reflectance: Nearest,
    },
    /// No material shows it.
    Unreachable {
        /// The nearest color of a fluorescent material, and how far it is in XYZ.
        fluorescence: Nearest,
    },
}

impl Standing {
    /// Where `rgb` stands under `contract`, by sums over 5 nm.
    ///
    /// # Examples
    ///
    /// ```
    /// use upglow_color::{Contract, LinearRgb};
    /// use upglow_fit::Standing;
    ///
    /// let standing = |rgb| Standing::of(LinearRgb(rgb), &Contract::default());
    /// assert_eq!(standing([0.5, 0.4, 0.3]), Standing::Reflectance);
    /// assert!(matches!(standing([0.9, 0.0, 0.9]), Standing::NeedsFluorescence { .. }));
    /// assert!(matches!(standing([0.0, 1.0, 0.0]), Standing::Unreachable { .. }));
    /// ```
    pub fn of(rgb: LinearRgb, contract: &Contract) -> Self {
        let colorimetry = contract.on(Grid::FIT);
        let color = colorimetry.xyz_from_rgb(rgb);
        let reflectance = ColorSolid::reflectance(&colorimetry);
        if reflectance.contains(color) {
            return Self::Reflectance;
        }
        let fluorescence = ColorSolid::fluorescence(&colorimetry);
        if fluorescence.contains(color) {
            return Self::NeedsFluorescence { reflectance: reflectance.nearest(color) };
        }
        Self::Unreachable { fluorescence: fluorescence.nearest(color) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn standing(rgb: [f64; 3]) -> Standing {
        Standing::of(LinearRgb(rgb), &Contract::default())
    }

    #[test]
    fn grays_black_and_white_are_reflectances() {
        for v in [0.0, 0.18, 1.0] {
            assert_eq!(standing([v; 3]), Standing::Reflectance, "{v}");
        }
    }

    #[test]
    fn brighter_than_white_takes_fluorescence_or_is_out_of_reach() {
        assert!(matches!(standing([1.01; 3]), Standing::NeedsFluorescence { .. }));
        assert!(matches!(standing([9.0; 3]), Standing::Unreachable { .. }));
    }

    #[test]
    fn what_lies_outside_has_its_distance() {
        let Standing::Unreachable { fluorescence } = standing([0.0, 1.0, 0.0]) else {
            panic!("green of AP1 is no real color");
        };
        assert!(fluorescence.distance > 1e-3);
        let Standing::NeedsFluorescence { reflectance } = standing([0.9, 0.0, 0.9]) else {
            panic!("magenta is brighter than any reflectance of its hue");
        };
        assert!(reflectance.distance > 1e-3);
    }
}
