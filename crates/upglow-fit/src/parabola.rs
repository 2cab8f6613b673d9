//! The parabola behind a sigmoid in the coordinates that fits move in.

use upglow::{Edge, Sigmoid};

/// Middle of the scaled wavelength t = (λ − 565) / 100: the visible range is −2..2.
const CENTER_NM: f64 = 565.0;
/// Length of one unit of t, nm.
const UNIT_NM: f64 = 100.0;

/// A wavelength in the fit's own unit.
pub(crate) fn scaled(lambda_nm: f64) -> f64 {
    (lambda_nm - CENTER_NM) / UNIT_NM
}

/// Coefficients of 1, t, t².
pub(crate) type Parabola = [f64; 3];

/// A parabola and its derivatives by three shape numbers, `[coefficient][number]`.
pub(crate) type Chart = (Parabola, [[f64; 3]; 3]);

/// The parabola that is its own coordinates.
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

/// The numbers of [`edge_chart`] for a reflectance: its steepest point nearer to `near_nm`.
pub(crate) fn edge_numbers(parabola: Parabola, near_nm: f64, slope_limit_per_nm: f64) -> [f64; 3] {
    let edge = sigmoid_of(parabola).to_edge(near_nm);
    [scaled(edge.edge_nm), edge.level, edge.slope_per_nm / slope_limit_per_nm]
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
            let back = edge_numbers(parabola, edge.edge_nm, 0.01);
            let again = sigmoid_of(edge_chart(back, 0.01).0);
            assert!((again.at(600.0) - edge.at(600.0)).abs() < 1e-9);
        }
    }

    #[test]
    fn derivatives_match_differences() {
        // A central difference of this step errs by its square, relative to derivatives near 10.
        const STEP: f64 = 1e-5;
        for numbers in [[0.3, 0.5, 1.0], [-1.2, -1.5, -0.7], [0.0, 0.0, 0.4]] {
            let (_, jacobian) = edge_chart(numbers, 0.01);
            for v in 0..3 {
                let moved = |by: f64| {
                    let mut n = numbers;
                    n[v] += by;
                    edge_chart(n, 0.01).0
                };
                let (low, high) = (moved(-STEP), moved(STEP));
                for m in 0..3 {
                    let quotient = (high[m] - low[m]) / (2.0 * STEP);
                    let scale = 1.0 + quotient.abs();
                    assert!(
                        (jacobian[m][v] - quotient).abs() < 1e-7 * scale,
                        "{numbers:?} {v} {m}"
                    );
                }
            }
        }
    }
}
