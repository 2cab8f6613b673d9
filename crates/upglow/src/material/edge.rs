//! A smooth reflectance by its steepest point.

use crate::material::sigmoid::{Sigmoid, sigmoid};

/// The reflectance with its greatest slope at `edge_nm`.
///
/// With P = `level`, s = `slope_per_nm` and d = λ − `edge_nm`, the parabola is
/// x = P + 2s(1 + P²)^(3/2)·d + 6s²P(1 + P²)²·d².
///
/// This form describes every [`Sigmoid`], including flat and straight ones, with bounded numbers:
/// cubes store it, fits optimize it, and the slope limit bounds a single number. Compared with
/// [`crate::Features`], `edge_nm` is shift ± width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// A wavelength at which |dr/dλ| is greatest, nm.
    pub edge_nm: f64,
    /// The parabola there; > 0 where the reflectance is U-shaped, < 0 where it is n-shaped.
    pub level: f64,
    /// dr/dλ there, 1/nm; 0 is a flat reflectance.
    pub slope_per_nm: f64,
}

impl Edge {
    /// Reflectance at `lambda_nm`, 0..=1.
    pub fn at(self, lambda_nm: f64) -> f64 {
        let d = lambda_nm - self.edge_nm;
        let [constant, linear, quadratic] = self.parabola();
        sigmoid(constant + d * (linear + d * quadratic))
    }

    /// Coefficients of 1, d and d² (1, 1/nm, 1/nm²), with d = λ − `edge_nm`.
    ///
    /// # Source
    ///
    /// From `konig`, Algorithm 1, with the origin moved to z ± w: there the sigmoid's argument is
    /// P, and the condition that its slope is greatest ties the quadratic coefficient to P and s.
    pub fn parabola(self) -> [f64; 3] {
        let Self { level: p, slope_per_nm: s, .. } = self;
        let flatness = 1.0 + p * p;
        [p, 2.0 * s * flatness * flatness.sqrt(), 6.0 * s * s * p * flatness * flatness]
    }

    /// The reflectance that has this one's value and slope at `lambda_nm`, and is steepest there.
    ///
    /// Its slope is nowhere greater than the greatest of this one. It nearly is this one where the
    /// slope varies little.
    #[must_use]
    pub fn tangent(self, lambda_nm: f64) -> Self {
        let d = lambda_nm - self.edge_nm;
        let [constant, linear, quadratic] = self.parabola();
        let level = constant + d * (linear + d * quadratic);
        let flatness = 1.0 + level * level;
        let slope_per_nm = 0.5 * (linear + 2.0 * d * quadratic) / (flatness * flatness.sqrt());
        Self { edge_nm: lambda_nm, level, slope_per_nm }
    }

    /// The coefficient form.
    pub fn to_sigmoid(self) -> Sigmoid {
        let [constant, linear, quadratic] = self.parabola();
        let e = self.edge_nm;
        Sigmoid {
            c0: quadratic,
            c1: linear - 2.0 * quadratic * e,
            c2: constant - e * (linear - quadratic * e),
        }
    }
}

impl Sigmoid {
    /// The form by the steepest point; of the two, the one nearer to `near_nm`.
    pub fn to_edge(self, near_nm: f64) -> Edge {
        let Self { c0, c1, c2 } = self;
        // Around `near_nm` the coefficients are small, without cancellation.
        let (k, b, x) = (c0, c1 + 2.0 * c0 * near_nm, c2 + near_nm * (c1 + c0 * near_nm));
        let discriminant = b * b - 4.0 * k * x;
        let r = (9.0 / 16.0 * discriminant * discriminant + 5.0 * k * k).sqrt();
        if r == 0.0 {
            return Edge { edge_nm: near_nm, level: x, slope_per_nm: 0.0 };
        }
        // Two forms of one P: each is free of cancellation for its sign of the discriminant.
        let level = if discriminant > 0.0 {
            k / (r + 0.75 * discriminant)
        } else {
            (r - 0.75 * discriminant) / (5.0 * k)
        };
        // The parabola's slope there: b² − 4k(x − P) = discriminant + 4kP, which is not negative.
        let slope = (discriminant + 4.0 * k * level).max(0.0).sqrt();
        // k·d² + b·d + x = P: the root without cancellation is the nearer one.
        let sum = if b >= 0.0 { b + slope } else { b - slope };
        let d = if sum == 0.0 { 0.0 } else { 2.0 * (level - x) / sum };
        let flatness = 1.0 + level * level;
        Edge {
            edge_nm: near_nm + d,
            level,
            slope_per_nm: 0.5 * slope.copysign(sum) / (flatness * flatness.sqrt()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::features::Features;
    use proptest::prelude::*;

    /// Single precision of the three numbers, through a parabola whose terms are near 10.
    const SINGLE: f64 = 1e-5;

    fn any_edge() -> impl Strategy<Value = Edge> {
        (300.0..830.0, -2.5..2.5, -0.02..0.02).prop_map(|(edge_nm, level, slope_per_nm)| Edge {
            edge_nm,
            level,
            slope_per_nm,
        })
    }

    proptest! {
        #[test]
        fn the_greatest_slope_is_at_the_edge(edge in any_edge()) {
            let r = edge.to_sigmoid();
            let s = edge.slope_per_nm;
            // Coefficients near 1e3 lose that many digits.
            prop_assert!((r.slope_per_nm(edge.edge_nm) - s).abs() < 1e-9 + 1e-7 * s.abs());
            prop_assert!((r.at(500.0) - edge.at(500.0)).abs() < 1e-9);
        }

        #[test]
        fn the_tangent_has_value_and_slope_there_and_is_nowhere_steeper(
            edge in any_edge(),
            nm in 300.0..830.0,
        ) {
            let tangent = edge.tangent(nm);
            prop_assert!((tangent.at(nm) - edge.at(nm)).abs() < 1e-12);
            // Coefficients near 1e3 lose that many digits.
            let slope = edge.to_sigmoid().slope_per_nm(nm);
            prop_assert!((tangent.slope_per_nm - slope).abs() < 1e-9 + 1e-7 * slope.abs());
            prop_assert!(tangent.slope_per_nm.abs() <= edge.slope_per_nm.abs() * (1.0 + 1e-9));
        }

        #[test]
        fn features_name_the_same_curve(edge in any_edge()) {
            prop_assume!(edge.level.abs() > 1e-3 && edge.slope_per_nm.abs() > 1e-5);
            let features = edge.to_sigmoid().to_vertex().unwrap().to_features().unwrap();
            let Features { shift_nm, width_nm, slope_per_nm } = features;
            prop_assert!((slope_per_nm.abs() / edge.slope_per_nm.abs() - 1.0).abs() < 1e-6);
            prop_assert_eq!(slope_per_nm > 0.0, edge.level > 0.0);
            let distance = (edge.edge_nm - shift_nm).abs();
            prop_assert!((distance / width_nm - 1.0).abs() < 1e-5);
        }

        #[test]
        fn it_survives_conversion_to_coefficients_and_back(edge in any_edge(), nm in 300.0..830.0) {
            for near in [edge.edge_nm, 400.0, 700.0] {
                let back = edge.to_sigmoid().to_edge(near);
                prop_assert!((back.at(nm) - edge.at(nm)).abs() < 1e-6, "{back:?}");
            }
        }

        #[test]
        #[expect(clippy::cast_possible_truncation, reason = "rounding is what is tested")]
        fn single_precision_is_enough(edge in any_edge(), nm in 300.0..830.0) {
            let single = |v: f64| f64::from(v as f32);
            let stored = Edge {
                edge_nm: single(edge.edge_nm),
                level: single(edge.level),
                slope_per_nm: single(edge.slope_per_nm),
            };
            prop_assert!((stored.at(nm) - edge.at(nm)).abs() < SINGLE);
        }
    }

    #[test]
    fn flat_and_straight_reflectances_have_an_edge() {
        for value in [0.0, 0.3, 1.0] {
            let edge = Sigmoid::flat(value).to_edge(550.0);
            assert_eq!((edge.slope_per_nm, edge.at(400.0)), (0.0, Sigmoid::flat(value).at(400.0)));
        }
        let straight = Sigmoid { c0: 0.0, c1: -0.02, c2: 0.02 * 600.0 };
        let edge = straight.to_edge(550.0);
        assert!((edge.edge_nm - 600.0).abs() < 1e-9 && edge.level == 0.0);
        assert!((edge.slope_per_nm + 0.01).abs() < 1e-12);
    }
}
