//! 3×3 matrices.

use std::ops::Mul;

/// A 3×3 matrix, `[row][column]`. Named `target_from_source` where it converts.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Matrix3(pub [[f64; 3]; 3]);

impl Matrix3 {
    /// The identity.
    pub const IDENTITY: Self = Self::diagonal([1.0, 1.0, 1.0]);

    /// The matrix with `d` on its diagonal.
    pub const fn diagonal(d: [f64; 3]) -> Self {
        Self([[d[0], 0.0, 0.0], [0.0, d[1], 0.0], [0.0, 0.0, d[2]]])
    }

    /// The matrix with these columns.
    pub const fn from_columns(c: [[f64; 3]; 3]) -> Self {
        Self([
            [c[0][0], c[1][0], c[2][0]],
            [c[0][1], c[1][1], c[2][1]],
            [c[0][2], c[1][2], c[2][2]],
        ])
    }

    /// The determinant.
    pub fn determinant(self) -> f64 {
        let [a, b, c] = self.0;
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * -(b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    }

    /// The inverse; `None` if the determinant is zero or not finite.
    pub fn inverse(self) -> Option<Self> {
        let m = self.0;
        let minor = |r0: usize, r1: usize, c0: usize, c1: usize| {
            m[r0][c0] * m[r1][c1] - m[r0][c1] * m[r1][c0]
        };
        let adjugate = [
            [minor(1, 2, 1, 2), -minor(0, 2, 1, 2), minor(0, 1, 1, 2)],
            [-minor(1, 2, 0, 2), minor(0, 2, 0, 2), -minor(0, 1, 0, 2)],
            [minor(1, 2, 0, 1), -minor(0, 2, 0, 1), minor(0, 1, 0, 1)],
        ];
        let det = self.determinant();
        let usable = det.is_finite() && det != 0.0;
        usable.then(|| Self(adjugate.map(|row| row.map(|v| v / det))))
    }
}

impl Mul for Matrix3 {
    type Output = Self;

    fn mul(self, rhs: Self) -> Self {
        let product = |r: usize, c: usize| (0..3).map(|k| self.0[r][k] * rhs.0[k][c]).sum();
        Self([0, 1, 2].map(|r| [0, 1, 2].map(|c| product(r, c))))
    }
}

impl Mul<[f64; 3]> for Matrix3 {
    type Output = [f64; 3];

    fn mul(self, v: [f64; 3]) -> [f64; 3] {
        self.0.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_times_matrix_is_identity() {
        let m = Matrix3([[0.9, 0.2, -0.1], [0.3, 1.1, 0.0], [0.05, -0.2, 0.7]]);
        let product = m.inverse().unwrap() * m;
        for (r, row) in product.0.iter().enumerate() {
            for (c, v) in row.iter().enumerate() {
                // Rounding only: a handful of products of numbers near 1.
                assert!((v - f64::from(u8::from(r == c))).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn singular_has_no_inverse() {
        assert_eq!(Matrix3([[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [0.0, 1.0, 0.0]]).inverse(), None);
    }
}
