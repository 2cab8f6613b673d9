//! Attributes in the header of an OpenEXR file.

use std::collections::BTreeMap;

use upglow_color::RgbSpace;
use upglow_color::rounding::to_single;

/// The attributes of one image, by name; a file states each once, sorted.
pub(crate) type Attributes = BTreeMap<String, Attribute>;

/// The value of an attribute.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Attribute {
    /// `string`: text; OpenEXR states no encoding, this program reads and writes UTF-8.
    Text(String),
    /// `float`.
    Float(f32),
    /// `double`.
    Double(f64),
    /// `int`.
    Int(i32),
    /// `v2f`.
    Float2([f32; 2]),
    /// `v3f`.
    Float3([f32; 3]),
    /// `chromaticities`: x, y of red, green, blue, white.
    Chromaticities([[f32; 2]; 4]),
    /// A type that this program passes on unread.
    Other {
        /// Name of the type.
        kind: String,
        /// The value, as the file holds it.
        bytes: Vec<u8>,
    },
}

impl Attribute {
    /// The name that OpenEXR gives this type.
    pub(crate) fn kind(&self) -> &str {
        match self {
            Self::Text(_) => "string",
            Self::Float(_) => "float",
            Self::Double(_) => "double",
            Self::Int(_) => "int",
            Self::Float2(_) => "v2f",
            Self::Float3(_) => "v3f",
            Self::Chromaticities(_) => "chromaticities",
            Self::Other { kind, .. } => kind,
        }
    }

    /// The text, if it is one.
    pub(crate) fn as_text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The value as a file holds it, little endian.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let singles = |values: &[f32]| values.iter().flat_map(|v| v.to_le_bytes()).collect();
        match self {
            Self::Text(text) => text.as_bytes().to_vec(),
            Self::Float(value) => singles(&[*value]),
            Self::Double(value) => value.to_le_bytes().to_vec(),
            Self::Int(value) => value.to_le_bytes().to_vec(),
            Self::Float2(values) => singles(values),
            Self::Float3(values) => singles(values),
            Self::Chromaticities(values) => singles(values.as_flattened()),
            Self::Other { bytes, .. } => bytes.clone(),
        }
    }

    /// The value of this type in these bytes; `None` if their number is not the type's.
    pub(crate) fn from_bytes(kind: &str, bytes: Vec<u8>) -> Option<Self> {
        Some(match kind {
            "string" => Self::Text(String::from_utf8_lossy(&bytes).into_owned()),
            "float" => Self::Float(singles::<1>(&bytes)?[0]),
            "double" => Self::Double(f64::from_le_bytes(bytes.try_into().ok()?)),
            "int" => Self::Int(i32::from_le_bytes(bytes.try_into().ok()?)),
            "v2f" => Self::Float2(singles(&bytes)?),
            "v3f" => Self::Float3(singles(&bytes)?),
            "chromaticities" => {
                let [rx, ry, gx, gy, bx, by, wx, wy] = singles(&bytes)?;
                Self::Chromaticities([[rx, ry], [gx, gy], [bx, by], [wx, wy]])
            }
            _ => Self::Other { kind: kind.into(), bytes },
        })
    }
}

/// The eight numbers of an RGB space.
pub(crate) fn chromaticities(space: &RgbSpace) -> Attribute {
    let [red, green, blue] = space.primaries();
    Attribute::Chromaticities([red, green, blue, space.white()].map(|c| c.map(to_single)))
}

impl From<&str> for Attribute {
    fn from(text: &str) -> Self {
        Self::Text(text.into())
    }
}

impl From<String> for Attribute {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

/// `N` single-precision numbers, little endian; `None` if the bytes are not that many.
fn singles<const N: usize>(bytes: &[u8]) -> Option<[f32; N]> {
    let (words, rest) = bytes.as_chunks::<4>();
    let words: &[[u8; 4]; N] = words.try_into().ok()?;
    rest.is_empty().then(|| words.map(f32::from_le_bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_survives_its_bytes() {
        let white = [0.3127, 0.329];
        for value in [
            Attribute::from("400nm:0.5;"),
            Attribute::Float(-1.5),
            Attribute::Double(1e-300),
            Attribute::Int(-7),
            Attribute::Float2([1.0, 2.0]),
            Attribute::Float3([1.0, 2.0, 3.0]),
            Attribute::Chromaticities([[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], white]),
            Attribute::Other { kind: "mine".into(), bytes: vec![1, 2, 3] },
        ] {
            let back = Attribute::from_bytes(value.kind(), value.to_bytes());
            assert_eq!(back, Some(value));
        }
    }

    #[test]
    fn a_value_of_the_wrong_length_is_none() {
        for kind in ["float", "double", "int", "v2f", "v3f", "chromaticities"] {
            assert_eq!(Attribute::from_bytes(kind, vec![0; 5]), None, "{kind}");
        }
    }
}
