//! How well a cube's materials match a picture.

use upglow_color::{Colorimetry, LinearRgb, Xyz, ciede2000};
use upglow_fit::{KindCounts, MaterialKind};

use super::limits::Blends;

/// How well a cube's mixtures match the texels of a picture whose values are in 0..=1.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CubeMatch {
    /// The name of the cube's file.
    pub file: String,
    /// Texels with all values in 0..=1.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub texels: u64,
    /// Share of them matched within 1 ΔE00, 0..=1.
    pub within_one: f64,
    /// Share of them matched within 2 ΔE00, 0..=1.
    pub within_two: f64,
    /// Mean ΔE00.
    pub mean_de2000: f64,
    /// Greatest ΔE00.
    pub greatest_de2000: f64,
    /// Texels of each kind of material.
    pub kinds: KindCounts,
}

/// Sums of differences, as integers so that the order of addition does not matter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct DifferenceSums {
    texels: u64,
    within_one: u64,
    within_two: u64,
    sum: u128,
    greatest: f64,
    kinds: KindCounts,
}

/// The unit of the sum of ΔE00: finer than the single precision of the cube.
const UNIT: f64 = 1.0 / 16_777_216.0;

impl DifferenceSums {
    pub(super) fn join(&mut self, other: &Self) {
        self.texels += other.texels;
        self.within_one += other.within_one;
        self.within_two += other.within_two;
        self.sum += other.sum;
        self.greatest = self.greatest.max(other.greatest);
        self.kinds.join(&other.kinds);
    }

    /// Adds the differences of texels from the cube's blends, and the kinds of these.
    pub(super) fn add_texels(
        &mut self,
        cube: &Blends<'_>,
        colorimetry: &Colorimetry,
        rgb: &[[f32; 3]],
    ) {
        let mut matched = vec![[0.0; 3]; rgb.len()];
        cube.colors.xyz(rgb, &mut matched).expect("there is room for each texel");
        for (rgb, matched) in rgb.iter().zip(matched) {
            // The table has NaN for colors outside 0..=1.
            if !matched[0].is_nan() {
                let rgb = LinearRgb(rgb.map(f64::from));
                let kind = cube.kinds.of(rgb).expect("the table has a color for it");
                let target = colorimetry.xyz_from_rgb(rgb);
                let pair = [target, Xyz(matched.map(f64::from))];
                let [target, matched] = pair.map(|xyz| colorimetry.lab_from_xyz(xyz));
                self.add(ciede2000(target, matched), kind);
            }
        }
    }

    fn add(&mut self, de2000: f64, kind: MaterialKind) {
        self.texels += 1;
        self.within_one += u64::from(de2000 <= 1.0);
        self.within_two += u64::from(de2000 <= 2.0);
        self.sum += u128::from(units(de2000));
        self.greatest = self.greatest.max(de2000);
        self.kinds.add(kind);
    }

    pub(super) fn finish(&self, file: &str) -> CubeMatch {
        let texels = self.texels.max(1) as f64;
        CubeMatch {
            file: file.into(),
            texels: self.texels,
            within_one: self.within_one as f64 / texels,
            within_two: self.within_two as f64 / texels,
            mean_de2000: self.sum as f64 * UNIT / texels,
            greatest_de2000: self.greatest,
            kinds: self.kinds,
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the value is rounded first")]
#[expect(clippy::cast_sign_loss, reason = "color differences are not negative")]
fn units(de2000: f64) -> u64 {
    (de2000 / UNIT).round() as u64
}
