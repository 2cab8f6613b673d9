//! `upglow bake --plan`: writes what is to be baked as numbered tasks, and bakes nothing.

use std::path::{Component, Path, PathBuf};

use clap::CommandFactory;
use clap::parser::ValueSource;
use rayon::prelude::*;
use serde::Serialize;
use upglow_fit::{Progress, Watch};
use upglow_image::Baker;
use upglow_terminal::{Bar, Console, Failure, Report};

use super::bake::{Recipe, Work, picture_failure};
use crate::args::{Args, BakeArgs};
use crate::farm::{CubeFile, Head, PlanWriter, Task, Template};
use crate::files;
use crate::output::{Lines, failed};
use crate::pictures::{Input, Inputs, Named};

#[derive(Debug, Serialize)]
struct PlanReport {
    /// The plan.
    file: String,
    template: Option<String>,
    tasks: usize,
    /// Files that the tasks will write.
    files: usize,
    /// Texels of all pictures.
    texels: usize,
    bytes: u64,
    /// What the given folders hold beside pictures.
    left_out: Vec<String>,
}

/// Pictures that are read before their tasks are written: enough for all cores.
const READ_TOGETHER: usize = 4096;

pub(super) fn run(
    args: &BakeArgs,
    path: &Path,
    recipe: &Recipe,
    inputs: &Inputs,
    outputs: &Named<'_>,
    console: &Console,
) -> Result<(), Failure> {
    let template = Template::named(path);
    let plan = template.as_ref().map_or(path, |template| &template.plan);
    for output in [Some(plan), template.as_ref().map(|_| path)].into_iter().flatten() {
        files::check_output(output)?;
    }
    if template.is_none() {
        files::check_ending(path, &["json"])?;
    }
    let cube = files::read_cube(&args.cube)?;
    let work = Work::new(args, recipe, &cube)?;
    let head = Head::new(
        unicode(&folder_from(plan)?)?,
        CubeFile { file: unicode(&args.cube)?, sha256: files::hash(&args.cube)? },
        options(),
        work.bakers.iter().map(Baker::hash).cloned().collect(),
        inputs.pictures.len(),
    );
    let planner = Planner { baker: &work.bakers[0], outputs };
    let writer = PlanWriter::create(plan, &head)?;
    let written = console.work(args.threads, |bar| planner.write(writer, &inputs.pictures, bar))?;
    let (texels, bytes) = written?;
    let count = inputs.pictures.len();
    if let Some(template) = &template {
        files::write(path, template.text(count, texels).as_bytes())?;
    }
    console.print(&PlanReport {
        file: plan.display().to_string(),
        template: template.map(|template| template.path.display().to_string()),
        tasks: count,
        files: count * work.bakers.len(),
        texels,
        bytes,
        left_out: inputs.left_out.iter().map(|path| path.display().to_string()).collect(),
    })
}

/// What makes tasks of pictures.
struct Planner<'a> {
    baker: &'a Baker<'a>,
    outputs: &'a Named<'a>,
}

impl Planner<'_> {
    /// Writes the tasks of all pictures, unless one cannot be read; each of those is named. Returns the number of
    /// texels and of bytes of the plan.
    fn write(
        &self,
        mut writer: PlanWriter,
        inputs: &[Input],
        bar: &Bar,
    ) -> Result<(usize, u64), Failure> {
        let (mut texels, mut bad) = (0, Vec::new());
        for (i, inputs_together) in inputs.chunks(READ_TOGETHER).enumerate() {
            let first = i * READ_TOGETHER;
            if bar.stopped() {
                return Err(Failure::Stopped);
            }
            let numbered = inputs_together.par_iter().enumerate();
            let tasks: Vec<Result<Task, Failure>> =
                numbered.map(|(j, input)| self.task(first + j + 1, input)).collect();
            for task in tasks {
                match task {
                    Ok(task) => {
                        texels += task.texels;
                        writer.add(&task)?;
                    }
                    Err(failure) => bad.push(failure),
                }
            }
            let done = first + inputs_together.len();
            bar.progress(Progress { stage: "planning", done, total: inputs.len() });
        }
        match &bad[..] {
            [] => Ok((texels, writer.finish()?)),
            [_] => Err(bad.remove(0)),
            bad => {
                bad.iter().for_each(|failure| failed(&failure.to_string()));
                let message =
                    "pictures cannot be baked, named above, expected none; no plan was written";
                Err(Failure::Input(format!("{} of {} {message}", bad.len(), inputs.len())))
            }
        }
    }

    fn task(&self, number: usize, input: &Input) -> Result<Task, Failure> {
        let path = input.path();
        let [width, height] =
            self.baker.size(&path).map_err(|error| picture_failure(error, &path))?;
        let outputs = self.outputs.files(input)?;
        for output in &outputs {
            files::check_is_free(output)?;
        }
        Ok(Task {
            task: number,
            sha256: files::hash(&path)?,
            picture: unicode(&path)?,
            texels: width * height,
            files: outputs.iter().map(|output| unicode(output)).collect::<Result<_, _>>()?,
        })
    }
}

/// A path as text, which plans are.
fn unicode(path: &Path) -> Result<String, Failure> {
    let text = path.to_str().map(str::to_owned);
    text.ok_or_else(|| Failure::file(path, "not Unicode, expected a name that a plan can hold"))
}

/// The present folder, from that of a file.
fn folder_from(file: &Path) -> Result<PathBuf, Failure> {
    let real = |path: &Path| {
        path.canonicalize().map_err(|error| Failure::system(path, &error, "an existing folder"))
    };
    let here = Path::new(".");
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(here);
    let (from, to) = (real(folder)?, real(here)?);
    let shared = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    let up = from.components().skip(shared).map(|_| Component::ParentDir);
    let path: PathBuf = up.chain(to.components().skip(shared)).collect();
    Ok(if path.as_os_str().is_empty() { here.to_owned() } else { path })
}

/// The options that say what is baked, as they were typed.
pub(super) fn options() -> Vec<String> {
    /// Those that say what this run does.
    const OF_RUNS: [&str; 3] = ["plan", "tasks", "threads"];
    let command = Args::command();
    let all = command.clone().get_matches();
    let Some((name, typed)) = all.subcommand() else { return Vec::new() };
    let mut words = Vec::new();
    for arg in command.find_subcommand(name).into_iter().flat_map(clap::Command::get_arguments) {
        let id = arg.get_id().as_str();
        let is_typed = typed.value_source(id) == Some(ValueSource::CommandLine);
        let Some(long) = arg.get_long().filter(|_| is_typed && !OF_RUNS.contains(&id)) else {
            continue;
        };
        if arg.get_action().takes_values() {
            let values = typed.get_raw(id).into_iter().flatten();
            words.extend(values.map(|value| format!("--{long}={}", value.to_string_lossy())));
        } else {
            words.push(format!("--{long}"));
        }
    }
    words
}

impl Report for PlanReport {
    fn text(&self) -> String {
        let mut lines = Lines::default();
        lines
            .add("tasks", self.tasks)
            .add("files", self.files)
            .add("texels", self.texels)
            .add_file("plan", &self.file, self.bytes);
        if let Some(template) = &self.template {
            lines.add("template", template);
        }
        if !self.left_out.is_empty() {
            lines.add("left out", format_args!("{} that are no pictures", self.left_out.len()));
        }
        lines.to_string()
    }
}
