//! Building cubes and fitting colors.

use std::sync::atomic::{AtomicUsize, Ordering};

use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use rayon::prelude::*;
use upglow::Node;
use upglow_color::{LinearRgb, Metric};
use upglow_fit::{FitOptions, Fitter, GivenOptions, Method, Preset, Progress, Watch, build_cube};

use crate::arrays::triples;
use crate::contract::Contract;
use crate::cube::Cube;
use crate::errors::value_error;
use crate::model::Model;
use crate::nodes::{Arrays, arrays};
use crate::threads::{Threads, on_threads};
use crate::watch::{Watcher, watched};
use crate::word::Word;

/// A slope limit (1/nm) in a tuple, because `None` is no limit.
type Limit = (Option<f64>,);

/// Preset, metric, slope limits of reflectance alone and under dyes, whether they are relaxed, method and
/// sweeps, as Python gives them; `None` for those of the preset.
type Options = (
    Word<Preset>,
    Option<Word<Metric>>,
    Option<Limit>,
    Option<Limit>,
    Option<bool>,
    Option<Word<Method>>,
    Option<u32>,
);

/// Fits a material for every node of a cube.
#[pyfunction]
pub(crate) fn build(
    py: Python<'_>,
    contract: &Contract,
    model: &Model,
    resolution: usize,
    options: Options,
    threads: Threads,
    report: Option<&Bound<'_, PyAny>>,
) -> PyResult<Cube> {
    let (Word(preset), metric, slope_max, slope_under_dyes, relaxed, method, sweeps) = options;
    let options = preset.options().with(GivenOptions {
        metric: metric.map(|word| word.0),
        slope_max_per_nm: slope_max.map(|(limit,)| limit),
        slope_under_dyes_per_nm: slope_under_dyes.map(|(limit,)| limit),
        relaxed,
        method: method.map(|word| word.0),
        sweeps,
    });
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
    threads: Threads,
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
