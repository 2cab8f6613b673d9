//! What attributes of a file in compact form state, checked.

use upglow_color::Choice;

use crate::exr::attribute::{Attribute, Attributes};
use crate::spectral::attribute_spectrum::parse_spectrum;
use crate::spectral::error::FormError;

/// Attributes of a file that claims to be in compact form.
pub(super) struct Stated<'a>(pub(super) &'a Attributes);

impl<'a> Stated<'a> {
    pub(super) fn text(&self, name: &str, expected: &str) -> Result<&'a str, FormError> {
        let found = self.0.get(name);
        found.and_then(Attribute::as_text).ok_or_else(|| {
            let found = found.map_or("absent".into(), |value| format!("a {}", value.kind()));
            wrong(name, found, expected)
        })
    }

    /// One of some words.
    pub(super) fn word(&self, name: &str, known: &[&str]) -> Result<&'a str, FormError> {
        let expected = known.join(" or ");
        let word = self.text(name, &expected)?;
        let found = known.contains(&word).then_some(word);
        found.ok_or_else(|| wrong(name, format!("{word:?}"), expected))
    }

    /// The value of an option.
    pub(super) fn choice<C: Choice>(&self, name: &str) -> Result<C, FormError> {
        let names: Vec<&str> = C::ALL.iter().map(|choice| choice.name()).collect();
        let word = self.word(name, &names)?;
        C::named(word).map_err(|unknown| wrong(name, format!("{word:?}"), unknown.expected))
    }

    /// A number from 0 to `most`.
    pub(super) fn number(&self, name: &str, most: f64) -> Result<f64, FormError> {
        let expected = format!("a number from 0 to {most}");
        let text = self.text(name, &expected)?;
        let number = text.parse().ok().filter(|v: &f64| (0.0..=most).contains(v));
        number.ok_or_else(|| wrong(name, format!("{text:?}"), expected))
    }

    /// Wavelengths, nm, and values of a curve, 0..=1.
    pub(super) fn curve(&self, name: &str) -> Result<(Vec<f64>, Vec<f64>), FormError> {
        const EXPECTED: &str = "numbers from 0 to 1 as 400nm:0.5;410nm:0.6, wavelengths ascending";
        let text = self.text(name, EXPECTED)?;
        let curve = parse_spectrum(text).filter(|(nm, values)| {
            nm.is_sorted_by(|a, b| a < b) && values.iter().all(|v| (0.0..=1.0).contains(v))
        });
        curve.ok_or_else(|| {
            /// A line that a person reads.
            const SHOWN: usize = 40;
            wrong(name, format!("{:?}", text.chars().take(SHOWN).collect::<String>()), EXPECTED)
        })
    }
}

/// What an attribute holds, and what it should.
pub(super) fn wrong(
    name: &str,
    found: impl Into<String>,
    expected: impl Into<String>,
) -> FormError {
    FormError::Attribute { name: name.into(), found: found.into(), expected: expected.into() }
}
