//! `upglow bake`: pictures become spectral files.

use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::Serialize;
use upglow_color::{Grid, Illuminant};
use upglow_image::{
    BakeError, BakeOptions, Baked, Baker, Form, LinearPictureError, MaterialWay, Repair, Sample,
};
use upglow_terminal::{Bar, Failure, on_threads};

use crate::args::{BakeArgs, BakeForm, SampleName};
use crate::output::{Format, Lines, Report};
use crate::{files, pictures, plan};

#[derive(Clone, Debug, Serialize)]
struct BakeReport {
    input: String,
    file: String,
    form: &'static str,
    width: usize,
    height: usize,
    channels: usize,
    /// Texels that `--repair` changed.
    repaired: u64,
    bytes: u64,
    time_s: f64,
}

pub(crate) fn run(args: &BakeArgs, format: Format, quiet: bool) -> Result<(), Failure> {
    let form = form(args)?;
    let options = BakeOptions {
        assumed: pictures::assumed(&args.picture)?,
        repair: repair(args)?,
        sample: match args.sample {
            SampleName::Half => Sample::Half,
            SampleName::Float => Sample::Float,
        },
    };
    let inputs = pictures::find(&args.inputs)?;
    let outputs = pictures::outputs(&inputs, &args.output, args.form.name())?;
    check_outputs(args, &inputs, &outputs)?;
    let cube = files::read_cube(&args.cube)?;
    let bar = Bar::start(quiet);
    let baker = Baker::new(&cube, form, options).map_err(|error| refused(error, &args.cube))?;
    for (number, (input, output)) in inputs.iter().zip(&outputs).enumerate() {
        let start = Instant::now();
        let baked = on_threads(args.threads, || baker.bake(input, output, &bar))?;
        bar.finish();
        let baked = baked.map_err(|error| failure(error, input, output))?;
        let time_s = start.elapsed().as_secs_f64();
        format.separate(number)?;
        format.print(&BakeReport::new(input, output, args.form, &baked, time_s))?;
    }
    Ok(())
}

/// No option is ignored: one that the form does not have is an error.
fn form(args: &BakeArgs) -> Result<Form, Failure> {
    use BakeForm::{Material, Radiance, Spectral};
    let options: [(&'static str, bool, BakeForm); 4] = [
        ("--fast", args.fast, Material),
        ("--bands", args.bands.is_some(), Spectral),
        ("--compact", args.compact, Spectral),
        ("--light", args.light.is_some(), Radiance),
    ];
    if let Some((option, _, form)) =
        options.into_iter().find(|(_, given, form)| *given && *form != args.form)
    {
        let (found, expected) = (args.form.name(), form.name());
        return Err(Failure::option(
            option,
            format_args!("given with --as {found}, expected --as {expected}"),
        ));
    }
    Ok(match args.form {
        Material if args.fast => Form::Material(MaterialWay::Interpolated),
        Material => Form::Material(MaterialWay::Polished),
        Spectral => Form::Spectral { grid: bands(args)?, compact: args.compact },
        Radiance => Form::Radiance { light: light(args)? },
    })
}

/// Bands that programs of others use most: 380, 390 … 780 nm.
const DEFAULT_BANDS: &str = "380:780:10";

fn bands(args: &BakeArgs) -> Result<Grid, Failure> {
    let text = args.bands.as_deref().unwrap_or(DEFAULT_BANDS);
    let refused = |what: &dyn std::fmt::Display| Failure::option("--bands", what);
    let numbers: Option<Vec<u32>> = text.split(':').map(|cell| cell.trim().parse().ok()).collect();
    let Some(&[first, last, step]) = numbers.as_deref() else {
        let expected = "expected FIRST:LAST:STEP in whole nm, such as 380:780:10";
        return Err(refused(&format_args!("{text:?}, {expected}")));
    };
    let [low, high] = [Grid::FINE.first_nm(), Grid::FINE.last_nm()];
    if first < low || last > high {
        return Err(refused(&format_args!("{text}, expected bands within {low} to {high} nm")));
    }
    Grid::try_new(first, last, step).map_err(|error| refused(&error))
}

fn light(args: &BakeArgs) -> Result<Illuminant, Failure> {
    let Some(text) = &args.light else {
        return Err(Failure::option("--light", "not given, expected one with --as radiance"));
    };
    plan::light("--light", text)
}

fn repair(args: &BakeArgs) -> Result<Option<Repair>, Failure> {
    let repair = args.repair.as_deref().map(str::parse::<Repair>).transpose();
    repair.map_err(|error| Failure::option("--repair", error))
}

/// Makes the folders of the outputs, and checks all of them before the first is baked.
fn check_outputs(args: &BakeArgs, inputs: &[PathBuf], outputs: &[PathBuf]) -> Result<(), Failure> {
    if args.inputs.iter().any(|input| input.is_dir() && files::is_same(input, &args.output)) {
        let message = "the folder of the pictures, expected another: the next run would bake what \
                       this one makes";
        return Err(Failure::file(&args.output, message));
    }
    for output in outputs {
        if let Some(input) = inputs.iter().find(|input| files::is_same(input, output)) {
            let input = input.display();
            let message = format_args!("the picture {input} itself, expected another file");
            return Err(Failure::file(output, message));
        }
        files::check_distinct(&args.cube, output)?;
        if let Some(folder) = output.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            files::make_folder(folder)?;
        }
        files::check_output(output)?;
    }
    Ok(())
}

/// Why the cube has no such form.
fn refused(error: BakeError, cube: &Path) -> Failure {
    match error {
        BakeError::NoDyes { .. } | BakeError::Compact(_) => Failure::option("--compact", error),
        error => Failure::file(cube, error),
    }
}

fn failure(error: BakeError, input: &Path, output: &Path) -> Failure {
    match error {
        BakeError::Stopped => Failure::Stopped,
        BakeError::Write(error) => Failure::file(output, error),
        BakeError::Picture(error) => picture_failure(&error, input),
        BakeError::Texel { .. } => {
            Failure::file(input, format_args!("{error}; give --repair clip, scale or nearest"))
        }
        error => Failure::file(input, error),
    }
}

/// What is wrong with a picture, with the option that mends it.
pub(super) fn picture_failure(error: &LinearPictureError, input: &Path) -> Failure {
    let option = match error {
        LinearPictureError::Space => "; give --space",
        LinearPictureError::Encoding => "; give --encoding",
        _ => "",
    };
    Failure::file(input, format_args!("{error}{option}"))
}

impl BakeReport {
    fn new(input: &Path, output: &Path, form: BakeForm, baked: &Baked, time_s: f64) -> Self {
        Self {
            input: input.display().to_string(),
            file: output.display().to_string(),
            form: form.name(),
            width: baked.size[0],
            height: baked.size[1],
            channels: baked.channels,
            repaired: baked.repaired,
            bytes: baked.bytes,
            time_s,
        }
    }
}

impl Report for BakeReport {
    fn text(&self) -> String {
        let Self { file, form, width, height, channels, repaired, time_s, .. } = self;
        let mut lines = Lines::default();
        lines.add("picture", format_args!("{}, {width} × {height}", self.input));
        if *repaired > 0 {
            lines.add("repaired", format_args!("{repaired} texels"));
        }
        lines
            .add("form", format_args!("{form}, {channels} channels"))
            .add("time", format_args!("{time_s:.1} s"))
            .add("file", format_args!("{file}, {}", files::size(self.bytes)));
        lines.to_string()
    }
}
