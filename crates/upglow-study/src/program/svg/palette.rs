//! Colors of lines and areas that color-blind readers can tell apart.
//!
//! The colors of lines are from the set of Okabe and Ito; the ramp of errors darkens steadily, so that
//! it is readable in gray.

use upglow_svg::byte;

/// Text and axes.
pub(crate) const INK: &str = "#1f2328";
/// Second lines of titles, and guides.
pub(crate) const MUTED: &str = "#5b626b";

/// Absorption.
pub(crate) const ABSORPTION: &str = "#0072b2";
/// Emission.
pub(crate) const EMISSION: &str = "#d55e00";

/// Weights of 0, ¼, ½, ¾ and 1, from blue through gray to orange.
pub(crate) const WEIGHTS: [&str; 5] = ["#1f5fa8", "#5b9bc7", "#8a8f96", "#e39a4f", "#bf4b00"];

/// Colors matched by a reflectance, only with fluorescence, and by no material.
pub(crate) const STANDINGS: [[u8; 3]; 3] =
    [[0xdc, 0xe6, 0xe4], [0xf3, 0xb8, 0x6b], [0x5c, 0x66, 0x78]];

/// The ramp of errors, from zero to the greatest shown.
const ERRORS: [[u8; 3]; 6] = [
    [0xff, 0xff, 0xff],
    [0xfd, 0xe3, 0xb8],
    [0xfc, 0xb1, 0x7a],
    [0xe8, 0x6a, 0x4a],
    [0xb0, 0x24, 0x36],
    [0x4f, 0x0a, 0x2e],
];

/// The color of an error, given as a share of the greatest shown; clamped to 0..=1.
pub(crate) fn error_color(share: f64) -> [u8; 3] {
    let last = ERRORS.len() - 1;
    let position = share.clamp(0.0, 1.0) * last as f64;
    let above = (1..last).find(|&i| position <= i as f64).unwrap_or(last);
    let fraction = position - (above - 1) as f64;
    let [low, high] = [ERRORS[above - 1], ERRORS[above]];
    [0, 1, 2].map(|k| byte(f64::from(low[k]) * (1.0 - fraction) + f64::from(high[k]) * fraction))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ramp_of_errors_runs_from_first_to_last_color() {
        assert_eq!(error_color(0.0), ERRORS[0]);
        assert_eq!(error_color(0.4), ERRORS[2]);
        assert_eq!(error_color(1.0), ERRORS[5]);
        assert_eq!(error_color(7.0), ERRORS[5]);
    }
}
