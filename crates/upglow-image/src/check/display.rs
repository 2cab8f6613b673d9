//! Display of the contract's colors in sRGB.

use upglow_color::{Colorimetry, Matrix3, Screen, Shown, Xyz, srgb_encoded};

/// Converts the contract's colors to sRGB for 8 bits.
#[derive(Debug)]
pub(super) struct Display {
    screen: Screen,
    xyz_from_rgb: Matrix3,
}

impl Display {
    pub(super) fn new(colorimetry: &Colorimetry) -> Self {
        Self {
            screen: Screen::srgb(colorimetry.white()),
            xyz_from_rgb: colorimetry.xyz_from_rgb_matrix(),
        }
    }

    /// Colors to be compared.
    pub(super) fn srgb_together<const N: usize>(&self, colors: [Xyz; N]) -> [[u8; 3]; N] {
        self.screen.together(colors).map(bytes)
    }

    /// A color of the contract's RGB.
    pub(super) fn srgb_of_rgb(&self, rgb: [f64; 3]) -> [u8; 3] {
        bytes(self.screen.within(Xyz(self.xyz_from_rgb * rgb)))
    }

    /// The luminance of a color of the contract's RGB, sRGB-encoded, 0..=1.
    pub(super) fn brightness(&self, rgb: [f64; 3]) -> f64 {
        srgb_encoded((self.xyz_from_rgb * rgb)[1].clamp(0.0, 1.0))
    }
}

fn bytes(shown: Shown) -> [u8; 3] {
    shown.rgb.0.map(|v| byte(srgb_encoded(v)))
}

/// Converts 0..=1 to 8 bits.
#[expect(clippy::cast_possible_truncation, reason = "it is clamped and rounded first")]
#[expect(clippy::cast_sign_loss, reason = "it is clamped and rounded first")]
pub(super) fn byte(share: f64) -> u8 {
    (255.0 * share.clamp(0.0, 1.0)).round() as u8
}
