//! Observers.

use std::path::PathBuf;

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::triples;
use crate::errors::value_error;

/// A named set of color-matching functions from 300 to 830 nm by 1 nm.
#[pyclass(frozen, module = "upglow._upglow")]
#[derive(Debug)]
pub(crate) struct Observer(pub(crate) upglow_color::Observer);

#[pymethods]
impl Observer {
    /// The names of the built-in observers.
    #[staticmethod]
    fn names() -> Vec<&'static str> {
        upglow_color::Observer::NAMES.to_vec()
    }

    /// The built-in observer of this name.
    #[staticmethod]
    fn named(name: &str) -> PyResult<Self> {
        upglow_color::Observer::named(name).map(Self).map_err(value_error)
    }

    /// The observer in CSV text with the header `wavelength_nm,x,y,z`.
    #[staticmethod]
    fn from_csv(name: &str, text: &str) -> PyResult<Self> {
        upglow_color::Observer::from_csv(name, text).map(Self).map_err(value_error)
    }

    /// The observer in the CSV text of the file at this path, named after it.
    #[staticmethod]
    fn from_csv_file(path: PathBuf, text: &str) -> PyResult<Self> {
        upglow_color::Observer::from_csv_file(&path, text).map(Self).map_err(value_error)
    }

    /// The observer with these samples, `[wavelength][x y z]`; wavelengths are nm.
    #[staticmethod]
    fn from_samples(
        name: &str,
        wavelengths_nm: PyReadonlyArray1<'_, f64>,
        matching: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Self> {
        let (nm, matching) = (wavelengths_nm.as_slice()?, triples(&matching)?);
        upglow_color::Observer::from_samples(name, nm, matching)
            .map(Self)
            .map_err(|error| value_error(format_args!("{name}: {error}")))
    }

    /// The name that files state.
    #[getter]
    fn name(&self) -> &str {
        self.0.name()
    }

    /// The functions at 300, 301 … 830 nm, `[wavelength][x y z]`.
    #[getter]
    fn matching<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = self.0.on(upglow_color::Grid::FINE);
        PyArray1::from_slice(py, rows.as_flattened()).reshape([rows.len(), 3])
    }
}
