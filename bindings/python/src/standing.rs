//! What kind of material can reproduce colors.

use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use upglow_color::LinearRgb;

use crate::arrays::{fill, triples, values};
use crate::contract::Contract;
use crate::threads::Threads;

/// Kind, distance in XYZ and ΔE00 of each color.
type Standings<'py> =
    (Bound<'py, PyArray1<u8>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// What kind of material can reproduce each RGB under a contract: 0, a reflectance; 1, only a
/// fluorescent one; 2, none. And the distance in XYZ and in ΔE00 to the nearest color of any
/// reflectance or, for 2, of any material.
#[pyfunction]
pub(crate) fn standing<'py>(
    py: Python<'py>,
    contract: &Contract,
    rgb: PyReadonlyArray2<'py, f64>,
    threads: Threads,
) -> PyResult<Standings<'py>> {
    let rgb = triples(&rgb)?;
    let mut found = values((0, 0.0, 0.0), rgb.len())?;
    let table = py.detach(|| contract.standing_table());
    fill(py, threads, &mut found, 1, |row, out| {
        let standing = table.standing(LinearRgb(rgb[row]));
        let beyond = standing.beyond();
        out[0] = (standing.kind as u8, beyond.distance, beyond.de2000);
    })?;
    Ok((
        PyArray1::from_iter(py, found.iter().map(|f| f.0)),
        PyArray1::from_iter(py, found.iter().map(|f| f.1)),
        PyArray1::from_iter(py, found.iter().map(|f| f.2)),
    ))
}
