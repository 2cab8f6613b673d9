//! Display of the contract's colors in sRGB.

use upglow_color::{Colorimetry, Contract, Grid, Matrix3, RgbSpace, Xyz, srgb_encoded};

/// Channels beyond 0..=1 by less are so by rounding: it is a hundredth of a step of 16 bits.
const ROUNDING: f64 = 1e-7;

/// Brightness of colors that are compared: as little less as the others need.
const DIMMED: [f64; 8] = [1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3];

/// Colors that are compared are dimmed until they can keep this share of their colorfulness. With more they
/// would be darker than necessary; with less, light yellows would look white.
const ENOUGH_COLOR: f64 = 0.6;

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
        let share = self.room(rgb);
        (rgb.map(|v| (gray + share * (v - gray)).clamp(0.0, 1.0)), true)
    }

    /// Colors to be compared, in 8-bit sRGB. If one is outside sRGB, all become grayer and darker by the same
    /// linear map, so that colors that differ still do: each keeps its luminance but for a common factor.
    pub(super) fn srgb_together<const N: usize>(&self, colors: [Xyz; N]) -> [[u8; 3]; N] {
        let colors = colors.map(|xyz| self.srgb_from_xyz * xyz.0);
        let room = |dim: f64| {
            let rooms = colors.iter().map(|rgb| self.room(rgb.map(|v| dim * v)));
            (rooms.fold(1.0, f64::min), dim)
        };
        // The brightest that leaves enough color, or else the most colorful.
        let tried = DIMMED.map(room);
        let enough = tried.into_iter().find(|(share, _)| *share >= ENOUGH_COLOR);
        let most = tried.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let (share, dim) = enough.or(most).expect("several are tried");
        colors.map(|rgb| {
            let rgb = rgb.map(|v| dim * v);
            let gray = self.luminance(rgb);
            rgb.map(|v| byte(srgb_encoded((gray + share * (v - gray)).clamp(0.0, 1.0))))
        })
    }

    /// How colorful a color of linear sRGB can stay, as a share, to be inside at its luminance.
    fn room(&self, rgb: [f64; 3]) -> f64 {
        let gray = self.luminance(rgb).clamp(0.0, 1.0);
        let room = |v: f64| match v - gray {
            above if above > 0.0 => (1.0 - gray) / above,
            below if below < 0.0 => gray / -below,
            _ => 1.0,
        };
        rgb.map(room).into_iter().fold(1.0, f64::min)
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

    /// Steps of 8 bits that differ, of colors that differ by more than one ΔE00. A step near black is up to
    /// 0.3 ΔE00, and dimming and graying leave a quarter of a difference.
    #[test]
    fn compared_colors_that_differ_by_more_than_one_look_different() {
        let colorimetry = Contract::default().on(Grid::FIT);
        let display = display();
        let corners =
            (0..1331).map(|i| [i % 11, i / 11 % 11, i / 121].map(|k| f64::from(k) / 10.0));
        let mut pairs = 0;
        for rgb in corners {
            for moved in [[0.03, 0.0, 0.0], [0.0, 0.03, 0.0], [0.0, 0.0, 0.05], [0.02; 3]] {
                let other = [0, 1, 2].map(|k| rgb[k] + moved[k]);
                let colors =
                    [rgb, other].map(|rgb| colorimetry.xyz_from_rgb(upglow_color::LinearRgb(rgb)));
                let [a, b] = colors.map(|xyz| colorimetry.lab_from_xyz(xyz));
                if upglow_color::ciede2000(a, b) > 1.0 {
                    pairs += 1;
                    let [first, second] = display.srgb_together(colors);
                    assert_ne!(first, second, "{rgb:?} {other:?}");
                }
            }
        }
        assert!(pairs > 1000, "{pairs}");
    }

    #[test]
    fn compared_colors_within_srgb_are_not_changed() {
        let colorimetry = Contract::default().on(Grid::FIT);
        let color = |rgb| colorimetry.xyz_from_rgb(upglow_color::LinearRgb(rgb));
        let colors = [[0.2, 0.3, 0.25], [0.5, 0.45, 0.4]].map(color);
        assert_eq!(display().srgb_together(colors), colors.map(|xyz| display().srgb(xyz)));
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
