//! Arrays of colors, one a row, and the materials that stand for them.

use numpy::{
    Element, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray2,
};
use pyo3::prelude::*;
use rayon::prelude::*;
use upglow::{Bispectral, LookupError, LookupTable, Mixture, Model, Node, PackedMixture};
use upglow_color::{LinearRgb, Xyz};
use upglow_fit::{ColorError, Fitter};

use crate::errors::value_error;
use crate::threads::on_threads;

/// Single or double precision: what the numbers of an array ask for.
pub(crate) trait Number: Element + Copy + Send + Sync + Into<f64> {
    const NAN: Self;

    /// The nearest number.
    fn from_double(value: f64) -> Self;
}

impl Number for f64 {
    const NAN: Self = Self::NAN;

    fn from_double(value: f64) -> Self {
        value
    }
}

impl Number for f32 {
    const NAN: Self = Self::NAN;

    #[expect(clippy::cast_possible_truncation, reason = "rounding is what it is for")]
    fn from_double(value: f64) -> Self {
        value as Self
    }
}

/// Tristimulus values in single precision.
pub(crate) fn to_single(Xyz(xyz): Xyz) -> [f32; 3] {
    xyz.map(f32::from_double)
}

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
    type Number: Number;
    type Material: Bispectral<Real = Self::Number>;

    fn len(&self) -> usize;

    /// `None` where a row stands for no material.
    fn material(&self, row: usize) -> Option<Self::Material>;
}

/// Colors looked up in double precision.
pub(crate) struct Doubles<'r>(pub(crate) &'r upglow::Cube, pub(crate) &'r [[f64; 3]]);

/// Colors looked up in single precision.
pub(crate) struct Singles<'r>(pub(crate) &'r LookupTable, pub(crate) &'r [[f32; 3]]);

/// Materials that were stored.
pub(crate) struct Stored<'r>(pub(crate) &'r Model, pub(crate) Vec<Node>);

impl<'r> Rows for Doubles<'r> {
    type Number = f64;
    type Material = Mixture<'r>;

    fn len(&self) -> usize {
        self.1.len()
    }

    fn material(&self, row: usize) -> Option<Mixture<'r>> {
        self.0.lookup(LinearRgb(self.1[row]), upglow::Interpolation::Blend).ok()
    }
}

impl<'r> Rows for Singles<'r> {
    type Number = f32;
    type Material = PackedMixture<'r>;

    fn len(&self) -> usize {
        self.1.len()
    }

    fn material(&self, row: usize) -> Option<PackedMixture<'r>> {
        self.0.lookup(self.1[row]).ok()
    }
}

impl<'r> Rows for Stored<'r> {
    type Number = f64;
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
                let $rows =
                    $crate::rows::Singles($cube.table(), $crate::rows::triples(rgb.as_slice()?));
                $work.map(pyo3::Bound::into_any)
            }
            $crate::rows::Subjects::Double(rgb) => {
                let $rows =
                    $crate::rows::Doubles(&$cube.cube, $crate::rows::triples(rgb.as_slice()?));
                $work.map(pyo3::Bound::into_any)
            }
            $crate::rows::Subjects::Stored(reflectance, dye, fluorescence) => {
                let nodes = $crate::materials::nodes(reflectance, dye, fluorescence)?;
                let $rows = $crate::rows::Stored($cube.cube.model(), nodes);
                $work.map(pyo3::Bound::into_any)
            }
        }
    };
}
pub(crate) use with_rows;

/// Rows of three numbers.
pub(crate) fn triples<T>(numbers: &[T]) -> &[[T; 3]] {
    numbers.as_chunks().0
}

/// An array of `width` numbers a row, which `answer` fills from the row's material; not-a-number
/// where there is none.
pub(crate) fn answers<'py, R: Rows>(
    py: Python<'py>,
    rows: &R,
    width: usize,
    threads: Option<usize>,
    answer: impl Fn(usize, &R::Material, &mut [R::Number]) + Sync,
) -> PyResult<Bound<'py, PyArray2<R::Number>>> {
    let array = PyArray2::zeros(py, [rows.len(), width], false);
    let mut writable: PyReadwriteArray2<'_, R::Number> = array.readwrite();
    let out = writable.as_slice_mut()?;
    let answer = |row: usize, numbers: &mut [R::Number]| match rows.material(row) {
        Some(material) => answer(row, &material, numbers),
        None => numbers.fill(R::Number::NAN),
    };
    py.detach(|| on_threads(threads, || fill(out, width, answer)))?;
    drop(writable);
    Ok(array)
}

/// Numbers that a thread makes at a time: enough that handing them out costs nothing.
const BATCH: usize = 4096;

/// Fills rows of `width` numbers, each alone, so that threads change nothing. Few are filled here.
pub(crate) fn fill<T: Send>(out: &mut [T], width: usize, work: impl Fn(usize, &mut [T]) + Sync) {
    if width == 0 {
        return;
    }
    let rows = (BATCH / width).max(1);
    let batch = |(batch, out): (usize, &mut [T])| {
        for (row, out) in out.chunks_exact_mut(width).enumerate() {
            work(batch * rows + row, out);
        }
    };
    if out.len() <= rows * width {
        batch((0, out));
    } else {
        out.par_chunks_mut(rows * width).enumerate().for_each(batch);
    }
}

/// Checks that `found` numbers are given for `expected` rows.
pub(crate) fn check_count(what: &str, found: usize, expected: usize) -> PyResult<()> {
    if found == expected {
        return Ok(());
    }
    Err(value_error(format_args!("{found} {what}, expected {expected}, one for each color")))
}

/// Row and message of the first RGB that is not in 0..=1, or, for fits, in 0..=10.
#[pyfunction]
#[pyo3(signature = (rgb, to_fit))]
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

/// An RGB or XYZ array as rows, for a function that knows only single precision.
pub(crate) fn single_rows<'a>(array: &'a PyReadonlyArray2<'_, f32>) -> PyResult<&'a [[f32; 3]]> {
    Ok(triples(array.as_slice()?))
}
