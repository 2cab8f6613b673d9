//! 3×3 matrices, and what small matrices of any size need.

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

/// The inverse of a square matrix, `[row][column]`, by elimination with the greatest pivot of each column;
/// `None` if it has none.
pub(crate) fn inverse<const N: usize>(mut left: [[f64; N]; N]) -> Option<[[f64; N]; N]> {
    let mut right = identity();
    for column in 0..N {
        let size = |row: &usize| left[*row][column].abs();
        let pivot = (column..N).max_by(|a, b| size(a).total_cmp(&size(b)))?;
        left.swap(column, pivot);
        right.swap(column, pivot);
        let scale = left[column][column].recip();
        if !scale.is_finite() {
            return None;
        }
        for matrix in [&mut left, &mut right] {
            let row = matrix[column].map(|v| v * scale);
            matrix[column] = row;
        }
        for row in (0..N).filter(|row| *row != column) {
            let factor = left[row][column];
            for matrix in [&mut left, &mut right] {
                let own = matrix[column];
                (0..N).for_each(|k| matrix[row][k] -= factor * own[k]);
            }
        }
    }
    Some(right)
}

/// Ones on the diagonal.
pub(crate) fn identity<const N: usize>() -> [[f64; N]; N] {
    std::array::from_fn(|r| std::array::from_fn(|c| if r == c { 1.0 } else { 0.0 }))
}

/// The product of two matrices, `[row][column]`.
pub(crate) fn product<const R: usize, const N: usize, const C: usize>(
    left: &[[f64; N]; R],
    right: &[[f64; C]; N],
) -> [[f64; C]; R] {
    let sum = |r: usize, c: usize| (0..N).map(|k| left[r][k] * right[k][c]).sum();
    std::array::from_fn(|r| std::array::from_fn(|c| sum(r, c)))
}

/// Columns become rows.
pub(crate) fn transposed<const R: usize, const C: usize>(m: &[[f64; C]; R]) -> [[f64; R]; C] {
    std::array::from_fn(|r| std::array::from_fn(|c| m[c][r]))
}

/// Sweeps of [`symmetric_eigen`]. Each about doubles the number of correct digits, so that after the first
/// few the rest changes nothing.
const SWEEPS: usize = 10;

/// Eigenvalues of a symmetric matrix, and their vectors as columns, by the rotations of Jacobi.
pub(crate) fn symmetric_eigen<const N: usize>(mut m: [[f64; N]; N]) -> ([f64; N], [[f64; N]; N]) {
    let mut vectors = identity();
    for _ in 0..SWEEPS {
        for p in 0..N {
            for q in p + 1..N {
                if m[p][q] == 0.0 {
                    continue;
                }
                let theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
                let tangent = theta.signum() / (theta.abs() + theta.hypot(1.0));
                let cosine = tangent.hypot(1.0).recip();
                let mut rotation = identity();
                (rotation[p][p], rotation[q][q]) = (cosine, cosine);
                (rotation[p][q], rotation[q][p]) = (tangent * cosine, -tangent * cosine);
                m = product(&product(&transposed(&rotation), &m), &rotation);
                vectors = product(&vectors, &rotation);
            }
        }
    }
    (std::array::from_fn(|k| m[k][k]), vectors)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_by_four_have_an_inverse_unless_they_are_singular() {
        let m = [
            [0.0, 2.0, 0.1, 0.0],
            [1.0, 0.0, 0.3, 0.2],
            [0.2, 0.1, 0.5, 3.0],
            [0.0, 0.4, 1.0, 0.1],
        ];
        let found = product(&inverse(m).unwrap(), &m);
        for (found, one) in found.as_flattened().iter().zip(identity::<4>().as_flattened()) {
            // Rounding only: a handful of products of numbers near 1.
            assert!((found - one).abs() < 1e-14);
        }
        assert_eq!(inverse([[1.0, 2.0], [2.0, 4.0]]), None);
    }

    #[test]
    fn eigenvectors_are_orthogonal_and_make_the_matrix_diagonal() {
        let m = [
            [2.0, 0.5, -0.3, 0.0],
            [0.5, 1.0, 0.2, 0.1],
            [-0.3, 0.2, 2.0, 0.0],
            [0.0, 0.1, 0.0, 0.0],
        ];
        let (values, vectors) = symmetric_eigen(m);
        let back = product(&transposed(&vectors), &product(&m, &vectors));
        let orthogonal = product(&transposed(&vectors), &vectors);
        for r in 0..4 {
            for c in 0..4 {
                let is_diagonal = if r == c { 1.0 } else { 0.0 };
                // Rounding only.
                assert!((back[r][c] - is_diagonal * values[r]).abs() < 1e-14, "{back:?}");
                assert!((orthogonal[r][c] - is_diagonal).abs() < 1e-14, "{orthogonal:?}");
            }
        }
    }

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
