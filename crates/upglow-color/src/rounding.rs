//! Rounding of numbers, for the crates of this workspace.

/// The nearest number in single precision.
#[expect(clippy::cast_possible_truncation, reason = "rounding is the purpose")]
#[inline(always)]
pub fn to_single(value: f64) -> f32 {
    value as f32
}

/// A number as messages show it: with an exponent where its digits would fill the line.
#[must_use]
pub fn shown(value: f64) -> String {
    let has_few_digits = value == 0.0 || (1e-6..1e16).contains(&value.abs());
    if has_few_digits { value.to_string() } else { format!("{value:e}") }
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
