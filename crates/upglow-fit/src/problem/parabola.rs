//! The parabola of a sigmoid as a function of the coordinates of fits.

use upglow::{Edge, Sigmoid};

/// Middle of the scaled wavelength t = (λ − 565) / 100: the visible range is −2..2.
const CENTER_NM: f64 = 565.0;
/// Length of one unit of t, nm.
pub(crate) const UNIT_NM: f64 = 100.0;

/// A shape has two steepest points; the one nearer to this wavelength, nm, is its edge.
pub(crate) const MIDDLE_NM: f64 = 540.0;

/// A wavelength as t.
pub(crate) fn scaled(lambda_nm: f64) -> f64 {
    (lambda_nm - CENTER_NM) / UNIT_NM
}

/// Coefficients of 1, t, t².
pub(crate) type Parabola = [f64; 3];

/// A parabola and its derivatives with respect to three coordinates, `[coefficient][coordinate]`.
pub(crate) type Chart = (Parabola, [[f64; 3]; 3]);

/// The parabola with these coefficients as its coordinates.
pub(crate) fn free_chart(coefficients: [f64; 3]) -> Chart {
    (coefficients, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
}

/// The reflectance with these coefficients.
pub(crate) fn sigmoid_of([q0, q1, q2]: Parabola) -> Sigmoid {
    let c0 = q2 / (UNIT_NM * UNIT_NM);
    let b = q1 / UNIT_NM;
    Sigmoid { c0, c1: b - 2.0 * c0 * CENTER_NM, c2: q0 - CENTER_NM * (b - c0 * CENTER_NM) }
}

/// The parabola of [`Edge`] with edge = `numbers[0]` (in t), level = `numbers[1]` and slope =
/// `numbers[2]` · `slope_limit_per_nm`.
///
/// With d = t − e: x = P + b·d + k·d²; b = 2s(1 + P²)^(3/2), k = 6s²P(1 + P²)².
pub(crate) fn edge_chart([e, p, relative]: [f64; 3], slope_limit_per_nm: f64) -> Chart {
    let unit = slope_limit_per_nm * UNIT_NM;
    let s = relative * unit;
    let g = 1.0 + p * p;
    let root = g.sqrt();
    let b = 2.0 * s * g * root;
    let k = 6.0 * s * s * p * g * g;
    let b_by = [6.0 * s * p * root, 2.0 * g * root * unit];
    let k_by = [6.0 * s * s * g * (g + 4.0 * p * p), 12.0 * s * p * g * g * unit];
    let by_level_or_slope = |level: f64, b_by: f64, k_by: f64| {
        [level - e * b_by + e * e * k_by, b_by - 2.0 * e * k_by, k_by]
    };
    let by_edge = [-b + 2.0 * e * k, -2.0 * k, 0.0];
    let by_level = by_level_or_slope(1.0, b_by[0], k_by[0]);
    let by_slope = by_level_or_slope(0.0, b_by[1], k_by[1]);
    let jacobian = [0, 1, 2].map(|m| [by_edge[m], by_level[m], by_slope[m]]);
    ([p - b * e + k * e * e, b - 2.0 * k * e, k], jacobian)
}

/// The parabola of [`upglow::Features`] with shift = `numbers[0]` and width = `numbers[1]` (in t),
/// and slope = `numbers[2]` · `slope_limit_per_nm`, which is not 0.
///
/// # Source
///
/// `konig`, Algorithm 1; with σ the sign of the slope and P = σ|P| the parabola at the steepest
/// point: |P|√(1 + P²) = 1/(6|s|w), c0 = s(1 + P²)^(3/2)/w, p = (5P² − 1)/(6P).
pub(crate) fn feature_chart([z, w, relative]: [f64; 3], slope_limit_per_nm: f64) -> Chart {
    let unit = slope_limit_per_nm * UNIT_NM;
    let (s, sign) = (relative.abs() * unit, relative.signum());
    let product = 1.0 / (6.0 * s * w);
    let p = (0.5 * ((1.0 + 4.0 * product * product).sqrt() - 1.0)).sqrt();
    let g = 1.0 + p * p;
    let p_by_product = g.sqrt() / (1.0 + 2.0 * p * p);
    let (p_by_w, p_by_s) = (-p_by_product * product / w, -p_by_product * product / s);
    let c0 = sign * s * g * g.sqrt() / w;
    let c0_by_p = 3.0 * p / g * c0;
    let peak = sign * (5.0 * p * p - 1.0) / (6.0 * p);
    let peak_by_p = sign * (5.0 + 1.0 / (p * p)) / 6.0;
    let by_width = [c0_by_p * p_by_w - c0 / w, peak_by_p * p_by_w];
    let by_slope = [c0_by_p * p_by_s + c0 / s, peak_by_p * p_by_s].map(|v| v * sign * unit);
    let expand = |[c0_by, peak_by]: [f64; 2]| [z * z * c0_by + peak_by, -2.0 * z * c0_by, c0_by];
    let by_shift = [2.0 * c0 * z, -2.0 * c0, 0.0];
    let (by_width, by_slope) = (expand(by_width), expand(by_slope));
    let jacobian = [0, 1, 2].map(|m| [by_shift[m], by_width[m], by_slope[m]]);
    ([c0 * z * z + peak, -2.0 * c0 * z, c0], jacobian)
}

/// The coordinates of [`feature_chart`] for a reflectance; `None` if it has no features.
pub(crate) fn feature_numbers(edge: Edge, slope_limit_per_nm: f64) -> Option<[f64; 3]> {
    let features = edge.to_sigmoid().to_vertex()?.to_features()?;
    let slope = features.slope_per_nm / slope_limit_per_nm;
    Some([scaled(features.shift_nm), features.width_nm / UNIT_NM, slope])
}

/// The greatest |dr/dλ| relative to `slope_limit_per_nm`, and its derivatives with respect to the
/// coefficients. At its maximum the slope is stationary in wavelength, so that the shift of the maximum
/// does not contribute.
pub(crate) fn steepness(parabola: Parabola, slope_limit_per_nm: f64) -> (f64, [f64; 3]) {
    let edge = sigmoid_of(parabola).to_edge(CENTER_NM);
    let t = scaled(edge.edge_nm);
    let [_, q1, q2] = parabola;
    let (x, x_slope) = (edge.level, q1 + 2.0 * q2 * t);
    let g = 1.0 + x * x;
    let unit = slope_limit_per_nm * UNIT_NM * x_slope.signum();
    let scale = 0.5 / (g * g.sqrt()) / unit;
    let by_value = -3.0 * x * x_slope / g * scale;
    let by = [by_value, by_value * t + scale, (by_value * t + 2.0 * scale) * t];
    (edge.slope_per_nm.abs() / slope_limit_per_nm, by)
}

/// The reflectance that [`edge_chart`] describes.
pub(crate) fn edge_of([e, p, relative]: [f64; 3], slope_limit_per_nm: f64) -> Edge {
    Edge { edge_nm: CENTER_NM + UNIT_NM * e, level: p, slope_per_nm: relative * slope_limit_per_nm }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_edge_chart_is_the_edge_form() {
        for numbers in [[0.3, 0.5, 1.0], [-1.2, -1.5, -0.7], [0.0, 0.0, 1.0], [2.0, 2.0, -0.2]] {
            let edge = edge_of(numbers, 0.01);
            let (parabola, _) = edge_chart(numbers, 0.01);
            for nm in [380.0, 500.0, 565.0, 700.0] {
                // Rounding only.
                assert!((sigmoid_of(parabola).at(nm) - edge.at(nm)).abs() < 1e-9, "{numbers:?}");
            }
        }
    }

    /// Derivatives against central differences of this step, which err by its square, relative to
    /// derivatives near 10.
    fn assert_derivatives(numbers: [f64; 3], chart: impl Fn([f64; 3]) -> Chart) {
        const STEP: f64 = 1e-5;
        let (_, jacobian) = chart(numbers);
        for v in 0..3 {
            let moved = |by: f64| {
                let mut n = numbers;
                n[v] += by;
                chart(n).0
            };
            let (low, high) = (moved(-STEP), moved(STEP));
            for m in 0..3 {
                let quotient = (high[m] - low[m]) / (2.0 * STEP);
                let scale = 1.0 + quotient.abs();
                assert!((jacobian[m][v] - quotient).abs() < 1e-7 * scale, "{numbers:?} {v} {m}");
            }
        }
    }

    #[test]
    fn derivatives_match_differences() {
        for numbers in [[0.3, 0.5, 1.0], [-1.2, -1.5, -0.7], [0.0, 0.0, 0.4]] {
            assert_derivatives(numbers, |n| edge_chart(n, 0.01));
        }
        for numbers in [[0.3, 0.5, 1.0], [-1.2, 1.5, -0.7], [0.1, 0.8, 0.4]] {
            assert_derivatives(numbers, |n| feature_chart(n, 0.01));
        }
        for parabola in [[0.3, 0.5, 1.0], [-1.2, 1.5, -0.7], [0.1, -2.0, 0.0]] {
            assert_derivatives(parabola, |q| {
                let (value, by) = steepness(q, 0.01);
                ([value, 0.0, 0.0], [by, [0.0; 3], [0.0; 3]])
            });
        }
    }

    #[test]
    fn the_feature_chart_is_algorithm_1() {
        for numbers in [[0.3, 0.5, 1.0], [-1.2, 1.5, -0.7]] {
            let (parabola, _) = feature_chart(numbers, 0.01);
            let edge = sigmoid_of(parabola).to_edge(550.0);
            let back = feature_numbers(edge, 0.01).unwrap();
            for k in 0..3 {
                // Rounding only.
                assert!((back[k] - numbers[k]).abs() < 1e-9, "{back:?}");
            }
        }
    }
}
