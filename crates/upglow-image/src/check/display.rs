//! Display of the contract's colors in sRGB.

use upglow_color::{Colorimetry, Contract, Grid, Matrix3, RgbSpace, Xyz, srgb_encoded};

/// Channels beyond 0..=1 by less are so by rounding: it is a hundredth of a step of 16 bits.
const ROUNDING: f64 = 1e-7;

/// Converts the contract's XYZ to sRGB, with chromatic adaptation of the white.
#[derive(Debug)]
pub(crate) struct Display {
    srgb_from_xyz: Matrix3,
    /// The luminance of linear sRGB, by channel.
    luminance: [f64; 3],
    xyz_from_rgb: Matrix3,
}

impl Display {
    pub(super) fn new(colorimetry: &Colorimetry) -> Self {
        Self::with_white(colorimetry, colorimetry.white())
    }

    /// Shows `white` as the white of the screen.
    pub(crate) fn with_white(colorimetry: &Colorimetry, white: Xyz) -> Self {
        let srgb = Contract {
            space: RgbSpace::named("srgb").expect("it is built in"),
            ..Contract::default()
        };
        let srgb = srgb.on(Grid::FIT);
        let adapted = upglow_color::Adaptation::default().target_from_source(white, srgb.white());
        Self {
            luminance: srgb.xyz_from_rgb_matrix().0[1],
            srgb_from_xyz: srgb.rgb_from_xyz_matrix() * adapted,
            xyz_from_rgb: colorimetry.xyz_from_rgb_matrix(),
        }
    }

    /// The color in 8-bit sRGB, with each channel clamped.
    pub(super) fn srgb(&self, xyz: Xyz) -> [u8; 3] {
        (self.srgb_from_xyz * xyz.0).map(|v| byte(srgb_encoded(v.clamp(0.0, 1.0))))
    }

    /// The color in linear sRGB, each channel in 0..=1, and whether it was outside. A color outside keeps
    /// its luminance and hue and becomes as gray as necessary; above the luminance of white it is white.
    pub(crate) fn within(&self, xyz: Xyz) -> ([f64; 3], bool) {
        let rgb = self.srgb_from_xyz * xyz.0;
        if rgb.iter().all(|v| (-ROUNDING..=1.0 + ROUNDING).contains(v)) {
            return (rgb.map(|v| v.clamp(0.0, 1.0)), false);
        }
        let gray = self.luminance(rgb).clamp(0.0, 1.0);
        let room = |v: f64| match v - gray {
            above if above > 0.0 => (1.0 - gray) / above,
            below if below < 0.0 => gray / -below,
            _ => 1.0,
        };
        let share = rgb.map(room).into_iter().fold(1.0, f64::min);
        (rgb.map(|v| (gray + share * (v - gray)).clamp(0.0, 1.0)), true)
    }

    fn luminance(&self, rgb: [f64; 3]) -> f64 {
        rgb.iter().zip(self.luminance).map(|(v, weight)| v * weight).sum()
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn display() -> Display {
        Display::new(&Contract::default().on(Grid::FIT))
    }

    #[test]
    fn white_is_the_white_of_the_screen_and_darker_grays_stay_gray() {
        let white = Contract::default().on(Grid::FIT).white();
        for share in [0.0, 0.18, 1.0] {
            let (rgb, was_outside) = display().within(white * share);
            assert!(!was_outside && rgb.iter().all(|v| (v - share).abs() < ROUNDING), "{rgb:?}");
        }
        assert_eq!(display().within(white * 3.0), ([1.0; 3], true));
    }

    proptest! {
        #[test]
        fn colors_outside_keep_their_luminance_and_order(
            xyz in prop::array::uniform3(0.0..1.0_f64),
        ) {
            let display = display();
            let before = display.srgb_from_xyz * xyz;
            let (after, _) = display.within(Xyz(xyz));
            prop_assert!(after.iter().all(|v| (0.0..=1.0).contains(v)), "{after:?}");
            let [y, shown] = [before, after].map(|rgb| display.luminance(rgb).clamp(0.0, 1.0));
            prop_assert!((y - shown).abs() < 3.0 * ROUNDING, "{before:?} {after:?}");
            for (i, k) in [(0, 1), (1, 2), (2, 0)] {
                prop_assert!(before[i] < before[k] || after[i] >= after[k] - ROUNDING);
            }
        }
    }
}
