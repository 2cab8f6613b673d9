//! RGB color spaces: primaries and a white. A new space is one line of [`SPACES`].

use crate::matrix::Matrix3;
use crate::names::NameError;
use crate::values::Xyz;

/// The primaries and white of an RGB space, as CIE 1931 chromaticities.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct RgbSpace {
    #[cfg_attr(feature = "serde", serde(rename = "rgb_space"))]
    name: String,
    #[cfg_attr(feature = "serde", serde(rename = "primaries_xy"))]
    primaries: [[f64; 2]; 3],
    #[cfg_attr(feature = "serde", serde(rename = "white_xy"))]
    white: [f64; 2],
}

/// Why an RGB space is rejected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RgbSpaceError {
    /// No built-in space has this name.
    #[error(
        "unknown RGB space {found:?}, expected {}, or eight numbers Rx,Ry,Gx,Gy,Bx,By,Wx,Wy",
        RgbSpace::names().join(", ")
    )]
    Unknown {
        /// The name given.
        found: String,
    },
    /// The name cannot be that of this space.
    #[error(transparent)]
    Name(#[from] NameError),
    /// A chromaticity is not a number in -10..=10, or the white has a y below 0.001.
    #[error(
        "chromaticity ({}, {}), expected numbers from -{LARGEST} to {LARGEST}, and a y of at least \
         {LEAST_WHITE_Y} for the white",
        .found[0],
        .found[1]
    )]
    Chromaticity {
        /// The chromaticity given.
        found: [f64; 2],
    },
    /// The primaries lie on one line.
    #[error("the three primaries lie on one line, expected a triangle")]
    Degenerate,
    /// The white is outside the triangle of the primaries.
    #[error("the white ({}, {}) is outside the triangle of the primaries, expected a white inside it", .white[0], .white[1])]
    WhiteOutside {
        /// The white given.
        white: [f64; 2],
    },
}

/// Greatest size of a chromaticity coordinate. Published spaces stay below 2; much larger numbers leave
/// the range in which matrices can be inverted.
const LARGEST: f64 = 10.0;
/// Least y of a white: X, Y, Z of the white are at most 10 000 times its luminance.
const LEAST_WHITE_Y: f64 = 1e-3;
/// Least area of the triangle of primaries, and least amount of a primary in white. Below it the
/// matrix from XYZ to RGB magnifies rounding in single precision to visible differences.
const LEAST_SHARE: f64 = 1e-6;

const D65_WHITE: [f64; 2] = [0.3127, 0.3290];
/// The white of SMPTE TB-2018-001, near D60.
const ACES_WHITE: [f64; 2] = [0.32168, 0.33767];
const D50_WHITE: [f64; 2] = [0.3457, 0.3585];
const EQUAL_ENERGY_WHITE: [f64; 2] = [1.0 / 3.0, 1.0 / 3.0];

/// Name, primaries of red, green and blue, white.
type Space = (&'static str, [[f64; 2]; 3], [f64; 2]);

/// Each from its defining standard: SMPTE ST 2065-1 and the Academy's
/// S-2014-004, ITU-R BT.2020, SMPTE EG 432-1, IEC 61966-2-1, ISO 22028-2, Adobe RGB (1998).
#[rustfmt::skip]
const SPACES: [Space; 8] = [
    ("acescg",      [[0.713, 0.293], [0.165, 0.830], [0.128, 0.044]], ACES_WHITE),
    ("aces2065-1",  [[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.0770]], ACES_WHITE),
    ("rec2020",     [[0.708, 0.292], [0.170, 0.797], [0.131, 0.046]], D65_WHITE),
    ("p3-d65",      [[0.680, 0.320], [0.265, 0.690], [0.150, 0.060]], D65_WHITE),
    ("srgb",        [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]], D65_WHITE),
    ("prophoto",    [[0.734_699, 0.265_301], [0.159_597, 0.840_403], [0.036_598, 0.000_105]], D50_WHITE),
    ("adobe-rgb",   [[0.64, 0.33], [0.21, 0.71], [0.15, 0.06]], D65_WHITE),
    ("xyz",         [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]], EQUAL_ENERGY_WHITE),
];

/// Other names of built-in spaces.
const ALIASES: [(&str, &str); 6] = [
    ("ap1", "acescg"),
    ("ap0", "aces2065-1"),
    ("rec709", "srgb"),
    ("bt709", "srgb"),
    ("bt2020", "rec2020"),
    ("display-p3", "p3-d65"),
];

impl RgbSpace {
    /// The names of the built-in spaces.
    pub fn names() -> [&'static str; SPACES.len()] {
        SPACES.map(|(name, ..)| name)
    }

    /// The built-in space of this name, or of an everyday name such as `rec709` or `ap1`; case, `-`, `_`,
    /// `.` and spaces are ignored.
    ///
    /// # Errors
    ///
    /// [`RgbSpaceError::Unknown`] lists the known names.
    pub fn named(name: &str) -> Result<Self, RgbSpaceError> {
        let plain = |s: &str| s.to_ascii_lowercase().replace(['-', '_', '.', ' '], "");
        let alias = ALIASES.iter().find(|(alias, _)| plain(alias) == plain(name));
        let wanted = plain(alias.map_or(name, |(_, name)| name));
        SPACES
            .iter()
            .find(|(known, ..)| plain(known) == wanted)
            .map(|&(name, primaries, white)| Self { name: name.into(), primaries, white })
            .ok_or_else(|| RgbSpaceError::Unknown { found: name.into() })
    }

    /// A space from the chromaticities (x, y) of red, green, blue, and of white.
    ///
    /// # Errors
    ///
    /// [`RgbSpaceError`] unless the primaries form a triangle around the white, or if the name is that
    /// of a built-in space with other chromaticities.
    pub fn custom(
        name: &str,
        primaries: [[f64; 2]; 3],
        white: [f64; 2],
    ) -> Result<Self, RgbSpaceError> {
        let wrong = |c: &[f64; 2]| !c.iter().all(|v| v.abs() <= LARGEST);
        if let Some(&found) = primaries.iter().chain([&white]).find(|c| wrong(c)) {
            return Err(RgbSpaceError::Chromaticity { found });
        }
        if white[1] < LEAST_WHITE_Y {
            return Err(RgbSpaceError::Chromaticity { found: white });
        }
        let shares = Self::shares(primaries, white).ok_or(RgbSpaceError::Degenerate)?;
        if shares.iter().any(|&s| !s.is_finite() || s < LEAST_SHARE) {
            return Err(RgbSpaceError::WhiteOutside { white });
        }
        let space = Self { name: name.into(), primaries, white };
        space.check_name()?;
        Ok(space)
    }

    /// Checks that a built-in name comes with the built-in chromaticities.
    fn check_name(&self) -> Result<(), NameError> {
        NameError::check_text(&self.name)?;
        let Ok(known) = Self::named(&self.name) else { return Ok(()) };
        let corners = |space: &Self| {
            let [red, green, blue] = space.primaries;
            [("red", red), ("green", green), ("blue", blue), ("white", space.white)]
        };
        let differs = |(found, known): &((_, _), (_, _))| found != known;
        let mut pairs = corners(self).into_iter().zip(corners(&known));
        pairs.find(differs).map_or(Ok(()), |((corner, found), (_, expected))| {
            Err(NameError::Taken {
                kind: "RGB space",
                name: self.name.clone(),
                number: format!("chromaticity of {corner}"),
                expected: format!("{expected:?}"),
                found: format!("{found:?}"),
            })
        })
    }

    /// The name that files state.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Chromaticities (x, y) of red, green and blue.
    pub fn primaries(&self) -> [[f64; 2]; 3] {
        self.primaries
    }

    /// Chromaticity (x, y) of RGB (1, 1, 1).
    pub fn white(&self) -> [f64; 2] {
        self.white
    }

    /// The matrix from linear RGB to XYZ without adaptation; Y = 1 for (1, 1, 1).
    pub fn xyz_from_rgb(&self) -> Matrix3 {
        let shares = Self::shares(self.primaries, self.white).expect("checked when it was made");
        directions(self.primaries) * Matrix3::diagonal(shares)
    }

    /// Amounts of the primaries that add up to the white; `None` if the primaries lie on one line.
    fn shares(primaries: [[f64; 2]; 3], white: [f64; 2]) -> Option<[f64; 3]> {
        let directions = directions(primaries);
        // Twice the area of the triangle.
        if directions.determinant().abs() < LEAST_SHARE {
            return None;
        }
        Some(directions.inverse()? * Xyz::from_chromaticity(white).0)
    }
}

impl Default for RgbSpace {
    /// `ACEScg`.
    fn default() -> Self {
        Self::named("acescg").expect("it is in the table")
    }
}

/// The tristimulus values x, y, 1 − x − y of each primary, one a column.
fn directions(primaries: [[f64; 2]; 3]) -> Matrix3 {
    Matrix3::from_columns(primaries.map(|[x, y]| [x, y, 1.0 - x - y]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Published matrices are printed to about ten digits.
    const PRINTED_DIGITS: f64 = 1e-9;

    #[test]
    fn acescg_has_the_published_matrix() {
        // Academy S-2014-004, TRA1 (AP1 to XYZ).
        let published = [
            [0.662_454_181_1, 0.134_004_206_5, 0.156_187_687_0],
            [0.272_228_716_8, 0.674_081_765_8, 0.053_689_517_4],
            [-0.005_574_649_5, 0.004_060_733_5, 1.010_339_100_3],
        ];
        let computed = RgbSpace::default().xyz_from_rgb().0;
        for (published, computed) in published.iter().flatten().zip(computed.iter().flatten()) {
            assert!((published - computed).abs() < PRINTED_DIGITS, "{published} {computed}");
        }
    }

    #[test]
    fn white_is_the_sum_of_the_primaries_in_every_space() {
        for name in RgbSpace::names() {
            let space = RgbSpace::named(name).unwrap();
            let sum = Xyz(space.xyz_from_rgb() * [1.0; 3]).chromaticity().unwrap();
            for k in 0..2 {
                // Rounding only.
                assert!((sum[k] - space.white()[k]).abs() < 1e-12, "{name}");
            }
        }
    }

    #[test]
    fn names_are_found_in_any_spelling_and_unknown_ones_refused() {
        assert_eq!(RgbSpace::named("ACEScg").unwrap().name(), "acescg");
        assert_eq!(RgbSpace::named("Rec.2020").unwrap().name(), "rec2020");
        for (alias, name) in ALIASES {
            assert_eq!(RgbSpace::named(alias).unwrap().name(), name);
        }
        assert_eq!(RgbSpace::named("BT.2020").unwrap().name(), "rec2020");
        let unknown = RgbSpace::named("rec7091").unwrap_err().to_string();
        assert!(unknown.starts_with("unknown RGB space"), "{unknown}");
    }

    #[test]
    fn a_built_in_name_is_for_the_built_in_chromaticities_only() {
        for (name, primaries, white) in SPACES {
            assert!(RgbSpace::custom(name, primaries, white).is_ok());
            let shifted = [white[0], white[1] + 1e-4];
            let refused = RgbSpace::custom(&name.to_uppercase(), primaries, shifted).unwrap_err();
            assert!(matches!(refused, RgbSpaceError::Name(NameError::Taken { .. })), "{name}");
            assert!(RgbSpace::custom("mine", primaries, shifted).is_ok());
        }
        let [_, (_, aces, white), ..] = SPACES;
        let refused = RgbSpace::custom("srgb", aces, white).unwrap_err().to_string();
        assert_eq!(
            refused,
            "\"srgb\" is a built-in RGB space whose chromaticity of red is [0.64, 0.33], \
             found [0.7347, 0.2653]: expected the built-in numbers, or another name"
        );
    }

    #[test]
    fn custom_primaries_must_form_a_triangle_around_the_white() {
        let triangle = [[0.7, 0.3], [0.2, 0.8], [0.1, 0.05]];
        assert!(RgbSpace::custom("mine", triangle, D65_WHITE).is_ok());
        let outside = RgbSpace::custom("mine", triangle, [0.7, 0.7]);
        assert_eq!(outside, Err(RgbSpaceError::WhiteOutside { white: [0.7, 0.7] }));
        let line = RgbSpace::custom("mine", [[0.1, 0.1], [0.2, 0.2], [0.3, 0.3]], D65_WHITE);
        assert!(line.is_err());
        let nan = RgbSpace::custom("mine", [[f64::NAN, 0.3], [0.2, 0.8], [0.1, 0.0]], D65_WHITE);
        assert!(matches!(nan, Err(RgbSpaceError::Chromaticity { .. })));
    }
}
