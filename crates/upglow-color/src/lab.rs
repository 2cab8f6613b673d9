//! CIELAB.

use crate::matrix::Matrix3;
use crate::values::Xyz;

/// CIELAB coordinates relative to a white.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[must_use]
pub struct Lab {
    /// Lightness; 0 is black, 100 the white.
    pub l: f64,
    /// Green (negative) to red (positive).
    pub a: f64,
    /// Blue (negative) to yellow (positive).
    pub b: f64,
}

/// (6/29)³: at and below it the response is linear instead of a cube root.
const LINEAR_BELOW: f64 = 216.0 / 24389.0;
/// Slope of that line: (29/3)³ / 116.
const LINEAR_SLOPE: f64 = 24389.0 / 27.0 / 116.0;

/// CIELAB of `xyz` relative to `white`.
///
/// Negative tristimulus values follow the linear branch, so wide-gamut primaries have coordinates.
///
/// # Source
///
/// `cie015`, section 8.2.1.
pub fn lab_from_xyz(xyz: Xyz, white: Xyz) -> Lab {
    lab_jacobian(xyz, white).0
}

/// The color with these coordinates relative to `white`; the inverse of [`lab_from_xyz`].
///
/// # Source
///
/// `cie015`, section 8.2.1 and appendix D.
pub fn xyz_from_lab(lab: Lab, white: Xyz) -> Xyz {
    let fy = (lab.l + 16.0) / 116.0;
    let f = [fy + lab.a / 500.0, fy, fy - lab.b / 200.0];
    Xyz([0, 1, 2].map(|k| white.0[k] * expand(f[k])))
}

/// The inverse of [`compress`].
fn expand(response: f64) -> f64 {
    let cube = response * response * response;
    if cube > LINEAR_BELOW { cube } else { (response - 16.0 / 116.0) / LINEAR_SLOPE }
}

/// The coordinates, and their derivatives `[L a b][X Y Z]`.
#[inline]
pub(crate) fn lab_jacobian(xyz: Xyz, white: Xyz) -> (Lab, Matrix3) {
    let f = [0, 1, 2].map(|k| compress(xyz.0[k] / white.0[k]));
    let [dx, dy, dz] = [0, 1, 2].map(|k| f[k].1 / white.0[k]);
    let [fx, fy, fz] = f.map(|(value, _)| value);
    let lab = Lab { l: 116.0 * fy - 16.0, a: 500.0 * (fx - fy), b: 200.0 * (fy - fz) };
    let jacobian =
        [[0.0, 116.0 * dy, 0.0], [500.0 * dx, -500.0 * dy, 0.0], [0.0, 200.0 * dy, -200.0 * dz]];
    (lab, Matrix3(jacobian))
}

/// The compressed response to `t`, and its derivative.
fn compress(t: f64) -> (f64, f64) {
    if t > LINEAR_BELOW {
        let root = cube_root(t);
        (root, root / (3.0 * t))
    } else {
        (LINEAR_SLOPE * t + 16.0 / 116.0, LINEAR_SLOPE)
    }
}

/// This minus a third of a number's bits are the bits of its inverse cube root within 3.5 %, near
/// enough for three steps.
const INVERSE_ROOT_BITS: u64 = 0x553e_f0ff_289d_d796;

/// The cube root of a normal positive number, within two units of the last digit.
///
/// Halley's steps to the inverse root need no division and overlap for three channels; the standard
/// library's root, exact to the last bit, took a twelfth of a whole build.
fn cube_root(t: f64) -> f64 {
    let mut inverse = f64::from_bits(INVERSE_ROOT_BITS - t.to_bits() / 3);
    for _ in 0..3 {
        let off = 1.0 - t * inverse * inverse * inverse;
        inverse += inverse * off * (1.0 / 3.0 + 2.0 / 9.0 * off);
    }
    t * inverse * inverse
}

impl Lab {
    /// The Euclidean distance ΔE*ab of 1976.
    pub fn de76(self, other: Self) -> f64 {
        let [dl, da, db] = [self.l - other.l, self.a - other.a, self.b - other.b];
        (dl * dl + da * da + db * db).sqrt()
    }

    /// Distance from gray, C*.
    pub fn chroma(self) -> f64 {
        self.a.hypot(self.b)
    }

    /// ΔL*, ΔC* and ΔH* from this color to another: lighter, more colorful and counterclockwise, from red
    /// to yellow, are positive. Their squares add up to that of [`Lab::de76`].
    ///
    /// # Source
    ///
    /// `cie015`, section 8.2.1.
    pub fn lch_difference(self, other: Self) -> [f64; 3] {
        let lightness = other.l - self.l;
        let chroma = other.chroma() - self.chroma();
        let square = self.de76(other).powi(2) - lightness * lightness - chroma * chroma;
        let turn = self.a * other.b - self.b * other.a;
        [lightness, chroma, square.max(0.0).sqrt().copysign(turn)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: Xyz = Xyz([0.950_43, 1.0, 1.088_80]);

    #[test]
    fn white_is_100_and_black_is_0() {
        // Rounding only.
        assert!(lab_from_xyz(WHITE, WHITE).de76(Lab { l: 100.0, a: 0.0, b: 0.0 }) < 1e-12);
        assert!(lab_from_xyz(Xyz::default(), WHITE).de76(Lab::default()) < 1e-12);
    }

    #[test]
    fn lightness_chroma_and_hue_add_up_to_the_whole_difference() {
        // Rounding of numbers up to 200.
        const ROUNDING: f64 = 1e-6;
        let first = Lab { l: 50.0, a: 30.0, b: -40.0 };
        for (l, a, b) in [(50.0, 30.0, -40.0), (60.0, -7.0, 90.0), (0.0, 0.0, 0.0)] {
            let second = Lab { l, a, b };
            let there = first.lch_difference(second);
            let norm = there.iter().map(|v| v * v).sum::<f64>().sqrt();
            assert!((norm - first.de76(second)).abs() < ROUNDING, "{there:?}");
        }
        let [lighter, richer, turned] = first.lch_difference(Lab { l: 51.0, a: 40.0, b: -40.0 });
        assert!(lighter == 1.0 && richer > 0.0 && turned > 0.0);
    }

    #[test]
    fn the_cube_root_is_accurate() {
        // Two units of the last digit; the standard library's is right to half of one.
        const ROUNDING: f64 = 4.5e-16;
        // The first guess repeats every three octaves; the rest tests the ends.
        for step in 0..40_000 {
            let t = LINEAR_BELOW * (f64::from(step) * 2e-4).exp();
            assert!((cube_root(t) / t.cbrt() - 1.0).abs() <= ROUNDING, "{t}");
        }
    }

    #[test]
    fn derivatives_match_differences() {
        let step = 1e-6;
        for xyz in [[0.3, 0.4, 0.2], [0.002, 0.001, 0.003], [0.5, 0.2, -0.01]] {
            let (_, jacobian) = lab_jacobian(Xyz(xyz), WHITE);
            for k in 0..3 {
                let moved = |by: f64| {
                    let mut p = xyz;
                    p[k] += by;
                    lab_from_xyz(Xyz(p), WHITE)
                };
                let (up, down) = (moved(step), moved(-step));
                let slopes = [up.l - down.l, up.a - down.a, up.b - down.b];
                for (row, slope) in jacobian.0.iter().zip(slopes) {
                    let slope = slope / (2.0 * step);
                    // Truncation of the central difference, relative to the steepest branch.
                    assert!((row[k] - slope).abs() < 1e-6 * (1.0 + slope.abs()), "{xyz:?}");
                }
            }
        }
    }
}
