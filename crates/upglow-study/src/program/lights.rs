//! The lights that materials are not fitted under.

use upglow_color::Illuminant;
use upglow_fit::ultraviolet_lamp;

/// Below this wavelength, nm, daylight without ultraviolet has no power: that of D65 behind a filter.
const CUT_NM: f64 = 400.0;

/// Incandescent light, equal energy, two fluorescent lamps, high-pressure sodium, a white LED, and an
/// ultraviolet lamp.
pub(crate) fn lamps() -> Vec<Illuminant> {
    let named = ["A", "E", "FL2", "FL11", "HP1", "LED-B3"].map(named);
    named.into_iter().chain([ultraviolet_lamp()]).collect()
}

/// Incandescent light, equal energy, and daylight without ultraviolet: what is measured down to 300 nm and
/// by 10 nm only is seen under smooth lights.
pub(crate) fn smooth_lights() -> Vec<Illuminant> {
    vec![named("A"), named("E"), daylight_without_ultraviolet()]
}

fn named(name: &str) -> Illuminant {
    Illuminant::named(name).expect("the light is built in")
}

fn daylight_without_ultraviolet() -> Illuminant {
    named("D65").cut_below("D65 from 400 nm", CUT_NM).expect("it is visible")
}
