//! A smooth reflectance by its shape: shift, width, slope.

use crate::material::sigmoid::{Sigmoid, Vertex};

/// A sigmoid reflectance described by its shape.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Features {
    /// Wavelength of the extremum, nm.
    pub shift_nm: f64,
    /// Distance from the extremum to the steepest point, nm; > 0.
    pub width_nm: f64,
    /// Slope at `shift_nm + width_nm`, 1/nm; > 0 is U-shaped, < 0 is n-shaped, never 0.
    pub slope_per_nm: f64,
}

/// Why a set of features describes no reflectance.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FeatureError {
    /// The width is not a positive number.
    #[error("width is {width_nm} nm, expected > 0")]
    Width {
        /// The width given, nm.
        width_nm: f64,
    },
    /// The slope is zero or not a number.
    #[error("slope is {slope_per_nm}/nm, expected a number other than 0")]
    Slope {
        /// The slope given, 1/nm.
        slope_per_nm: f64,
    },
}

impl Features {
    /// The vertex form of the reflectance that has these features.
    ///
    /// # Errors
    ///
    /// [`FeatureError`] if `width_nm` is not positive or `slope_per_nm` is zero: a flat
    /// reflectance has no features.
    ///
    /// # Source
    ///
    /// `konig`, section 4.3, Algorithm 1. There `t = 1 + P²`, with P the parabola at the steepest
    /// point; the parabola at the extremum is the second term of its `c2`.
    pub fn to_vertex(self) -> Result<Vertex, FeatureError> {
        let Self { shift_nm: z, width_nm: w, slope_per_nm: s } = self;
        if !w.is_finite() || w <= 0.0 {
            return Err(FeatureError::Width { width_nm: w });
        }
        if !s.is_finite() || s == 0.0 {
            return Err(FeatureError::Slope { slope_per_nm: s });
        }
        let y = s.abs() * w;
        let t = (y + (y * y + 1.0 / 9.0).sqrt()) / (2.0 * y);
        let c0 = s * t.powf(1.5) / w;
        let peak = s * w * (5.0 * t.powf(1.5) - 6.0 * t.sqrt());
        Ok(Vertex { curvature_per_nm2: c0, shift_nm: z, peak })
    }

    /// The coefficients of the reflectance that has these features.
    ///
    /// # Errors
    ///
    /// As [`Features::to_vertex`].
    pub fn to_sigmoid(self) -> Result<Sigmoid, FeatureError> {
        self.to_vertex().map(Vertex::to_sigmoid)
    }
}

impl Vertex {
    /// The features; `None` for a flat reflectance, whose width is infinite.
    ///
    /// The inverse of `konig`, Algorithm 1: P = (3p + σ√(9p² + 5)) / 5, w = √((P − p) / c0),
    /// s = c0·w / (1 + P²)^(3/2), with p the parabola at the extremum and σ the sign of c0.
    pub fn to_features(self) -> Option<Features> {
        let Self { curvature_per_nm2: c0, shift_nm, peak: p } = self;
        if c0 == 0.0 {
            return None;
        }
        let root = (9.0 * p * p + 5.0).sqrt().copysign(c0);
        // Two forms of one P: each is free of cancellation for its sign of p·c0.
        let steepest = if p * c0 >= 0.0 { (3.0 * p + root) / 5.0 } else { 1.0 / (root - 3.0 * p) };
        let width_nm = ((steepest - p) / c0).sqrt();
        let slope_per_nm = c0 * width_nm / (1.0 + steepest * steepest).powf(1.5);
        let usable = width_nm.is_finite() && width_nm > 0.0 && slope_per_nm != 0.0;
        usable.then_some(Features { shift_nm, width_nm, slope_per_nm })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Rounding only: the slope goes through one cube and one square root.
    const RELATIVE: f64 = 1e-9;

    fn any_features() -> impl Strategy<Value = Features> {
        (200.0..900.0, 2.0..500.0, 1e-4..0.1, any::<bool>()).prop_map(|(z, w, s, up)| Features {
            shift_nm: z,
            width_nm: w,
            slope_per_nm: if up { s } else { -s },
        })
    }

    proptest! {
        #[test]
        fn steepest_slope_is_where_and_what_the_features_say(shape in any_features()) {
            let r = shape.to_sigmoid().unwrap();
            let (z, w, s) = (shape.shift_nm, shape.width_nm, shape.slope_per_nm);
            // Coefficients near z² times the curvature lose that many digits.
            let tolerance = 1e-7 * s.abs();
            prop_assert!((r.slope_per_nm(z + w) - s).abs() < tolerance);
            prop_assert!((r.slope_per_nm(z - w) + s).abs() < tolerance);
            let steepest = shape.to_vertex().unwrap().steepest_slope_per_nm();
            prop_assert!((steepest - s.abs()).abs() < RELATIVE * s.abs());
        }

        #[test]
        fn features_survive_the_way_to_the_vertex_and_back(shape in any_features()) {
            let back = shape.to_vertex().unwrap().to_features().unwrap();
            prop_assert_eq!(back.shift_nm, shape.shift_nm);
            prop_assert!((back.width_nm / shape.width_nm - 1.0).abs() < RELATIVE);
            prop_assert!((back.slope_per_nm / shape.slope_per_nm - 1.0).abs() < RELATIVE);
        }
    }

    #[test]
    fn what_describes_no_reflectance_is_refused() {
        let with = |width_nm, slope_per_nm| {
            Features { shift_nm: 550.0, width_nm, slope_per_nm }
                .to_vertex()
                .unwrap_err()
                .to_string()
        };
        assert_eq!(with(-3.0, 0.01), "width is -3 nm, expected > 0");
        assert_eq!(with(f64::NAN, 0.01), "width is NaN nm, expected > 0");
        assert_eq!(with(3.0, 0.0), "slope is 0/nm, expected a number other than 0");
    }

    #[test]
    fn a_flat_reflectance_has_no_features() {
        assert_eq!(Sigmoid::flat(0.4).to_vertex().unwrap().to_features(), None);
    }
}
