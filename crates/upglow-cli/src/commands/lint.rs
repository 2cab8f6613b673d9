//! `upglow lint`: checks whether files are well-formed spectral EXR.

use serde::Serialize;
use upglow_image::{ExrReader, Form, Lint};
use upglow_terminal::{Console, Failure, Report};

use crate::args::LintArgs;
use crate::output::Lines;
use crate::pictures;

#[derive(Debug, Serialize)]
struct LintReport {
    file: String,
    /// The form as which `upglow bake` wrote it, if it did.
    baked_as: Option<String>,
    well_formed: bool,
    #[serde(flatten)]
    lint: Lint,
}

pub(crate) fn run(args: &LintArgs, console: &Console) -> Result<(), Failure> {
    let mut broken = Vec::new();
    for path in &args.files {
        pictures::check_there(path, "an OpenEXR file")?;
        let lint = if args.names_only { Lint::of_header(path) } else { Lint::of_file(path) };
        let lint = lint.map_err(|error| Failure::file(path, error))?;
        if !lint.is_well_formed() {
            broken.push(path);
        }
        let reader = ExrReader::open(path).ok();
        console.print(&LintReport {
            file: path.display().to_string(),
            baked_as: reader.and_then(|r| Form::stated(&r).map(str::to_owned)),
            well_formed: lint.is_well_formed(),
            lint,
        })?;
    }
    match broken[..] {
        [] => Ok(()),
        [one] => Err(Failure::file(one, "not well-formed, expected a well-formed spectral EXR")),
        [first, ref others @ ..] => {
            let others = others.len();
            let message =
                format!("not well-formed, like {others} others, expected well-formed spectral EXR");
            Err(Failure::file(first, message))
        }
    }
}

impl Report for LintReport {
    fn text(&self) -> String {
        let Lint { findings, reflectance, radiance, polarization, reradiation, is_compact } =
            &self.lint;
        let kinds = [
            (reflectance, "reflectance"),
            (radiance, "radiance"),
            (polarization, "polarization"),
            (reradiation, "re-radiation"),
        ];
        let kinds = kinds.iter().filter(|(count, _)| **count > 0);
        let mut kinds: Vec<String> = kinds.map(|(count, kind)| format!("{count} {kind}")).collect();
        if *is_compact {
            kinds.push("compact dyes".into());
        }
        let kinds = if kinds.is_empty() { "none".to_owned() } else { kinds.join(", ") };
        let mut lines = Lines::default();
        lines.add("file", &self.file);
        if let Some(form) = self.baked_as.as_deref().filter(|form| *form != "spectral") {
            lines.add("baked as", format_args!("{form}, which is not a spectral picture"));
        }
        lines.add("channels", kinds);
        for finding in findings {
            let expected = &finding.expected;
            lines.add(finding.severity, format_args!("{}, expected {expected}", finding.found));
        }
        lines.add("well-formed", if self.well_formed { "yes" } else { "no" });
        lines.to_string()
    }
}
