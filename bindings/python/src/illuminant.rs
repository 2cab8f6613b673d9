//! Lights.

use std::path::PathBuf;

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use upglow_color::{Ends, Grid, IlluminantError};

use crate::errors::value_error;
use crate::observer::Observer;
use crate::word::Word;

/// A named light: relative spectral power from 300 to 830 nm by 1 nm.
#[pyclass(frozen, module = "upglow._upglow")]
#[derive(Debug)]
pub(crate) struct Illuminant(pub(crate) upglow_color::Illuminant);

impl Illuminant {
    /// The light of samples. An error starts with `place` and names the argument that could mend it.
    fn sampled(
        light: Result<upglow_color::Illuminant, IlluminantError>,
        ends: Option<Ends>,
        place: &str,
    ) -> PyResult<Self> {
        light.map(Self).map_err(|error| {
            let has_choice = ends.is_none() && error.lacks_ends();
            let hint = "; Illuminant(…, ends=\"zero\") or \"hold\" says what is beyond";
            value_error(format_args!("{place}{error}{}", if has_choice { hint } else { "" }))
        })
    }
}

#[pymethods]
impl Illuminant {
    /// The names of the built-in lights.
    #[staticmethod]
    fn names() -> Vec<&'static str> {
        upglow_color::Illuminant::names()
    }

    /// The built-in light of this name.
    #[staticmethod]
    fn named(name: &str) -> PyResult<Self> {
        upglow_color::Illuminant::named(name).map(Self).map_err(value_error)
    }

    /// The light in CSV text with the header `wavelength_nm,power`.
    #[staticmethod]
    #[pyo3(signature = (name, text, ends=None))]
    fn from_csv(name: &str, text: &str, ends: Option<Word<Ends>>) -> PyResult<Self> {
        let ends = ends.map(|Word(ends)| ends);
        Self::sampled(upglow_color::Illuminant::from_csv(name, text, ends), ends, "")
    }

    /// The light in the CSV text of the file at this path, named after it.
    #[staticmethod]
    #[pyo3(signature = (path, text, ends=None))]
    fn from_csv_file(path: PathBuf, text: &str, ends: Option<Word<Ends>>) -> PyResult<Self> {
        let ends = ends.map(|Word(ends)| ends);
        Self::sampled(upglow_color::Illuminant::from_csv_file(&path, text, ends), ends, "")
    }

    /// The light with these samples; wavelengths are nm.
    #[staticmethod]
    #[pyo3(signature = (name, wavelengths_nm, power, ends=None))]
    fn from_samples(
        name: &str,
        wavelengths_nm: PyReadonlyArray1<'_, f64>,
        power: PyReadonlyArray1<'_, f64>,
        ends: Option<Word<Ends>>,
    ) -> PyResult<Self> {
        let (nm, power) = (wavelengths_nm.as_slice()?, power.as_slice()?);
        let ends = ends.map(|Word(ends)| ends);
        let light = upglow_color::Illuminant::from_samples(name, nm, power, ends);
        Self::sampled(light, ends, &format!("{name}: "))
    }

    /// A light with one Gaussian line; wavelengths are nm.
    #[staticmethod]
    fn line(name: &str, peak_nm: f64, fwhm_nm: f64) -> PyResult<Self> {
        upglow_color::Illuminant::line(name, peak_nm, fwhm_nm).map(Self).map_err(value_error)
    }

    /// The name that files state.
    #[getter]
    fn name(&self) -> &str {
        self.0.name()
    }

    /// Relative power at 300, 301 … 830 nm.
    #[getter]
    fn power<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.0.power().values())
    }

    /// First and last wavelength at which the power is known, nm.
    #[getter]
    fn given_nm(&self) -> [u32; 2] {
        self.0.given_nm()
    }

    /// Relative power in each band of a grid (first, last, step: nm).
    fn power_in_bands<'py>(
        &self,
        py: Python<'py>,
        grid_nm: [u32; 3],
        observer: &Observer,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let [first_nm, last_nm, step_nm] = grid_nm;
        let grid = Grid::try_new(first_nm, last_nm, step_nm).map_err(value_error)?;
        Ok(PyArray1::from_vec(py, self.0.power_in_bands(grid, &observer.0)))
    }

    /// The wavelengths of every table, 300, 301 … 830 nm.
    #[staticmethod]
    fn wavelengths_nm(py: Python<'_>) -> Bound<'_, PyArray1<f64>> {
        PyArray1::from_iter(py, Grid::FINE.wavelengths_nm())
    }
}
