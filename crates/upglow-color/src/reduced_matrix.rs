//! Light as X, Y, Z and ultraviolet, and how materials act on it by a 4×4 matrix.

use std::ops::{Add, Mul};

use crate::matrix::{Matrix3, inverse, product, symmetric_eigen, transposed};
use crate::values::Xyz;

/// Light as four numbers: X, Y, Z and U, its ultraviolet as [`crate::ReducedBasis::ultraviolet_at`] weighs it.
///
/// A perfect diffuser under the contract's light has Y = 1; D65 of that luminance has U = 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[must_use]
pub struct Xyzu(pub [f64; 4]);

impl Xyzu {
    /// What an observer sees of it.
    pub fn xyz(self) -> Xyz {
        let [x, y, z, _] = self.0;
        Xyz([x, y, z])
    }
}

/// How a material acts on light of four numbers, `[outgoing][incident]`, each X, Y, Z, U.
///
/// A mixture of materials has the mixture of their matrices, so these may be interpolated and filtered.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[must_use]
pub struct ReducedMatrix(pub [[f64; 4]; 4]);

impl ReducedMatrix {
    /// A matrix of X, Y, Z that leaves U alone.
    pub(crate) fn of_colors(Matrix3([a, b, c]): Matrix3) -> Self {
        let [a, b, c] = [a, b, c].map(|[x, y, z]| [x, y, z, 0.0]);
        Self([a, b, c, [0.0, 0.0, 0.0, 1.0]])
    }
}

impl Mul<Xyzu> for ReducedMatrix {
    type Output = Xyzu;

    fn mul(self, light: Xyzu) -> Xyzu {
        Xyzu(self.0.map(|row| row.iter().zip(light.0).map(|(m, v)| m * v).sum()))
    }
}

impl Mul for ReducedMatrix {
    type Output = Self;

    fn mul(self, first: Self) -> Self {
        Self(product(&self.0, &first.0))
    }
}

impl Mul<f64> for ReducedMatrix {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|row| row.map(|v| v * factor)))
    }
}

impl Add for ReducedMatrix {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self([0, 1, 2, 3].map(|r| [0, 1, 2, 3].map(|c| self.0[r][c] + other.0[r][c])))
    }
}

/// Four lights that stand for every other, and how matrices are made of what a material makes of them.
///
/// With the lights bₖ as the columns of B, each (X, Y, Z, U), and as the columns of A what a material makes of
/// each of them, the matrix is A·B⁻¹: exact for each of the four and all their sums.
///
/// # Energy
///
/// Four numbers do not tell the power of a light. How strong it is, is therefore defined as
/// ‖v‖² = (x − y)² + y² + (3z)² + (4u)², where x, y, z, u are X, Y, Z, U relative to those of the contract's
/// light. No matrix returns a light stronger than it came, whatever its four numbers are: so no
/// number of reflections, by whichever materials, makes light grow.
///
/// Most materials keep to that by themselves. What A·B⁻¹ adds where a steep curve does not is taken away
/// again from lights other than the contract's own, under which the color stays exact. The factors make blue and
/// ultraviolet as strong as the red and yellow, or the blue, that a dye can make of them: with smaller ones more
/// matrices have to be changed, with greater ones a little ultraviolet would hide a gain of luminance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reduction {
    basis_from_light: [[f64; 4]; 4],
    white: Xyzu,
    strength_from_light: [[f64; 4]; 4],
    light_from_strength: [[f64; 4]; 4],
    /// U of light of which only X, Y, Z are known.
    ultraviolet_from_xyz: [f64; 3],
    /// An orthogonal and symmetric matrix whose first column has the direction of the white.
    reflection: [[f64; 4]; 4],
}

/// How much more than luminance blue and ultraviolet count in the strength of a light; see [`Reduction`].
const BLUE: f64 = 3.0;
const ULTRAVIOLET: f64 = 4.0;

/// The U, in units of daylight's, that a contract's light is taken to have at least where strengths are compared:
/// beside none at all, any ultraviolet would be infinitely strong.
const LEAST_U: f64 = 0.05;

/// Rounding of a matrix that returns all light, such as white's.
const ROUNDING: f64 = 1e-9;

/// The least of 1 less a squared strength that is divided by. With a smaller one, rounding of the squares
/// of the quotients is no longer small beside 1; with a greater one, less of a matrix is kept.
const LEAST_LOSS: f64 = 1e-6;

impl Reduction {
    /// From four lights, blue, green, red and ultraviolet, and the contract's light, which is the sum of all or
    /// of the first three. `None` if they cannot be told apart by their numbers.
    pub fn try_new(lights: [Xyzu; 4], white: Xyzu) -> Option<Self> {
        let basis_from_light = inverse(transposed(&lights.map(|light| light.0)))?;
        let [x, y, z, _] = white.0.map(f64::recip);
        let u = white.0[3].max(LEAST_U).recip();
        let strength_from_light = [
            [x, -y, 0.0, 0.0],
            [0.0, y, 0.0, 0.0],
            [0.0, 0.0, BLUE * z, 0.0],
            [0.0, 0.0, 0.0, ULTRAVIOLET * u],
        ];
        let light_from_strength = inverse(strength_from_light)?;
        let own = (ReducedMatrix(strength_from_light) * white).0;
        let [_, green, red, _] = lights.map(|light| light.0);
        let blue = [0, 1, 2, 3].map(|k| white.0[k] - green[k] - red[k]);
        let xyz_from_basis =
            Matrix3::from_columns([blue, green, red].map(|[x, y, z, _]| [x, y, z]));
        let basis_from_xyz = xyz_from_basis.inverse()?;
        let [ultraviolet_from_xyz] = product(&[[blue[3], green[3], red[3]]], &basis_from_xyz.0);
        let reflection = reflection(own);
        Some(Self {
            basis_from_light,
            white,
            strength_from_light,
            light_from_strength,
            ultraviolet_from_xyz,
            reflection,
        })
    }

    /// The contract's light.
    pub fn white(&self) -> Xyzu {
        self.white
    }

    /// How strong a light is; see [`Reduction`].
    pub fn strength(&self, light: Xyzu) -> f64 {
        length((ReducedMatrix(self.strength_from_light) * light).0)
    }

    /// The greatest ratio of the strengths of what leaves and what arrived, over all lights.
    pub fn gain(&self, matrix: ReducedMatrix) -> f64 {
        let own = self.in_strength(matrix);
        let (squares, _) = symmetric_eigen(product(&transposed(&own), &own));
        squares.into_iter().fold(0.0, f64::max).sqrt()
    }

    /// The matrix of a material that makes `answers` of the four lights.
    pub fn matrix(&self, answers: [Xyzu; 4]) -> ReducedMatrix {
        self.limited(self.unlimited(answers))
    }

    /// A·B⁻¹ itself, which may return light stronger than it came.
    pub fn unlimited(&self, answers: [Xyzu; 4]) -> ReducedMatrix {
        let columns = transposed(&answers.map(|answer| answer.0));
        ReducedMatrix(product(&columns, &self.basis_from_light))
    }

    /// What the matrix makes of X, Y, Z where no ultraviolet is known: blue light then brings as much of it as the
    /// contract's does. Exact under the contract's light. Such matrices may be mixed as those of four numbers
    /// may; that no light comes back stronger is not promised for them.
    pub fn without_ultraviolet(&self, matrix: ReducedMatrix) -> Matrix3 {
        let [x, y, z, _] = matrix.0;
        let row = |[a, b, c, u]: [f64; 4]| {
            let known = [a, b, c];
            [0, 1, 2].map(|k| known[k] + u * self.ultraviolet_from_xyz[k])
        };
        Matrix3([x, y, z].map(row))
    }

    /// The matrix, or one near it that returns no light stronger.
    ///
    /// In coordinates where strength is length and the first axis is the contract's light, a matrix [c N]
    /// is no longer than 1 iff |c| ≤ 1 and K = (1 − ccᵀ)^(−½)·N is not: the singular values of K are clipped
    /// at 1. So c, the color under the contract's light, stays.
    ///
    /// # Source
    ///
    /// `parrott`, for a matrix of which one column is given.
    fn limited(&self, matrix: ReducedMatrix) -> ReducedMatrix {
        if self.gain(matrix) <= 1.0 + ROUNDING {
            return matrix;
        }
        let rows = product(&self.in_strength(matrix), &self.reflection);
        let mut first = rows.map(|row| row[0]);
        let size = length(first);
        if size > 1.0 {
            first = first.map(|v| v / size);
        }
        let others = rows.map(|[_, others @ ..]| others);
        let direction = if size > 0.0 { first.map(|v| v / length(first)) } else { first };
        let loss = 1.0 - size.min(1.0).powi(2);
        let kept = along(direction, loss.max(LEAST_LOSS).sqrt().recip(), &others);
        let (squares, vectors) = symmetric_eigen(product(&transposed(&kept), &kept));
        let clip = |k: usize| squares[k].max(1.0).sqrt().recip();
        let clips = std::array::from_fn(|r| std::array::from_fn(|c| vectors[r][c] * clip(c)));
        let kept = product(&product(&kept, &clips), &transposed::<3, 3>(&vectors));
        let others = along(direction, loss.sqrt(), &kept);
        let rows = [0, 1, 2, 3].map(|r| {
            let [a, b, c] = others[r];
            [first[r], a, b, c]
        });
        let back = product(&self.light_from_strength, &product(&rows, &self.reflection));
        ReducedMatrix(product(&back, &self.strength_from_light))
    }

    fn in_strength(&self, matrix: ReducedMatrix) -> [[f64; 4]; 4] {
        product(&product(&self.strength_from_light, &matrix.0), &self.light_from_strength)
    }
}

fn length(v: [f64; 4]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// The reflection that exchanges the first axis and the direction of `v`, whose second component is positive.
fn reflection(v: [f64; 4]) -> [[f64; 4]; 4] {
    let size = length(v);
    let [a, rest @ ..] = v.map(|v| v / size);
    let mirror = [a - 1.0, rest[0], rest[1], rest[2]];
    let square: f64 = mirror.iter().map(|m| m * m).sum();
    let entry = |r: usize, c: usize| {
        let one = if r == c { 1.0 } else { 0.0 };
        one - 2.0 * mirror[r] * mirror[c] / square
    };
    std::array::from_fn(|r| std::array::from_fn(|c| entry(r, c)))
}

/// The columns with their component along `direction` scaled.
fn along(direction: [f64; 4], scale: f64, columns: &[[f64; 3]; 4]) -> [[f64; 3]; 4] {
    let parts: [f64; 3] =
        std::array::from_fn(|c| (0..4).map(|r| direction[r] * columns[r][c]).sum());
    let entry = |r: usize, c: usize| columns[r][c] + (scale - 1.0) * direction[r] * parts[c];
    std::array::from_fn(|r| std::array::from_fn(|c| entry(r, c)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding only, of products of numbers near 1.
    const EXACT: f64 = 1e-12;

    fn reduction() -> Reduction {
        let lights = [
            [0.19, 0.09, 1.0, 0.6],
            [0.2, 0.6, 0.08, 0.01],
            [0.56, 0.31, 0.0, 0.0],
            [0.0, 0.0, 0.0, 0.39],
        ];
        let white =
            lights.iter().fold([0.0; 4], |sum, light| [0, 1, 2, 3].map(|k| sum[k] + light[k]));
        Reduction::try_new(lights.map(Xyzu), Xyzu(white)).unwrap()
    }

    #[test]
    fn white_has_the_identity() {
        let reduction = reduction();
        let lights = transposed(&inverse(reduction.basis_from_light).unwrap());
        let white = reduction.matrix(lights.map(Xyzu));
        for r in 0..4 {
            for c in 0..4 {
                let one = if r == c { 1.0 } else { 0.0 };
                assert!((white.0[r][c] - one).abs() < EXACT, "{white:?}");
            }
        }
        assert!((reduction.gain(white) - 1.0).abs() < EXACT);
    }

    #[test]
    fn no_light_comes_back_stronger_and_the_color_under_the_contract_stays() {
        // What ROUNDING lets pass.
        const GAIN: f64 = 1e-9;
        let reduction = reduction();
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let (mut limited, mut kept) = (0, 0);
        for _ in 0..2000 {
            let spread = 1.5 * random();
            let mut raw = ReducedMatrix::default();
            raw.0.as_flattened_mut().iter_mut().for_each(|v| *v = spread * (random() - 0.3));
            let found = reduction.limited(raw);
            assert!(reduction.gain(found) <= 1.0 + GAIN, "{raw:?} {found:?}");
            let (before, after) = (raw * reduction.white(), found * reduction.white());
            if reduction.strength(before) <= reduction.strength(reduction.white()) {
                for k in 0..4 {
                    assert!((before.0[k] - after.0[k]).abs() < EXACT, "{before:?} {after:?}");
                }
            }
            let was_within = reduction.gain(raw) <= 1.0;
            kept += usize::from(was_within);
            limited += usize::from(!was_within);
            assert!(!was_within || found == raw, "{raw:?} {found:?}");
        }
        assert!(limited > 100 && kept > 100, "{limited} {kept}");
    }

    #[test]
    fn without_ultraviolet_the_color_under_the_contract_is_the_same() {
        let reduction = reduction();
        let matrix = ReducedMatrix([
            [0.5, 0.1, 0.2, 0.1],
            [0.1, 0.6, 0.1, 0.3],
            [0.0, 0.0, 0.3, 0.1],
            [0.0, 0.0, 0.1, 0.2],
        ]);
        let expected = (matrix * reduction.white()).xyz();
        let found = reduction.without_ultraviolet(matrix) * reduction.white().xyz().0;
        for k in 0..3 {
            assert!((found[k] - expected.0[k]).abs() < EXACT, "{found:?} {expected:?}");
        }
    }
}
