//! Options that are words.

use pyo3::prelude::*;
use upglow_color::Choice;

use crate::errors::{kind_error, value_error};

/// The value that a word names; an unknown one is a `ValueError` that lists the known ones, and what is no text a
/// `TypeError`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Word<C>(pub(crate) C);

impl<C: Choice> FromPyObject<'_, '_> for Word<C> {
    type Error = PyErr;

    fn extract(word: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        let Ok(text) = word.extract::<String>() else {
            return Err(kind_error(C::WHAT, word, &C::known_words()));
        };
        C::named(&text).map(Self).map_err(value_error)
    }
}
