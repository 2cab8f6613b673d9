//! The RGB space of the chromaticities in a file.

use upglow_color::RgbSpace;

use super::stated::{Stated, StatementError};

/// Greatest difference from a built-in space. Files round chromaticities to four or five digits, and
/// any two built-in spaces differ by 0.005 or more in some number.
const SAME: f64 = 2e-4;

/// The space of these primaries (red, green, blue) and white: a built-in one if all eight numbers
/// agree, else one named `custom`.
pub(super) fn stated(
    by: &'static str,
    primaries: [[f64; 2]; 3],
    white: [f64; 2],
) -> Stated<RgbSpace> {
    let [red, green, blue] = primaries;
    let found = [red, green, blue, white];
    let same = |known: &RgbSpace| {
        let [red, green, blue] = known.primaries();
        let known = [red, green, blue, known.white()];
        known.as_flattened().iter().zip(found.as_flattened()).all(|(a, b)| (a - b).abs() < SAME)
    };
    let mut named = RgbSpace::names().into_iter().filter_map(|name| RgbSpace::named(name).ok());
    let space = named.find(same).map_or_else(|| RgbSpace::custom("custom", primaries, white), Ok);
    match space {
        Ok(value) => Stated::yes(value, by),
        Err(source) => Stated::invalid(StatementError::Chromaticities { by, found, source }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn space(primaries: [[f64; 2]; 3], white: [f64; 2]) -> Option<RgbSpace> {
        match stated("chromaticities", primaries, white) {
            Stated::Yes { value, .. } => Some(value),
            _ => None,
        }
    }

    #[test]
    fn every_built_in_space_is_recognized_from_rounded_numbers() {
        for name in RgbSpace::names() {
            let known = RgbSpace::named(name).unwrap();
            let round = |v: f64| (v * 1e4).round() / 1e4;
            let primaries = known.primaries().map(|c| c.map(round));
            let found = space(primaries, known.white().map(round)).unwrap();
            assert_eq!(found.name(), name);
        }
    }

    #[test]
    fn other_primaries_are_custom_and_invalid_ones_refused() {
        let wide = space([[0.7, 0.3], [0.2, 0.75], [0.1, 0.05]], [0.3127, 0.329]).unwrap();
        assert_eq!(wide.name(), "custom");
        assert!(space([[0.0; 2]; 3], [0.0; 2]).is_none());
        assert!(space([[f64::NAN; 2]; 3], [f64::NAN; 2]).is_none());
    }
}
