//! Conversion of nodes, the numbers that cubes store, to and from arrays.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use upglow::Node;

use crate::arrays::{check_count, triples};

/// `reflectance`, `dyes`, `fluorescence` and `de2000` of nodes, one per row.
pub(crate) type Arrays<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray2<u8>>,
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
        PyArray1::from_iter(py, nodes.iter().flat_map(|node| node.dyes))
            .reshape([nodes.len(), 2])?,
        rows(|node| node.fluorescence)?,
        PyArray1::from_iter(py, nodes.iter().map(|node| node.de2000)),
    ))
}

/// Nodes from arrays; their `de2000` is 0.
pub(crate) fn nodes(
    reflectance: &PyReadonlyArray2<'_, f32>,
    dyes: &PyReadonlyArray2<'_, u8>,
    fluorescence: &PyReadonlyArray2<'_, f32>,
) -> PyResult<Vec<Node>> {
    let (reflectance, fluorescence) = (triples(reflectance)?, triples(fluorescence)?);
    let (dyes, _) = dyes.as_slice()?.as_chunks();
    check_count("dyes", dyes.len(), reflectance.len())?;
    check_count("fluorescences", fluorescence.len(), reflectance.len())?;
    let rows = reflectance.iter().zip(dyes).zip(fluorescence);
    let node = |((&reflectance, &dyes), &fluorescence)| Node {
        reflectance,
        dyes,
        fluorescence,
        de2000: 0.0,
    };
    Ok(rows.map(node).collect())
}
