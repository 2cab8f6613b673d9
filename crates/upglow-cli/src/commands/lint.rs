//! `upglow lint`: checks whether files are well-formed spectral EXR.

use std::path::Path;

use serde::Serialize;
use upglow_image::{ExrReader, Form, Lint};
use upglow_terminal::{Console, Failure, Report};

use super::bake_tasks;
use crate::args::{BakeForm, LintArgs};
use crate::farm::TaskNumbers;
use crate::output::{Lines, failed};
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
    if let Some(tasks) = &args.tasks {
        return of_tasks(args, tasks, console);
    }
    let mut broken = Vec::new();
    for path in &args.files {
        pictures::check_there(path, "an OpenEXR file")?;
        let report = report(path, args.names_only)?;
        if !report.well_formed {
            broken.push(path);
        }
        console.print(&report)?;
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

fn report(path: &Path, names_only: bool) -> Result<LintReport, Failure> {
    let lint = if names_only { Lint::of_header(path) } else { Lint::of_file(path) };
    let lint = lint.map_err(|error| Failure::file(path, error))?;
    let reader = ExrReader::open(path).ok();
    Ok(LintReport {
        file: path.display().to_string(),
        baked_as: reader.and_then(|r| Form::stated(&r).map(str::to_owned)),
        well_formed: lint.is_well_formed(),
        lint,
    })
}

/// What is found of the files of tasks.
#[derive(Debug, Serialize)]
struct TasksReport {
    files: usize,
    /// Those that are there and made from what the plan says.
    made: usize,
    /// Those that are well-formed spectral files, if the plan is to bake such.
    well_formed: Option<usize>,
}

/// Checks the files of tasks, and names each with a fault.
fn of_tasks(args: &LintArgs, tasks: &TaskNumbers, console: &Console) -> Result<(), Failure> {
    let [path] = &args.files[..] else {
        let message = format!("given with {} files, expected one plan", args.files.len());
        return Err(Failure::option("--task", message));
    };
    let mut plan = bake_tasks::open(path, tasks)?;
    let is_spectral = bake_tasks::bake_args(&plan)?.form == BakeForm::Spectral;
    let mut found = TasksReport { files: 0, made: 0, well_formed: is_spectral.then_some(0) };
    let mut faults = 0;
    for number in tasks.iter() {
        let task = plan.task(number)?;
        for (i, file) in task.files.iter().enumerate() {
            found.files += 1;
            let file = Path::new(file);
            let is_made = bake_tasks::is_made(&plan, &task, i);
            found.made += usize::from(is_made);
            let fault = if !is_made {
                let is = if file.exists() { "made from something else" } else { "not there" };
                let expected = format!("expected what task {number} of the plan makes; run it");
                Some(Failure::file(file, format!("{is}, {expected}")))
            } else if let Some(well_formed) = &mut found.well_formed {
                let report = report(file, args.names_only)?;
                *well_formed += usize::from(report.well_formed);
                let expected = "not well-formed, expected a well-formed spectral EXR";
                (!report.well_formed).then(|| Failure::file(file, expected))
            } else {
                None
            };
            if let Some(fault) = fault {
                failed(&fault.to_string());
                faults += 1;
            }
        }
    }
    console.print(&found)?;
    match faults {
        0 => Ok(()),
        faults => {
            let message = format!("{faults} of {} files, named above, expected none", found.files);
            Err(Failure::Input(format!("faults in {message}")))
        }
    }
}

impl Report for TasksReport {
    fn text(&self) -> String {
        let mut lines = Lines::default();
        lines.add("files", self.files).add("as planned", self.made);
        if let Some(well_formed) = self.well_formed {
            lines.add("well-formed", well_formed);
        }
        lines.to_string()
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
