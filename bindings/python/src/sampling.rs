//! Wavelengths drawn for arrays of colors, and how likely they were.

use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use upglow::{Bispectral, Draw, Sample};

use crate::cube::Cube;
use crate::errors::value_error;
use crate::rows::{Number, Rows, Subjects, answers, check_count, with_rows};

/// Which wavelength of light is drawn; the other one is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Drawn {
    /// That of incident light, for a path from the camera.
    Incident,
    /// That of the light that leaves, for a path from the light.
    Outgoing,
}

/// The wavelength of this name.
fn drawn_of(name: &str) -> PyResult<Drawn> {
    match name {
        "incident" => Ok(Drawn::Incident),
        "outgoing" => Ok(Drawn::Outgoing),
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
    let (drawn, known, u) =
        (drawn_of(drawn)?, known_nm.as_slice()?, u.as_slice()?.as_chunks::<2>().0);
    with_rows!(cube, of, rows => {
        check_count("known wavelengths", known.len(), rows.len())?;
        check_count("pairs of random numbers", u.len(), rows.len())?;
        answers(py, &rows, 4, threads, |row, material, out| {
            let u = u[row].map(Number::from_double);
            let sample = match drawn {
                Drawn::Incident => material.sample_incident(number(known[row]), u),
                Drawn::Outgoing => material.sample_outgoing(number(known[row]), u),
            };
            out.copy_from_slice(&numbers_of(sample));
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
    let (drawn, from, to) = (drawn_of(drawn)?, in_nm.as_slice()?, out_nm.as_slice()?);
    with_rows!(cube, of, rows => {
        check_count("in_nm", from.len(), rows.len())?;
        check_count("out_nm", to.len(), rows.len())?;
        answers(py, &rows, 1, threads, |row, material, out| {
            let (in_nm, out_nm) = (number(from[row]), number(to[row]));
            out[0] = match drawn {
                Drawn::Incident => material.incident_pdf_per_nm(in_nm, out_nm),
                Drawn::Outgoing => material.outgoing_pdf_per_nm(in_nm, out_nm),
            };
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
    let (drawn, known) = (drawn_of(drawn)?, known_nm.as_slice()?);
    with_rows!(cube, of, rows => {
        check_count("known wavelengths", known.len(), rows.len())?;
        answers(py, &rows, 1, threads, |row, material, out| {
            out[0] = match drawn {
                Drawn::Incident => material.incident_elastic_probability(number(known[row])),
                Drawn::Outgoing => material.outgoing_elastic_probability(number(known[row])),
            };
        })
    })
}

/// Wavelength, throughput, probability or density, and 1 where the wavelength was kept.
fn numbers_of<T: Number>(sample: Option<Sample<T>>) -> [T; 4] {
    let [zero, one] = [0.0, 1.0].map(T::from_double);
    match sample {
        None => [T::NAN, zero, zero, zero],
        Some(Sample { nm, throughput, draw: Draw::Elastic { probability } }) => {
            [nm, throughput, probability, one]
        }
        Some(Sample { nm, throughput, draw: Draw::Fluorescent { per_nm } }) => {
            [nm, throughput, per_nm, zero]
        }
    }
}

fn number<T: Number>(value: f64) -> T {
    T::from_double(value)
}
