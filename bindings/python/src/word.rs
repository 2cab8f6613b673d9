//! Options that are words.

use pyo3::prelude::*;
use upglow_color::Choice;

use crate::errors::value_error;

/// The value that a word names; an unknown word is a `ValueError` that lists the known ones.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Word<C>(pub(crate) C);

impl<C: Choice> FromPyObject<'_, '_> for Word<C> {
    type Error = PyErr;

    fn extract(word: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        C::named(&word.extract::<String>()?).map(Self).map_err(value_error)
    }
}
