//! Encodings of linear light as stored numbers.

use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

use upglow_color::{UnknownChoice, srgb_decoded};

/// The encoding of linear light as stored numbers.
///
/// Negative numbers follow the straight piece of a curve; a pure power leaves them as they are.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Encoding {
    /// Stored numbers are linear.
    Linear,
    /// The curve of sRGB.
    Srgb,
    /// The curve of cameras in ITU-R BT.709 and BT.2020.
    Bt709,
    /// A power: linear = stored^γ, γ > 0; [`Encoding::of_gamma`] has the range of those that are read.
    Gamma(f64),
    /// A curve of an ICC profile.
    Parametric(ParametricCurve),
    /// X, Y and Z, whose white is D65 with Y = 1.
    XyzD65,
}

/// A power with a straight piece: `(a·v + b)^γ + e` from `start` on, and `c·v + f` below it.
///
/// # Source
///
/// `icc`, 10.18, function type 4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParametricCurve {
    /// The exponent γ, a, b, c, the start of the power, e and f.
    pub numbers: [f64; 7],
}

impl ParametricCurve {
    fn decoded(self, v: f64) -> f64 {
        let [gamma, a, b, c, start, e, f] = self.numbers;
        match v {
            v if v < start => c * v + f,
            v if a * v + b < 0.0 => v,
            v => (a * v + b).powf(gamma) + e,
        }
    }
}

/// X, Y and Z of the white D65 of RGB spaces, from its chromaticity 0.3127, 0.3290.
const D65: [f64; 3] = [0.3127 / 0.3290, 1.0, (1.0 - 0.3127 - 0.3290) / 0.3290];

/// The gammas of pictures. Those of displays are from 1 to 3; beyond these, nearly all numbers become black or white.
const GAMMAS: RangeInclusive<f64> = 0.1..=10.0;

impl Encoding {
    /// The range of gammas, for messages.
    pub(crate) const GAMMAS: &str = "0.1 to 10";

    /// The encoding of this gamma; `None` unless it is from 0.1 to 10.
    pub fn of_gamma(gamma: f64) -> Option<Self> {
        GAMMAS.contains(&gamma).then_some(Self::Gamma(gamma))
    }

    /// Converts stored numbers to linear light.
    pub fn to_linear(self, stored: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Linear => stored,
            Self::Srgb => stored.map(srgb_decoded),
            Self::Bt709 => stored.map(bt709_decoded),
            Self::Gamma(gamma) => stored.map(|v| if v < 0.0 { v } else { v.powf(gamma) }),
            Self::Parametric(curve) => stored.map(|v| curve.decoded(v)),
            Self::XyzD65 => [0, 1, 2].map(|k| stored[k] / D65[k]),
        }
    }
}

/// # Source
///
/// `bt709`, 1.2, solved for the light.
fn bt709_decoded(v: f64) -> f64 {
    if v < 0.081 { v / 4.5 } else { ((v + 0.099) / 1.099).powf(1.0 / 0.45) }
}

impl FromStr for Encoding {
    type Err = UnknownChoice;

    fn from_str(word: &str) -> Result<Self, Self::Err> {
        match word {
            "linear" => Ok(Self::Linear),
            "srgb" => Ok(Self::Srgb),
            "bt709" => Ok(Self::Bt709),
            _ => word.parse().ok().and_then(Self::of_gamma).ok_or_else(|| UnknownChoice {
                what: "encoding",
                found: word.into(),
                expected: format!("linear, srgb, bt709 or a gamma from {}", Self::GAMMAS),
            }),
        }
    }
}

impl fmt::Display for Encoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Linear => f.write_str("linear"),
            Self::Srgb => f.write_str("srgb"),
            Self::Bt709 => f.write_str("bt709"),
            Self::Gamma(gamma) => write!(f, "{gamma}"),
            Self::Parametric(ParametricCurve { numbers }) => write!(f, "a curve {numbers:?}"),
            Self::XyzD65 => f.write_str("linear"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gray(encoding: Encoding, v: f64) -> f64 {
        encoding.to_linear([v; 3])[1]
    }

    #[test]
    fn srgb_has_its_published_values() {
        assert_eq!([0.0, 1.0].map(|v| gray(Encoding::Srgb, v)), [0.0, 1.0]);
        // A middle gray of 8 bits, computed from the formula to five digits.
        assert!((gray(Encoding::Srgb, 119.0 / 255.0) - 0.18448).abs() < 1e-5);
    }

    #[test]
    fn bt709_meets_its_straight_piece_and_has_its_formula() {
        // V = 1.099·L^0.45 − 0.099 for L = 0.5, of which the standard prints three digits.
        let stored = 1.099 * 0.5_f64.powf(0.45) - 0.099;
        assert!((gray(Encoding::Bt709, stored) - 0.5).abs() < 1e-12);
        // The standard's rounded constants meet within a thousandth.
        assert!((gray(Encoding::Bt709, 0.081) - 0.018).abs() < 1e-3);
    }

    #[test]
    fn negative_numbers_go_straight() {
        assert_eq!(gray(Encoding::Srgb, -0.4), -0.4 / 12.92);
        assert_eq!(gray(Encoding::Bt709, -0.45), -0.1);
        for encoding in [Encoding::Linear, Encoding::Gamma(2.2)] {
            assert_eq!(gray(encoding, -0.4), -0.4);
        }
    }

    #[test]
    fn a_parametric_curve_with_the_numbers_of_srgb_is_srgb() {
        let numbers = [2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045, 0.0, 0.0];
        let curve = Encoding::Parametric(ParametricCurve { numbers });
        for v in [-0.1, 0.0, 0.02, 0.3, 1.0] {
            // Rounding only.
            assert!((gray(curve, v) - gray(Encoding::Srgb, v)).abs() < 1e-14);
        }
    }

    #[test]
    fn words_name_encodings() {
        for word in ["linear", "srgb", "bt709", "2.2"] {
            assert_eq!(word.parse::<Encoding>().unwrap().to_string(), word);
        }
        for word in ["", "gamma", "0", "-1", "NaN", "inf", "1e-300", "1e300", "0.0999", "10.001"] {
            assert!(word.parse::<Encoding>().is_err(), "{word}");
        }
        assert_eq!(Encoding::GAMMAS, format!("{} to {}", GAMMAS.start(), GAMMAS.end()));
    }

    #[test]
    fn middle_numbers_stay_between_black_and_white_at_every_gamma() {
        for i in 0..=100 {
            let gamma = 0.1 * 100_f64.powf(f64::from(i) / 100.0);
            let encoding = Encoding::of_gamma(gamma.clamp(0.1, 10.0)).unwrap();
            let light = gray(encoding, 0.5);
            assert!(light > 9e-4 && light < 0.94, "{gamma} {light}");
        }
    }
}
