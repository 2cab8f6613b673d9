//! How the materials of colors look under lights.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use upglow_color::{LinearRgb, Xyz};
use upglow_fit::{Appearance, Relighting, View};

use crate::arrays::triples;
use crate::cube::Cube;
use crate::errors::value_error;
use crate::illuminant::Illuminant;
use crate::metamers::of_each;
use crate::observer::Observer;
use crate::threads::{Threads, on_threads};
use crate::watch::watched;

/// Numbers of each color under each light, `[light, color][number]`; the white of each light, and whether the observer is
/// adapted to it.
type Relit<'py> =
    (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<bool>>);

/// How the blends of each RGB, which must be in 0..=1, look to an observer under lights; with bands if that is asked.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python passes each by its name")]
pub(crate) fn relight<'py>(
    py: Python<'py>,
    cube: &Cube,
    rgb: PyReadonlyArray2<'py, f64>,
    lights: Vec<PyRef<'py, Illuminant>>,
    observer: &Observer,
    band: bool,
    threads: Threads,
    report: Option<&Bound<'py, PyAny>>,
) -> PyResult<Relit<'py>> {
    let rgb: Vec<LinearRgb> = triples(&rgb)?.iter().copied().map(LinearRgb).collect();
    let lights: Vec<upglow_color::Illuminant> =
        lights.iter().map(|light| light.0.clone()).collect();
    let cube = &cube.cube;
    let views: PyResult<Vec<View>> = watched(py, report, |watcher| {
        let relighting = Relighting::of_colors(cube, &rgb).map_err(value_error)?;
        on_threads(threads, || {
            let searched = if band { of_each(cube.contract(), &rgb, watcher)? } else { Vec::new() };
            let relighting = relighting.with_metamers(searched);
            let seen_by = relighting.seen_by(&observer.0).map_err(value_error)?;
            Ok(lights.iter().map(|light| seen_by.under(light)).collect())
        })?
    })?;
    let views = views?;
    let each = views.iter().flat_map(|view| &view.appearances).flat_map(numbers);
    let rows = PyArray1::from_iter(py, each).reshape([views.len() * rgb.len(), NUMBERS])?;
    let whites = PyArray1::from_iter(py, views.iter().flat_map(|view| view.seen.white.0));
    let is_adapted = PyArray1::from_iter(py, views.iter().map(|view| view.seen.is_adapted));
    Ok((rows, whites.reshape([views.len(), 3])?, is_adapted))
}

const NUMBERS: usize = 14;

/// XYZ, Lab, RGB, CIEDE2000, share of fluorescence, whiteness, tint and band; NaN where not defined.
fn numbers(seen: &Appearance) -> [f64; NUMBERS] {
    let (Xyz([x, y, z]), LinearRgb([r, g, b])) = (seen.xyz, seen.rgb);
    let [whiteness, tint] = seen.whiteness.map_or([f64::NAN; 2], |w| [w.whiteness, w.tint]);
    let [de2000, share, band] = [seen.de2000, seen.fluorescent_share, seen.band_de2000]
        .map(|value| value.unwrap_or(f64::NAN));
    let lab = seen.lab;
    [x, y, z, lab.l, lab.a, lab.b, r, g, b, de2000, share, whiteness, tint, band]
}
