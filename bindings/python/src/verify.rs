//! Verification of what a cube promises.

use pyo3::prelude::*;
use upglow::Interpolation;
use upglow_fit::{Check, Offender, VerifyOptions};

use crate::cube::Cube;
use crate::errors::value_error;
use crate::threads::{Threads, on_threads};
use crate::watch::watched;
use crate::word::Word;

/// Name, about, verdict, value, limit, unit, checked, violations and the worst case.
type Row = (
    &'static str,
    &'static str,
    String,
    f64,
    Option<f64>,
    &'static str,
    usize,
    usize,
    Option<String>,
);

/// Nodes, points, whether all laws hold, and every check.
#[pyfunction]
pub(crate) fn verify(
    py: Python<'_>,
    cube: &Cube,
    points: usize,
    interpolation: Word<Interpolation>,
    seed: u64,
    threads: Threads,
    report: Option<&Bound<'_, PyAny>>,
) -> PyResult<(usize, usize, bool, Vec<Row>)> {
    let options = VerifyOptions { points, interpolation: interpolation.0, seed };
    let found = watched(py, report, |watcher| {
        on_threads(threads, || upglow_fit::verify(&cube.cube, &options, watcher))
    })??;
    let found = found.map_err(value_error)?;
    Ok((found.nodes, found.points, found.holds(), found.checks.iter().map(row).collect()))
}

fn row(check: &Check) -> Row {
    (
        check.name,
        check.about,
        check.verdict.to_string(),
        check.value,
        check.limit,
        check.unit,
        check.checked,
        check.violations,
        check.worst.as_ref().map(Offender::to_string),
    )
}
