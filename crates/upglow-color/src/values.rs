//! Triples that look alike and mean different things.

/// Relative CIE tristimulus values; Y = 1 is the perfect diffuser under the contract's illuminant.
///
/// Any finite number is allowed: AP1's red primary has Z < 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Xyz(pub [f64; 3]);

/// Linear-light RGB in the contract's space; (1, 1, 1) is that space's white.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct LinearRgb(pub [f64; 3]);

impl LinearRgb {
    /// Whether every component is a number in 0..=1.
    pub fn is_in_unit_cube(self) -> bool {
        self.0.iter().all(|v| (0.0..=1.0).contains(v))
    }
}

impl Xyz {
    /// Chromaticity (x, y); `None` where X + Y + Z is not positive.
    pub fn chromaticity(self) -> Option<[f64; 2]> {
        let [x, y, z] = self.0;
        let sum = x + y + z;
        (sum > 0.0).then(|| [x / sum, y / sum])
    }

    /// The values of a chromaticity (x, y) with Y = 1.
    pub fn from_chromaticity([x, y]: [f64; 2]) -> Self {
        Self([x / y, 1.0, (1.0 - x - y) / y])
    }
}
