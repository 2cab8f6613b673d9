//! Arithmetic with vectors, and with single numbers where vector instructions are faster.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, i32x4};

use crate::material::formula::{AbsorbedSlope, Number};

/// Runs code with the instructions that every processor of the target has: enough where one vector
/// holds the four corners at one wavelength.
macro_rules! with_baseline {
    ($simd:ident => $answer:expr) => {
        fearless_simd::dispatch!(fearless_simd::Level::baseline(), $simd => $answer)
    };
}
pub(crate) use with_baseline;

/// Without a branch and without fused products, so that loops become vectors of the same bits on every
/// processor.
impl Number for f32 {
    fn zero(self) -> Self {
        0.0
    }

    fn mixed([one, two]: [Self; 2], weight: Self) -> Self {
        weight * (two - one) + one
    }

    fn divided(self, weight: Self) -> [Self; 2] {
        let second = self * weight;
        [self - second, second]
    }

    fn photon_share(self, mean_nm: Self) -> Self {
        (self / mean_nm).min(1.0)
    }

    #[inline(always)]
    fn transmittance(self) -> Self {
        // 2^x as 2^(whole part) · e^(rest · ln 2).
        let x = greater_of(self * -std::f32::consts::LOG2_10, -LEAST_EXPONENT);
        let shifted = x + ROUNDING_SHIFT;
        let rest = (x - (shifted - ROUNDING_SHIFT)) * std::f32::consts::LN_2;
        let power = EXPONENTIAL.iter().fold(0.0, |sum, c| sum * rest + c);
        // The low bits of `shifted` hold the whole part.
        let exponent = shifted.to_bits().wrapping_add(127) << 23;
        power * Self::from_bits(exponent)
    }

    #[inline(always)]
    fn absorbed_per_density(self) -> Self {
        let z = self * std::f32::consts::LN_10;
        let series = 0.5 - z * (1.0 / 6.0 - z * (1.0 / 24.0 - z * (1.0 / 120.0)));
        let series = std::f32::consts::LN_10 * (1.0 - z * series);
        let closed = (1.0 - self.transmittance()) / greater_of(self, THIN);
        if self < THIN { series } else { closed }
    }
}

impl AbsorbedSlope for f32 {
    #[inline(always)]
    fn absorbed_slope(self) -> Self {
        const LN_10: f32 = std::f32::consts::LN_10;
        let z = self * LN_10;
        let series = 1.0 / 3.0 - z * (1.0 / 8.0 - z * (1.0 / 30.0 - z * (1.0 / 144.0)));
        let series = -LN_10 * LN_10 * (0.5 - z * series);
        let lost = LN_10 * self.transmittance() - self.absorbed_per_density();
        let closed = lost / greater_of(self, THIN);
        if self < THIN { series } else { closed }
    }
}

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

    #[inline(always)]
    fn transmittance(self) -> Self {
        let simd = self.simd;
        // 2^x as 2^(whole part) · e^(rest · ln 2).
        let x = (self * -std::f32::consts::LOG2_10).max(-LEAST_EXPONENT);
        let shifted = x + ROUNDING_SHIFT;
        let rest = (x - (shifted - ROUNDING_SHIFT)) * std::f32::consts::LN_2;
        let mut power = Self::splat(simd, EXPONENTIAL[0]);
        for coefficient in &EXPONENTIAL[1..] {
            power = power.mul_add(rest, Self::splat(simd, *coefficient));
        }
        // The low bits of `shifted` hold the whole part.
        let exponent = (shifted.bitcast::<i32x4<S>>() + 127) << 23;
        power * exponent.bitcast::<Self>()
    }

    #[inline(always)]
    fn absorbed_per_density(self) -> Self {
        let simd = self.simd;
        let z = self * std::f32::consts::LN_10;
        let splat = |c: f32| Self::splat(simd, c);
        let series = z.mul_add(-1.0 / 120.0, splat(1.0 / 24.0));
        let series = series.mul_add(-z, splat(1.0 / 6.0)).mul_add(-z, splat(0.5));
        let series = series.mul_add(-z, splat(1.0)) * std::f32::consts::LN_10;
        let closed = (splat(1.0) - self.transmittance()) / self.max(THIN);
        self.simd_lt(THIN).select(series, closed)
    }
}

/// Below this density the closed form cancels more digits than the series leaves out.
const THIN: f32 = 0.1;
/// Beyond it, the exponent would not be a normal number.
const LEAST_EXPONENT: f32 = 120.0;
/// Adding it to a number below 2²² rounds that to a whole one.
const ROUNDING_SHIFT: f32 = 12_582_912.0;
/// Coefficients of e^x, the highest first: the first that is left out adds 1.2e-7 at ½·ln 2.
const EXPONENTIAL: [f32; 7] = [1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0];

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_numbers_are_those_of_double_precision() {
        // Single precision of numbers up to 3, over the least density of the closed form.
        const TOLERANCE: f64 = 2e-6;
        // The same divided by that density once more.
        const OF_SLOPES: f64 = 3e-5;
        for i in 0..=12_000_u16 {
            let (single, double) = (f32::from(i) * 1e-3, f64::from(f32::from(i) * 1e-3));
            let off = |a: f32, b: f64| (f64::from(a) - b).abs();
            assert!(off(single.transmittance(), double.transmittance()) < TOLERANCE, "{double}");
            let absorbed = [single.absorbed_per_density(), single.absorbed_slope()];
            assert!(off(absorbed[0], double.absorbed_per_density()) < TOLERANCE, "{double}");
            assert!(off(absorbed[1], double.absorbed_slope()) < OF_SLOPES, "{double}");
        }
        assert!(f32::INFINITY.transmittance() < 1e-35);
    }
}
