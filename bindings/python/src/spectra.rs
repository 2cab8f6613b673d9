//! Spectra and re-radiation matrices of arrays of colors.

use numpy::PyArray2;
use pyo3::prelude::*;
use upglow::{Bispectral, Mixture};
use upglow_color::{Grid, choices};

use crate::arrays::{Number, triples};
use crate::cube::Cube;
use crate::errors::value_error;
use crate::nodes::nodes;
use crate::rows::{Rows, Subjects, answers, doubles, stored, with_rows};
use crate::threads::Threads;
use crate::word::Word;

/// The quantity of a spectrum.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Quantity {
    /// Light that leaves at the incident wavelength.
    Reflectance,
    /// Light that leaves at any wavelength.
    Albedo,
}

choices!(Quantity, "quantity", Reflectance = "reflectance", Albedo = "albedo");

/// Reflectances or albedos, `[color][wavelength]`.
#[pyfunction]
pub(crate) fn spectrum<'py>(
    py: Python<'py>,
    cube: &Cube,
    of: Subjects<'py>,
    quantity: Word<Quantity>,
    wavelengths_nm: Vec<f64>,
    threads: Threads,
) -> PyResult<Bound<'py, PyAny>> {
    with_rows!(cube, of, rows => {
        let nm: Vec<_> = wavelengths_nm.iter().map(|&nm| Number::from_double(nm)).collect();
        answers(py, &rows, nm.len(), threads, |_, material, out| match quantity.0 {
            Quantity::Reflectance => material.reflectances(&nm, out),
            Quantity::Albedo => {
                out.iter_mut().zip(&nm).for_each(|(out, nm)| *out = material.albedo(*nm));
            }
        })
    })
}

/// Re-radiation matrices over the bands of a grid (first, last, step: nm), in double precision,
/// `[color][outgoing · incident]`.
#[pyfunction]
pub(crate) fn reradiation_matrix<'py>(
    py: Python<'py>,
    cube: &Cube,
    of: Subjects<'py>,
    grid_nm: [u32; 3],
    threads: Threads,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let [first_nm, last_nm, step_nm] = grid_nm;
    let grid = Grid::try_new(first_nm, last_nm, step_nm).map_err(value_error)?;
    match &of {
        Subjects::Double(rgb) => matrices(py, &doubles(&cube.cube, triples(rgb)?), grid, threads),
        Subjects::Single(rgb) => {
            let rgb: Vec<_> = triples(rgb)?.iter().map(|v| v.map(f64::from)).collect();
            matrices(py, &doubles(&cube.cube, &rgb), grid, threads)
        }
        Subjects::Stored(reflectance, dyes, fluorescence) => {
            let nodes = nodes(reflectance, dyes, fluorescence)?;
            matrices(py, &stored(cube.cube.model(), nodes), grid, threads)
        }
    }
}

fn matrices<'py, 'r>(
    py: Python<'py>,
    rows: &Rows<impl Fn(usize) -> Option<Mixture<'r>> + Sync>,
    grid: Grid,
    threads: Threads,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    answers(py, rows, grid.len().pow(2), threads, |_, mixture, out| {
        for (out, row) in out.chunks_exact_mut(grid.len()).zip(mixture.reradiation_matrix(grid)) {
            out.copy_from_slice(&row);
        }
    })
}
