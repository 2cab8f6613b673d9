//! Arithmetic with vectors, and with single numbers where vector instructions are faster.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, i32x4};

use crate::material::formula::Number;

/// Runs code with the instructions that every processor of the target has: enough where one vector
/// holds the four corners at one wavelength.
macro_rules! with_baseline {
    ($simd:ident => $answer:expr) => {
        fearless_simd::dispatch!(fearless_simd::Level::baseline(), $simd => $answer)
    };
}
pub(crate) use with_baseline;

impl<S: Simd> Number for f32x4<S> {
    #[inline(always)]
    fn zero(self) -> Self {
        Self::splat(self.simd, 0.0)
    }

    #[inline(always)]
    fn mixed([one, two]: [Self; 2], weight: Self) -> Self {
        weight.mul_add(two - one, one)
    }

    #[inline(always)]
    fn divided(self, weight: Self) -> [Self; 2] {
        let second = self * weight;
        [self - second, second]
    }

    #[inline(always)]
    fn photon_share(self, mean_nm: Self) -> Self {
        (self / mean_nm).min(1.0)
    }
}

#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, corners: &[f32; 4]) -> f32x4<S> {
    f32x4::from_slice(simd, corners)
}

/// The transposed matrix.
#[inline(always)]
pub(crate) fn transposed<S: Simd>([a, b, c, d]: [f32x4<S>; 4]) -> [f32x4<S>; 4] {
    let (even, odd) = (a.interleave(c), b.interleave(d));
    let (first, last) = (even.0.interleave(odd.0), even.1.interleave(odd.1));
    [first.0, first.1, last.0, last.1]
}

/// The sums of four vectors.
#[inline(always)]
pub(crate) fn sums<S: Simd>([a, b, c, d]: [f32x4<S>; 4]) -> f32x4<S> {
    let (even, odd) = (a.interleave(c), b.interleave(d));
    let both = (even.0 + even.1).interleave(odd.0 + odd.1);
    both.0 + both.1
}

/// The sum over the corners.
#[inline(always)]
pub(crate) fn sum<S: Simd>(corners: f32x4<S>) -> f32 {
    let [a, b, c, d] = corners.into();
    (a + b) + (c + d)
}

/// The whole part of a number in 0..2³¹. In a vector: a plain conversion, which is safe for all
/// numbers, takes four more instructions.
#[inline(always)]
pub(crate) fn whole<S: Simd>(simd: S, number: f32) -> u32 {
    let whole: i32x4<S> = f32x4::splat(simd, number).to_int();
    let [whole, ..]: [i32; 4] = whole.into();
    whole.cast_unsigned()
}

/// The greater of two numbers, in one instruction: `f32::max` also looks for NaN.
#[inline(always)]
pub(crate) fn greater_of(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers, in one instruction.
#[inline(always)]
pub(crate) fn smaller_of(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
