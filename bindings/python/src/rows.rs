//! Arrays of colors, one per row, and their materials.

use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray2, PyReadwriteArray2};
use pyo3::prelude::*;
use upglow::{
    Bispectral, Interpolation, LookupError, LookupTable, Mixture, Model, Node, PackedMixture,
};
use upglow_color::LinearRgb;
use upglow_fit::{ColorError, Fitter};

use crate::arrays::{Number, fill, zeros};
use crate::threads::Threads;

/// What is evaluated, one per row: colors to look up in one of two precisions, or stored materials.
#[derive(FromPyObject)]
pub(crate) enum Subjects<'py> {
    Single(PyReadonlyArray2<'py, f32>),
    Double(PyReadonlyArray2<'py, f64>),
    /// `reflectance`, `dyes` and `fluorescence` of nodes.
    Stored(PyReadonlyArray2<'py, f32>, PyReadonlyArray2<'py, u8>, PyReadonlyArray2<'py, f32>),
}

/// Materials, one per row.
pub(crate) struct Rows<F> {
    pub(crate) count: usize,
    /// The material of a row; `None` where it has none.
    material: F,
}

/// Colors looked up in double precision.
pub(crate) fn doubles<'r>(
    cube: &'r upglow::Cube,
    rgb: &'r [[f64; 3]],
) -> Rows<impl Fn(usize) -> Option<Mixture<'r>> + Sync> {
    let material = |row: usize| cube.lookup(LinearRgb(rgb[row]), Interpolation::Blend).ok();
    Rows { count: rgb.len(), material }
}

/// Colors looked up in single precision.
pub(crate) fn singles<'r>(
    table: &'r LookupTable,
    rgb: &'r [[f32; 3]],
) -> Rows<impl Fn(usize) -> Option<PackedMixture<'r>> + Sync> {
    Rows { count: rgb.len(), material: |row: usize| table.lookup(rgb[row]).ok() }
}

/// Materials that were stored.
pub(crate) fn stored<'r>(
    model: &'r Model,
    nodes: Vec<Node>,
) -> Rows<impl Fn(usize) -> Option<Mixture<'r>> + Sync> {
    let count = nodes.len();
    let material = move |row: usize| {
        let node = nodes[row];
        node.check(model).is_ok().then(|| Mixture::of(model, node.material(model)))
    };
    Rows { count, material }
}

/// Evaluates `$work` with `$rows` as the materials of `$subjects` in `$cube`.
macro_rules! with_rows {
    ($cube:expr, $subjects:expr, $rows:ident => $work:expr) => {
        match &$subjects {
            $crate::rows::Subjects::Single(rgb) => {
                let $rows = $crate::rows::singles($cube.table(), $crate::arrays::triples(rgb)?);
                $work.map(pyo3::Bound::into_any)
            }
            $crate::rows::Subjects::Double(rgb) => {
                let $rows = $crate::rows::doubles(&$cube.cube, $crate::arrays::triples(rgb)?);
                $work.map(pyo3::Bound::into_any)
            }
            $crate::rows::Subjects::Stored(reflectance, dyes, fluorescence) => {
                let nodes = $crate::nodes::nodes(reflectance, dyes, fluorescence)?;
                let $rows = $crate::rows::stored($cube.cube.model(), nodes);
                $work.map(pyo3::Bound::into_any)
            }
        }
    };
}
pub(crate) use with_rows;

/// An array of `width` numbers per row, which `answer` fills from the row's material; NaN in rows
/// without one.
pub(crate) fn answers<'py, M: Bispectral<Real: Number>>(
    py: Python<'py>,
    rows: &Rows<impl Fn(usize) -> Option<M> + Sync>,
    width: usize,
    threads: Threads,
    answer: impl Fn(usize, &M, &mut [M::Real]) + Sync,
) -> PyResult<Bound<'py, PyArray2<M::Real>>> {
    let array = zeros(py, [rows.count, width])?;
    let mut writable: PyReadwriteArray2<'_, M::Real> = array.readwrite();
    let out = writable.as_slice_mut()?;
    let answer = |row: usize, numbers: &mut [M::Real]| match (rows.material)(row) {
        Some(material) => answer(row, &material, numbers),
        None => numbers.fill(<M::Real>::NAN),
    };
    fill(py, threads, out, width, answer)?;
    drop(writable);
    Ok(array)
}

/// Row and message of the first RGB that is not in 0..=1, or, for fits, in 0..=10.
#[pyfunction]
pub(crate) fn first_outside(
    py: Python<'_>,
    rgb: Subjects<'_>,
    to_fit: bool,
) -> PyResult<Option<(usize, String)>> {
    let most = if to_fit { Fitter::BRIGHTEST } else { 1.0 };
    let found = match &rgb {
        Subjects::Single(rgb) => first_beyond(py, rgb.as_slice()?, most),
        Subjects::Double(rgb) => first_beyond(py, rgb.as_slice()?, most),
        Subjects::Stored(..) => None,
    };
    Ok(found.map(|(at, value)| {
        let channel = ["red", "green", "blue"][at % 3];
        let message = match to_fit {
            true => ColorError::Outside { channel, value }.to_string(),
            false => LookupError::Outside { channel, value }.to_string(),
        };
        (at / 3, message)
    }))
}

/// Index and value of the first number that is not in 0..=`most`.
fn first_beyond<T: Number>(py: Python<'_>, numbers: &[T], most: f64) -> Option<(usize, f64)> {
    let is_within = |v: &T| (0.0..=most).contains(&(*v).into());
    let at = py.detach(|| numbers.iter().position(|v| !is_within(v)))?;
    Some((at, numbers[at].into()))
}
