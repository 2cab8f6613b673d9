//! Arrays of numbers, in single and double precision.

use numpy::{Element, PyReadonlyArray2};
use pyo3::prelude::*;
use rayon::prelude::*;
use upglow_color::Xyz;

use crate::errors::value_error;

/// Single or double precision, the element type of an array.
pub(crate) trait Number: Element + Copy + Send + Sync + Into<f64> {
    const NAN: Self;

    /// The nearest number of this precision.
    fn from_double(value: f64) -> Self;
}

impl Number for f64 {
    const NAN: Self = Self::NAN;

    fn from_double(value: f64) -> Self {
        value
    }
}

impl Number for f32 {
    const NAN: Self = Self::NAN;

    #[expect(clippy::cast_possible_truncation, reason = "its purpose is to round")]
    fn from_double(value: f64) -> Self {
        value as Self
    }
}

/// Tristimulus values in single precision.
pub(crate) fn to_single(Xyz(xyz): Xyz) -> [f32; 3] {
    xyz.map(f32::from_double)
}

/// An array as rows of three numbers.
pub(crate) fn triples<'a, T: Element>(
    array: &'a PyReadonlyArray2<'_, T>,
) -> PyResult<&'a [[T; 3]]> {
    Ok(array.as_slice()?.as_chunks().0)
}

/// Numbers that a thread computes at a time: enough that the cost of distributing them vanishes.
const BATCH: usize = 4096;

/// Fills rows of `width` numbers in parallel; a few are filled on this thread. Each row is computed
/// independently, so the number of threads changes no result.
pub(crate) fn fill<T: Send>(out: &mut [T], width: usize, work: impl Fn(usize, &mut [T]) + Sync) {
    if width == 0 {
        return;
    }
    let rows = (BATCH / width).max(1);
    let batch = |(batch, out): (usize, &mut [T])| {
        for (row, out) in out.chunks_exact_mut(width).enumerate() {
            work(batch * rows + row, out);
        }
    };
    if out.len() <= rows * width {
        batch((0, out));
    } else {
        out.par_chunks_mut(rows * width).enumerate().for_each(batch);
    }
}

/// Checks that `found` numbers are given for `expected` rows.
pub(crate) fn check_count(what: &str, found: usize, expected: usize) -> PyResult<()> {
    if found == expected {
        return Ok(());
    }
    Err(value_error(format_args!("{found} {what}, expected {expected}, one for each color")))
}
