//! Recomputes what a cube promises from its stored numbers alone.

mod inspector;
mod laws;
mod report;
mod spectra;
mod subjects;
mod tally;

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use upglow::{Cube, DyeCurves, Interpolation, Model};

pub use report::{Check, Offender, Place, Stopped, Verdict, VerifyReport};

use crate::summary::Spread;
use crate::{Progress, Watch};
use inspector::{Figure, Findings, Inspector};
use laws::{LAWS, Law, verdict};
use spectra::Spectra;

/// How a cube is verified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VerifyOptions {
    /// Random colors between the nodes; default 1 000 000.
    pub points: usize,
    /// How colors between nodes get their material; default blend.
    pub interpolation: Interpolation,
    /// Where the random colors start; default 0.
    pub seed: u64,
}

impl Default for VerifyOptions {
    fn default() -> Self {
        Self { points: 1_000_000, interpolation: Interpolation::default(), seed: 0 }
    }
}

/// Mean CIEDE2000 that may lie between sums over 5 nm and over 1 nm. Larger means that the fit saw
/// another material than a renderer will; smaller is not to be had from sums over 5 nm.
const GRID_LIMIT: f64 = 0.05;

/// Checks every node, 1001 grays and `options.points` random colors against the laws, on all
/// threads of the current rayon pool.
///
/// Spectra are taken at every nanometer from 300 to 830 nm. The report does not depend on the
/// number of threads. The laws of the spectra hold for any interpolation but may be broken by all
/// but blend and none, which do not mix materials but parameters.
///
/// # Errors
///
/// [`Stopped`] if `watch` stopped the work.
pub fn verify(
    cube: &Cube,
    options: &VerifyOptions,
    watch: &dyn Watch,
) -> Result<VerifyReport, Stopped> {
    let inspector = Inspector::new(cube, options);
    let subjects = inspector.subjects();
    let done = AtomicUsize::new(0);
    let pieces: Vec<Findings> = (0..subjects.pieces())
        .into_par_iter()
        .map_init(Spectra::new, |spectra, piece| {
            if watch.stopped() {
                return Err(Stopped);
            }
            let findings = inspector.inspect(piece, spectra);
            let count = subjects.piece(piece).len();
            let done = done.fetch_add(count, Ordering::Relaxed) + count;
            watch.progress(Progress { stage: "verifying", done, total: subjects.len() });
            Ok(findings)
        })
        .collect::<Result<_, _>>()?;
    let mut findings = Findings::default();
    pieces.into_iter().for_each(|piece| findings.add(piece));
    let checks = checks(cube, &inspector, findings);
    Ok(VerifyReport { nodes: cube.nodes().len(), points: options.points, checks })
}

fn checks(cube: &Cube, inspector: &Inspector<'_>, findings: Findings) -> Vec<Check> {
    let exact = findings.laws[Law::Exact as usize].checked;
    let laws = inspector.rules().iter().zip(findings.laws);
    let mut checks: Vec<Check> = laws.map(|(rule, tally)| rule.check(tally, cube)).collect();
    debug_assert_eq!(checks.len(), LAWS.len());
    checks.push(dye_curves(cube.model()));
    let points = findings.points.values.len();
    checks.extend(grid_checks(GRID_NODES, findings.grid_nodes, cube));
    checks.extend(grid_checks(GRID_POINTS, findings.grid_points, cube));
    checks.extend(point_figures(findings.points, cube));
    checks.push(Check {
        name: "points-between-exact",
        about: "share of random colors whose nodes are all exact",
        unit: "",
        ..figure(exact as f64 / points.max(1) as f64, points)
    });
    checks
}

/// A number to report.
fn figure(value: f64, checked: usize) -> Check {
    Check {
        name: "",
        about: "",
        verdict: verdict(None, checked, 0),
        value,
        limit: None,
        unit: "CIEDE2000",
        checked,
        violations: 0,
        worst: None,
    }
}

/// Name and description of a mean and of a greatest value.
type MeanAndMax = [(&'static str, &'static str); 2];

const GRID_NODES: MeanAndMax = [
    ("grid-nodes-mean", "nodes, sums over 1 nm against 5 nm, mean"),
    ("grid-nodes-max", "nodes, sums over 1 nm against 5 nm, greatest"),
];
const GRID_POINTS: MeanAndMax = [
    ("grid-points-mean", "random colors, sums over 1 nm against 5 nm, mean"),
    ("grid-points-max", "random colors, sums over 1 nm against 5 nm, greatest"),
];

fn grid_checks([mean, max]: MeanAndMax, found: Figure, cube: &Cube) -> [Check; 2] {
    let worst = found.tally.worst.map(|worst| worst.offender(cube));
    let spread = Spread::of(found.values);
    let checked = found.tally.checked;
    let violations = usize::from(spread.mean.is_nan() || spread.mean > GRID_LIMIT);
    [
        Check {
            name: mean.0,
            about: mean.1,
            verdict: verdict(Some(GRID_LIMIT), checked, violations),
            limit: Some(GRID_LIMIT),
            violations,
            worst: worst.clone(),
            ..figure(spread.mean, checked)
        },
        Check { name: max.0, about: max.1, worst, ..figure(spread.max, checked) },
    ]
}

fn point_figures(found: Figure, cube: &Cube) -> [Check; 3] {
    let worst = found.tally.worst.map(|worst| worst.offender(cube));
    let spread = Spread::of(found.values);
    let of = |value| figure(value, found.tally.checked);
    [
        Check {
            name: "points-mean",
            about: "random colors against their targets, mean",
            ..of(spread.mean)
        },
        Check {
            name: "points-p95",
            about: "random colors against their targets, 95 in 100 are within",
            ..of(spread.p95)
        },
        Check {
            name: "points-max",
            about: "random colors against their targets, greatest",
            worst,
            ..of(spread.max)
        },
    ]
}

/// The curves that all materials share: absorption in 0 to 1, emission of 0 or more and unit area.
fn dye_curves(model: &Model) -> Check {
    /// Rounding of a sum of 531 numbers.
    const LIMIT: f64 = 1e-9;
    let dyes = match model {
        Model::Dyes(model) => model.curves().iter().zip(model.set().dyes()).collect(),
        _ => Vec::new(),
    };
    let faults: Vec<f64> = dyes.iter().map(|(curves, _)| curve_fault(curves)).collect();
    let violations = faults.iter().filter(|&&fault| fault > LIMIT).count();
    let (value, at) = tally::greatest(faults.iter().copied());
    let worst = dyes.get(at).map(|(_, dye)| Offender {
        place: Place::Dye { name: dye.name.clone() },
        wavelength_nm: None,
        found: value,
    });
    Check {
        name: "dye-curves",
        about: "how far absorption lies outside 0 to 1, emission below 0, its area from 1",
        verdict: verdict(Some(LIMIT), dyes.len(), violations),
        limit: Some(LIMIT),
        unit: "",
        violations,
        worst,
        ..figure(value.max(0.0), dyes.len())
    }
}

fn curve_fault(curves: &DyeCurves) -> f64 {
    let absorption = curves.absorption.values().iter().map(|&a| (a - 1.0).max(-a));
    let emission = curves.emission.values().iter().map(|e| -e);
    let area = (curves.emission.integral() - 1.0).abs();
    absorption.chain(emission).fold(area, f64::max)
}
