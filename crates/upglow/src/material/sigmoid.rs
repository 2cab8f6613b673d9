//! A smooth reflectance by its coefficients, and by its vertex.

/// Reflectance r(λ) = ½ + x / (2√(1 + x²)), x = c0·λ² + c1·λ + c2, λ in nm.
///
/// Every choice of finite coefficients is a valid reflectance, 0 ≤ r ≤ 1.
///
/// # Source
///
/// `jakob`; `konig`, equation 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Sigmoid {
    /// Coefficient of λ², 1/nm².
    pub c0: f64,
    /// Coefficient of λ, 1/nm.
    pub c1: f64,
    /// Constant coefficient.
    pub c2: f64,
}

/// The same reflectance by the vertex of its parabola: x = curvature·(λ − shift)² + peak.
///
/// It describes every [`Sigmoid`] except those with c0 = 0 and c1 ≠ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// c0, 1/nm²; 0 is a flat reflectance.
    pub curvature_per_nm2: f64,
    /// Wavelength of the extremum, nm.
    pub shift_nm: f64,
    /// The parabola's value at the extremum.
    pub peak: f64,
}

/// The parabola's value for an exactly white (negative: black) reflectance. Above 1e19 its square
/// overflows in single precision; below 1e8 the reflectance is not exactly 1 in double.
const SATURATED: f64 = 1e9;

/// Reflectance from the parabola's value.
pub(crate) fn sigmoid(x: f64) -> f64 {
    0.5 + 0.5 * x / (1.0 + x * x).sqrt()
}

impl Sigmoid {
    /// The reflectance that is `value`, 0..=1, at every wavelength.
    pub fn flat(value: f64) -> Self {
        let spread = (value * (1.0 - value)).sqrt();
        let c2 = ((value - 0.5) / spread).clamp(-SATURATED, SATURATED);
        Self { c0: 0.0, c1: 0.0, c2: if c2.is_nan() { 0.0 } else { c2 } }
    }

    /// Reflectance at `lambda_nm`, 0..=1.
    pub fn at(self, lambda_nm: f64) -> f64 {
        sigmoid(self.parabola(lambda_nm))
    }

    /// dr/dλ at `lambda_nm`, 1/nm.
    pub fn slope_per_nm(self, lambda_nm: f64) -> f64 {
        let x = self.parabola(lambda_nm);
        let flatness = 1.0 + x * x;
        0.5 * (2.0 * self.c0 * lambda_nm + self.c1) / (flatness * flatness.sqrt())
    }

    fn parabola(self, lambda_nm: f64) -> f64 {
        (self.c0 * lambda_nm + self.c1) * lambda_nm + self.c2
    }

    /// The greatest |dr/dλ| over all wavelengths, 1/nm, in closed form.
    pub fn steepest_slope_per_nm(self) -> f64 {
        steepest_slope(self.c0, self.c1 * self.c1 - 4.0 * self.c0 * self.c2)
    }

    /// The vertex form; `None` for a straight parabola, which has no vertex.
    pub fn to_vertex(self) -> Option<Vertex> {
        let Self { c0, c1, c2 } = self;
        if c0 == 0.0 {
            let flat = Vertex { curvature_per_nm2: 0.0, shift_nm: 0.0, peak: c2 };
            return (c1 == 0.0).then_some(flat);
        }
        let vertex = Vertex {
            curvature_per_nm2: c0,
            shift_nm: -c1 / (2.0 * c0),
            peak: c2 - c1 * c1 / (4.0 * c0),
        };
        (vertex.shift_nm.is_finite() && vertex.peak.is_finite()).then_some(vertex)
    }
}

impl Vertex {
    /// Reflectance at `lambda_nm`, 0..=1.
    pub fn at(self, lambda_nm: f64) -> f64 {
        let distance = lambda_nm - self.shift_nm;
        sigmoid(self.curvature_per_nm2 * distance * distance + self.peak)
    }

    /// The greatest |dr/dλ| over all wavelengths, 1/nm, in closed form.
    pub fn steepest_slope_per_nm(self) -> f64 {
        steepest_slope(self.curvature_per_nm2, -4.0 * self.curvature_per_nm2 * self.peak)
    }

    /// The coefficient form.
    pub fn to_sigmoid(self) -> Sigmoid {
        let Self { curvature_per_nm2: c0, shift_nm: z, peak: p } = self;
        Sigmoid { c0, c1: -2.0 * c0 * z, c2: c0 * z * z + p }
    }
}

/// The greatest slope of the sigmoid whose parabola has quadratic coefficient `c0` and
/// discriminant `d`. With R = √(9d²/16 + 5c0²), the slope's square is (d/2 + R) / (5(1 + P²)³),
/// where P is the parabola's value at the steepest point. Valid at c0 = 0 too.
fn steepest_slope(c0: f64, d: f64) -> f64 {
    let r = (9.0 / 16.0 * d * d + 5.0 * c0 * c0).sqrt();
    if r == 0.0 {
        return 0.0;
    }
    // Two forms of one P: each is free of cancellation for its sign of d.
    let p = if d > 0.0 { c0 / (r + 0.75 * d) } else { (r - 0.75 * d) / (5.0 * c0) };
    ((0.5 * d + r) / 5.0).sqrt() / (1.0 + p * p).powf(1.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Rounding only: numbers near 1 go through a square root and a division.
    const ROUNDING: f64 = 1e-9;

    fn any_sigmoid() -> impl Strategy<Value = Sigmoid> {
        (-1e-2..1e-2, 0.0..1000.0, -20.0..20.0).prop_map(|(c0, z, p)| {
            Vertex { curvature_per_nm2: c0, shift_nm: z, peak: p }.to_sigmoid()
        })
    }

    proptest! {
        #[test]
        fn a_reflectance_is_a_fraction_everywhere(r in any_sigmoid(), nm in 0.0..2000.0) {
            prop_assert!((0.0..=1.0).contains(&r.at(nm)));
        }

        #[test]
        fn no_slope_is_steeper_than_the_steepest(r in any_sigmoid()) {
            let steepest = r.steepest_slope_per_nm();
            let mut found: f64 = 0.0;
            for i in 0..40_000 {
                found = found.max(r.slope_per_nm(f64::from(i) * 0.05 - 500.0).abs());
            }
            prop_assert!(found <= steepest * (1.0 + 1e-6), "{found} {steepest}");
        }

        #[test]
        fn slope_is_the_difference_quotient(r in any_sigmoid(), nm in 300.0..830.0) {
            // A central difference of this step errs by its square times the third derivative.
            let h = 1e-4;
            let quotient = (r.at(nm + h) - r.at(nm - h)) / (2.0 * h);
            prop_assert!((r.slope_per_nm(nm) - quotient).abs() < 1e-6);
        }

        #[test]
        fn both_forms_are_the_same_curve(r in any_sigmoid(), nm in 300.0..830.0) {
            let vertex = r.to_vertex().unwrap();
            prop_assert!((vertex.at(nm) - r.at(nm)).abs() < ROUNDING);
            let (a, b) = (vertex.steepest_slope_per_nm(), r.steepest_slope_per_nm());
            prop_assert!((a - b).abs() <= 1e-6 * a.max(1e-9), "{a} {b}");
        }
    }

    #[test]
    fn flat_is_flat_and_exact_at_both_ends() {
        for value in [0.0, 0.01, 0.5, 0.99, 1.0] {
            let r = Sigmoid::flat(value);
            assert!((r.at(400.0) - value).abs() < 1e-15, "{value}");
            assert_eq!(r.steepest_slope_per_nm(), 0.0);
            assert_eq!(r.to_vertex().unwrap().at(700.0), r.at(400.0));
        }
    }

    #[test]
    fn a_straight_parabola_has_a_slope_but_no_vertex() {
        let r = Sigmoid { c0: 0.0, c1: 0.02, c2: -0.02 * 550.0 };
        assert!((r.steepest_slope_per_nm() - 0.01).abs() < 1e-15);
        assert_eq!(r.to_vertex(), None);
    }
}
