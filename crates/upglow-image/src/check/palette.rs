//! The colors of the heat map: gray, then yellow to brown, then pink to purple. Each ramp also decreases
//! in lightness, so that it can be read without hue.

use super::display::byte;

/// The meaning of a pixel of the heat map: the worst of its texels, by kind and then by difference.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub(super) enum Heat {
    /// Reflectances match all texels.
    #[default]
    Reflectance,
    /// The furthest texel is this many ΔE00 beyond reflectance.
    Fluorescence(f64),
    /// The furthest texel is this many ΔE00 beyond any material.
    Unreachable(f64),
    /// A value is NaN or infinite.
    NoColor,
}

/// ΔE00 at which the ramps end. With a greater value the usual differences of a few ΔE00 would look
/// alike; with a smaller one whole pictures would be at the end.
const FULL_DE2000: f64 = 30.0;

/// Black and white of the gray picture, which differ from the ends of the ramps and from the page.
const GRAYS: [f64; 2] = [0.16, 0.82];

const FLUORESCENCE: [[u8; 3]; 4] = [[255, 236, 150], [253, 180, 60], [232, 98, 12], [140, 45, 4]];
const UNREACHABLE: [[u8; 3]; 3] = [[245, 120, 215], [196, 24, 140], [88, 10, 94]];
const NO_COLOR: [u8; 3] = [0, 200, 230];

impl Heat {
    /// The color of the pixel. Reflectances are gray, of the given brightness, 0..=1.
    pub(super) fn color(self, bright: f64) -> [u8; 3] {
        match self {
            Self::Reflectance => [byte(GRAYS[0] + (GRAYS[1] - GRAYS[0]) * bright); 3],
            Self::Fluorescence(de2000) => ramp(&FLUORESCENCE, ramp_position(de2000)),
            Self::Unreachable(de2000) => ramp(&UNREACHABLE, ramp_position(de2000)),
            Self::NoColor => NO_COLOR,
        }
    }
}

/// The position of a difference on a ramp, 0..=1, on a logarithmic scale.
pub(super) fn ramp_position(de2000: f64) -> f64 {
    (de2000.ln_1p() / FULL_DE2000.ln_1p()).clamp(0.0, 1.0)
}

/// A color of a ramp, interpolated linearly between its stops.
fn ramp(stops: &[[u8; 3]], share: f64) -> [u8; 3] {
    let last = stops.len() - 1;
    let position = share * last as f64;
    let index = (1..last).filter(|&i| i as f64 <= position).count();
    let share = position - index as f64;
    let (a, b) = (stops[index], stops[index + 1]);
    [0, 1, 2].map(|k| byte((f64::from(a[k]) * (1.0 - share) + f64::from(b[k]) * share) / 255.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn luma([r, g, b]: [u8; 3]) -> f64 {
        0.3 * f64::from(r) + 0.59 * f64::from(g) + 0.11 * f64::from(b)
    }

    #[test]
    fn each_ramp_decreases_in_lightness() {
        for heat in [Heat::Fluorescence, Heat::Unreachable] {
            let mut lumas = (0..=60).map(|i| luma(heat(f64::from(i) / 2.0).color(0.0)));
            let first = lumas.next().unwrap();
            lumas.fold(first, |before, l| {
                assert!(l < before, "{l} {before}");
                l
            });
        }
    }

    #[test]
    fn ramps_begin_and_end_at_their_stops() {
        assert_eq!(Heat::Fluorescence(0.0).color(0.0), FLUORESCENCE[0]);
        assert_eq!(Heat::Fluorescence(1e9).color(0.0), FLUORESCENCE[3]);
        assert_eq!(Heat::Unreachable(f64::INFINITY).color(0.0), UNREACHABLE[2]);
    }
}
