//! Wavelengths drawn for arrays of colors, and how likely they were.

use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::cube::Cube;
use crate::errors::value_error;
use crate::evaluate::{Evaluate, Way, numbers_of};
use crate::rows::{Number, Rows, Subjects, answers, check_count, with_rows};

/// The way of this name.
fn way(name: &str) -> PyResult<Way> {
    match name {
        "incident" => Ok(Way::Incident),
        "outgoing" => Ok(Way::Outgoing),
        _ => Err(value_error(format_args!("way {name:?}, expected incident or outgoing"))),
    }
}

/// Drawn wavelength (nm), throughput, probability or density, and 1 where the wavelength was kept,
/// `[color][4]`.
#[pyfunction]
#[pyo3(signature = (cube, of, drawn, known_nm, u, threads))]
pub(crate) fn sample<'py>(
    py: Python<'py>,
    cube: &Cube,
    of: Subjects<'py>,
    drawn: &str,
    known_nm: PyReadonlyArray1<'py, f64>,
    u: PyReadonlyArray2<'py, f64>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyAny>> {
    let (way, known, u) = (way(drawn)?, known_nm.as_slice()?, u.as_slice()?.as_chunks::<2>().0);
    with_rows!(cube, of, rows => {
        check_count("known wavelengths", known.len(), rows.len())?;
        check_count("pairs of random numbers", u.len(), rows.len())?;
        answers(py, &rows, 4, threads, |row, material, out| {
            let u = u[row].map(Number::from_double);
            out.copy_from_slice(&numbers_of(material.sample(way, number(known[row]), u)));
        })
    })
}

/// Densities of drawn wavelengths, 1/nm, `[color][1]`.
#[pyfunction]
#[pyo3(signature = (cube, of, drawn, in_nm, out_nm, threads))]
pub(crate) fn pdf_per_nm<'py>(
    py: Python<'py>,
    cube: &Cube,
    of: Subjects<'py>,
    drawn: &str,
    in_nm: PyReadonlyArray1<'py, f64>,
    out_nm: PyReadonlyArray1<'py, f64>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyAny>> {
    let (way, from, to) = (way(drawn)?, in_nm.as_slice()?, out_nm.as_slice()?);
    with_rows!(cube, of, rows => {
        check_count("in_nm", from.len(), rows.len())?;
        check_count("out_nm", to.len(), rows.len())?;
        answers(py, &rows, 1, threads, |row, material, out| {
            out[0] = material.pdf_per_nm(way, number(from[row]), number(to[row]));
        })
    })
}

/// Probabilities that wavelengths are kept, `[color][1]`.
#[pyfunction]
#[pyo3(signature = (cube, of, drawn, known_nm, threads))]
pub(crate) fn elastic_probability<'py>(
    py: Python<'py>,
    cube: &Cube,
    of: Subjects<'py>,
    drawn: &str,
    known_nm: PyReadonlyArray1<'py, f64>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyAny>> {
    let (way, known) = (way(drawn)?, known_nm.as_slice()?);
    with_rows!(cube, of, rows => {
        check_count("known wavelengths", known.len(), rows.len())?;
        answers(py, &rows, 1, threads, |row, material, out| {
            out[0] = material.elastic_probability(way, number(known[row]));
        })
    })
}

fn number<T: Number>(value: f64) -> T {
    T::from_double(value)
}
