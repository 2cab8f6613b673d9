//! The CIEDE2000 color difference, as one number and as three residuals with derivatives.

use crate::jet::Jet;
use crate::lab::{Lab, lab_jacobian};
use crate::matrix::Matrix3;
use crate::values::Xyz;

/// CIEDE2000 of two colors with unit weights; symmetric.
///
/// # Source
///
/// `sharma`, equations 2 to 22.
pub fn ciede2000(reference: Lab, sample: Lab) -> f64 {
    let [l, c, h] = ciede2000_residuals(reference, sample).0;
    (l * l + c * c + h * h).sqrt()
}

/// A chroma that nobody sees, and with which the direction of a hue is exact to ten digits.
const NEUTRAL: f64 = 1e-4;

/// Derivatives by X, Y, Z, at a color seen against a white, of three numbers whose squares add up to the square of
/// CIEDE2000 from that color: small differences of color are linear in X, Y, Z.
pub fn difference_by_xyz(color: Xyz, white: Xyz) -> Matrix3 {
    let (lab, lab_by_xyz) = lab_jacobian(color, white);
    // A gray has no hue, in whose direction to differ: beside it the numbers are the same.
    let lab = Lab { a: if lab.chroma() < NEUTRAL { NEUTRAL } else { lab.a }, ..lab };
    ciede2000_residuals(lab, lab).1 * lab_by_xyz
}

/// Three numbers whose squares add up to the square of CIEDE2000, and their derivatives with respect to
/// the sample's coordinates, `[residual][L a b]`.
///
/// The residuals are `ΔL'/S_L`; `ΔC'/S_C + R_T/2 · ΔH'/S_H`; `√(1 − R_T²/4) · ΔH'/S_H`. A least-squares
/// solver needs all three: their norm alone as a residual gives it no useful curvature.
///
/// # Source
///
/// `sharma`, equations 2 to 22. Hues are unit vectors here, not angles: the mean hue is the direction
/// of their sum, the case that equation 14 selects.
pub fn ciede2000_residuals(reference: Lab, sample: Lab) -> ([f64; 3], Matrix3) {
    let (lightness, by_l) = lightness_residual(reference.l, sample.l);
    let [chroma, hue] = chromatic_residuals(reference, sample);
    let jacobian = [
        [by_l, 0.0, 0.0],
        [0.0, chroma.partials[0], chroma.partials[1]],
        [0.0, hue.partials[0], hue.partials[1]],
    ];
    ([lightness, chroma.value, hue.value], Matrix3(jacobian))
}

/// `ΔL'/S_L` and its derivative with respect to the sample's L.
fn lightness_residual(l1: f64, l2: f64) -> (f64, f64) {
    let from_middle = (l1 + l2) / 2.0 - 50.0;
    let square = from_middle * from_middle;
    let root = (20.0 + square).sqrt();
    let s_l = 1.0 + 0.015 * square / root;
    let s_l_by_l = 0.5 * 0.015 * from_middle * (40.0 + square) / (root * root * root);
    let difference = l2 - l1;
    (difference / s_l, (s_l - difference * s_l_by_l) / (s_l * s_l))
}

/// The second and third residual as functions of the sample's a and b.
fn chromatic_residuals(reference: Lab, sample: Lab) -> [Jet; 2] {
    let (a2, b2) = (Jet::variable(sample.a, 0), Jet::variable(sample.b, 1));
    let b1 = reference.b;
    let mean_chroma = ((a2 * a2 + b2 * b2).sqrt() + reference.a.hypot(b1)) * 0.5;
    let stretch = -saturation(mean_chroma) * 0.5 + 1.5;
    let (a1, a2) = (stretch * reference.a, stretch * a2);
    let c1 = (a1 * a1 + b1 * b1).sqrt();
    let c2 = (a2 * a2 + b2 * b2).sqrt();
    let b1 = Jet::constant(b1);

    let mean_c = (c1 + c2) * 0.5;
    let delta_c = c2 - c1;
    let (delta_h, mean_hue) = hue_difference([a1, b1, c1], [a2, b2, c2]);

    let s_c = mean_c * 0.045 + 1.0;
    let s_h = mean_c * hue_weight(mean_hue) * 0.015 + 1.0;
    let r_t = rotation(mean_c, mean_hue);
    let hue = delta_h / s_h;
    [delta_c / s_c + r_t * hue * 0.5, (-(r_t * r_t) * 0.25 + 1.0).sqrt() * hue]
}

/// √(C⁷ / (C⁷ + 25⁷)).
fn saturation(chroma: Jet) -> Jet {
    const POW7_OF_25: f64 = 6_103_515_625.0;
    let c7 = chroma.powi(7);
    (c7 / (c7 + POW7_OF_25)).sqrt()
}

/// ΔH' and the mean hue as a unit vector (cos, sin), from two colors (a', b', C').
fn hue_difference(first: [Jet; 3], second: [Jet; 3]) -> (Jet, [Jet; 2]) {
    let ([a1, b1, c1], [a2, b2, c2]) = (first, second);
    if c1.value == 0.0 || c2.value == 0.0 {
        return (Jet::constant(0.0), gray_mean_hue(first, second));
    }
    let product = c1 * c2;
    let cross = a1 * b2 - b1 * a2;
    let dot = a1 * a2 + b1 * b2;
    let both = product + dot;
    // 1 + cos Δh cancels to nothing for opposite hues.
    if both.value <= product.value * 1e-15 {
        return opposite_hues(first, second);
    }
    let delta_h = cross * std::f64::consts::SQRT_2 / both.sqrt();
    let (x, y) = (a1 / c1 + a2 / c2, b1 / c1 + b2 / c2);
    let norm = (x * x + y * y).sqrt();
    (delta_h, [x / norm, y / norm])
}

/// The mean hue if one color is gray: that of the other, or 0 for two grays.
fn gray_mean_hue([a1, b1, c1]: [Jet; 3], [a2, b2, c2]: [Jet; 3]) -> [Jet; 2] {
    if c1.value > 0.0 {
        [a1 / c1, b1 / c1]
    } else if c2.value > 0.0 {
        [a2 / c2, b2 / c2]
    } else {
        [Jet::constant(1.0), Jet::constant(0.0)]
    }
}

/// Hues 180° apart: the mean is 90° above the smaller angle. CIEDE2000 is discontinuous here, so the
/// mean hue gets no derivatives.
fn opposite_hues([a1, b1, c1]: [Jet; 3], [a2, b2, c2]: [Jet; 3]) -> (Jet, [Jet; 2]) {
    let in_first_turn = |a: Jet, b: Jet| b.value.atan2(a.value).rem_euclid(std::f64::consts::TAU);
    let rises = in_first_turn(a1, b1) < in_first_turn(a2, b2);
    let (a, b, c) = if rises { (a1, b1, c1) } else { (a2, b2, c2) };
    let delta_h = (c1 * c2).sqrt() * if rises { 2.0 } else { -2.0 };
    (delta_h, [-b / c, a / c].map(|v| Jet::constant(v.value)))
}

/// T from the mean hue, a unit vector.
fn hue_weight([cos, sin]: [Jet; 2]) -> Jet {
    let turn = |[c, s]: [Jet; 2]| [c * cos - s * sin, s * cos + c * sin];
    let twice = turn([cos, sin]);
    let thrice = turn(twice);
    let four_times = turn(thrice);
    let cos_after = |[c, s]: [Jet; 2], degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        c * cos - s * sin
    };
    cos_after([cos, sin], -30.0) * -0.17
        + twice[0] * 0.24
        + cos_after(thrice, 6.0) * 0.32
        + cos_after(four_times, -63.0) * -0.20
        + 1.0
}

/// `R_T`, the rotation term for blues.
fn rotation(mean_c: Jet, [cos, sin]: [Jet; 2]) -> Jet {
    let degrees = sin.atan2(cos) * 1f64.to_radians().recip();
    let wrapped = if degrees.value < 0.0 { degrees + 360.0 } else { degrees };
    let distance = (wrapped - 275.0) / 25.0;
    let angle = (-(distance * distance)).exp() * 60f64.to_radians();
    -(angle.sin() * saturation(mean_c) * 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn any_lab() -> impl Strategy<Value = Lab> {
        (0.0..100.0, -120.0..120.0, -120.0..120.0).prop_map(|(l, a, b)| Lab { l, a, b })
    }

    proptest! {
        #[test]
        fn derivatives_match_differences(reference in any_lab(), sample in any_lab()) {
            // Central differences with this step err by about its square and by rounding over it.
            const STEP: f64 = 1e-5;
            const TOLERANCE: f64 = 1e-5;
            // CIEDE2000 is discontinuous at opposite hues and has no derivative at gray.
            let cross = reference.a * sample.b - reference.b * sample.a;
            let product = reference.a.hypot(reference.b) * sample.a.hypot(sample.b);
            prop_assume!(cross.abs() > 0.1 * product && sample.a.hypot(sample.b) > 1.0);
            let (_, jacobian) = ciede2000_residuals(reference, sample);
            for k in 0..3 {
                let moved = |by: f64| {
                    let mut p = [sample.l, sample.a, sample.b];
                    p[k] += by;
                    ciede2000_residuals(reference, Lab { l: p[0], a: p[1], b: p[2] }).0
                };
                let (up, down) = (moved(STEP), moved(-STEP));
                for r in 0..3 {
                    let slope = (up[r] - down[r]) / (2.0 * STEP);
                    prop_assert!((jacobian.0[r][k] - slope).abs() < TOLERANCE * (1.0 + slope.abs()));
                }
            }
        }

        #[test]
        fn the_difference_is_symmetric(first in any_lab(), second in any_lab()) {
            let (there, back) = (ciede2000(first, second), ciede2000(second, first));
            // Rounding only.
            prop_assert!((there - back).abs() < 1e-9 * (1.0 + there));
        }

        #[test]
        fn a_color_has_no_difference_from_itself(color in any_lab()) {
            prop_assert!(ciede2000(color, color) < 1e-12);
        }
    }

    #[test]
    fn gray_and_opposite_hues_are_finite() {
        let at = |a: f64, b: f64| Lab { l: 50.0, a, b };
        for (first, second) in [
            (at(0.0, 0.0), at(0.0, 0.0)),
            (at(0.0, 0.0), at(3.0, 4.0)),
            (at(5.0, 0.0), at(-5.0, 0.0)),
            (at(0.0, 5.0), at(0.0, -5.0)),
        ] {
            assert!(ciede2000(first, second).is_finite());
            assert!(ciede2000_residuals(first, second).1.0.iter().flatten().all(|v| v.is_finite()));
        }
    }
}
