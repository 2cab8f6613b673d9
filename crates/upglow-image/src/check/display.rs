//! Colors of the contract on a screen.

use upglow_color::{Colorimetry, Contract, Grid, Matrix3, RgbSpace, Xyz, srgb_encoded};

/// Turns the contract's XYZ into sRGB: white is white.
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

    /// The color in 8 bits; what sRGB cannot hold is cut off by channel.
    pub(super) fn srgb(&self, xyz: Xyz) -> [u8; 3] {
        (self.srgb_from_xyz * xyz.0).map(|v| byte(srgb_encoded(v.clamp(0.0, 1.0))))
    }

    /// A color of the contract's RGB in 8 bits.
    pub(super) fn srgb_of_rgb(&self, rgb: [f64; 3]) -> [u8; 3] {
        self.srgb(Xyz(self.xyz_from_rgb * rgb))
    }

    /// How bright a color of the contract's RGB looks: 0..=1, sRGB-encoded luminance.
    pub(super) fn brightness(&self, rgb: [f64; 3]) -> f64 {
        srgb_encoded((self.xyz_from_rgb * rgb)[1].clamp(0.0, 1.0))
    }
}

/// 0..=1 in 8 bits.
#[expect(clippy::cast_possible_truncation, reason = "it is clamped and rounded first")]
#[expect(clippy::cast_sign_loss, reason = "it is clamped and rounded first")]
pub(super) fn byte(share: f64) -> u8 {
    (255.0 * share.clamp(0.0, 1.0)).round() as u8
}
