//! Conversion from colors of a cube to colors of the page.

use upglow_color::{Colorimetry, Contract, LinearRgb, Matrix3, RgbSpace, choices, srgb_encoded};
use upglow_study::konig2020;
use upglow_svg::byte;

/// How RGB colors of a cube are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) enum Display {
    /// The values are treated as linear sRGB, as in the paper: hues are wrong, but every color of the
    /// cube is inside the page's gamut, so every artifact is visible.
    #[default]
    AsSrgb,
    /// Colors are converted to sRGB and clipped to its gamut by channel.
    Correct,
}

choices!(Display, "display", AsSrgb = "as-srgb", Correct = "correct");

impl Display {
    /// The sentence for captions.
    pub(crate) fn note(self) -> &'static str {
        match self {
            Self::AsSrgb => "ACEScg triples are shown as sRGB.",
            Self::Correct => "Colors are converted from ACEScg to sRGB and cut off at its gamut.",
        }
    }

    /// A converter from RGB of a contract to the page.
    pub(crate) fn painter(self, colorimetry: &Colorimetry) -> Painter {
        let srgb_from_rgb = match self {
            Self::AsSrgb => Matrix3::IDENTITY,
            Self::Correct => {
                let space = RgbSpace::named("srgb").expect("it is in the table");
                let page = Contract { space, ..konig2020::contract() }.on(colorimetry.grid());
                page.rgb_from_xyz_matrix() * colorimetry.xyz_from_rgb_matrix()
            }
        };
        Painter { srgb_from_rgb }
    }
}

/// Converts colors to sRGB bytes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Painter {
    srgb_from_rgb: Matrix3,
}

impl Painter {
    /// The sRGB bytes of a color, clipped to the gamut.
    pub(crate) fn paint(self, rgb: LinearRgb) -> [u8; 3] {
        (self.srgb_from_rgb * rgb.0).map(|v| byte(255.0 * srgb_encoded(v.clamp(0.0, 1.0))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow_color::Grid;

    #[test]
    fn white_and_black_stay_white_and_black() {
        let colorimetry = konig2020::contract().on(Grid::FIT);
        for display in [Display::AsSrgb, Display::Correct] {
            let painter = display.painter(&colorimetry);
            assert_eq!(painter.paint(LinearRgb([1.0; 3])), [255; 3], "{display}");
            assert_eq!(painter.paint(LinearRgb([0.0; 3])), [0; 3], "{display}");
        }
    }

    #[test]
    fn a_dull_green_is_greener_when_converted() {
        let colorimetry = konig2020::contract().on(Grid::FIT);
        let [as_srgb, correct] = [Display::AsSrgb, Display::Correct]
            .map(|display| display.painter(&colorimetry).paint(LinearRgb([0.3, 0.5, 0.3])));
        assert!(correct[0] < as_srgb[0] && correct[1] > as_srgb[1]);
    }

    #[test]
    fn names_are_read_back() {
        for display in [Display::AsSrgb, Display::Correct] {
            assert_eq!(display.to_string().parse(), Ok(display));
        }
        assert!("".parse::<Display>().is_err());
    }
}
