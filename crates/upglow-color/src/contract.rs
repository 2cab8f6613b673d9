//! What must be agreed before RGB means a color.

use crate::{Adaptation, Colorimetry, Grid, Illuminant, Observer, RgbSpace};

/// The agreement that turns RGB into a color: nothing in upglow guesses any part of it.
///
/// The default is ACEScg under D65 for the CIE 1931 2° observer, Bradford-adapted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contract {
    /// Primaries and white of the RGB numbers.
    pub space: RgbSpace,
    /// The light that the material is seen under.
    pub illuminant: Illuminant,
    /// The eye that sees it.
    pub observer: Observer,
    /// What happens where the space's white is not the illuminant's.
    pub adaptation: Adaptation,
}

impl Contract {
    /// The contract with its sums taken over `grid`.
    pub fn on(&self, grid: Grid) -> Colorimetry {
        Colorimetry::new(self, grid)
    }
}
