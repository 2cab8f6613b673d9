//! Rounding of numbers, for the crates of this workspace.

/// The nearest number in single precision.
#[expect(clippy::cast_possible_truncation, reason = "rounding is the purpose")]
#[inline(always)]
pub fn to_single(value: f64) -> f32 {
    value as f32
}

/// The whole part; 0 for negative numbers and NaN.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the fraction is to be dropped, and callers bound the rest"
)]
#[inline(always)]
pub fn whole(position: f64) -> usize {
    position as usize
}
