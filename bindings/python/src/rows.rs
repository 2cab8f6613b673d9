//! Arrays of colors, one a row, and the materials that stand for them.

use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray2};
use pyo3::prelude::*;
use upglow::{Bispectral, LookupError, LookupTable, Mixture, Model, Node, PackedMixture};
use upglow_color::LinearRgb;
use upglow_fit::{ColorError, Fitter};

use crate::arrays::{Number, fill};
use crate::threads::on_threads;

/// What is evaluated, one a row: colors to look up in one of two precisions, or stored materials.
#[derive(FromPyObject)]
pub(crate) enum Subjects<'py> {
    Single(PyReadonlyArray2<'py, f32>),
    Double(PyReadonlyArray2<'py, f64>),
    /// `reflectance`, `dye` and `fluorescence` of nodes.
    Stored(PyReadonlyArray2<'py, f32>, PyReadonlyArray1<'py, u8>, PyReadonlyArray2<'py, f32>),
}

/// Materials, one a row.
pub(crate) trait Rows: Sync {
    type Material: Bispectral<Real: Number>;

    fn len(&self) -> usize;

    /// `None` where a row stands for no material.
    fn material(&self, row: usize) -> Option<Self::Material>;

    /// Numbers as the materials take them.
    fn numbers(&self, values: &[f64]) -> Vec<RealOf<Self>> {
        values.iter().map(|value| Number::from_double(*value)).collect()
    }
}

/// The precision in which rows are evaluated.
pub(crate) type RealOf<R> = <<R as Rows>::Material as Bispectral>::Real;

/// Colors looked up in double precision.
pub(crate) struct Doubles<'r>(pub(crate) &'r upglow::Cube, pub(crate) &'r [[f64; 3]]);

/// Colors looked up in single precision.
pub(crate) struct Singles<'r>(pub(crate) &'r LookupTable, pub(crate) &'r [[f32; 3]]);

/// Materials that were stored.
pub(crate) struct Stored<'r>(pub(crate) &'r Model, pub(crate) Vec<Node>);

impl<'r> Rows for Doubles<'r> {
    type Material = Mixture<'r>;

    fn len(&self) -> usize {
        self.1.len()
    }

    fn material(&self, row: usize) -> Option<Mixture<'r>> {
        self.0.lookup(LinearRgb(self.1[row]), upglow::Interpolation::Blend).ok()
    }
}

impl<'r> Rows for Singles<'r> {
    type Material = PackedMixture<'r>;

    fn len(&self) -> usize {
        self.1.len()
    }

    fn material(&self, row: usize) -> Option<PackedMixture<'r>> {
        self.0.lookup(self.1[row]).ok()
    }
}

impl<'r> Rows for Stored<'r> {
    type Material = Mixture<'r>;

    fn len(&self) -> usize {
        self.1.len()
    }

    fn material(&self, row: usize) -> Option<Mixture<'r>> {
        let node = self.1[row];
        node.check(self.0).is_ok().then(|| Mixture::of(self.0, node.material(self.0)))
    }
}

/// Evaluates `$work` with `$rows` as the materials of `$subjects` in `$cube`.
macro_rules! with_rows {
    ($cube:expr, $subjects:expr, $rows:ident => $work:expr) => {
        match &$subjects {
            $crate::rows::Subjects::Single(rgb) => {
                let $rows = $crate::rows::Singles($cube.table(), $crate::arrays::triples(rgb)?);
                $work.map(pyo3::Bound::into_any)
            }
            $crate::rows::Subjects::Double(rgb) => {
                let $rows = $crate::rows::Doubles(&$cube.cube, $crate::arrays::triples(rgb)?);
                $work.map(pyo3::Bound::into_any)
            }
            $crate::rows::Subjects::Stored(reflectance, dye, fluorescence) => {
                let nodes = $crate::nodes::nodes(reflectance, dye, fluorescence)?;
                let $rows = $crate::rows::Stored($cube.cube.model(), nodes);
                $work.map(pyo3::Bound::into_any)
            }
        }
    };
}
pub(crate) use with_rows;

/// An array of `width` numbers a row, which `answer` fills from the row's material; not-a-number
/// where there is none.
pub(crate) fn answers<'py, R: Rows>(
    py: Python<'py>,
    rows: &R,
    width: usize,
    threads: Option<usize>,
    answer: impl Fn(usize, &R::Material, &mut [RealOf<R>]) + Sync,
) -> PyResult<Bound<'py, PyArray2<RealOf<R>>>> {
    let array = PyArray2::zeros(py, [rows.len(), width], false);
    let mut writable: PyReadwriteArray2<'_, RealOf<R>> = array.readwrite();
    let out = writable.as_slice_mut()?;
    let answer = |row: usize, numbers: &mut [RealOf<R>]| match rows.material(row) {
        Some(material) => answer(row, &material, numbers),
        None => numbers.fill(<RealOf<R>>::NAN),
    };
    py.detach(|| on_threads(threads, || fill(out, width, answer)))?;
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

/// Place and value of the first number that is not in 0..=`most`.
fn first_beyond<T: Number>(py: Python<'_>, numbers: &[T], most: f64) -> Option<(usize, f64)> {
    let is_within = |v: &T| (0.0..=most).contains(&(*v).into());
    let at = py.detach(|| numbers.iter().position(|v| !is_within(v)))?;
    Some((at, numbers[at].into()))
}
