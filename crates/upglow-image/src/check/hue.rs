//! Names of the hues of colors, for sentences.

use upglow_color::Lab;

/// A range of hues.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Hue {
    Grays,
    Reds,
    Oranges,
    Yellows,
    Greens,
    Cyans,
    Blues,
    Purples,
}

/// Less C* than this has no hue that is worth a name.
const GRAY_CHROMA: f64 = 8.0;

/// Where a range of CIELAB hues begins, in degrees. sRGB's red, yellow, green, cyan, blue and magenta
/// are at 40, 103, 136, 196, 306 and 328.
const BEGINNINGS: [(f64, Hue); 7] = [
    (345.0, Hue::Reds),
    (312.0, Hue::Purples),
    (230.0, Hue::Blues),
    (172.0, Hue::Cyans),
    (115.0, Hue::Greens),
    (82.0, Hue::Yellows),
    (52.0, Hue::Oranges),
];

impl Hue {
    pub(super) const ALL: [Self; 8] = [
        Self::Grays,
        Self::Reds,
        Self::Oranges,
        Self::Yellows,
        Self::Greens,
        Self::Cyans,
        Self::Blues,
        Self::Purples,
    ];

    pub(super) fn of(color: Lab) -> Self {
        if color.chroma() < GRAY_CHROMA {
            return Self::Grays;
        }
        let degrees = color.b.atan2(color.a).to_degrees().rem_euclid(360.0);
        let found = BEGINNINGS.into_iter().find(|(beginning, _)| degrees >= *beginning);
        found.map_or(Self::Reds, |(_, hue)| hue)
    }

    /// The colors of this hue, in words.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Grays => "grays",
            Self::Reds => "reds",
            Self::Oranges => "oranges",
            Self::Yellows => "yellows",
            Self::Greens => "greens",
            Self::Cyans => "cyans",
            Self::Blues => "blues",
            Self::Purples => "purples",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow_color::{Contract, Grid, LinearRgb, RgbSpace};

    #[test]
    fn the_corners_of_srgb_have_their_names() {
        let space = RgbSpace::named("srgb").unwrap();
        let srgb = Contract { space, ..Contract::default() }.on(Grid::FIT);
        for (rgb, hue) in [
            ([0.2; 3], Hue::Grays),
            ([1.0, 0.0, 0.0], Hue::Reds),
            ([1.0, 0.25, 0.0], Hue::Oranges),
            ([1.0, 1.0, 0.0], Hue::Yellows),
            ([0.0, 1.0, 0.0], Hue::Greens),
            ([0.0, 1.0, 1.0], Hue::Cyans),
            ([0.0, 0.0, 1.0], Hue::Blues),
            ([1.0, 0.0, 1.0], Hue::Purples),
        ] {
            let lab = srgb.lab_from_xyz(srgb.xyz_from_rgb(LinearRgb(rgb)));
            assert_eq!(Hue::of(lab), hue, "{rgb:?} {lab:?}");
            assert_eq!(Hue::ALL[hue as usize], hue);
        }
    }
}
