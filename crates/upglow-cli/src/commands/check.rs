//! `upglow check`: which texels of pictures a material can match, and what a cube makes of them.

use std::path::{Path, PathBuf};

use serde::Serialize;
use upglow::Cube;
use upglow_color::Contract;
use upglow_image::{
    Change, CheckError, CheckReport, Checker, CubeMatch, DyeUse, Flaw, FlawedTexel, Interpretation,
    MissedTexel, UsedDye, WorstTexel,
};
use upglow_terminal::{Console, Failure, Report};

use super::bake::picture_failure;
use super::bake_tasks;
use crate::args::CheckArgs;
use crate::batch::{Batch, Interpreted};
use crate::farm::TaskNumbers;
use crate::output::{Lines, warn_of_ultraviolet};
use crate::pictures::Input;
use crate::{files, pictures, plan};

#[derive(Debug, Serialize)]
struct PictureReport {
    headline: String,
    #[serde(flatten)]
    found: CheckReport,
    heat_map: Option<String>,
    /// The report on all pictures.
    page: Option<String>,
    /// What the light lacks that dyes absorb.
    missing_ultraviolet: Option<String>,
}

pub(crate) fn run(args: &CheckArgs, console: &Console) -> Result<(), Failure> {
    match &args.tasks {
        Some(tasks) => check(&of_tasks(args, tasks)?, console),
        None => check(args, console),
    }
}

/// A check of the pictures of tasks with the cube and the options of their plan.
fn of_tasks(args: &CheckArgs, tasks: &TaskNumbers) -> Result<CheckArgs, Failure> {
    let [plan] = &args.inputs[..] else {
        let message = format!("given with {} files, expected one plan", args.inputs.len());
        return Err(Failure::option("--task", message));
    };
    // The plan's names are valid in another folder.
    let absolute = |path: &Option<PathBuf>| {
        let absolute = |path| {
            let made = std::path::absolute(path);
            made.map_err(|error| Failure::system(path, &error, "a file to write"))
        };
        path.as_deref().map(absolute).transpose()
    };
    let (output, heat_map) = (absolute(&args.output)?, absolute(&args.heat_map)?);
    let mut plan = bake_tasks::open(plan, tasks)?;
    let planned = bake_tasks::bake_args(&plan)?;
    let pictures = tasks.iter().map(|number| Ok(plan.task(number)?.picture.into()));
    Ok(CheckArgs {
        inputs: pictures.collect::<Result<_, Failure>>()?,
        output,
        heat_map,
        cube: Some(planned.cube),
        picture: planned.picture,
        ..args.clone()
    })
}

fn check(args: &CheckArgs, console: &Console) -> Result<(), Failure> {
    let inputs = pictures::find(&args.inputs, args.picture.depth())?;
    check_outputs(args, &inputs.pictures)?;
    let cube = args.cube.as_deref().map(files::read_cube).transpose()?;
    let contract = contract(args, cube.as_ref())?;
    let light = &contract.illuminant;
    let missing = match &cube {
        Some(cube) => cube.model().missing_ultraviolet(light),
        None => light.missing_ultraviolet(),
    };
    let missing_ultraviolet = warn_of_ultraviolet(missing);
    let mut checker = Checker::new(contract, args.picture.declared());
    if let (Some(cube), Some(path)) = (&cube, &args.cube) {
        let checked = checker.with_cube(cube, path.display().to_string());
        checker = checked.map_err(|error| Failure::option("--cube", error))?;
    }
    let mut batch = Batch::new("checked", inputs.pictures.len(), &inputs.left_out);
    let mut found = Vec::new();
    let ended = inputs.pictures.iter().try_for_each(|input| {
        let input = input.path();
        match console.work(args.threads, |bar| checker.check(&input, bar))? {
            Ok(report) => found.push(report),
            Err(error) => batch.add_failure(&input, failure(error, &input))?,
        }
        Ok(())
    });
    let ended = ended.and_then(|()| {
        if let Some(output) = args.output.as_ref().filter(|_| !found.is_empty()) {
            files::write(output, CheckReport::page(&found).as_bytes())?;
        }
        if let (Some(path), [report]) = (&args.heat_map, &found[..]) {
            files::write(path, &report.heat_map_png())?;
        }
        let shown = |path: &Option<PathBuf>| path.as_ref().map(|path| path.display().to_string());
        found.into_iter().try_for_each(|found| {
            let (heat_map, page) = (shown(&args.heat_map), shown(&args.output));
            let (headline, missing_ultraviolet) = (found.headline(), missing_ultraviolet.clone());
            let report = PictureReport { headline, found, heat_map, page, missing_ultraviolet };
            batch.add(console, report)
        })
    });
    batch.finish(console, ended)
}

fn failure(error: CheckError, input: &Path) -> Failure {
    match error {
        CheckError::Stopped(_) => Failure::Stopped,
        CheckError::Picture(error) => picture_failure(error, input),
        error => Failure::file(input, error),
    }
}

fn check_outputs(args: &CheckArgs, inputs: &[Input]) -> Result<(), Failure> {
    if args.heat_map.is_some() && inputs.len() != 1 {
        let message = format!(
            "given with {} pictures, expected one; --output has all heat maps",
            inputs.len()
        );
        return Err(Failure::option("--heat-map", message));
    }
    let page = args.output.iter().map(|path| (path, files::PAGE));
    let mut outputs = page.chain(args.heat_map.iter().map(|path| (path, files::PNG)));
    outputs.try_for_each(|(path, endings)| {
        files::check_output(path)?;
        files::check_ending(path, endings)
    })
}

/// The light and adaptation of the options or the cube. The RGB space is that of each picture.
fn contract(args: &CheckArgs, cube: Option<&Cube>) -> Result<Contract, Failure> {
    let mut contract = cube.map(|cube| cube.contract().clone()).unwrap_or_default();
    let given: Vec<&str> = args.illuminant.as_deref().into_iter().collect();
    if let Some(light) = plan::lights("--illuminant", &given, &args.light)?.pop() {
        contract.illuminant = light;
    }
    if let Some(adaptation) = args.adapt {
        contract.adaptation = adaptation;
    }
    plan::checked(contract)
}

/// Red, green and blue with four decimals, the precision of half floats.
fn rgb_text([r, g, b]: [f32; 3]) -> String {
    format!("{r:.4}, {g:.4}, {b:.4}")
}

impl Interpreted for PictureReport {
    fn interpretation(&self) -> &Interpretation {
        &self.found.interpretation
    }

    fn picture(&self) -> &str {
        &self.found.file
    }
}

fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

/// Adds what a cube makes of a picture.
fn add_cube(lines: &mut Lines, cube: &CubeMatch) {
    let CubeMatch { file, mean_de2000, greatest_de2000, dye, .. } = cube;
    lines.add(
        "with the cube",
        format_args!(
            "{file}: {} within 1 ΔE00, {} within 2; mean {mean_de2000:.2}, greatest \
             {greatest_de2000:.2}",
            percent(cube.within_one),
            percent(cube.within_two),
        ),
    );
    lines.add_kinds(&cube.kinds);
    for (i, texel) in cube.worst.iter().enumerate() {
        let MissedTexel { x, y, rgb, de2000, cause, .. } = texel;
        let name = if i == 0 { "furthest off" } else { "" };
        let rgb = rgb_text(*rgb);
        lines.add(name, format_args!("{x},{y} ({rgb}): ΔE00 {de2000:.2}; {cause}"));
    }
    let DyeUse { unit, share, mean_dose, greatest_dose, dyes } = dye;
    if *share > 0.0 {
        lines.add(
            "dye",
            format_args!(
                "{} of texels; {unit} {mean_dose:.3} on average, {greatest_dose:.3} at most",
                percent(*share)
            ),
        );
    }
    for UsedDye { name, share, mean, greatest } in dyes {
        let share = percent(*share);
        lines.add("", format_args!("{share} {name}: {mean:.3} on average, {greatest:.3} at most"));
    }
    for (i, change) in cube.changes.iter().enumerate().skip(1) {
        let Change { name, options, within_one, with_dye, .. } = change;
        let options = if options.is_empty() { String::new() } else { format!(" ({options})") };
        lines.add(
            if i == 1 { "instead" } else { "" },
            format_args!(
                "{name}{options}: about {:.1} % within 1 ΔE00, {:.1} % with dye",
                100.0 * within_one,
                100.0 * with_dye
            ),
        );
    }
}

impl Report for PictureReport {
    fn text(&self) -> String {
        let CheckReport { file, width, height, interpretation, .. } = &self.found;
        let CheckReport { rgb_space, illuminant, counts, .. } = &self.found;
        let share = |texels| percent(counts.share(texels));
        let mut lines = Lines::default();
        lines
            .add("result", &self.headline)
            .add("advice", self.found.advice())
            .add("picture", format_args!("{file}, {width} × {height}"))
            .add("RGB space", &interpretation.space)
            .add("encoding", &interpretation.encoding)
            .add("checked in", format_args!("{rgb_space} under {illuminant}"))
            .add("reflectance matches", share(counts.reflectance))
            .add("fluorescence needed", share(counts.needs_fluorescence))
            .add("no material matches", share(counts.unreachable));
        let flaws = Flaw::ALL.map(|flaw| (flaw.to_string(), counts.of(flaw)));
        let counts = [("not a color".into(), counts.no_color)].into_iter().chain(flaws);
        for (name, count) in counts.filter(|(_, count)| *count > 0) {
            lines.add(name, format_args!("{count} texels"));
        }
        for (i, FlawedTexel { flaw, x, y, rgb }) in self.found.flaws.iter().enumerate() {
            let name = if i == 0 { "at" } else { "" };
            lines.add(name, format_args!("{x},{y} ({}): {flaw}", rgb_text(*rgb)));
        }
        for (i, worst) in self.found.worst.iter().enumerate() {
            let name = if i == 0 { "worst" } else { "" };
            let WorstTexel { x, y, rgb, standing, .. } = worst;
            let (rgb, needs) = (rgb_text(*rgb), worst.needs());
            let [passive, any] = [standing.reflectance.de2000, standing.fluorescence.de2000];
            lines.add(
                name,
                format_args!(
                    "{x},{y} ({rgb}): {needs}; ΔE00 {passive:.1} to the nearest reflectance, \
                     {any:.1} to the nearest of all materials"
                ),
            );
        }
        if let Some(cube) = &self.found.cube {
            add_cube(&mut lines, cube);
        }
        for (name, path) in [("heat map", &self.heat_map), ("page", &self.page)] {
            if let Some(path) = path {
                lines.add(name, path);
            }
        }
        lines.to_string()
    }
}
