//! One material per color, and the nodes around a color.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use upglow::Node;
use upglow_fit::Polisher;

use crate::arrays::{fill_batches, triples, values};
use crate::cube::Cube;
use crate::errors::value_error;
use crate::nodes::{Arrays, arrays};
use crate::threads::Threads;

/// Colors that a thread works on at a time.
const BATCH: usize = 1024;

/// One material for each RGB; NaN outside 0..=1.
#[pyfunction]
pub(crate) fn polish<'py>(
    py: Python<'py>,
    cube: &Cube,
    rgb: PyReadonlyArray2<'py, f32>,
    threads: Threads,
) -> PyResult<Arrays<'py>> {
    let rgb = triples(&rgb)?;
    let polisher = py.detach(|| Polisher::new(&cube.cube)).map_err(value_error)?;
    let mut texels = values(Node::default(), rgb.len())?;
    fill_batches(py, threads, &mut texels, BATCH, |batch, texels| {
        let rgb = &rgb[batch * BATCH..][..texels.len()];
        polisher.polish(rgb, texels).expect("as many materials as colors");
    })?;
    arrays(py, &texels)
}

/// Indices of nodes and their weights, both `[color][corner]`.
type NodesAndWeights<'py> = (Bound<'py, PyArray2<usize>>, Bound<'py, PyArray2<f64>>);

/// The four nodes around each RGB; outside 0..=1 their weights are NaN.
#[pyfunction]
pub(crate) fn corners<'py>(
    py: Python<'py>,
    cube: &Cube,
    rgb: PyReadonlyArray2<'py, f64>,
) -> PyResult<NodesAndWeights<'py>> {
    let rgb = triples(&rgb)?;
    let around = |rgb: &[f64; 3]| {
        cube.cube.corners(upglow_color::LinearRgb(*rgb)).unwrap_or([(0, f64::NAN); 4])
    };
    let found: Vec<_> = py.detach(|| rgb.iter().flat_map(around).collect());
    let nodes = PyArray1::from_iter(py, found.iter().map(|(node, _)| *node));
    let weights = PyArray1::from_iter(py, found.iter().map(|(_, weight)| *weight));
    Ok((nodes.reshape([rgb.len(), 4])?, weights.reshape([rgb.len(), 4])?))
}
