//! Parsers of the values of options.

use std::ffi::OsStr;
use std::fmt::Display;
use std::marker::PhantomData;
use std::str::FromStr;

use clap::builder::{PossibleValue, TypedValueParser};
use clap::{Arg, Command};
use upglow_color::Choice;

/// Parses the words of a [`Choice`], which clap lists in the help.
#[derive(Clone, Copy, Debug)]
struct Word<T>(PhantomData<T>);

/// A parser of the words of a [`Choice`].
#[must_use]
pub fn word<T: Choice + Send + Sync>() -> impl TypedValueParser<Value = T> {
    Word(PhantomData)
}

impl<T: Choice + Send + Sync> TypedValueParser for Word<T> {
    type Value = T;

    fn parse_ref(
        &self,
        command: &Command,
        option: Option<&Arg>,
        value: &OsStr,
    ) -> Result<T, clap::Error> {
        T::named.parse_ref(command, option, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let value = |value: &T| PossibleValue::new(value.name()).aliases(value.aliases());
        Some(Box::new(T::ALL.iter().map(value)))
    }
}

/// Parses a number.
///
/// # Errors
///
/// A text that says what was found and what was expected.
pub fn number(text: &str) -> Result<f64, String> {
    parsed(text, "a number")
}

/// Parses a whole number of 0 or more.
///
/// # Errors
///
/// A text that says what was found and what was expected.
pub fn count<T: FromStr>(text: &str) -> Result<T, String> {
    parsed(text, "a whole number of 0 or more")
}

/// A parser of whole numbers from `least` to `most`.
pub fn in_range(
    [least, most]: [usize; 2],
) -> impl Fn(&str) -> Result<usize, String> + Clone + Send + Sync + 'static {
    move |text| {
        let expected = format!("a whole number from {least} to {most}");
        match parsed(text, &expected)? {
            found if (least..=most).contains(&found) => Ok(found),
            found => Err(format!("{found}, expected {expected}")),
        }
    }
}

/// Parses a value; `expected` describes it in the error.
///
/// # Errors
///
/// A text that says what was found and what was expected.
pub fn parsed<T: FromStr>(text: &str, expected: impl Display) -> Result<T, String> {
    text.trim().parse().map_err(|_| format!("{text:?}, expected {expected}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_out_of_range_is_refused() {
        let resolution = in_range([2, 256]);
        assert_eq!(resolution("32"), Ok(32));
        for text in ["1", "257", "-4", "many", "4.5"] {
            assert!(resolution(text).is_err_and(|e| e.ends_with("from 2 to 256")), "{text}");
        }
    }
}
