//! Materials as arrays: the numbers that cubes store.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use rayon::prelude::*;
use upglow::Node;
use upglow_fit::Polisher;

use crate::cube::Cube;
use crate::errors::value_error;
use crate::rows::{check_count, single_rows, triples};
use crate::threads::on_threads;

/// `reflectance`, `dye`, `fluorescence` and `de2000` of nodes, one a row.
pub(crate) type Arrays<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<u8>>,
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f32>>,
);

/// Nodes as arrays.
pub(crate) fn arrays<'py>(py: Python<'py>, nodes: &[Node]) -> PyResult<Arrays<'py>> {
    let rows = |numbers: fn(&Node) -> [f32; 3]| {
        PyArray1::from_iter(py, nodes.iter().flat_map(numbers)).reshape([nodes.len(), 3])
    };
    Ok((
        rows(|node| node.reflectance)?,
        PyArray1::from_iter(py, nodes.iter().map(|node| node.dye)),
        rows(|node| node.fluorescence)?,
        PyArray1::from_iter(py, nodes.iter().map(|node| node.de2000)),
    ))
}

/// Nodes from arrays; their `de2000` is 0.
pub(crate) fn nodes(
    reflectance: &PyReadonlyArray2<'_, f32>,
    dye: &PyReadonlyArray1<'_, u8>,
    fluorescence: &PyReadonlyArray2<'_, f32>,
) -> PyResult<Vec<Node>> {
    let (reflectance, dye) = (triples(reflectance.as_slice()?), dye.as_slice()?);
    let fluorescence = triples(fluorescence.as_slice()?);
    check_count("dyes", dye.len(), reflectance.len())?;
    check_count("fluorescences", fluorescence.len(), reflectance.len())?;
    let rows = reflectance.iter().zip(dye).zip(fluorescence);
    let node = |((&reflectance, &dye), &fluorescence)| Node {
        reflectance,
        dye,
        fluorescence,
        de2000: 0.0,
    };
    Ok(rows.map(node).collect())
}

/// Texels that a thread works on at a time.
const BATCH: usize = 1024;

/// One material for each RGB; not-a-number outside 0..=1.
#[pyfunction]
#[pyo3(signature = (cube, rgb, threads))]
pub(crate) fn polish<'py>(
    py: Python<'py>,
    cube: &Cube,
    rgb: PyReadonlyArray2<'py, f32>,
    threads: Option<usize>,
) -> PyResult<Arrays<'py>> {
    let rgb = single_rows(&rgb)?;
    let polished = py.detach(|| {
        let polisher = Polisher::new(&cube.cube).map_err(value_error)?;
        let mut texels = vec![Node::default(); rgb.len()];
        on_threads(threads, || {
            let batches = rgb.par_chunks(BATCH).zip(texels.par_chunks_mut(BATCH));
            batches.try_for_each(|(rgb, texels)| polisher.polish(rgb, texels).map(|_| ()))
        })?
        .map_err(value_error)?;
        PyResult::Ok(texels)
    })?;
    arrays(py, &polished)
}

/// Numbers of nodes and their weights, `[color][corner]` both.
type NodesAndWeights<'py> = (Bound<'py, PyArray2<usize>>, Bound<'py, PyArray2<f64>>);

/// The four nodes around each RGB; outside 0..=1 their weights are not-a-number.
#[pyfunction]
#[pyo3(signature = (cube, rgb))]
pub(crate) fn corners<'py>(
    py: Python<'py>,
    cube: &Cube,
    rgb: PyReadonlyArray2<'py, f64>,
) -> PyResult<NodesAndWeights<'py>> {
    let rgb = triples(rgb.as_slice()?);
    let around = |rgb: &[f64; 3]| {
        cube.cube.corners(upglow_color::LinearRgb(*rgb)).unwrap_or([(0, f64::NAN); 4])
    };
    let found: Vec<_> = py.detach(|| rgb.iter().flat_map(around).collect());
    let nodes = PyArray1::from_iter(py, found.iter().map(|(node, _)| *node));
    let weights = PyArray1::from_iter(py, found.iter().map(|(_, weight)| *weight));
    Ok((nodes.reshape([rgb.len(), 4])?, weights.reshape([rgb.len(), 4])?))
}
