//! `upglow verify`: recomputes the laws that a cube must obey.

use serde::Serialize;
use upglow::Interpolation;
use upglow_fit::{Check, Verdict, VerifyOptions, verify};
use upglow_terminal::{Console, Failure, Report};

use crate::args::VerifyArgs;
use crate::files;
use crate::output::{Side, Table, warn_of_own_light};

#[derive(Debug, Serialize)]
struct VerificationReport<'a> {
    file: String,
    interpolation: Interpolation,
    seed: u64,
    nodes: usize,
    points: usize,
    holds: bool,
    checks: &'a [Check],
    /// What the cube's light lacks that its dyes absorb.
    missing_ultraviolet: Option<String>,
}

pub(crate) fn run(args: &VerifyArgs, console: &Console) -> Result<(), Failure> {
    let cube = files::read_cube(&args.file)?;
    let VerifyArgs { points, interpolation, seed, .. } = *args;
    let options = VerifyOptions { points, interpolation, seed };
    let report = console.work(args.threads, |bar| verify(&cube, &options, bar))??;
    console.print(&VerificationReport {
        file: args.file.display().to_string(),
        interpolation,
        seed,
        nodes: report.nodes,
        points: report.points,
        holds: report.holds(),
        checks: &report.checks,
        missing_ultraviolet: warn_of_own_light(&cube),
    })?;
    match report.broken().next() {
        None => Ok(()),
        Some(check) => Err(Failure::file(&args.file, broken(check))),
    }
}

/// Names the broken law, and the worst offender and how many there are, which means do not have.
fn broken(check: &Check) -> String {
    let Check { name, value, unit, limit, violations, worst, .. } = check;
    let expected = limit.map_or("none".into(), |limit| format!("at most {limit} {unit}"));
    let expected = expected.trim_end();
    match worst {
        Some(worst) => format!("{name}: {worst}, expected {expected}; {violations} violations"),
        None => format!("{name}: {value}, expected {expected}"),
    }
}

impl Report for VerificationReport<'_> {
    fn text(&self) -> String {
        let mut table = Table::new([
            ("check", Side::Left),
            ("verdict", Side::Left),
            ("worst", Side::Right),
            ("limit", Side::Right),
            ("unit", Side::Left),
            ("what", Side::Left),
        ]);
        for check in self.checks {
            let applies = check.verdict != Verdict::NotApplicable;
            table.add([
                check.name.into(),
                check.verdict.to_string(),
                if applies { short(check.value) } else { String::new() },
                check.limit.map_or(String::new(), short),
                if check.unit == "CIEDE2000" { "ΔE00" } else { check.unit }.into(),
                check.about.into(),
            ]);
        }
        let Self { nodes, points, interpolation, seed, .. } = self;
        let tried = format!(
            "{nodes} nodes and {points} colors between them, interpolation {interpolation}, seed {seed}"
        );
        let faults = self.checks.iter().filter(|check| check.verdict == Verdict::Broken);
        let faults: String = faults.map(|check| format!("Broken: {}.\n", broken(check))).collect();
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
    use upglow_fit::Offender;

    use super::*;

    #[test]
    fn a_mean_above_its_limit_is_named_by_its_value() {
        let worst =
            Offender { found: 0.5, wavelength_nm: Some(400.0), node: None, rgb: None, dye: None };
        let mean = Check {
            name: "grid-nodes-mean",
            about: "",
            verdict: Verdict::Broken,
            value: 0.25,
            limit: Some(0.05),
            unit: "CIEDE2000",
            checked: 8,
            violations: 1,
            worst: None,
        };
        assert_eq!(broken(&mean), "grid-nodes-mean: 0.25, expected at most 0.05 CIEDE2000");
        let law = Check { name: "slope", unit: "1/nm", worst: Some(worst), ..mean };
        assert_eq!(broken(&law), "slope: 0.5 at 400 nm, expected at most 0.05 1/nm; 1 violations");
    }

    #[test]
    fn numbers_of_any_size_are_short() {
        let found = [0.0, 0.05, 1.0, 1.25e-9, 31_000.0].map(short);
        assert_eq!(found, ["0", "0.05", "1", "1.25e-9", "3.10e4"]);
    }
}
