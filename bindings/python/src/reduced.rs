//! Materials as 4×4 matrices, and lights as four numbers.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyReadwriteArray2};
use pyo3::prelude::*;
use upglow::{Mixture, ReducedModel, ReducedTable};
use upglow_color::{Grid, ReducedBasis, ReducedMatrix};

use crate::arrays::{Number, fill, triples, zeros};
use crate::cube::Cube;
use crate::errors::value_error;
use crate::illuminant::Illuminant;
use crate::nodes::nodes;
use crate::rows::{Rows, Subjects, answers, doubles, stored};
use crate::threads::Threads;

/// The lights by which a cube's materials are reduced, and what is made of them at the first call.
#[pyclass(frozen, module = "upglow._upglow")]
#[derive(Debug)]
pub(crate) struct Reduced {
    basis: ReducedBasis,
    model: ReducedModel,
    table: ReducedTable,
}

/// Numbers of a matrix.
const NUMBERS: usize = 16;

#[pymethods]
impl Reduced {
    /// For the materials of a cube, by sums over 5 nm.
    #[new]
    fn new(py: Python<'_>, cube: &Cube) -> PyResult<Self> {
        py.detach(|| {
            let basis =
                ReducedBasis::try_new(cube.cube.contract(), Grid::FIT).map_err(value_error)?;
            let model = ReducedModel::new(cube.cube.model(), &basis);
            Ok(Self { table: cube.cube.reduced_table(&basis), basis, model })
        })
    }

    /// X, Y, Z, U of a light; of the contract's without one.
    fn light<'py>(&self, py: Python<'py>, light: Option<&Illuminant>) -> Bound<'py, PyArray1<f64>> {
        let light = light.map_or(self.basis.white(), |light| self.basis.light(&light.0));
        PyArray1::from_slice(py, &light.0)
    }

    /// Matrices of the cube's materials, `[color][outgoing · incident]`; NaN outside 0..=1.
    fn matrix<'py>(
        &self,
        py: Python<'py>,
        cube: &Cube,
        of: Subjects<'py>,
        threads: Threads,
    ) -> PyResult<Bound<'py, PyAny>> {
        match &of {
            Subjects::Single(rgb) => Ok(self.looked_up(py, triples(rgb)?, threads)?.into_any()),
            Subjects::Double(rgb) => {
                let rows = doubles(&cube.cube, triples(rgb)?);
                Ok(self.each(py, &rows, threads)?.into_any())
            }
            Subjects::Stored(reflectance, dyes, fluorescence) => {
                let rows = stored(cube.cube.model(), nodes(reflectance, dyes, fluorescence)?);
                Ok(self.each(py, &rows, threads)?.into_any())
            }
        }
    }

    /// 3×3 matrices of X, Y, Z of 4×4 ones, `[matrix][outgoing · incident]`.
    fn without_ultraviolet<'py>(
        &self,
        py: Python<'py>,
        matrices: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (flat, _) = matrices.as_slice()?.as_chunks::<NUMBERS>();
        let of = |numbers: &[f64; NUMBERS]| {
            let (rows, _) = numbers.as_chunks::<4>();
            let matrix = ReducedMatrix([rows[0], rows[1], rows[2], rows[3]]);
            self.basis.reduction().without_ultraviolet(matrix).0
        };
        let found: Vec<f64> = flat.iter().flat_map(|m| of(m).into_iter().flatten()).collect();
        PyArray1::from_vec(py, found).reshape([flat.len(), 9])
    }
}

impl Reduced {
    fn looked_up<'py>(
        &self,
        py: Python<'py>,
        rgb: &[[f32; 3]],
        threads: Threads,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let array = zeros(py, [rgb.len(), NUMBERS])?;
        let mut writable: PyReadwriteArray2<'_, f32> = array.readwrite();
        let look_up = |row: usize, numbers: &mut [f32]| match self.table.matrix(rgb[row]) {
            Ok(matrix) => numbers.copy_from_slice(matrix.as_flattened()),
            Err(_) => numbers.fill(<f32 as Number>::NAN),
        };
        fill(py, threads, writable.as_slice_mut()?, NUMBERS, look_up)?;
        drop(writable);
        Ok(array)
    }

    fn each<'py, 'r>(
        &self,
        py: Python<'py>,
        rows: &Rows<impl Fn(usize) -> Option<Mixture<'r>> + Sync>,
        threads: Threads,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        answers(py, rows, NUMBERS, threads, |_, mixture, out| {
            out.copy_from_slice(mixture.reduced_matrix(&self.model).0.as_flattened());
        })
    }
}
