//! Cubes: files, nodes, and what they were made of.

use std::path::PathBuf;
use std::sync::OnceLock;

use numpy::PyArray3;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use upglow::{LookupTable, Model, ReadCubeError, WriteCubeError};
use upglow_fit::CubeSummary;

use crate::contract::Contract;
use crate::errors::{file_error, os_error, value_error};
use crate::materials::{Arrays, arrays};

/// One material for each node of a grid over RGB.
#[pyclass(frozen, module = "upglow._upglow")]
#[derive(Debug)]
pub(crate) struct Cube {
    pub(crate) cube: upglow::Cube,
    table: OnceLock<LookupTable>,
}

impl Cube {
    pub(crate) fn of(cube: upglow::Cube) -> Self {
        Self { cube, table: OnceLock::new() }
    }

    /// The cube compiled for look-ups in single precision.
    pub(crate) fn table(&self) -> &LookupTable {
        self.table.get_or_init(|| self.cube.lookup_table())
    }
}

/// Nodes, exact, within 1 and 2 ΔE00; mean, 95th percentile and greatest ΔE00; fluorescent nodes.
type Summary = (usize, usize, usize, usize, f64, f64, f64, usize);

#[pymethods]
impl Cube {
    /// What fluoresces, and by what rules.
    fn model(&self) -> crate::model::Model {
        crate::model::Model(self.cube.model().clone())
    }

    /// Reads a cube's file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        py.detach(|| upglow::Cube::read(&path)).map(Self::of).map_err(|error| match error {
            ReadCubeError::Io(error) => os_error(&path, &error),
            error => file_error(&path, error),
        })
    }

    /// Reads a cube from the content of its file.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, content: &[u8]) -> PyResult<Self> {
        py.detach(|| upglow::Cube::from_bytes(content)).map(Self::of).map_err(value_error)
    }

    /// Writes the cube's file, whole or not at all.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.cube.write(&path)).map_err(|error| match error {
            WriteCubeError::Io(error) => os_error(&path, &error),
            error => value_error(error),
        })
    }

    /// The content of the cube's file.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let content = py.detach(|| self.cube.to_bytes()).map_err(value_error)?;
        Ok(PyBytes::new(py, &content))
    }

    /// What RGB means.
    fn contract(&self) -> Contract {
        Contract::of(self.cube.contract().clone())
    }

    /// Nodes along each axis.
    #[getter]
    fn resolution(&self) -> usize {
        self.cube.resolution()
    }

    /// What the file says of itself, as JSON.
    fn header_json(&self) -> String {
        self.cube.header_json()
    }

    /// `reflectance`, `dye`, `fluorescence` and `de2000` of every node, one a row.
    fn nodes<'py>(&self, py: Python<'py>) -> PyResult<Arrays<'py>> {
        arrays(py, self.cube.nodes())
    }

    /// Absorption, then emission (1/nm) of each dye as the model uses it,
    /// `[dye][absorption emission][wavelength]`, 300 to 830 nm by 1 nm.
    fn dye_curves<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let curves = match self.cube.model() {
            Model::Dyes(model) => model.curves(),
            _ => &[],
        };
        let pair = |dye: &upglow::DyeCurves| {
            vec![dye.absorption.values().to_vec(), dye.emission.values().to_vec()]
        };
        Ok(PyArray3::from_vec3(py, &curves.iter().map(pair).collect::<Vec<_>>())?)
    }

    /// How well the nodes match their colors.
    fn summary(&self) -> Summary {
        let summary = CubeSummary::of(&self.cube);
        let CubeSummary { nodes, exact, within_1, within_2, fluorescent, .. } = summary;
        let CubeSummary { mean_de2000, p95_de2000, max_de2000, .. } = summary;
        (nodes, exact, within_1, within_2, mean_de2000, p95_de2000, max_de2000, fluorescent)
    }
}
