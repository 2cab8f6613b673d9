//! Automatic differentiation: numbers with their exact partial derivatives in two variables.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value and its partial derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jet {
    pub(crate) value: f64,
    pub(crate) partials: [f64; 2],
}

impl Jet {
    /// A number with derivatives of 0.
    pub(crate) const fn constant(value: f64) -> Self {
        Self { value, partials: [0.0, 0.0] }
    }

    /// Variable number `index`.
    pub(crate) fn variable(value: f64, index: usize) -> Self {
        let mut partials = [0.0, 0.0];
        partials[index] = 1.0;
        Self { value, partials }
    }

    /// `f(self)`, given `f` and `f'` there.
    fn chain(self, value: f64, derivative: f64) -> Self {
        Self { value, partials: self.partials.map(|p| derivative * p) }
    }

    /// Square root; its derivative at 0 is set to 0.
    pub(crate) fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }

    pub(crate) fn exp(self) -> Self {
        let e = self.value.exp();
        self.chain(e, e)
    }

    pub(crate) fn sin(self) -> Self {
        self.chain(self.value.sin(), self.value.cos())
    }

    pub(crate) fn powi(self, n: i32) -> Self {
        self.chain(self.value.powi(n), f64::from(n) * self.value.powi(n - 1))
    }

    /// The angle of the vector (`x`, `self`) in radians.
    pub(crate) fn atan2(self, x: Self) -> Self {
        let norm2 = self.value * self.value + x.value * x.value;
        let (dy, dx) = (x.value / norm2, -self.value / norm2);
        Self {
            value: self.value.atan2(x.value),
            partials: [0, 1].map(|k| dy * self.partials[k] + dx * x.partials[k]),
        }
    }
}

impl From<f64> for Jet {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

impl<T: Into<Self>> Add<T> for Jet {
    type Output = Self;

    fn add(self, rhs: T) -> Self {
        let rhs = rhs.into();
        Self {
            value: self.value + rhs.value,
            partials: [0, 1].map(|k| self.partials[k] + rhs.partials[k]),
        }
    }
}

impl Neg for Jet {
    type Output = Self;

    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

impl<T: Into<Self>> Sub<T> for Jet {
    type Output = Self;

    fn sub(self, rhs: T) -> Self {
        self + -rhs.into()
    }
}

#[expect(clippy::suspicious_arithmetic_impl, reason = "the product rule adds")]
impl<T: Into<Self>> Mul<T> for Jet {
    type Output = Self;

    fn mul(self, rhs: T) -> Self {
        let rhs = rhs.into();
        Self {
            value: self.value * rhs.value,
            partials: [0, 1].map(|k| self.partials[k] * rhs.value + self.value * rhs.partials[k]),
        }
    }
}

#[expect(clippy::suspicious_arithmetic_impl, reason = "the quotient rule subtracts")]
impl<T: Into<Self>> Div<T> for Jet {
    type Output = Self;

    fn div(self, rhs: T) -> Self {
        let rhs = rhs.into();
        let value = self.value / rhs.value;
        let partial = |k: usize| (self.partials[k] - value * rhs.partials[k]) / rhs.value;
        Self { value, partials: [0, 1].map(partial) }
    }
}
