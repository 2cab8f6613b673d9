//! Pictures for screens: colors under a light in sRGB.

use upglow::Cube;
use upglow_color::rounding::to_single;
use upglow_color::{Grid, Illuminant, Screen, srgb_encoded};

use super::blends::Blends;
use super::maker::{Filled, Maker};
use super::radiance::NAMES;
use crate::exr::attribute::Attributes;

/// For each texel the color of its blend under a light, as encoded sRGB.
#[derive(Debug)]
pub(super) struct ScreenMaker<'c> {
    blends: Blends<'c>,
    screen: Screen,
    /// Factor of the light.
    exposure: f64,
}

impl<'c> ScreenMaker<'c> {
    pub(super) fn new(cube: &'c Cube, light: &Illuminant, exposure_stops: f64) -> Self {
        let seen = cube.contract().seen_under(light, Grid::FIT);
        Self {
            blends: Blends::new(cube, &seen.colorimetry),
            screen: Screen::srgb(seen.white),
            exposure: exposure_stops.exp2(),
        }
    }
}

impl Maker for ScreenMaker<'_> {
    fn channels(&self) -> Vec<String> {
        NAMES.map(str::to_owned).to_vec()
    }

    /// None: the file is a PNG, whose chunks say what it is.
    fn attributes(&self) -> Attributes {
        Attributes::new()
    }

    fn fill(&self, rgb: &[[f32; 3]], planes: &mut [&mut [f32]]) -> Filled {
        let mut beyond_screen = 0;
        for (i, xyz) in self.blends.xyz(rgb).into_iter().enumerate() {
            let shown = self.screen.within(self.exposure * xyz);
            beyond_screen += u64::from(shown.beyond > 0.0);
            (0..3).for_each(|k| planes[k][i] = to_single(srgb_encoded(shown.rgb.0[k])));
        }
        Filled { kinds: Some(self.blends.kinds(rgb)), beyond_screen }
    }
}
