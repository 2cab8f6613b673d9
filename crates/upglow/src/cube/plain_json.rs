//! What the JSON of a file must be before its fields are read.

use std::collections::HashSet;
use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use upglow_color::NameError;

/// Any JSON in which no object has two fields of one name: of two, readers in different languages take
/// different ones. With `ONE_LINE`, every text and every name of a field is one line too.
pub(crate) struct PlainJson<const ONE_LINE: bool>;

impl<'de, const ONE_LINE: bool> Deserialize<'de> for PlainJson<ONE_LINE> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Self)
    }
}

impl<'de, const ONE_LINE: bool> Visitor<'de> for PlainJson<ONE_LINE> {
    type Value = Self;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("JSON")
    }

    fn visit_bool<E: Error>(self, _: bool) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_i64<E: Error>(self, _: i64) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_u64<E: Error>(self, _: u64) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_f64<E: Error>(self, _: f64) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_unit<E: Error>(self) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Self, E> {
        if ONE_LINE {
            NameError::check_text(text).map_err(E::custom)?;
        }
        Ok(self)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Self, A::Error> {
        while items.next_element::<Self>()?.is_some() {}
        Ok(self)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut fields: A) -> Result<Self, A::Error> {
        let mut names = HashSet::new();
        while let Some(name) = fields.next_key::<String>()? {
            if ONE_LINE {
                NameError::check_text(&name).map_err(A::Error::custom)?;
            }
            fields.next_value::<Self>()?;
            if let Some(name) = names.replace(name) {
                return Err(A::Error::custom(format_args!("two fields {name:?}, expected one")));
            }
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_texts_of_several_lines_and_twins_are_refused() {
        let message =
            |json: &str| serde_json::from_str::<PlainJson<true>>(json).err().map(|e| e.to_string());
        for plain in [r#"{"a":[1,-2,0.5,null,true,"é"],"b":{"a":{}}}"#, "[]", "3"] {
            assert_eq!(message(plain), None);
        }
        let twins = message(r#"{"a":[{"b":1,"b":1}]}"#).unwrap();
        assert!(twins.starts_with("two fields \"b\", expected one"), "{twins}");
        for lines in [
            r#"["a\nb"]"#,
            r#"{"a":"\u2028b"}"#,
            r#""\u0007""#,
            r#"{"a\nb":1}"#,
            r#"[{"\u001b":1}]"#,
        ] {
            assert!(message(lines).unwrap().contains("holds a control character"), "{lines}");
            assert!(serde_json::from_str::<PlainJson<false>>(lines).is_ok(), "{lines}");
        }
    }
}
