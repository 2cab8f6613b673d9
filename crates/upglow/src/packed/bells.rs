//! The bells of the analytic model in single precision.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4};
use upglow_color::rounding::to_single;

use crate::material::model::Model;

/// Cubic B-splines of one width in single precision.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Bells {
    /// 1 / distance of knots, 1/nm.
    per_step: f32,
    /// Factor of the bell with area 1 and unit step, over 6.
    scale: f32,
}

impl Bells {
    /// Absorption with a peak of 1, and emission with an area of 1.
    pub(crate) fn of(model: &Model) -> [Self; 2] {
        let Model::Analytic(model) = model else { return [Self::default(); 2] };
        let [absorption, emission] =
            [model.absorption_bell(0.0).step_nm.recip(), model.emission_bell(0.0).step_nm.recip()];
        [
            Self { per_step: to_single(absorption), scale: 1.5 / 6.0 },
            Self { per_step: to_single(emission), scale: to_single(emission / 6.0) },
        ]
    }

    #[inline(always)]
    pub(crate) fn at<S: Simd>(self, simd: S, center_nm: f32x4<S>, nm: f32x4<S>) -> f32x4<S> {
        let v = (nm - center_nm).abs() * self.per_step;
        // The bell as two cubes, each of which is zero beyond its knot.
        let outer = (f32x4::splat(simd, 2.0) - v).max(0.0);
        let inner = (f32x4::splat(simd, 1.0) - v).max(0.0);
        self.scale * (outer * outer * outer - 4.0 * inner * inner * inner)
    }
}
