//! `upglow lint`: whether files are well-formed spectral EXR.

use std::path::Path;

use serde::Serialize;
use upglow_image::{Depth, ExrReader, Lint, Severity, baked_form, lint};
use upglow_terminal::Failure;

use crate::args::LintArgs;
use crate::output::{Format, Lines, Report};
use crate::pictures;

#[derive(Clone, Debug, Serialize)]
struct LintReport {
    file: String,
    /// What `upglow bake` made it as, if it did.
    baked_as: Option<String>,
    well_formed: bool,
    reflectance_channels: usize,
    radiance_channels: usize,
    polarization_channels: usize,
    reradiation_channels: usize,
    compact: bool,
    findings: Vec<FindingReport>,
}

#[derive(Clone, Debug, Serialize)]
struct FindingReport {
    severity: &'static str,
    found: String,
    expected: String,
}

pub(crate) fn run(args: &LintArgs, format: Format) -> Result<(), Failure> {
    let depth = if args.names_only { Depth::Header } else { Depth::Pixels };
    let mut broken = Vec::new();
    for (number, path) in args.files.iter().enumerate() {
        pictures::check_there(path, "an OpenEXR file")?;
        let found = lint(path, depth).map_err(|error| Failure::file(path, error))?;
        format.separate(number)?;
        format.print(&LintReport::new(path, &found))?;
        if !found.is_well_formed() {
            broken.push(path);
        }
    }
    match broken[..] {
        [] => Ok(()),
        [one] => Err(Failure::file(one, "broken, expected a well-formed spectral EXR")),
        [first, ..] => Err(Failure::file(
            first,
            format_args!(
                "broken, like {} others, expected well-formed spectral EXR",
                broken.len() - 1
            ),
        )),
    }
}

impl LintReport {
    fn new(path: &Path, lint: &Lint) -> Self {
        let reader = ExrReader::open(path).ok();
        let findings = lint.findings.iter().map(|finding| FindingReport {
            severity: match finding.severity {
                Severity::Warning => "warning",
                Severity::Error => "error",
            },
            found: finding.found.clone(),
            expected: finding.expected.clone(),
        });
        Self {
            file: path.display().to_string(),
            baked_as: reader.and_then(|r| baked_form(r.attributes()).map(str::to_owned)),
            well_formed: lint.is_well_formed(),
            reflectance_channels: lint.reflectance,
            radiance_channels: lint.radiance,
            polarization_channels: lint.polarization,
            reradiation_channels: lint.reradiation,
            compact: lint.is_compact,
            findings: findings.collect(),
        }
    }
}

impl Report for LintReport {
    fn text(&self) -> String {
        let kinds = [
            (self.reflectance_channels, "reflectance"),
            (self.radiance_channels, "radiance"),
            (self.polarization_channels, "polarization"),
            (self.reradiation_channels, "re-radiation"),
        ];
        let kinds = kinds.iter().filter(|(count, _)| *count > 0);
        let mut kinds: Vec<String> = kinds.map(|(count, kind)| format!("{count} {kind}")).collect();
        if self.compact {
            kinds.push("compact dyes".into());
        }
        let kinds = if kinds.is_empty() { "none".to_owned() } else { kinds.join(", ") };
        let mut lines = Lines::default();
        lines.add("file", &self.file);
        match self.baked_as.as_deref() {
            Some("spectral") | None => {}
            Some(form) => {
                lines.add("baked as", format_args!("{form}, which is no spectral picture"));
            }
        }
        lines.add("channels", kinds);
        for FindingReport { severity, found, expected } in &self.findings {
            lines.add(severity, format_args!("{found}, expected {expected}"));
        }
        lines.add("well-formed", if self.well_formed { "yes" } else { "no" });
        lines.to_string()
    }
}
