//! Numbers with fewer digits, for the crates of this workspace.

/// The nearest number in single precision.
#[expect(clippy::cast_possible_truncation, reason = "rounding is what it is for")]
#[inline(always)]
pub fn to_single(value: f64) -> f32 {
    value as f32
}

/// The whole part; 0 for what is negative or not a number.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the fraction is meant to go, and callers bound the rest"
)]
#[inline(always)]
pub fn whole(position: f64) -> usize {
    position as usize
}
