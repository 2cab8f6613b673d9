//! Attributes in the header of an OpenEXR file.

use std::collections::BTreeMap;

use upglow_color::RgbSpace;
use upglow_color::rounding::to_single;

use crate::picture::interop::InteropSpace;

/// The attributes of one image, by name: a file holds each once.
pub(crate) type Attributes = BTreeMap<String, Attribute>;

/// The value of an attribute: the name of its type, and its bytes as a file holds them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Attribute {
    pub(crate) kind: String,
    pub(crate) bytes: Vec<u8>,
}

/// Types of fixed length among those that pictures commonly have, and their lengths, bytes.
const LENGTHS: [(&str, usize); 6] =
    [("chromaticities", 32), ("double", 8), ("float", 4), ("int", 4), ("v2f", 8), ("v3f", 12)];

impl Attribute {
    pub(crate) fn new(kind: &str, bytes: Vec<u8>) -> Self {
        Self { kind: kind.into(), bytes }
    }

    /// An attribute of single-precision numbers.
    pub(crate) fn singles(kind: &str, values: &[f32]) -> Self {
        Self::new(kind, values.iter().flat_map(|v| v.to_le_bytes()).collect())
    }

    /// Whether a value of this type can have this length.
    pub(crate) fn has_valid_length(&self) -> bool {
        LENGTHS.iter().all(|(kind, length)| self.kind != *kind || self.bytes.len() == *length)
    }

    /// The bytes, if the attribute is of this type.
    pub(crate) fn of_kind(&self, kind: &str) -> Option<&[u8]> {
        (self.kind == kind).then_some(&self.bytes[..])
    }

    /// The text of a `string`. OpenEXR specifies no encoding; readers replace what is not UTF-8.
    pub(crate) fn as_text(&self) -> Option<&str> {
        str::from_utf8(self.of_kind("string")?).ok()
    }

    /// The numbers, if the attribute is of this type and has `N` single-precision numbers.
    pub(crate) fn as_singles<const N: usize>(&self, kind: &str) -> Option<[f32; N]> {
        let words: &[[u8; 4]; N] = self.of_kind(kind)?.as_chunks().0.try_into().ok()?;
        Some(words.map(f32::from_le_bytes))
    }
}

/// The chromaticities of an RGB space: x and y of red, green, blue and white.
pub(crate) fn chromaticities(space: &RgbSpace) -> Attribute {
    let [red, green, blue] = space.primaries();
    let xy = [red, green, blue, space.white()].map(|c| c.map(to_single));
    Attribute::singles("chromaticities", xy.as_flattened())
}

/// The attribute of the Color Interop Forum that names the color space of a file's color channels.
pub(crate) const INTEROP_ID: &str = "colorInteropID";

/// The attribute that states the space of linear colors, and its name: its ID in the Color Interop Forum, or its
/// chromaticities if it has none. Both together would be two statements.
pub(crate) fn stated_space(space: &RgbSpace) -> (String, Attribute) {
    match InteropSpace::linear_id(space) {
        Some(id) => (INTEROP_ID.into(), id.into()),
        None => ("chromaticities".into(), chromaticities(space)),
    }
}

impl<T: Into<String>> From<T> for Attribute {
    fn from(text: T) -> Self {
        Self::new("string", text.into().into_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_back_as_their_own_type_only() {
        let text = Attribute::from("400nm:0.5;");
        assert_eq!((text.as_text(), text.as_singles::<1>("float")), (Some("400nm:0.5;"), None));
        let white = Attribute::singles("v2f", &[0.3127, 0.329]);
        assert_eq!(white.as_singles("v2f"), Some([0.3127, 0.329]));
        assert_eq!((white.as_singles::<3>("v2f"), white.as_singles::<2>("v3f")), (None, None));
        assert_eq!(white.as_text(), None);
        let space = chromaticities(&RgbSpace::default());
        assert!(space.has_valid_length() && space.as_singles::<8>("chromaticities").is_some());
    }

    #[test]
    fn a_value_of_the_wrong_length_is_invalid() {
        for kind in ["float", "double", "int", "v2f", "v3f", "chromaticities"] {
            assert!(!Attribute::new(kind, vec![0; 5]).has_valid_length(), "{kind}");
        }
        for (kind, length) in LENGTHS {
            assert!(Attribute::new(kind, vec![0; length]).has_valid_length(), "{kind}");
        }
        assert!(Attribute::new("mine", vec![1, 2, 3]).has_valid_length());
    }
}
