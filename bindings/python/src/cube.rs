//! Cubes: files, nodes, contract and model.

use std::io::ErrorKind;
use std::path::PathBuf;
use std::sync::OnceLock;

use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use upglow::{CubeFileError, DyeCurves, DyeModel, FilmModel, LookupTable, Model};
use upglow_fit::CubeSummary;

use crate::contract::Contract;
use crate::errors::{os_error, value_error};
use crate::illuminant::Illuminant;
use crate::nodes::{Arrays, arrays};

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

    /// Empty where the model has no dyes.
    fn dyes(&self) -> &[DyeCurves] {
        self.cube.model().dyes().map_or(&[], DyeModel::curves)
    }

    /// The cube compiled for look-ups in single precision.
    pub(crate) fn table(&self) -> &LookupTable {
        self.table.get_or_init(|| self.cube.lookup_table())
    }
}

/// Optical densities, and curves `[dye][density][wavelength]`.
type Proposals<'py> = ([f64; 4], Bound<'py, PyArray3<f64>>);

/// Nodes, exact, within 1 and 2 ΔE00; mean, 95th percentile and greatest ΔE00; fluorescent nodes; nodes
/// of each kind of material.
type Summary = (usize, usize, usize, usize, f64, f64, f64, usize, [u64; 4]);

fn file_error(error: CubeFileError) -> PyErr {
    match error {
        CubeFileError::Io { path, cause } if cause.kind() != ErrorKind::InvalidInput => {
            os_error(&path, &cause)
        }
        error => value_error(error),
    }
}

#[pymethods]
impl Cube {
    /// What fluoresces, and by what rules.
    fn model(&self) -> crate::model::Model {
        crate::model::Model(self.cube.model().clone())
    }

    /// Reads a cube's file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        py.detach(|| upglow::Cube::read(path)).map(Self::of).map_err(file_error)
    }

    /// Reads a cube from the content of its file.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, content: &[u8]) -> PyResult<Self> {
        py.detach(|| upglow::Cube::from_bytes(content)).map(Self::of).map_err(value_error)
    }

    /// Writes the cube's file, completely or not at all.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.cube.write(path)).map_err(file_error)
    }

    /// The content of the cube's file.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let content = py.detach(|| self.cube.to_bytes());
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

    /// The file's header, as JSON.
    fn header_json(&self) -> String {
        self.cube.header_json()
    }

    /// What is to say about its materials under a light.
    fn missing_ultraviolet(&self, light: &Illuminant) -> Option<String> {
        self.cube.model().missing_ultraviolet(&light.0).map(|missing| missing.to_string())
    }

    /// `reflectance`, `dyes`, `fluorescence` and `de2000` of every node, one per row.
    fn nodes<'py>(&self, py: Python<'py>) -> PyResult<Arrays<'py>> {
        arrays(py, self.cube.nodes())
    }

    /// Every node in the packed layout of `docs/cube-format.md`, `[node][8]`.
    fn packed_nodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let nodes = self.cube.packed_nodes();
        let count = nodes.len();
        let numbers = nodes.flat_map(|node| node.reflectance.into_iter().chain(node.fluorescence));
        PyArray1::from_iter(py, numbers).reshape([count, 8])
    }

    /// Absorption, then emission (1/nm) of each dye as the model uses it,
    /// `[dye][absorption emission][wavelength]`, 300 to 830 nm by 1 nm.
    fn dye_curves<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let pair = |dye: &DyeCurves| {
            vec![dye.absorption.values().to_vec(), dye.emission.values().to_vec()]
        };
        Ok(PyArray3::from_vec3(py, &self.dyes().iter().map(pair).collect::<Vec<_>>())?)
    }

    /// Quantum yield and mean emission (nm) of each dye, `[dye][2]`.
    fn dye_numbers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let dyes = self.dyes();
        let numbers = dyes.iter().flat_map(|dye| [dye.quantum_yield, dye.mean_emission_nm]);
        PyArray1::from_iter(py, numbers).reshape([dyes.len(), 2])
    }

    /// Optical densities of a film, and what each dye by itself returns at them and a quantum yield
    /// of 1, `[dye][density][wavelength]`, 300 to 830 nm by 1 nm; `None` for other models.
    fn film_proposals<'py>(&self, py: Python<'py>) -> PyResult<Option<Proposals<'py>>> {
        let Model::Film(film) = self.cube.model() else { return Ok(None) };
        let of_dye = |dye: usize| film.proposed(dye).map(<[f64]>::to_vec).to_vec();
        let curves: Vec<_> = (0..film.dyes().curves().len()).map(of_dye).collect();
        Ok(Some((FilmModel::LEVELS, PyArray3::from_vec3(py, &curves)?)))
    }

    /// How well the nodes match their colors.
    fn summary(&self) -> Summary {
        let summary = CubeSummary::of(&self.cube);
        let CubeSummary { nodes, exact, within_1, within_2, fluorescent, kinds, .. } = summary;
        let kinds = kinds.each().map(|(_, count)| count);
        let CubeSummary { mean_de2000, p95_de2000, max_de2000, .. } = summary;
        (nodes, exact, within_1, within_2, mean_de2000, p95_de2000, max_de2000, fluorescent, kinds)
    }
}
