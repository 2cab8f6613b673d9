//! Spectra and re-radiation of arrays of colors.

use numpy::{PyArray2, PyReadonlyArray1};
use pyo3::prelude::*;
use upglow::{Bispectral, Mixture};
use upglow_color::Grid;

use crate::cube::Cube;
use crate::errors::value_error;
use crate::materials::nodes;
use crate::rows::{
    Doubles, Number, Rows, Stored, Subjects, answers, check_count, triples, with_rows,
};

/// Reflectances, `[color][wavelength]`.
#[pyfunction]
#[pyo3(signature = (cube, of, wavelengths_nm, threads))]
pub(crate) fn reflectance<'py>(
    py: Python<'py>,
    cube: &Cube,
    of: Subjects<'py>,
    wavelengths_nm: Vec<f64>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyAny>> {
    with_rows!(cube, of, rows => {
        let nm = converted(&rows, &wavelengths_nm);
        answers(py, &rows, nm.len(), threads, |_, material, out| material.reflectances(&nm, out))
    })
}

/// Albedos, `[color][wavelength]`.
#[pyfunction]
#[pyo3(signature = (cube, of, wavelengths_nm, threads))]
pub(crate) fn albedo<'py>(
    py: Python<'py>,
    cube: &Cube,
    of: Subjects<'py>,
    wavelengths_nm: Vec<f64>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyAny>> {
    with_rows!(cube, of, rows => {
        let nm = converted(&rows, &wavelengths_nm);
        answers(py, &rows, nm.len(), threads, |_, material, out| {
            for (out, nm) in out.iter_mut().zip(&nm) {
                *out = material.albedo(*nm);
            }
        })
    })
}

/// Energy that moves between two wavelengths, 1/nm, `[color][1]`.
#[pyfunction]
#[pyo3(signature = (cube, of, in_nm, out_nm, threads))]
pub(crate) fn reradiation<'py>(
    py: Python<'py>,
    cube: &Cube,
    of: Subjects<'py>,
    in_nm: PyReadonlyArray1<'py, f64>,
    out_nm: PyReadonlyArray1<'py, f64>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyAny>> {
    let (from, to) = (in_nm.as_slice()?, out_nm.as_slice()?);
    with_rows!(cube, of, rows => {
        check_count("in_nm", from.len(), rows.len())?;
        check_count("out_nm", to.len(), rows.len())?;
        answers(py, &rows, 1, threads, |row, material, out| {
            out[0] = material.reradiation_per_nm(number(from[row]), number(to[row]));
        })
    })
}

/// Re-radiation matrices over the bands of a grid (first, last, step: nm), in double precision,
/// `[color][outgoing · incident]`.
#[pyfunction]
#[pyo3(signature = (cube, of, grid_nm, threads))]
pub(crate) fn reradiation_matrix<'py>(
    py: Python<'py>,
    cube: &Cube,
    of: Subjects<'py>,
    grid_nm: [u32; 3],
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let [first_nm, last_nm, step_nm] = grid_nm;
    let grid = Grid::try_new(first_nm, last_nm, step_nm).map_err(value_error)?;
    match &of {
        Subjects::Double(rgb) => {
            matrices(py, &Doubles(&cube.cube, triples(rgb.as_slice()?)), grid, threads)
        }
        Subjects::Single(rgb) => {
            let rgb: Vec<_> = triples(rgb.as_slice()?).iter().map(|v| v.map(f64::from)).collect();
            matrices(py, &Doubles(&cube.cube, &rgb), grid, threads)
        }
        Subjects::Stored(reflectance, dye, fluorescence) => {
            let nodes = nodes(reflectance, dye, fluorescence)?;
            matrices(py, &Stored(cube.cube.model(), nodes), grid, threads)
        }
    }
}

fn matrices<'py, 'r>(
    py: Python<'py>,
    rows: &impl Rows<Number = f64, Material = Mixture<'r>>,
    grid: Grid,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    answers(py, rows, grid.len().pow(2), threads, |_, mixture, out| {
        for (out, row) in out.chunks_exact_mut(grid.len()).zip(mixture.reradiation_matrix(grid)) {
            out.copy_from_slice(&row);
        }
    })
}

fn converted<R: Rows>(_: &R, wavelengths_nm: &[f64]) -> Vec<R::Number> {
    wavelengths_nm.iter().map(|nm| R::Number::from_double(*nm)).collect()
}

fn number<T: Number>(value: f64) -> T {
    T::from_double(value)
}
