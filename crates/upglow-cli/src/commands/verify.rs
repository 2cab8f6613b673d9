//! `upglow verify`: recomputes what a cube promises.

use serde::Serialize;
use upglow_fit::{Check, Offender, Place, Verdict, VerifyOptions, VerifyReport, verify};
use upglow_terminal::{Bar, Failure, on_threads};

use crate::args::VerifyArgs;
use crate::files;
use crate::output::{Format, Report, Side, Table};

#[derive(Clone, Debug, Serialize)]
struct VerificationReport {
    file: String,
    interpolation: String,
    seed: u64,
    nodes: usize,
    points: usize,
    holds: bool,
    checks: Vec<CheckReport>,
}

#[derive(Clone, Debug, Serialize)]
struct CheckReport {
    name: &'static str,
    about: &'static str,
    verdict: String,
    value: f64,
    limit: Option<f64>,
    unit: &'static str,
    checked: usize,
    violations: usize,
    worst: Option<OffenderReport>,
    /// What is said where the law is broken.
    #[serde(skip)]
    fault: Option<String>,
}

#[derive(Clone, Debug, Serialize)]
struct OffenderReport {
    found: f64,
    wavelength_nm: Option<f64>,
    /// `[blue, green, red]` where the offender is a node.
    node: Option<[usize; 3]>,
    rgb: Option<[f64; 3]>,
    dye: Option<String>,
}

pub(crate) fn run(args: &VerifyArgs, format: Format, quiet: bool) -> Result<(), Failure> {
    let cube = files::read_cube(&args.file)?;
    let options =
        VerifyOptions { points: args.points, interpolation: args.interpolation, seed: args.seed };
    let bar = Bar::start(quiet);
    let found = on_threads(args.threads, || verify(&cube, &options, &bar))?;
    bar.finish();
    let report = found.map_err(|_| Failure::Stopped)?;
    let file = args.file.display().to_string();
    format.print(&VerificationReport::new(file, &options, &report))?;
    match report.broken().next() {
        None => Ok(()),
        Some(check) => Err(Failure::file(&args.file, broken(check))),
    }
}

/// Names the law that is broken and the worst offender.
fn broken(check: &Check) -> String {
    let Check { name, value, unit, limit, violations, worst, .. } = check;
    let found = worst.as_ref().map_or_else(|| value.to_string(), Offender::to_string);
    let expected = limit.map_or("none".into(), |limit| format!("at most {limit} {unit}"));
    format!("{name}: {found}, expected {}; {violations} violations", expected.trim_end())
}

impl VerificationReport {
    fn new(file: String, options: &VerifyOptions, report: &VerifyReport) -> Self {
        Self {
            file,
            interpolation: options.interpolation.to_string(),
            seed: options.seed,
            nodes: report.nodes,
            points: report.points,
            holds: report.holds(),
            checks: report.checks.iter().map(CheckReport::new).collect(),
        }
    }
}

impl CheckReport {
    fn new(check: &Check) -> Self {
        Self {
            name: check.name,
            about: check.about,
            verdict: check.verdict.to_string(),
            value: check.value,
            limit: check.limit,
            unit: check.unit,
            checked: check.checked,
            violations: check.violations,
            worst: check.worst.as_ref().map(OffenderReport::new),
            fault: (check.verdict == Verdict::Broken).then(|| broken(check)),
        }
    }

    fn applies(&self) -> bool {
        self.verdict != Verdict::NotApplicable.to_string()
    }
}

impl OffenderReport {
    fn new(offender: &Offender) -> Self {
        let (node, rgb, dye) = match &offender.place {
            Place::Node { node, rgb } => (Some(*node), Some(rgb.0), None),
            Place::Point { rgb } => (None, Some(rgb.0), None),
            Place::Dye { name } => (None, None, Some(name.clone())),
        };
        let Offender { found, wavelength_nm, .. } = *offender;
        Self { found, wavelength_nm, node, rgb, dye }
    }
}

impl Report for VerificationReport {
    fn text(&self) -> String {
        let mut table = Table::new([
            ("check", Side::Left),
            ("verdict", Side::Left),
            ("worst", Side::Right),
            ("limit", Side::Right),
            ("unit", Side::Left),
            ("what", Side::Left),
        ]);
        for check in &self.checks {
            let value = if check.applies() { short(check.value) } else { String::new() };
            table.add([
                check.name.into(),
                check.verdict.clone(),
                value,
                check.limit.map_or(String::new(), short),
                if check.unit == "CIEDE2000" { "ΔE00" } else { check.unit }.into(),
                check.about.into(),
            ]);
        }
        let Self { nodes, points, interpolation, seed, .. } = self;
        let tried = format!(
            "{nodes} nodes and {points} colors between them, interpolation {interpolation}, seed {seed}"
        );
        let faults = self.checks.iter().filter_map(|check| check.fault.as_ref());
        let faults: String = faults.map(|fault| format!("Broken: {fault}.\n")).collect();
        let verdict = if self.holds { "Every law holds for" } else { "Checked" };
        format!("{table}\n{faults}{verdict} {tried}.\n")
    }
}

/// A number to four significant digits.
fn short(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude == 0.0 || (1e-3..1e4).contains(&magnitude) {
        let text = format!("{value:.4}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{value:.2e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_any_size_are_short() {
        let found = [0.0, 0.05, 1.0, 1.25e-9, 31_000.0].map(short);
        assert_eq!(found, ["0", "0.05", "1", "1.25e-9", "3.10e4"]);
    }
}
