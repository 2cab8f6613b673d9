//! How a screen shows colors, also those beyond its gamut.

use crate::adaptation::Adaptation;
use crate::contract::Contract;
use crate::grid::Grid;
use crate::matrix::Matrix3;
use crate::rgb_space::RgbSpace;
use crate::values::{LinearRgb, Xyz};

/// Channels beyond 0..=1 by less are so by rounding: it is a hundredth of a step of 16 bits.
const ROUNDING: f64 = 1e-7;

/// Brightness of colors that are compared: as little less as the others need.
const DIMMED: [f64; 8] = [1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3];

/// Colors that are compared are dimmed until they can keep this share of their colorfulness. With more they
/// would be darker than necessary; with less, light yellows would look white.
const ENOUGH_COLOR: f64 = 0.6;

/// Converts XYZ to the linear RGB of a screen, with chromatic adaptation of the white.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Screen {
    rgb_from_xyz: Matrix3,
    /// The luminance of the screen's RGB, by channel.
    luminance: [f64; 3],
}

/// A color on a screen.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Shown {
    /// Linear RGB of the screen, each channel in 0..=1.
    pub rgb: LinearRgb,
    /// By how much a channel of the color itself is below 0 or above 1; 0 for a color within the gamut.
    pub beyond: f64,
}

impl Screen {
    /// A screen of this RGB space that shows `white` as its white.
    pub fn new(space: RgbSpace, white: Xyz) -> Self {
        let screen = Contract { space, ..Contract::default() }.on(Grid::FIT);
        let adapted = Adaptation::default().target_from_source(white, screen.white());
        Self {
            rgb_from_xyz: screen.rgb_from_xyz_matrix() * adapted,
            luminance: screen.xyz_from_rgb_matrix().0[1],
        }
    }

    /// A screen of sRGB that shows `white` as its white.
    ///
    /// # Panics
    ///
    /// Never: sRGB is built in.
    pub fn srgb(white: Xyz) -> Self {
        Self::new(RgbSpace::named("srgb").expect("it is built in"), white)
    }

    /// Linear RGB of the screen from XYZ.
    pub fn rgb_from_xyz_matrix(&self) -> Matrix3 {
        self.rgb_from_xyz
    }

    /// Linear RGB of the screen, beyond 0..=1 for colors that it cannot show.
    pub fn rgb_from_xyz(&self, xyz: Xyz) -> LinearRgb {
        LinearRgb(self.rgb_from_xyz * xyz.0)
    }

    /// A color as the screen can show it. One outside the gamut keeps its luminance and hue and becomes as gray
    /// as necessary; above the luminance of white it is white.
    pub fn within(&self, xyz: Xyz) -> Shown {
        let rgb = self.rgb_from_xyz(xyz).0;
        let beyond = beyond(rgb);
        let share = if beyond > 0.0 { self.room(rgb) } else { 1.0 };
        Shown { rgb: self.grayed(rgb, share), beyond }
    }

    /// Colors to be compared. If one is outside the gamut, all become grayer and darker by the same linear map, so
    /// that colors that differ still do: each keeps its luminance but for a common factor.
    pub fn together<const N: usize>(&self, colors: [Xyz; N]) -> [Shown; N] {
        let colors = colors.map(|xyz| self.rgb_from_xyz(xyz).0);
        let room = |dim: f64| {
            let rooms = colors.iter().map(|rgb| self.room(rgb.map(|v| dim * v)));
            (rooms.fold(1.0, f64::min), dim)
        };
        // The brightest that leaves enough color, or else the most colorful.
        let tried = DIMMED.map(room);
        let enough = tried.into_iter().find(|(share, _)| *share >= ENOUGH_COLOR);
        let most = tried.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let (share, dim) = enough.or(most).unwrap_or((1.0, 1.0));
        let shown = |rgb: [f64; 3]| self.grayed(rgb.map(|v| dim * v), share);
        colors.map(|rgb| Shown { rgb: shown(rgb), beyond: beyond(rgb) })
    }

    /// With this share of its colorfulness, within the gamut.
    fn grayed(&self, rgb: [f64; 3], share: f64) -> LinearRgb {
        let gray = self.luminance(rgb).clamp(0.0, 1.0);
        let kept = |v: f64| if share < 1.0 { gray + share * (v - gray) } else { v };
        LinearRgb(rgb.map(|v| kept(v).clamp(0.0, 1.0)))
    }

    /// How colorful a color of the screen's RGB can stay, as a share, to be inside at its luminance.
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
}

/// By how much a channel is outside 0..=1.
fn beyond(rgb: [f64; 3]) -> f64 {
    let beyond = rgb.iter().map(|v| (-v).max(v - 1.0)).fold(0.0, f64::max);
    if beyond <= ROUNDING { 0.0 } else { beyond }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ciede2000::ciede2000;
    use proptest::prelude::*;

    fn white() -> Xyz {
        Contract::default().on(Grid::FIT).white()
    }

    #[test]
    fn white_is_the_white_of_the_screen_and_darker_grays_stay_gray() {
        for (space, white) in [("srgb", white()), ("p3-d65", Xyz([1.1, 1.0, 0.36]))] {
            let screen = Screen::new(RgbSpace::named(space).unwrap(), white);
            for share in [0.0, 0.18, 1.0] {
                let Shown { rgb, beyond } = screen.within(white * share);
                assert!(rgb.0.iter().all(|v| (v - share).abs() < ROUNDING), "{rgb:?}");
                assert_eq!(beyond, 0.0);
            }
            let Shown { rgb, beyond } = screen.within(white * 3.0);
            assert!(rgb == LinearRgb([1.0; 3]) && (beyond - 2.0).abs() < ROUNDING, "{beyond}");
        }
    }

    /// Steps of 8 bits that differ, of colors that differ by more than one ΔE00. A step near black is up to
    /// 0.3 ΔE00, and dimming and graying leave a quarter of a difference.
    #[test]
    fn compared_colors_that_differ_by_more_than_one_look_different() {
        let bytes = |shown: Shown| shown.rgb.0.map(|v| (255.0 * crate::srgb_encoded(v)).round());
        let colorimetry = Contract::default().on(Grid::FIT);
        let screen = Screen::srgb(colorimetry.white());
        let corners =
            (0..1331).map(|i| [i % 11, i / 11 % 11, i / 121].map(|k| f64::from(k) / 10.0));
        let mut pairs = 0;
        for rgb in corners {
            for moved in [[0.03, 0.0, 0.0], [0.0, 0.03, 0.0], [0.0, 0.0, 0.05], [0.02; 3]] {
                let other = [0, 1, 2].map(|k| rgb[k] + moved[k]);
                let colors = [rgb, other].map(|rgb| colorimetry.xyz_from_rgb(LinearRgb(rgb)));
                let [a, b] = colors.map(|xyz| colorimetry.lab_from_xyz(xyz));
                if ciede2000(a, b) > 1.0 {
                    pairs += 1;
                    let [first, second] = screen.together(colors).map(bytes);
                    assert_ne!(first, second, "{rgb:?} {other:?}");
                }
            }
        }
        assert!(pairs > 1000, "{pairs}");
    }

    #[test]
    fn compared_colors_within_the_gamut_are_not_changed() {
        let colorimetry = Contract::default().on(Grid::FIT);
        let screen = Screen::srgb(colorimetry.white());
        let color = |rgb| colorimetry.xyz_from_rgb(LinearRgb(rgb));
        let colors = [[0.2, 0.3, 0.25], [0.5, 0.45, 0.4]].map(color);
        assert_eq!(screen.together(colors), colors.map(|xyz| screen.within(xyz)));
    }

    proptest! {
        #[test]
        fn colors_outside_keep_their_luminance_and_order(
            xyz in prop::array::uniform3(0.0..1.0_f64),
        ) {
            let screen = Screen::srgb(white());
            let before = screen.rgb_from_xyz(Xyz(xyz)).0;
            let after = screen.within(Xyz(xyz)).rgb.0;
            prop_assert!(after.iter().all(|v| (0.0..=1.0).contains(v)), "{after:?}");
            let [y, shown] = [before, after].map(|rgb| screen.luminance(rgb).clamp(0.0, 1.0));
            prop_assert!((y - shown).abs() < 3.0 * ROUNDING, "{before:?} {after:?}");
            for (i, k) in [(0, 1), (1, 2), (2, 0)] {
                prop_assert!(before[i] < before[k] || after[i] >= after[k] - ROUNDING);
            }
        }
    }
}
