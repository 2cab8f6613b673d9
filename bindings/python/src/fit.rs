//! Building cubes and fitting colors.

use std::sync::atomic::{AtomicUsize, Ordering};

use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use rayon::prelude::*;
use upglow::Node;
use upglow_color::{LinearRgb, Metric};
use upglow_fit::{FitOptions, Fitter, Method, Progress, Watch, build_cube};

use crate::arrays::triples;
use crate::contract::Contract;
use crate::cube::Cube;
use crate::errors::value_error;
use crate::model::Model;
use crate::nodes::{Arrays, arrays};
use crate::threads::on_threads;
use crate::watch::{Watcher, watched};
use crate::word::Word;

/// Metric, slope limit (1/nm), method and sweeps, as Python gives them.
type Options = (Word<Metric>, Option<f64>, Word<Method>, Option<u32>);

/// Fits a material for every node of a cube.
#[pyfunction]
pub(crate) fn build(
    py: Python<'_>,
    contract: &Contract,
    model: &Model,
    resolution: usize,
    options: Options,
    threads: Option<usize>,
    report: Option<&Bound<'_, PyAny>>,
) -> PyResult<Cube> {
    let (Word(metric), slope_max_per_nm, Word(method), sweeps) = options;
    let sweeps = sweeps.unwrap_or(method.default_sweeps());
    let options = FitOptions { metric, slope_max_per_nm, method, sweeps };
    let built = watched(py, report, |watcher| {
        on_threads(threads, || {
            build_cube(&contract.contract, &model.0, options, resolution, watcher)
        })
    })??;
    built.map(Cube::of).map_err(value_error)
}

/// Fits a material for each RGB, as the cube's nodes were fitted.
#[pyfunction]
pub(crate) fn fit<'py>(
    py: Python<'py>,
    cube: &Cube,
    rgb: PyReadonlyArray2<'py, f64>,
    threads: Option<usize>,
    report: Option<&Bound<'_, PyAny>>,
) -> PyResult<Arrays<'py>> {
    let options = FitOptions::try_from(cube.cube.fit()).map_err(value_error)?;
    let rgb = triples(&rgb)?;
    let fitted = watched(py, report, |watcher| {
        let fitter = Fitter::new(cube.cube.contract(), cube.cube.model(), options);
        let fitter = fitter.map_err(value_error)?;
        on_threads(threads, || fit_each(&fitter, rgb, watcher))?
    })??;
    arrays(py, &fitted)
}

/// A material for each RGB. Once the watcher has stopped, the rest are defaults, which nobody reads.
fn fit_each(fitter: &Fitter, rgb: &[[f64; 3]], watcher: &Watcher) -> PyResult<Vec<Node>> {
    let done = AtomicUsize::new(0);
    let fit = |rgb: &[f64; 3]| {
        if watcher.stopped() {
            return Ok(Node::default());
        }
        let fit = fitter.fit(LinearRgb(*rgb)).map_err(value_error)?;
        let done = 1 + done.fetch_add(1, Ordering::Relaxed);
        watcher.progress(Progress { stage: "fitting", done, total: rgb.len() });
        Ok(Node::new(fit.reflectance, fit.fluorescence, fit.de2000))
    };
    rgb.par_iter().map(fit).collect()
}
