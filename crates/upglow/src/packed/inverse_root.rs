//! 1 / √y for the sigmoid: a division and a square root would be most of an evaluation's time.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, f32x8};

/// 2 / √y for y from 1 to 10³⁷, with a relative error below 5e-7.
///
/// The factor 2 saves a multiplication in Newton's step, g ← g·(3 − y·g²) / 2.
#[inline(always)]
pub(crate) fn twice_inverse_root<S: Simd>(simd: S, y: f32x4<S>) -> f32x4<S> {
    let g = estimate(simd, y);
    g * (-(y * g)).mul_add(g, f32x4::splat(simd, 3.0))
}

/// [`twice_inverse_root`] of eight numbers.
#[inline(always)]
pub(crate) fn twice_inverse_root8<S: Simd>(simd: S, y: f32x8<S>) -> f32x8<S> {
    let g = estimate8(simd, y);
    g * (-(y * g)).mul_add(g, f32x8::splat(simd, 3.0))
}

/// The processor's estimate, exact to at least 11 bits, or the root itself.
#[inline(always)]
fn estimate<S: Simd>(simd: S, y: f32x4<S>) -> f32x4<S> {
    #[cfg(target_arch = "x86_64")]
    if let Some(sse2) = simd.level().as_sse2() {
        let y: [f32; 4] = y.into();
        let g: f32x4<fearless_simd::Sse2> = x86::estimate(sse2, y.simd_into(sse2));
        let g: [f32; 4] = g.into();
        return g.simd_into(simd);
    }
    f32x4::splat(simd, 1.0) / y.sqrt()
}

#[inline(always)]
fn estimate8<S: Simd>(simd: S, y: f32x8<S>) -> f32x8<S> {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = simd.level().as_avx2() {
        let y: [f32; 8] = y.into();
        let g: f32x8<fearless_simd::Avx2> = x86::estimate8(avx2, y.simd_into(avx2));
        let g: [f32; 8] = g.into();
        return g.simd_into(simd);
    }
    let (low, high) = y.split();
    estimate(simd, low).combine(estimate(simd, high))
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use core::arch::x86_64::{_mm_rsqrt_ps, _mm256_rsqrt_ps};
    use fearless_simd::prelude::*;
    use fearless_simd::{Avx2, Sse2, f32x4, f32x8, kernel};

    kernel!(
        #[inline]
        pub(super) fn estimate(sse2: Sse2, y: f32x4<Sse2>) -> f32x4<Sse2> {
            _mm_rsqrt_ps(y.into()).simd_into(sse2)
        }
    );

    kernel!(
        #[inline]
        pub(super) fn estimate8(avx2: Avx2, y: f32x8<Avx2>) -> f32x8<Avx2> {
            _mm256_rsqrt_ps(y.into()).simd_into(avx2)
        }
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    #[test]
    fn it_is_twice_one_over_the_root() {
        // Three halves of the square of the estimate's error, 3.7e-4, and rounding.
        const NEWTON: f64 = 5e-7;
        for level in [Level::baseline(), Level::new()] {
            for i in 0..40_000 {
                let y = 10.0_f32.powf(37.0 * i as f32 / 40_000.0);
                let [four, eight]: [f32; 2] = dispatch!(level, simd => [
                    twice_inverse_root(simd, f32x4::splat(simd, y))[3],
                    twice_inverse_root8(simd, f32x8::splat(simd, y))[7],
                ]);
                let expected = 2.0 / f64::from(y).sqrt();
                for found in [four, eight] {
                    assert!((f64::from(found) / expected - 1.0).abs() < NEWTON, "{y} {found}");
                }
            }
        }
    }
}
