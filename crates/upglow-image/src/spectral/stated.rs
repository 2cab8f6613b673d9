//! Checked reading of attributes.

use upglow_color::Choice;

use crate::exr::attribute::Attributes;
use crate::exr::error::shown;
use crate::spectral::error::FormError;

/// Reads attribute `name` with `parse`, which returns `None` for text that is not as `expected`.
pub(crate) fn stated<T>(
    attributes: &Attributes,
    name: &str,
    expected: &str,
    parse: impl FnOnce(&str) -> Option<T>,
) -> Result<T, FormError> {
    /// Characters that fit on a line.
    const SHOWN: usize = 40;
    let wrong = |found: String| FormError::Attribute {
        // It may hold the name of a dye, and that any character.
        name: shown(name),
        found,
        expected: expected.into(),
    };
    let value = attributes.get(name).ok_or_else(|| wrong("absent".into()))?;
    let text = value.as_text().ok_or_else(|| wrong(format!("a {}", shown(&value.kind))))?;
    let start = || text.chars().take(SHOWN).collect::<String>();
    parse(text).ok_or_else(|| wrong(format!("{:?}", start())))
}

/// Reads the value of an option.
pub(crate) fn choice<C: Choice>(attributes: &Attributes, name: &str) -> Result<C, FormError> {
    let names: Vec<&str> = C::ALL.iter().map(|choice| choice.name()).collect();
    let parse = |word: &str| C::ALL.iter().copied().find(|choice| choice.name() == word);
    stated(attributes, name, &names.join(" or "), parse)
}
