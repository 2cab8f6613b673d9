//! `upglow bake`: converts pictures to spectral files.

use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::Serialize;
use upglow_color::{Choice, Grid};
use upglow_fit::KindCounts;
use upglow_image::{
    BakeError, BakeOptions, Baker, DeclaredAlpha, Form, Interpretation, Missing, PictureError,
};
use upglow_terminal::{Console, Failure, Report};

use crate::args::{BakeArgs, BakeForm};
use crate::batch::Batch;
use crate::output::Lines;
use crate::{files, pictures, plan};

#[derive(Debug, Serialize)]
struct BakeReport {
    input: String,
    file: String,
    form: &'static str,
    width: usize,
    height: usize,
    channels: usize,
    /// Texels that `--repair` changed.
    repaired: u64,
    /// Texels of each kind of material; `None` with `--fast`, which measures no material.
    kinds: Option<KindCounts>,
    bytes: u64,
    time_s: f64,
    interpretation: Interpretation,
}

pub(crate) fn run(args: &BakeArgs, console: &Console) -> Result<(), Failure> {
    let form = form(args)?;
    let options = BakeOptions {
        declared: args.picture.declared(),
        repair: args.repair,
        sample: args.result.sample.into(),
    };
    let inputs = pictures::find(&args.inputs)?;
    let outputs = pictures::outputs(&inputs.pictures, &args.output, args.form.name())?;
    check_outputs(args, &inputs.pictures, &outputs)?;
    let cube = files::read_cube(&args.cube)?;
    let baker = Baker::new(&cube, form, options).map_err(|error| refused(error, &args.cube))?;
    let mut batch = Batch::new("baked", &inputs);
    let mut pairs = inputs.pictures.iter().zip(&outputs);
    let ended = pairs.try_for_each(|(input, output)| {
        if args.update && baker.is_made(input, output) {
            batch.add_unchanged(input);
            return Ok(());
        }
        let start = Instant::now();
        match console.work(args.threads, |bar| baker.bake(input, output, bar))? {
            Ok(baked) => batch.add(
                console,
                BakeReport {
                    input: input.display().to_string(),
                    file: output.display().to_string(),
                    form: args.form.name(),
                    width: baked.size[0],
                    height: baked.size[1],
                    channels: baked.channels,
                    repaired: baked.repaired,
                    kinds: baked.kinds,
                    bytes: baked.bytes,
                    time_s: start.elapsed().as_secs_f64(),
                    interpretation: baked.interpretation,
                },
            ),
            Err(error) => batch.add_failure(input, failure(error, input, output)),
        }
    });
    batch.finish(console, ended)
}

/// The bands that most other programs use.
const DEFAULT_BANDS: [u32; 3] = [380, 780, 10];

fn form(args: &BakeArgs) -> Result<Form, Failure> {
    use BakeForm::{Material, Radiance, Spectral};
    let result = &args.result;
    let options: [(&str, bool, &[BakeForm]); 4] = [
        ("--fast", result.fast, &[Material]),
        ("--bands", result.bands.is_some(), &[Spectral]),
        ("--compact", result.compact, &[Spectral]),
        ("--light", result.light.is_some(), &[Radiance]),
    ];
    plan::refuse_ignored("--as", args.form, &options)?;
    Ok(match (args.form, &result.light) {
        (Material, _) if result.fast => Form::InterpolatedMaterial,
        (Material, _) => Form::Material,
        (Spectral, _) => {
            let [first, last, step] = DEFAULT_BANDS;
            let default = || Grid::try_new(first, last, step).expect("whole steps");
            Form::Spectral { grid: result.bands.unwrap_or_else(default), compact: result.compact }
        }
        (Radiance, Some(light)) => Form::Radiance { light: plan::light("--light", light)? },
        (Radiance, None) => {
            let message = "not given, expected a light with --as radiance";
            return Err(Failure::option("--light", message));
        }
    })
}

/// Creates the folders of the outputs, and checks all outputs before the first is baked.
fn check_outputs(args: &BakeArgs, inputs: &[PathBuf], outputs: &[PathBuf]) -> Result<(), Failure> {
    if args.inputs.iter().any(|input| input.is_dir() && files::is_same(input, &args.output)) {
        let message = "the folder of the pictures, expected another: the next run would bake the \
                       files that this one writes";
        return Err(Failure::file(&args.output, message));
    }
    let pictures = files::really(inputs);
    for output in outputs {
        if let Some(folder) = output.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            files::make_folder(folder)?;
        }
        files::check_output_of(output, Some(&args.cube), &pictures)?;
    }
    Ok(())
}

/// Names the option or file that prevents the cube from being baked in this form.
fn refused(error: BakeError, cube: &Path) -> Failure {
    match error {
        BakeError::NoDyes { .. } | BakeError::Compact(_) => Failure::option("--compact", error),
        error => Failure::file(cube, error),
    }
}

fn failure(error: BakeError, input: &Path, output: &Path) -> Failure {
    match error {
        BakeError::Stopped(_) => Failure::Stopped,
        BakeError::Write(error) => Failure::file(output, error),
        BakeError::Picture(error) => picture_failure(error, input),
        BakeError::Texel { .. } => {
            Failure::file(input, error).with("; give --repair clip, scale or nearest")
        }
        error => Failure::file(input, error),
    }
}

/// The fault of a picture, and the option that solves it.
pub(super) fn picture_failure(error: PictureError, input: &Path) -> Failure {
    let remedy = match &error {
        PictureError::Io(error) => return Failure::system(input, error, "a picture"),
        PictureError::Unstated { missing, .. } => {
            let (name, options) = match missing {
                Missing::Space => ("ACEScg", "--space acescg"),
                Missing::Encoding => ("encoded as sRGB", "--encoding srgb"),
                Missing::Both => ("sRGB", "--space srgb --encoding srgb"),
            };
            format!("; if it is {name}, type: {} {options}", typed())
        }
        PictureError::Alpha => "; give --alpha straight, associated or none".into(),
        PictureError::Layers { .. } => "; give --layer NAME".into(),
        PictureError::NoLayers => "; leave --layer out".into(),
        _ => String::new(),
    };
    Failure::file(input, error).with(&remedy)
}

/// The command line of this run, as it can be typed again.
fn typed() -> String {
    let quoted = |word: std::ffi::OsString| {
        let word = word.to_string_lossy().into_owned();
        let is_plain = |c: char| c.is_alphanumeric() || "-_=./:,+%@".contains(c);
        if !word.is_empty() && word.chars().all(is_plain) {
            word
        } else {
            format!("'{}'", word.replace('\'', "'\\''"))
        }
    };
    let words = std::env::args_os().skip(1).map(quoted);
    ["upglow".to_owned()].into_iter().chain(words).collect::<Vec<_>>().join(" ")
}

impl Report for BakeReport {
    fn text(&self) -> String {
        let Self { form, width, height, channels, repaired, time_s, .. } = self;
        let mut lines = Lines::default();
        let Interpretation { space, encoding, alpha } = &self.interpretation;
        lines
            .add("picture", format_args!("{}, {width} × {height}", self.input))
            .add("RGB space", space)
            .add("encoding", encoding);
        if *alpha != DeclaredAlpha::None.name() {
            lines.add("alpha", alpha);
        }
        if *repaired > 0 {
            lines.add("repaired", format_args!("{repaired} texels"));
        }
        lines.add("form", format_args!("{form}, {channels} channels"));
        if let Some(kinds) = &self.kinds {
            lines.add_kinds(kinds);
        }
        lines.add("time", format_args!("{time_s:.1} s")).add_file("file", &self.file, self.bytes);
        lines.to_string()
    }
}
