//! Encodings of linear light as stored numbers.

use std::fmt;
use std::str::FromStr;

use upglow_color::{UnknownChoice, srgb_decoded};

/// The encoding of linear light as stored numbers, odd-symmetric for negative numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Encoding {
    /// Stored numbers are linear.
    Linear,
    /// The curve of sRGB.
    Srgb,
    /// A power: linear = stored^γ, γ > 0.
    Gamma(f64),
}

impl Encoding {
    /// Converts a stored number to linear light.
    pub fn to_linear(self, stored: f64) -> f64 {
        let magnitude = stored.abs();
        let linear = match self {
            Self::Linear => magnitude,
            Self::Srgb => srgb_decoded(magnitude),
            Self::Gamma(gamma) => magnitude.powf(gamma),
        };
        linear.copysign(stored)
    }
}

impl FromStr for Encoding {
    type Err = UnknownChoice;

    fn from_str(word: &str) -> Result<Self, Self::Err> {
        let gamma = || word.parse().ok().filter(|g: &f64| g.is_finite() && *g > 0.0);
        match word {
            "linear" => Ok(Self::Linear),
            "srgb" => Ok(Self::Srgb),
            _ => gamma().map(Self::Gamma).ok_or_else(|| UnknownChoice {
                what: "encoding",
                found: word.into(),
                expected: "linear, srgb or a gamma above 0, as 2.2".into(),
            }),
        }
    }
}

impl fmt::Display for Encoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Linear => f.write_str("linear"),
            Self::Srgb => f.write_str("srgb"),
            Self::Gamma(gamma) => write!(f, "{gamma}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_has_its_published_values() {
        assert_eq!([0.0, 1.0].map(|v| Encoding::Srgb.to_linear(v)), [0.0, 1.0]);
        // A middle gray of 8 bits, computed from the formula to five digits.
        assert!((Encoding::Srgb.to_linear(119.0 / 255.0) - 0.18448).abs() < 1e-5);
    }

    #[test]
    fn negative_numbers_mirror_positive_ones() {
        for encoding in [Encoding::Linear, Encoding::Srgb, Encoding::Gamma(2.2)] {
            assert_eq!(encoding.to_linear(-0.4), -encoding.to_linear(0.4));
        }
    }

    #[test]
    fn words_name_encodings() {
        for word in ["linear", "srgb", "2.2"] {
            assert_eq!(word.parse::<Encoding>().unwrap().to_string(), word);
        }
        for word in ["", "gamma", "0", "-1", "NaN", "inf"] {
            assert!(word.parse::<Encoding>().is_err(), "{word}");
        }
    }
}
