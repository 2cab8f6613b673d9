//! The transfer curve of sRGB.

/// Where the linear segment ends, as linear and as encoded value.
const LINEAR_KNEE: f64 = 0.003_130_8;
const ENCODED_KNEE: f64 = 0.04045;

/// The encoded value for linear light of 0 or more.
///
/// # Source
///
/// `iec61966`, equations 9 and 10.
pub fn srgb_encoded(linear: f64) -> f64 {
    if linear <= LINEAR_KNEE { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The linear light for an encoded value of 0 or more.
///
/// # Source
///
/// `iec61966`, equations 5 and 6.
pub fn srgb_decoded(encoded: f64) -> f64 {
    if encoded <= ENCODED_KNEE { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_linear_segment_meets_the_power_curve() {
        // The standard's rounded constants leave 1e-8 decoded, and 12.92 times that encoded.
        const JUMP: f64 = 2e-8;
        let jump = |curve: fn(f64) -> f64, knee: f64| curve(knee + 1e-12) - curve(knee);
        assert!(jump(srgb_decoded, ENCODED_KNEE).abs() < JUMP);
        assert!(jump(srgb_encoded, LINEAR_KNEE).abs() < 12.92 * JUMP);
    }

    #[test]
    fn decoding_is_the_inverse_of_encoding() {
        // The standard's rounded knees are 1e-8 apart.
        const KNEES: f64 = 1e-7;
        for i in 0..=1000 {
            let linear = f64::from(i) / 1000.0;
            assert!((srgb_decoded(srgb_encoded(linear)) - linear).abs() < KNEES, "{linear}");
        }
    }
}
