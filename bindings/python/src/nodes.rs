//! Conversion of nodes, the numbers that cubes store, to and from arrays.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use upglow::Node;

use crate::arrays::{check_count, triples};

/// `reflectance`, `dye`, `fluorescence` and `de2000` of nodes, one per row.
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
    let (reflectance, dye) = (triples(reflectance)?, dye.as_slice()?);
    let fluorescence = triples(fluorescence)?;
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
