//! Measured re-radiation matrices, and the materials of them.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use upglow_color::{BispectralUnit, Choice as _, MeasuredDye};
use upglow_fit::{MatrixDifference, MatrixDyes, MatrixFitOptions, MatrixReflectance};

use crate::cube::Cube;
use crate::errors::value_error;
use crate::illuminant::Illuminant;
use crate::model::DyeSet;
use crate::observer::Observer;
use crate::threads::{Threads, on_threads};
use crate::word::Word;

/// A measured re-radiation matrix.
#[pyclass(frozen, module = "upglow._upglow")]
#[derive(Debug)]
pub(crate) struct DonaldsonMatrix(pub(crate) upglow_color::DonaldsonMatrix);

/// The measured color, the fitted one, ΔE00 and what noise may change of it, and whether the observer is adapted.
type Difference = ([f64; 3], [f64; 3], f64, f64, bool);

#[pymethods]
impl DonaldsonMatrix {
    /// The matrix of these values, `[outgoing][incident]`, at these wavelengths, nm; and the reflectance
    /// `[wavelength][nm share]` that replaces its diagonal.
    #[staticmethod]
    #[pyo3(signature = (incident_nm, outgoing_nm, values, unit, reflectance=None))]
    fn from_samples(
        incident_nm: PyReadonlyArray1<'_, f64>,
        outgoing_nm: PyReadonlyArray1<'_, f64>,
        values: PyReadonlyArray2<'_, f64>,
        unit: Word<BispectralUnit>,
        reflectance: Option<Vec<(f64, f64)>>,
    ) -> PyResult<Self> {
        let rows = values.as_array().rows().into_iter().map(|row| row.to_vec()).collect();
        let [incident, outgoing] =
            [incident_nm.as_slice()?, outgoing_nm.as_slice()?].map(Vec::from);
        let matrix = upglow_color::DonaldsonMatrix::try_new(incident, outgoing, rows, unit.0)
            .map_err(value_error)?;
        match reflectance {
            Some(samples) => matrix.with_reflectance(&samples).map(Self).map_err(value_error),
            None => Ok(Self(matrix)),
        }
    }

    /// The matrix in the text of a BFC-450's file.
    #[staticmethod]
    fn from_bfc(text: &str) -> PyResult<Self> {
        upglow_color::DonaldsonMatrix::from_bfc(text).map(Self).map_err(value_error)
    }

    /// The matrix in CSV text with named axes.
    #[staticmethod]
    fn from_csv(text: &str) -> PyResult<Self> {
        upglow_color::DonaldsonMatrix::from_csv(text).map(Self).map_err(value_error)
    }

    /// X, Y, Z under a light, where the perfect diffuser has Y = 1.
    fn color(&self, light: &Illuminant, observer: &Observer) -> PyResult<[f64; 3]> {
        self.0.color(&light.0, &observer.0).map(|color| color.0).map_err(value_error)
    }

    /// How another matrix on the same axes looks beside this one under a light.
    fn difference(&self, fitted: &Self, light: &Illuminant) -> PyResult<Difference> {
        let found = MatrixDifference::of(&self.0, &fitted.0, &light.0).map_err(value_error)?;
        let MatrixDifference { measured, fitted, de2000, noise_de2000, is_adapted, .. } = found;
        Ok((measured.0, fitted.0, de2000, noise_de2000, is_adapted))
    }

    /// What is to say about it under a light.
    fn missing_ultraviolet(&self, light: &Illuminant) -> Option<String> {
        self.0.missing_ultraviolet(&light.0).map(|missing| missing.to_string())
    }

    /// Where light arrives, nm.
    #[getter]
    fn incident_nm<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.0.incident_nm())
    }

    /// Where light leaves, nm.
    #[getter]
    fn outgoing_nm<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.0.outgoing_nm())
    }

    /// Shares per band, `[outgoing][incident]`.
    #[getter]
    fn per_band<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let numbers = self.0.factors().iter().flatten().copied();
        let shape = [self.0.outgoing_nm().len(), self.0.incident_nm().len()];
        PyArray1::from_iter(py, numbers).reshape(shape)
    }

    /// What the diagonal holds.
    #[getter]
    fn diagonal(&self) -> &'static str {
        self.0.diagonal().name()
    }

    /// Root mean square and greatest size below the diagonal, per band.
    #[getter]
    fn noise(&self) -> Option<[f64; 2]> {
        self.0.noise()
    }
}

/// A material fitted to a matrix.
#[pyclass(frozen, module = "upglow._upglow")]
#[derive(Debug)]
pub(crate) struct MatrixFit(upglow_fit::MatrixFit);

#[pymethods]
impl MatrixFit {
    /// The material on the axes of the measured matrix.
    #[getter]
    fn matrix(&self) -> DonaldsonMatrix {
        DonaldsonMatrix(self.0.matrix().clone())
    }

    /// A cube of nodes that are all the material.
    fn cube(&self) -> PyResult<Cube> {
        self.0.to_cube().map(Cube::of).map_err(value_error)
    }
}

/// The material of a matrix: with these dyes, all built-in ones, or those of the matrix.
#[pyfunction]
#[pyo3(signature = (measured, dyes, all_dyes, count, reflectance))]
pub(crate) fn fit_matrix(
    py: Python<'_>,
    measured: &DonaldsonMatrix,
    dyes: Option<&DyeSet>,
    all_dyes: bool,
    count: Option<usize>,
    reflectance: Option<Word<MatrixReflectance>>,
) -> PyResult<MatrixFit> {
    let dyes = match dyes {
        Some(set) => MatrixDyes::Of(set.dyes_of_set()),
        None if all_dyes => MatrixDyes::Of(MeasuredDye::all().collect()),
        None => MatrixDyes::Measured,
    };
    let reflectance = reflectance.map(|Word(word)| word);
    let options = MatrixFitOptions { dyes, count, reflectance };
    let fitted = py.detach(|| {
        on_threads(Threads::default(), || upglow_fit::fit_matrix(&measured.0, &options))
    })?;
    fitted.map(MatrixFit).map_err(value_error)
}
