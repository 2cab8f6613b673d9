//! The options of the commands for pictures.

use std::path::{Path, PathBuf};

use upglow_color::{Adaptation, Grid, RgbSpace, choices};
use upglow_image::{Declared, DeclaredAlpha, Encoding, FORMATS, PngBits, Repair, Sample};
use upglow_terminal::{Threads, word};

use super::values::{PictureSpace, bands, lights, picture_space, position, rgb_space, stops};
use super::{LightArgs, NamedCube};
use crate::farm::TaskNumbers;
use crate::pictures::Depth;

/// How to interpret pictures.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Pictures")]
pub(crate) struct PictureArgs {
    /// RGB space of the pictures, whatever their files state: acescg, aces2065-1, rec2020, p3-d65, srgb,
    /// prophoto, adobe-rgb, xyz, an ID of the Color Interop Forum such as `g22_ap1_scene`, which
    /// states the encoding too, or eight chromaticities Rx,Ry,Gx,Gy,Bx,By,Wx,Wy
    /// [default: what each file states]
    #[arg(long, value_parser = picture_space)]
    space: Option<PictureSpace>,
    /// Transfer curve of the pictures, whatever their files state: linear, srgb, bt709, or a gamma from
    /// 0.1 to 10 such as 2.2 [default: what each file states]
    #[arg(long, value_name = "NAME|GAMMA")]
    encoding: Option<Encoding>,
    /// Whether the colors of the pictures are multiplied by their alpha: straight, associated, or none
    /// if alpha has no meaning [default: what each file states]
    #[arg(long, value_name = "NAME", value_parser = word::<DeclaredAlpha>())]
    alpha: Option<DeclaredAlpha>,
    /// Layer of OpenEXR files with several: the text before .R in its channels, or the name of its part
    #[arg(long, value_name = "NAME")]
    layer: Option<String>,
    /// Also read the pictures in the subfolders of given folders; outputs are in the same subfolders
    #[arg(long)]
    recursive: bool,
}

impl PictureArgs {
    pub(crate) fn depth(&self) -> Depth {
        if self.recursive { Depth::Subfolders } else { Depth::Folder }
    }

    pub(crate) fn declared(&self) -> Declared {
        let space = self.space.as_ref();
        Declared {
            space: space.map(|named| named.space.clone()),
            encoding: self.encoding.or(space.and_then(|named| named.encoding)),
            alpha: self.alpha,
            layer: self.layer.clone(),
        }
    }
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct BakeArgs {
    /// Cube made by `upglow build`; with --task, the plan
    pub(crate) cube: PathBuf,
    #[command(flatten)]
    _named_cube: NamedCube,
    #[arg(required_unless_present = "tasks", value_name = "IN", help = inputs_help())]
    pub(crate) inputs: Vec<PathBuf>,
    /// File to write for one picture, EXR or also PNG with --as radiance; file with <UDIM> or %04d in its
    /// name, or folder, for several; folders are created if they do not exist
    #[arg(long, short, value_name = "OUT", required_unless_present = "tasks")]
    output: Option<PathBuf>,
    /// Skip pictures whose output was made from the same picture, cube and options
    #[arg(long)]
    pub(crate) update: bool,
    /// What to write: material stores the parameters of one material per texel; spectral stores
    /// reflectance in bands and re-radiation between them; radiance stores the color under --light; rgbu stores 4×4
    /// matrices for engines without spectra, in four files: what becomes of red, green, blue and ultraviolet
    #[arg(long = "as", default_value_t = BakeForm::Material, value_name = "NAME", value_parser = word::<BakeForm>())]
    pub(crate) form: BakeForm,
    #[command(flatten)]
    pub(crate) threads: Threads,

    #[command(flatten)]
    pub(crate) picture: PictureArgs,
    /// What to do with texels outside 0 to 1 or not finite: clip limits each channel, scale divides
    /// the picture by its maximum, nearest moves each color to the nearest one that a material can
    /// match; texels that are not finite become black, alpha of NaN and -inf becomes 0, that of +inf 1
    /// [default: refuse the picture]
    #[arg(long, value_name = "NAME", value_parser = word::<Repair>(), help_heading = "Pictures")]
    pub(crate) repair: Option<Repair>,

    #[command(flatten)]
    pub(crate) result: ResultArgs,

    /// Bake nothing, but write to this file a plan: hashes of cube, options and pictures, and a numbered task
    /// for each picture. A name that ends in .template.json is that of an Open Job Description template, and the
    /// plan is beside it
    #[arg(long, value_name = "PLAN.json", help_heading = "Farm", conflicts_with = "update")]
    pub(crate) plan: Option<PathBuf>,
    #[arg(
        long = "task",
        value_name = TASK_NUMBERS,
        help = "Do these tasks of a plan, as 3, 1-50 or 1,4,7-9; what is already done is left as it is",
        help_heading = "Farm",
        conflicts_with_all = ["inputs", "plan"]
    )]
    pub(crate) tasks: Option<TaskNumbers>,
}

impl BakeArgs {
    /// Where the files go. Tasks of a plan have files of their own.
    pub(crate) fn output(&self) -> &Path {
        self.output.as_deref().unwrap_or(Path::new(""))
    }
}

const TASK_NUMBERS: &str = "N|A-B";

#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct ResultArgs {
    /// Interpolate the parameters without a solver, which is faster and less exact (material only)
    #[arg(long)]
    pub(crate) fast: bool,
    /// Centers of the bands, FIRST:LAST:STEP in nm (spectral only) [default: 380:780:10]
    #[arg(long, value_name = "NM:NM:NM", value_parser = bands)]
    pub(crate) bands: Option<Grid>,
    /// Store one map per dye and the spectra of the dyes once, instead of one channel per pair of
    /// bands (spectral only)
    #[arg(long)]
    pub(crate) compact: bool,
    #[arg(
        long = "light",
        alias = "illuminant",
        value_name = "NAME|FILE",
        help = format!(
            "Light under which colors are computed: {}; given several times, one file is written \
             for each (radiance only)",
            lights()
        )
    )]
    pub(crate) lights: Vec<String>,
    #[command(flatten)]
    pub(crate) light: LightArgs,
    /// exr is read by rows; tx is an EXR file of tiles at all levels, for texture systems, each level
    /// baked from filtered colors; both hold linear colors in the RGB space of the cube; png holds what a screen shows, in sRGB,
    /// adapted to the light (radiance only) [default: by the suffix of OUT, exr for folders]
    #[arg(long, value_name = "NAME", value_parser = word::<BakeFormat>())]
    pub(crate) format: Option<BakeFormat>,
    /// The same as --format tx
    #[arg(long, conflicts_with = "format")]
    pub(crate) tx: bool,
    /// Bits of each sample: 8 or 16 (png only) [default: 8]
    #[arg(long, value_name = "N", value_parser = word::<PngBits>())]
    pub(crate) bits: Option<PngBits>,
    /// By how many stops the light is brighter, -20 to 20 (png only) [default: 0]
    #[arg(long, value_name = "STOPS", value_parser = stops, allow_hyphen_values = true)]
    pub(crate) exposure: Option<f64>,
    /// Also write a MaterialX document and a USD stage, with a surface for each map or set of tiles: beside OUT with its
    /// name, or in the folder as materials.mtlx and materials.usda (spectral and radiance only)
    #[arg(long, conflicts_with_all = ["plan", "tasks"])]
    pub(crate) mtlx: bool,
    /// RGB space that the engine keeps light in: a name or eight numbers (rgbu only) [default: that of the cube]
    #[arg(long, value_name = "SPACE", value_parser = rgb_space)]
    pub(crate) engine: Option<RgbSpace>,
    /// Number format of the channels: 16-bit half or 32-bit float (exr and tx only) [default: half]
    #[arg(long, value_name = "NAME", value_parser = word::<SampleName>())]
    pub(crate) sample: Option<SampleName>,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct CheckArgs {
    #[arg(required = true, value_name = "IN", help = inputs_help())]
    pub(crate) inputs: Vec<PathBuf>,
    /// Write an illustrated report on all pictures to this file
    #[arg(long, short, value_name = "REPORT.html")]
    pub(crate) output: Option<PathBuf>,
    /// Write the heat map of a single picture to this file: how far the cube is off, or without --cube
    /// which materials are needed
    #[arg(long, value_name = "FILE.png")]
    pub(crate) heat_map: Option<PathBuf>,
    /// Also judge this cube: how far its materials are off and why, where they have dye, and what other
    /// cubes would change; its light and adaptation are used
    #[arg(long, value_name = "FILE")]
    pub(crate) cube: Option<PathBuf>,
    #[arg(
        long,
        visible_alias = "light",
        value_name = "NAME|FILE",
        conflicts_with = "cube",
        help = format!("Light: {} [default: D65]", lights())
    )]
    pub(crate) illuminant: Option<String>,
    #[command(flatten)]
    pub(crate) light: LightArgs,
    /// Chromatic adaptation from the white of the RGB space to that of the light
    /// [default: bradford]
    #[arg(long, value_name = "NAME", value_parser = word::<Adaptation>(), conflicts_with = "cube")]
    pub(crate) adapt: Option<Adaptation>,
    #[command(flatten)]
    pub(crate) threads: Threads,
    #[command(flatten)]
    pub(crate) picture: PictureArgs,
    #[arg(
        long = "task",
        value_name = TASK_NUMBERS,
        help = "Check the pictures of these tasks of the plan IN with its cube and options",
        help_heading = "Farm",
        conflicts_with_all = ["cube", "illuminant", "adapt", "PictureArgs", "LightArgs"]
    )]
    pub(crate) tasks: Option<TaskNumbers>,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ReadArgs {
    /// Baked material, or spectral, bispectral or compact EXR
    pub(crate) file: PathBuf,
    /// Column and row of the texel; 0,0 is the upper left
    #[arg(long, value_name = "X,Y", value_parser = position, allow_hyphen_values = true)]
    pub(crate) at: [usize; 2],
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct LintArgs {
    /// EXR files
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
    /// Check the header only, not the texels
    #[arg(long)]
    pub(crate) names_only: bool,
    #[arg(
        long = "task",
        value_name = TASK_NUMBERS,
        help = "Check the files of these tasks of the plan FILE: that each is there and made from what the \
                plan says, and spectral ones as any other",
        help_heading = "Farm"
    )]
    pub(crate) tasks: Option<TaskNumbers>,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ExamplesArgs {
    /// Folder for the EXR files; created if it does not exist
    #[arg(long, short, alias = "out", default_value = "examples", value_name = "FOLDER")]
    pub(crate) output: PathBuf,
}

fn inputs_help() -> String {
    format!(
        "Pictures, or folders of pictures: {FORMATS}. In a name, <UDIM> stands for the numbers of tiles, \
         %04d or #### for those of frames"
    )
}

/// What is written for a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BakeForm {
    Material,
    Spectral,
    Radiance,
    Rgbu,
}

choices!(
    BakeForm,
    "form",
    Material = "material",
    Spectral = "spectral",
    Radiance = "radiance",
    Rgbu = "rgbu",
);

/// Formats of baked files; the word is also their suffix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BakeFormat {
    Exr,
    Tx,
    Png,
}

choices!(BakeFormat, "format", Exr = "exr", Tx = "tx", Png = "png");

/// Number formats of channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SampleName {
    Half,
    Float,
}

choices!(SampleName, "kind of number", Half = "half", Float = "float");

impl From<SampleName> for Sample {
    fn from(name: SampleName) -> Self {
        match name {
            SampleName::Half => Self::Half,
            SampleName::Float => Self::Float,
        }
    }
}
