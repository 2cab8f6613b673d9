//! The blends of texels: their colors and kinds.

use upglow::{ColorTable, Cube};
use upglow_color::{Colorimetry, LinearRgb, Xyz};
use upglow_fit::{BlendKinds, KindCounts};

/// The blends of a cube's materials, seen under one light.
#[derive(Debug)]
pub(super) struct Blends<'c> {
    table: ColorTable,
    kinds: BlendKinds<'c>,
}

impl<'c> Blends<'c> {
    pub(super) fn new(cube: &'c Cube, colorimetry: &Colorimetry) -> Self {
        Self { table: cube.color_table(colorimetry), kinds: BlendKinds::new(cube) }
    }

    /// The color of each texel's blend.
    pub(super) fn xyz(&self, rgb: &[[f32; 3]]) -> Vec<Xyz> {
        let mut colors = vec![[0.0; 3]; rgb.len()];
        self.table.xyz(rgb, &mut colors).expect("as many colors as texels");
        colors.into_iter().map(|xyz| Xyz(xyz.map(f64::from))).collect()
    }

    /// The kinds of the texels' blends under the cube's own light.
    pub(super) fn kinds(&self, rgb: &[[f32; 3]]) -> KindCounts {
        kinds(&self.kinds, rgb)
    }
}

/// The kinds of the texels' blends.
pub(super) fn kinds(kinds: &BlendKinds<'_>, rgb: &[[f32; 3]]) -> KindCounts {
    let kind = |rgb: &[f32; 3]| kinds.of(LinearRgb(rgb.map(f64::from)));
    rgb.iter().map(|rgb| kind(rgb).expect("texels outside were repaired or refused")).collect()
}
