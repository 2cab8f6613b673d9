//! Colors under a light.

use upglow::Cube;
use upglow_color::rounding::to_single;
use upglow_color::{Colorimetry, Grid, Illuminant, Matrix3};
use upglow_fit::KindCounts;

use super::attributes;
use super::blends::Blends;
use super::maker::{Filled, Maker};
use crate::exr::attribute::{Attribute, Attributes};

/// For each texel the linear RGB of its blend under a light, in the cube's space.
#[derive(Debug)]
pub(super) struct RadianceMaker<'c> {
    cube: &'c Cube,
    light: Illuminant,
    blends: Blends<'c>,
    rgb_from_xyz: Matrix3,
    white: [f64; 3],
}

impl<'c> RadianceMaker<'c> {
    pub(super) fn new(cube: &'c Cube, light: Illuminant) -> Self {
        let colorimetry = colorimetry(cube, &light);
        Self {
            cube,
            blends: Blends::new(cube, &colorimetry),
            rgb_from_xyz: colorimetry.rgb_from_xyz_matrix(),
            white: colorimetry.rgb_from_xyz(colorimetry.white()).0,
            light,
        }
    }

    /// Red, green, blue of each texel's blend.
    pub(super) fn fill_rgb(&self, rgb: &[[f32; 3]], planes: &mut [&mut [f32]]) {
        for (i, xyz) in self.blends.xyz(rgb).into_iter().enumerate() {
            let color = self.rgb_from_xyz * xyz.0;
            (0..3).for_each(|k| planes[k][i] = to_single(color[k]));
        }
    }

    /// The kinds of the texels' blends.
    pub(super) fn kinds(&self, rgb: &[[f32; 3]]) -> KindCounts {
        self.blends.kinds(rgb)
    }
}

/// The cube's colorimetry under a light that brings as much power as its own.
pub(super) fn colorimetry(cube: &Cube, light: &Illuminant) -> Colorimetry {
    let contract = cube.contract();
    contract.on(Grid::FIT).relit(&contract.observer, light)
}

/// Red, green and blue: also a preview for programs without spectra.
pub(super) const NAMES: [&str; 3] = ["R", "G", "B"];

/// What the three channels hold.
const CHANNELS: &str = "R, G, B: linear light that leaves the material, in the RGB space of \
                        upglow.header, under upglow.light, which brings as much power as the \
                        contract's light; the perfect diffuser has upglow.white";

impl Maker for RadianceMaker<'_> {
    fn channels(&self) -> Vec<String> {
        NAMES.map(str::to_owned).to_vec()
    }

    fn attributes(&self) -> Attributes {
        let mut attributes = attributes::colors(self.cube, "radiance", CHANNELS);
        let white = Attribute::singles("v3f", &self.white.map(to_single));
        attributes.insert("upglow.light".into(), self.light.name().into());
        attributes.insert("upglow.white".into(), white);
        attributes
    }

    fn is_light(&self) -> bool {
        true
    }

    fn fill(&self, rgb: &[[f32; 3]], planes: &mut [&mut [f32]]) -> Filled {
        self.fill_rgb(rgb, planes);
        self.kinds(rgb).into()
    }
}
