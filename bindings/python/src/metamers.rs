//! The materials that colors may have.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use upglow::Interpolation;
use upglow_color::{LinearRgb, MeasuredDye, Xyz};
use upglow_fit::{MetamerError, MetamerSearch, OwnMaterial, PaintKind, Progress, Watch};

use crate::arrays::triples;
use crate::contract::Contract;
use crate::cube::Cube;
use crate::errors::{check_range, value_error};
use crate::illuminant::Illuminant;
use crate::matrix::DonaldsonMatrix;
use crate::model::DyeSet;
use crate::threads::{Threads, on_threads};
use crate::watch::Watcher;
use crate::word::Word;

/// The materials that may have a color.
#[pyclass(frozen, module = "upglow._upglow")]
#[derive(Debug)]
pub(crate) struct Metamers {
    found: upglow_fit::Metamers,
    contract: upglow_color::Contract,
}

/// A cube of nodes that are all the heaviest part; a cube that blends all parts, and for which color.
type Answer = (Cube, Cube, [f64; 3]);

/// Probabilities, and X, Y, Z `[material][number]`.
type Colors<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>);

#[pymethods]
impl Metamers {
    /// The probability that the paint fluoresces.
    #[getter]
    fn fluorescent_probability(&self, py: Python<'_>) -> PyResult<f64> {
        py.detach(|| on_threads(Threads::default(), || self.found.fluorescent_probability()))
    }

    /// The probability and X, Y, Z of each material under a light.
    fn colors<'py>(&self, py: Python<'py>, light: &Illuminant) -> PyResult<Colors<'py>> {
        let colors = || self.found.colors(&self.found.light(&light.0));
        let colors = py.detach(|| on_threads(Threads::default(), colors))?;
        let probabilities = PyArray1::from_iter(py, colors.iter().map(|(weight, _)| *weight));
        let xyz = PyArray1::from_iter(py, colors.iter().flat_map(|(_, xyz)| xyz.0));
        Ok((probabilities, xyz.reshape([colors.len(), 3])?))
    }

    /// The mean color under a light.
    fn mean(&self, py: Python<'_>, light: &Illuminant) -> PyResult<[f64; 3]> {
        let mean = || self.found.mean(&self.found.light(&light.0)).0;
        py.detach(|| on_threads(Threads::default(), mean))
    }

    /// How far an answer may be off under a light, ΔE00.
    fn band(
        &self,
        py: Python<'_>,
        light: &Illuminant,
        answer: [f64; 3],
        share: f64,
    ) -> PyResult<f64> {
        check_range("share", share, [0.0, 1.0])?;
        let band = || self.found.band(&self.found.light(&light.0), Xyz(answer), share);
        py.detach(|| on_threads(Threads::default(), band))
    }

    /// The best single material.
    fn single(&self, py: Python<'_>) -> PyResult<Answer> {
        self.answer(py, upglow_fit::Metamers::single)
    }

    /// The best blend of up to four materials.
    fn mixture(&self, py: Python<'_>) -> PyResult<Answer> {
        self.answer(py, upglow_fit::Metamers::mixture)
    }

    /// What is to say about a light.
    fn missing_ultraviolet(&self, light: &Illuminant) -> Option<String> {
        self.found.missing_ultraviolet(&light.0).map(|missing| missing.to_string())
    }
}

impl Metamers {
    fn answer(
        &self,
        py: Python<'_>,
        choose: fn(&upglow_fit::Metamers) -> Result<OwnMaterial, MetamerError>,
    ) -> PyResult<Answer> {
        let chosen = py.detach(|| on_threads(Threads::default(), || choose(&self.found)))?;
        let material = chosen.map_err(value_error)?;
        let (contract, method) = (&self.contract, MetamerSearch::METHOD);
        let all = material.to_cube(contract, method).map_err(value_error)?;
        let (blending, rgb) = material.to_blending_cube(contract, method).map_err(value_error)?;
        Ok((Cube::of(all), Cube::of(blending), rgb.0))
    }
}

/// The materials that may have these linear colors, `[light][channel]`, the first under the light of the contract, the
/// others under `lights`; with these dyes, or all that are built in.
#[pyfunction]
pub(crate) fn metamers(
    py: Python<'_>,
    contract: &Contract,
    lights: Vec<PyRef<'_, Illuminant>>,
    rgb: PyReadonlyArray2<'_, f64>,
    kind: Word<PaintKind>,
    dyes: Option<&DyeSet>,
    threads: Threads,
) -> PyResult<Metamers> {
    let contract = contract.contract.clone();
    let lights: Vec<upglow_color::Illuminant> =
        lights.iter().map(|light| light.0.clone()).collect();
    let rgb: Vec<LinearRgb> = triples(&rgb)?.iter().copied().map(LinearRgb).collect();
    let dyes = dyes.map_or_else(|| MeasuredDye::all().collect(), DyeSet::dyes_of_set);
    let find = || MetamerSearch::among(&contract, &lights, kind.0, dyes)?.of_rgb(&rgb);
    let found = py.detach(|| on_threads(threads, find))?.map_err(value_error)?;
    Ok(Metamers { found, contract })
}

/// The materials that may have each of some colors under the light of a contract. Once the watcher has stopped, the rest
/// are missing, which nobody reads.
pub(crate) fn of_each(
    contract: &upglow_color::Contract,
    rgb: &[LinearRgb],
    watcher: &Watcher,
) -> PyResult<Vec<upglow_fit::Metamers>> {
    let most = MetamerSearch::MOST_IN_TURN;
    if rgb.len() > most {
        let takes = "which takes half a second for each";
        let found = rgb.len();
        let message =
            format_args!("{found} colors, expected at most {most} with band=True, {takes}");
        return Err(value_error(message));
    }
    let search = MetamerSearch::new(contract, &[], PaintKind::default()).map_err(value_error)?;
    let total = rgb.len();
    let mut found = Vec::with_capacity(total);
    for (done, &rgb) in rgb.iter().enumerate() {
        if watcher.stopped() {
            break;
        }
        watcher.progress(Progress { stage: "searching materials", done, total });
        found.push(search.of_rgb(&[rgb]).map_err(value_error)?);
    }
    Ok(found)
}

/// What a color looks up, on the axes of a measured matrix.
#[pyfunction]
pub(crate) fn matrix_like(
    cube: &Cube,
    rgb: [f64; 3],
    measured: &DonaldsonMatrix,
) -> PyResult<DonaldsonMatrix> {
    let mixture = cube.cube.lookup(LinearRgb(rgb), Interpolation::Blend).map_err(value_error)?;
    Ok(DonaldsonMatrix(mixture.matrix_like(&measured.0)))
}
