//! Numbers with fewer digits.

/// The nearest number in single precision.
#[expect(clippy::cast_possible_truncation, reason = "rounding is what it is for")]
#[inline(always)]
pub(crate) fn to_single(value: f64) -> f32 {
    value as f32
}
