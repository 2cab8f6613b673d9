//! Parsers of option values that are neither a word nor a number.

use upglow_color::{Grid, Illuminant, Observer, RgbSpace};
use upglow_image::{Encoding, InteropSpace};
use upglow_terminal::parsed;

/// The greatest slope of a reflectance, 1/nm, or `None` for no limit. A type of its own, because clap
/// would read a plain `Option` as an option without default.
pub(crate) type SlopeLimit = Option<f64>;

pub(super) fn slope_limit(text: &str) -> Result<SlopeLimit, String> {
    match text {
        "none" => Ok(None),
        _ => parsed(text, "a number of 1/nm or none").map(Some),
    }
}

/// Column and row of a texel.
pub(super) fn position(text: &str) -> Result<[usize; 2], String> {
    let expected = "two whole numbers X,Y";
    let (x, y) = text.split_once(',').ok_or_else(|| format!("{text:?}, expected {expected}"))?;
    Ok([parsed(x, expected)?, parsed(y, expected)?])
}

/// The RGB space of pictures, and their encoding if its name states one.
#[derive(Clone, Debug)]
pub(crate) struct PictureSpace {
    pub(crate) space: RgbSpace,
    pub(crate) encoding: Option<Encoding>,
}

/// The name of a space, eight chromaticities, or an ID of the Color Interop Forum.
pub(super) fn picture_space(text: &str) -> Result<PictureSpace, String> {
    let expected = "expected an RGB space";
    match InteropSpace::of_id(text) {
        Some(InteropSpace::Color(space, encoding)) => {
            return Ok(PictureSpace { space, encoding: Some(encoding) });
        }
        Some(InteropSpace::Data) => return Err(format!("data, which is no color, {expected}")),
        Some(_) => return Err(format!("{text}, {expected}; leave --space out to use the file's")),
        None => {}
    }
    let numbers: Option<Vec<f64>> = text.split(',').map(|cell| cell.trim().parse().ok()).collect();
    let space = match numbers.as_deref() {
        Some(&[rx, ry, gx, gy, bx, by, wx, wy]) => {
            RgbSpace::custom("custom", [[rx, ry], [gx, gy], [bx, by]], [wx, wy])
        }
        _ => RgbSpace::named(text),
    };
    space.map(|space| PictureSpace { space, encoding: None }).map_err(|error| error.to_string())
}

/// An RGB space of linear colors, like [`picture_space`].
pub(super) fn rgb_space(text: &str) -> Result<RgbSpace, String> {
    match picture_space(text)? {
        PictureSpace { space, encoding: None | Some(Encoding::Linear) } => Ok(space),
        _ => Err(format!("{text}, expected an RGB space of linear colors such as lin_ap1_scene")),
    }
}

/// The lights that an option takes, for its help.
pub(super) fn lights() -> String {
    let names = Illuminant::FAMILIES;
    format!("{names}, or a CSV file with the header `wavelength_nm,power`")
}

/// The observers that an option takes, for its help.
pub(super) fn observers() -> String {
    let names = Observer::NAMES.join(", ");
    format!(
        "{names}, or a CSV file of color-matching functions with the header \
         `wavelength_nm,x,y,z`"
    )
}

/// A factor of light as a power of two.
pub(super) fn stops(text: &str) -> Result<f64, String> {
    /// A million times as bright: more is a mistake.
    const MOST: f64 = 20.0;
    let expected = format!("a number from -{MOST} to {MOST}");
    match parsed(text, &expected)? {
        found if (-MOST..=MOST).contains(&found) => Ok(found),
        found => Err(format!("{found}, expected {expected}")),
    }
}

/// Wavelengths FIRST:LAST:STEP in nm, within the range of the built-in tables.
pub(super) fn bands(text: &str) -> Result<Grid, String> {
    let numbers: Option<Vec<u32>> = text.split(':').map(|cell| cell.trim().parse().ok()).collect();
    let Some(&[first, last, step]) = numbers.as_deref() else {
        return Err(format!("{text:?}, expected FIRST:LAST:STEP in whole nm, such as 380:780:10"));
    };
    let [low, high] = [Grid::FINE.first_nm(), Grid::FINE.last_nm()];
    if first < low || last > high {
        return Err(format!("{text}, expected bands within {low} to {high} nm"));
    }
    Grid::try_new(first, last, step).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_word_none_means_no_slope_limit() {
        assert_eq!(slope_limit("none"), Ok(None));
        assert_eq!(slope_limit("0.02"), Ok(Some(0.02)));
        assert!(slope_limit("steep").is_err());
    }

    #[test]
    fn eight_chromaticities_are_a_space() {
        let custom = rgb_space("0.64,0.33,0.30,0.60,0.15,0.06,0.3127,0.3290");
        assert!(custom.is_ok_and(|space| space.name() == "custom"));
        assert!(rgb_space("rec7091").is_err());
        assert!(rgb_space("0.64,0.33").is_err());
    }

    #[test]
    fn interop_ids_state_the_encoding_too() {
        let id = picture_space("g22_rec709_scene").unwrap();
        assert_eq!((id.space.name(), id.encoding), ("srgb", Some(Encoding::Gamma(2.2))));
        assert!(rgb_space("lin_rec2020_scene").is_ok_and(|space| space.name() == "rec2020"));
        for text in ["srgb_ap1_scene", "lin_ciexyzd65_scene", "data", "unknown"] {
            assert!(rgb_space(text).is_err_and(|e| e.starts_with(text) && e.contains("expected")));
        }
    }
}
