//! `upglow bake`: converts pictures to spectral files.

use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::Serialize;
use upglow::Cube;
use upglow_color::{Choice, Grid};
use upglow_fit::KindCounts;
use upglow_image::{
    BakeError, BakeOptions, Baked, Baker, DeclaredAlpha, Form, Incident, Interpretation, Layout,
    Missing, PictureError, StatementError,
};
use upglow_terminal::{Console, Failure, Report};

use super::documents::MapDocuments;
use crate::args::{BakeArgs, BakeForm, BakeFormat, SampleName};
use crate::batch::{Batch, Interpreted};
use crate::output::{Lines, warn, warn_of_ultraviolet};
use crate::pictures::{Depth, Input, Named, Outputs};
use crate::{files, pictures, plan};

use super::{bake_plan, bake_tasks};

#[derive(Debug, Serialize)]
pub(super) struct BakeReport {
    input: String,
    file: String,
    form: &'static str,
    /// The light of the form radiance.
    light: Option<String>,
    /// What the light lacks that the dyes absorb.
    missing_ultraviolet: Option<String>,
    width: usize,
    height: usize,
    channels: usize,
    /// Whether `OpenImageIO` refuses the file for its number of channels.
    beyond_openimageio: bool,
    /// Texels that `--repair` changed.
    repaired: u64,
    /// Texels of a PNG whose colors are outside sRGB, and are shown grayer.
    beyond_screen: Option<u64>,
    /// Texels of each kind of material; `None` with `--fast`, which measures no material.
    kinds: Option<KindCounts>,
    bytes: u64,
    time_s: f64,
    interpretation: Interpretation,
}

pub(crate) fn run(args: &BakeArgs, console: &Console) -> Result<(), Failure> {
    if let Some(tasks) = &args.tasks {
        return bake_tasks::run(args, tasks, console);
    }
    let recipe = Recipe::new(args)?;
    let inputs = pictures::find(&args.inputs, args.picture.depth())?;
    let variants = recipe.variants();
    let outputs = Outputs {
        path: args.output(),
        form: args.form.name(),
        ending: recipe.format.name(),
        variants: &variants,
    };
    let outputs = outputs.of(&inputs.pictures)?;
    refuse_own_folder(args)?;
    if let Some(plan) = &args.plan {
        return bake_plan::run(args, plan, &recipe, &inputs, &outputs, console);
    }
    check_outputs(&inputs.pictures, &outputs)?;
    let documents = args.result.mtlx.then(|| MapDocuments::beside(args.output(), &outputs));
    for path in documents.iter().flat_map(MapDocuments::paths) {
        files::check_output(path)?;
    }
    let cube = files::read_cube(&args.cube)?;
    let whites = whites(args, &recipe.forms, &cube)?;
    if let Some(documents) = &documents {
        // Names that do not fit are told before work starts.
        documents.of(&cube, &inputs.pictures, &outputs, &whites, |_| true)?;
    }
    let work = Work::new(args, &recipe, &cube)?;
    let mut batch = Batch::new("baked", inputs.pictures.len(), &inputs.left_out);
    let ended = inputs.pictures.iter().try_for_each(|input| {
        let (path, outputs) = (input.path(), outputs.files(input)?);
        let is_made = |i: usize| args.update && work.bakers[i].is_made(&path, &outputs[i]);
        work.bake(&path, &outputs, is_made, &mut batch, console)
    });
    if let (Ok(()), Some(documents)) = (&ended, &documents) {
        let made = documents.of(&cube, &inputs.pictures, &outputs, &whites, Path::is_file)?;
        batch.add_documents(documents.write(&made)?);
    }
    batch.finish(console, ended)
}

/// What is written for each picture, and with which options.
#[derive(Debug)]
pub(super) struct Recipe {
    format: BakeFormat,
    /// One form, or one for each light, or for each number of light.
    forms: Vec<Form>,
    options: BakeOptions,
}

impl Recipe {
    pub(super) fn new(args: &BakeArgs) -> Result<Self, Failure> {
        let format = format(args);
        let options = BakeOptions {
            declared: args.picture.declared(),
            repair: args.repair,
            sample: args.result.sample.unwrap_or(SampleName::Half).into(),
            layout: if format == BakeFormat::Tx { Layout::Mipmap } else { Layout::Rows },
        };
        Ok(Self { format, forms: forms(args, format)?, options })
    }

    /// What tells the files of a picture apart in their names, if there are several.
    fn variants(&self) -> Vec<String> {
        let variant = |form: &Form| match form {
            Form::Matrix { incident, .. } => incident.name().to_owned(),
            form => form.light().map_or_else(String::new, |light| in_file_name(light.name())),
        };
        let forms = if self.forms.len() > 1 { &self.forms[..] } else { &[] };
        forms.iter().map(variant).collect()
    }
}

/// All that bakes pictures with a cube.
#[derive(Debug)]
pub(super) struct Work<'a> {
    args: &'a BakeArgs,
    recipe: &'a Recipe,
    /// One for each file of a picture.
    pub(super) bakers: Vec<Baker<'a>>,
    /// What each light lacks that the dyes absorb.
    missing_ultraviolet: Vec<Option<String>>,
}

impl<'a> Work<'a> {
    pub(super) fn new(
        args: &'a BakeArgs,
        recipe: &'a Recipe,
        cube: &'a Cube,
    ) -> Result<Self, Failure> {
        let bakers = Baker::of_forms(cube, &recipe.forms, &recipe.options);
        let bakers = bakers.map_err(|error| refused(error, &args.cube))?;
        let missing = |form: &Form| cube.model().missing_ultraviolet(form.light()?);
        let warned = recipe.forms.iter().map(|form| warn_of_ultraviolet(missing(form)));
        Ok(Self { args, recipe, bakers, missing_ultraviolet: warned.collect() })
    }

    /// Bakes the files of a picture, but for those that are made already; they appear together.
    pub(super) fn bake(
        &self,
        input: &Path,
        outputs: &[PathBuf],
        is_made: impl Fn(usize) -> bool,
        batch: &mut Batch<BakeReport>,
        console: &Console,
    ) -> Result<(), Failure> {
        let Self { args, recipe, .. } = self;
        let (mut files, mut reports) = (Vec::new(), Vec::new());
        for (i, (baker, output)) in self.bakers.iter().zip(outputs).enumerate() {
            if is_made(i) {
                batch.add_unchanged(input);
                continue;
            }
            let start = Instant::now();
            let baked = console.work(args.threads, |bar| baker.bake_aside(input, output, bar))?;
            let (baked, file) = match baked {
                Ok(baked) => baked,
                // Under another light the picture would fail alike.
                Err(error) => return batch.add_failure(input, failure(error, input, output)),
            };
            if baked.is_beyond_openimageio() {
                let (file, most) = (output.display(), Baked::OPENIMAGEIO_CHANNELS);
                let channels = baked.channels;
                warn(format_args!(
                    "{file}: {channels} channels, OpenImageIO reads at most {most}; give wider --bands \
                     or --compact"
                ));
            }
            files.push(file);
            reports.push(BakeReport {
                input: input.display().to_string(),
                file: output.display().to_string(),
                form: args.form.name(),
                light: recipe.forms[i].light().map(|light| light.name().to_owned()),
                missing_ultraviolet: self.missing_ultraviolet[i].clone(),
                width: baked.size[0],
                height: baked.size[1],
                channels: baked.channels,
                beyond_openimageio: baked.is_beyond_openimageio(),
                repaired: baked.repaired,
                beyond_screen: (recipe.format == BakeFormat::Png).then_some(baked.beyond_screen),
                kinds: baked.kinds,
                bytes: baked.bytes,
                time_s: start.elapsed().as_secs_f64(),
                interpretation: baked.interpretation,
            });
        }
        if let Some(first) = outputs.first()
            && let Err(failure) = files::write_together(first, files)
        {
            return batch.add_failure(input, failure);
        }
        reports.into_iter().try_for_each(|report| batch.add(console, report))
    }
}

/// With `--mtlx`, what the perfect diffuser is in the maps of each form.
fn whites(args: &BakeArgs, forms: &[Form], cube: &Cube) -> Result<Vec<[f64; 3]>, Failure> {
    if !args.result.mtlx {
        return Ok(Vec::new());
    }
    let white = |form: &Form| match form.white(cube)? {
        Ok(white) => Some(Ok(white.0)),
        Err(error) => Some(Err(Failure::option("--mtlx", error))),
    };
    forms.iter().filter_map(white).collect()
}

/// The bands that most other programs use.
const DEFAULT_BANDS: [u32; 3] = [380, 780, 10];

/// The format that was given, or that of the output's suffix.
fn format(args: &BakeArgs) -> BakeFormat {
    let suffix = args.output().extension().and_then(|suffix| suffix.to_str()).unwrap_or_default();
    let of_suffix = || BakeFormat::named(&suffix.to_lowercase()).ok();
    if args.result.tx {
        return BakeFormat::Tx;
    }
    let fits = |format: &BakeFormat| {
        !args.output().is_dir() && (*format != BakeFormat::Png || args.form == BakeForm::Radiance)
    };
    args.result.format.or_else(|| of_suffix().filter(fits)).unwrap_or(BakeFormat::Exr)
}

/// What is written for each picture: one form, or one for each light, or for each number of light.
fn forms(args: &BakeArgs, format: BakeFormat) -> Result<Vec<Form>, Failure> {
    use BakeForm::{Material, Radiance, Rgbu, Spectral};
    let result = &args.result;
    let is_png = format == BakeFormat::Png;
    let options: [(&str, bool, &[BakeForm]); 8] = [
        ("--fast", result.fast, &[Material]),
        ("--bands", result.bands.is_some(), &[Spectral]),
        ("--compact", result.compact, &[Spectral]),
        ("--light", !result.lights.is_empty(), &[Radiance]),
        ("--light-ends", result.light.ends.is_some(), &[Radiance]),
        ("--format png", is_png, &[Radiance]),
        ("--mtlx", result.mtlx, &[Spectral, Radiance]),
        ("--engine", result.engine.is_some(), &[Rgbu]),
    ];
    plan::refuse_ignored("--as", args.form, &options)?;
    let options: [(&str, bool, &[BakeFormat]); 4] = [
        ("--bits", result.bits.is_some(), &[BakeFormat::Png]),
        ("--exposure", result.exposure.is_some(), &[BakeFormat::Png]),
        ("--mtlx", result.mtlx, &[BakeFormat::Exr, BakeFormat::Tx]),
        ("--sample", result.sample.is_some(), &[BakeFormat::Exr, BakeFormat::Tx]),
    ];
    plan::refuse_ignored("--format", format, &options)?;
    match args.form {
        Material if result.fast => Ok(vec![Form::InterpolatedMaterial]),
        Material => Ok(vec![Form::Material]),
        Spectral => {
            let [first, last, step] = DEFAULT_BANDS;
            let default = || Grid::try_new(first, last, step).expect("whole steps");
            let grid = result.bands.unwrap_or_else(default);
            Ok(vec![Form::Spectral { grid, compact: result.compact }])
        }
        Radiance if result.lights.is_empty() => {
            let message = "not given, expected a light with --as radiance";
            Err(Failure::option("--light", message))
        }
        Radiance => {
            let lights = plan::lights("--light", &result.lights, &result.light)?;
            let form = |light| match format {
                BakeFormat::Exr | BakeFormat::Tx => Form::Radiance { light },
                BakeFormat::Png => Form::Screen {
                    light,
                    bits: result.bits.unwrap_or_default(),
                    exposure_stops: result.exposure.unwrap_or_default(),
                },
            };
            Ok(lights.into_iter().map(form).collect())
        }
        Rgbu => {
            let form = |&incident| Form::Matrix { engine: result.engine.clone(), incident };
            Ok(Incident::ALL.iter().map(form).collect())
        }
    }
}

/// The name of a light in the name of a file, without separators and signs with a meaning to shells.
fn in_file_name(light: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || "-_".contains(c) { c } else { '_' };
    light.chars().map(plain).collect()
}

/// Refuses to write into a folder of the pictures.
fn refuse_own_folder(args: &BakeArgs) -> Result<(), Failure> {
    let is_source = |folder: &PathBuf| match args.picture.depth() {
        Depth::Folder => files::is_same(folder, args.output()),
        Depth::Subfolders => files::is_inside(args.output(), folder),
    };
    if args.inputs.iter().any(|input| input.is_dir() && is_source(input)) {
        let message = "the folder of the pictures, expected another: the next run would bake the \
                       files that this one writes";
        return Err(Failure::file(args.output(), message));
    }
    Ok(())
}

/// Creates the folders of the outputs, and checks all outputs before the first is baked.
fn check_outputs(inputs: &[Input], outputs: &Named<'_>) -> Result<(), Failure> {
    for input in inputs {
        for output in outputs.files(input)? {
            make_folder_of(&output)?;
            files::check_output(&output)?;
        }
    }
    Ok(())
}

/// Creates the folder of an output.
pub(super) fn make_folder_of(output: &Path) -> Result<(), Failure> {
    let folder = output.parent().filter(|folder| !folder.as_os_str().is_empty());
    folder.map_or(Ok(()), files::make_folder)
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
        BakeError::Write(error) => files::unwritten_exr(output, error),
        BakeError::Texel { .. } | BakeError::Picture(PictureError::AlphaValue { .. }) => {
            Failure::file(input, error).with("; give --repair clip, scale or nearest")
        }
        BakeError::Picture(error) => picture_failure(error, input),
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
        PictureError::Statement(error) => match **error {
            StatementError::Chromaticities { .. } => "; give --space".into(),
            _ => "; give --encoding".into(),
        },
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

impl Interpreted for BakeReport {
    fn interpretation(&self) -> &Interpretation {
        &self.interpretation
    }

    fn picture(&self) -> &str {
        &self.input
    }
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
        if let Some(light) = &self.light {
            lines.add("light", light);
        }
        if let Some(beyond) = self.beyond_screen.filter(|beyond| *beyond > 0) {
            lines.add("beyond sRGB", format_args!("{beyond} texels, shown grayer"));
        }
        if let Some(kinds) = &self.kinds {
            lines.add_kinds(kinds);
        }
        lines.add("time", format_args!("{time_s:.1} s")).add_file("file", &self.file, self.bytes);
        lines.to_string()
    }
}
