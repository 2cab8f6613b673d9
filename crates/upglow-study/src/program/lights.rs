//! The lights that materials are seen under.

use std::ops::Range;

use upglow_color::Illuminant;

/// Which of [`lights`] are neither D65 nor a part of it.
pub(crate) const SEVEN: Range<usize> = 1..8;

/// Daylight, under which colors are known. [`SEVEN`] other lights: incandescent, equal energy, two fluorescent lamps, a
/// metal halide lamp, a white LED, and daylight behind a window. Daylight without ultraviolet, and ultraviolet
/// alone.
pub(crate) fn lights() -> Vec<Illuminant> {
    let mut lights =
        ["D65", "A", "E", "FL2", "FL11", "HP5", "LED-B3", "ID65", "D65-cut400"].map(named).to_vec();
    lights.push(Illuminant::mineral_lamp());
    lights
}

/// Daylight, incandescent light, equal energy, and daylight without ultraviolet.
pub(crate) fn smooth_lights() -> Vec<Illuminant> {
    ["D65", "A", "E", "D65-cut400"].map(named).to_vec()
}

/// Whether a light is daylight times something smooth: not a lamp with lines, and not ultraviolet alone.
pub(crate) fn is_smooth(light: &Illuminant) -> bool {
    ["D65", "A", "E", "ID65", "D65-cut400"].contains(&light.name())
}

/// A built-in light.
pub(crate) fn named(name: &str) -> Illuminant {
    Illuminant::named(name).expect("the light is built in")
}
