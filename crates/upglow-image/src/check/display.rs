//! Display of the contract's colors in sRGB.

use upglow_color::{Colorimetry, Contract, Grid, Matrix3, RgbSpace, Xyz, srgb_encoded};

/// Converts the contract's XYZ to sRGB, with chromatic adaptation of the white.
#[derive(Debug)]
pub(super) struct Display {
    srgb_from_xyz: Matrix3,
    xyz_from_rgb: Matrix3,
}

impl Display {
    pub(super) fn new(colorimetry: &Colorimetry) -> Self {
        let srgb = Contract {
            space: RgbSpace::named("srgb").expect("it is built in"),
            ..Contract::default()
        };
        let srgb = srgb.on(Grid::FIT);
        let [from, to] = [colorimetry.white(), srgb.white()];
        let adapted = upglow_color::Adaptation::default().target_from_source(from, to);
        Self {
            srgb_from_xyz: srgb.rgb_from_xyz_matrix() * adapted,
            xyz_from_rgb: colorimetry.xyz_from_rgb_matrix(),
        }
    }

    /// The color in 8-bit sRGB, with each channel clamped.
    pub(super) fn srgb(&self, xyz: Xyz) -> [u8; 3] {
        (self.srgb_from_xyz * xyz.0).map(|v| byte(srgb_encoded(v.clamp(0.0, 1.0))))
    }

    /// A color of the contract's RGB in 8-bit sRGB.
    pub(super) fn srgb_of_rgb(&self, rgb: [f64; 3]) -> [u8; 3] {
        self.srgb(Xyz(self.xyz_from_rgb * rgb))
    }

    /// The luminance of a color of the contract's RGB, sRGB-encoded, 0..=1.
    pub(super) fn brightness(&self, rgb: [f64; 3]) -> f64 {
        srgb_encoded((self.xyz_from_rgb * rgb)[1].clamp(0.0, 1.0))
    }
}

/// Converts 0..=1 to 8 bits.
#[expect(clippy::cast_possible_truncation, reason = "it is clamped and rounded first")]
#[expect(clippy::cast_sign_loss, reason = "it is clamped and rounded first")]
pub(super) fn byte(share: f64) -> u8 {
    (255.0 * share.clamp(0.0, 1.0)).round() as u8
}
