//! Vectors of three components: XYZ and linear RGB.

use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Relative CIE tristimulus values; Y = 1 is the perfect diffuser under the contract's illuminant.
///
/// Components may be negative: the red primary of AP1 has Z < 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[must_use]
pub struct Xyz(pub [f64; 3]);

/// Linear-light RGB in the contract's space; (1, 1, 1) is that space's white.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[must_use]
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

/// Arithmetic by component: lights add up.
macro_rules! vector {
    ($vector:ident) => {
        impl From<[f64; 3]> for $vector {
            #[inline]
            fn from(components: [f64; 3]) -> Self {
                Self(components)
            }
        }

        impl From<$vector> for [f64; 3] {
            #[inline]
            fn from(vector: $vector) -> Self {
                vector.0
            }
        }

        impl Add for $vector {
            type Output = Self;

            #[inline]
            fn add(self, rhs: Self) -> Self {
                Self([0, 1, 2].map(|k| self.0[k] + rhs.0[k]))
            }
        }

        impl AddAssign for $vector {
            #[inline]
            fn add_assign(&mut self, rhs: Self) {
                *self = *self + rhs;
            }
        }

        impl Sub for $vector {
            type Output = Self;

            #[inline]
            fn sub(self, rhs: Self) -> Self {
                Self([0, 1, 2].map(|k| self.0[k] - rhs.0[k]))
            }
        }

        impl Neg for $vector {
            type Output = Self;

            #[inline]
            fn neg(self) -> Self {
                Self(self.0.map(|v| -v))
            }
        }

        impl Mul<f64> for $vector {
            type Output = Self;

            #[inline]
            fn mul(self, factor: f64) -> Self {
                Self(self.0.map(|v| v * factor))
            }
        }

        impl Mul<$vector> for f64 {
            type Output = $vector;

            #[inline]
            fn mul(self, vector: $vector) -> $vector {
                vector * self
            }
        }

        impl Div<f64> for $vector {
            type Output = Self;

            #[inline]
            fn div(self, divisor: f64) -> Self {
                Self(self.0.map(|v| v / divisor))
            }
        }

        /// Adds to zero in the order given.
        impl Sum for $vector {
            fn sum<I: Iterator<Item = Self>>(vectors: I) -> Self {
                vectors.fold(Self::default(), Add::add)
            }
        }
    };
}

vector!(Xyz);
vector!(LinearRgb);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_is_by_component() {
        let (a, b) = (Xyz([1.0, 2.0, 3.0]), Xyz([0.5, 0.25, -1.0]));
        assert_eq!(a + b, [1.5, 2.25, 2.0].into());
        assert_eq!([a, b, -b].into_iter().sum::<Xyz>(), a + b - b);
        assert_eq!((2.0 * a, a / 2.0), (a + a, a * 0.5));
    }
}
