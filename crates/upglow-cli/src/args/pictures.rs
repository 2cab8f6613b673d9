//! What was typed about pictures.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::str::FromStr;

use upglow_color::Adaptation;

use super::{named, threads, whole};

/// What the numbers of a picture mean, where its file does not say.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct PictureArgs {
    /// RGB space of pictures that do not name theirs: acescg, aces2065-1, rec2020, p3-d65, srgb,
    /// prophoto, adobe-rgb, xyz, or eight numbers Rx,Ry,Gx,Gy,Bx,By,Wx,Wy
    #[arg(long, help_heading = "Pictures")]
    pub(crate) space: Option<String>,
    /// How pictures that do not say so store light: linear, srgb, or a gamma such as 2.2
    #[arg(long, value_name = "NAME|GAMMA", help_heading = "Pictures")]
    pub(crate) encoding: Option<String>,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct BakeArgs {
    /// Cube made by `upglow build`
    pub(crate) cube: PathBuf,
    /// Pictures, or folders of them: EXR, TIFF or PNG
    #[arg(required = true, value_name = "IN")]
    pub(crate) inputs: Vec<PathBuf>,
    /// File to write, or folder for the files of several pictures; made if it is not there
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// material (parameters of one material a texel), spectral (reflectance in bands, and
    /// re-radiation between them) or radiance (color under --light)
    #[arg(long = "as", default_value = "material", value_name = "NAME")]
    pub(crate) form: BakeForm,

    #[command(flatten)]
    pub(crate) picture: PictureArgs,
    /// What to do with texels outside 0 to 1, negative or no numbers: clip, scale or nearest
    /// [default: refuse them]
    #[arg(long, value_name = "NAME", help_heading = "Pictures")]
    pub(crate) repair: Option<String>,

    /// Interpolate parameters without a solver: faster, and less exact (material only)
    #[arg(long, help_heading = "Output")]
    pub(crate) fast: bool,
    /// Wavelengths FIRST:LAST:STEP in nm (spectral only) [default: 380:780:10]
    #[arg(long, value_name = "NM:NM:NM", help_heading = "Output")]
    pub(crate) bands: Option<String>,
    /// Store one map for each dye, and the dyes' curves once, instead of a channel for each pair of
    /// bands (spectral only)
    #[arg(long, help_heading = "Output")]
    pub(crate) compact: bool,
    /// Light to show colors under: D65, D60, D55, D50, A, E, or a CSV file with the header
    /// `wavelength_nm,power` (radiance only)
    #[arg(long, value_name = "NAME|FILE", help_heading = "Output")]
    pub(crate) light: Option<String>,
    /// Numbers in the file: half or float
    #[arg(long, default_value = "half", value_name = "NAME", help_heading = "Output")]
    pub(crate) sample: SampleName,
    /// Threads; the files do not depend on it [default: one for each core]
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct CheckArgs {
    /// Pictures, or folders of them: EXR, TIFF or PNG
    #[arg(required = true, value_name = "IN")]
    pub(crate) inputs: Vec<PathBuf>,
    /// Write a page with pictures to this file
    #[arg(long, short, value_name = "REPORT.html")]
    pub(crate) output: Option<PathBuf>,
    /// Write the heat map of a single picture to this file
    #[arg(long, value_name = "FILE.png")]
    pub(crate) heat_map: Option<PathBuf>,
    /// Also say how close this cube's materials come; its light and adaptation are used
    #[arg(long, value_name = "FILE")]
    pub(crate) cube: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) picture: PictureArgs,
    /// Light: D65, D60, D55, D50, A, E, or a CSV file with the header `wavelength_nm,power`
    /// [default: D65]
    #[arg(long, value_name = "NAME|FILE", conflicts_with = "cube")]
    pub(crate) illuminant: Option<String>,
    /// Chromatic adaptation from the white of the space to that of the light: bradford or none
    /// [default: bradford]
    #[arg(long, value_name = "NAME", conflicts_with = "cube")]
    pub(crate) adapt: Option<Adaptation>,
    /// Threads; the result does not depend on it [default: one for each core]
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ReadArgs {
    /// Spectral, bispectral or compact EXR
    pub(crate) file: PathBuf,
    /// Column and row of the texel, from the upper left, first 0,0
    #[arg(long, value_name = "X,Y", value_parser = position, allow_hyphen_values = true)]
    pub(crate) at: [usize; 2],
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct LintArgs {
    /// EXR files
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
    /// Look at the channels only, not at the texels
    #[arg(long)]
    pub(crate) names_only: bool,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ExamplesArgs {
    /// Folder for the EXR files; made if it is not there
    #[arg(long, default_value = "examples", value_name = "FOLDER")]
    pub(crate) out: PathBuf,
}

/// What becomes of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BakeForm {
    Material,
    Spectral,
    Radiance,
}

impl BakeForm {
    const ALL: [Self; 3] = [Self::Material, Self::Spectral, Self::Radiance];

    /// The word that is typed.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Material => "material",
            Self::Spectral => "spectral",
            Self::Radiance => "radiance",
        }
    }
}

impl FromStr for BakeForm {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        named("form", &Self::ALL.map(|form| (form.name(), form)), name)
    }
}

/// The kinds of number in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SampleName {
    Half,
    Float,
}

impl FromStr for SampleName {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        named("kind of number", &[("half", Self::Half), ("float", Self::Float)], name)
    }
}

fn position(text: &str) -> Result<[usize; 2], String> {
    let expected = "two whole numbers X,Y";
    let (x, y) = text.split_once(',').ok_or_else(|| format!("{text:?}, expected {expected}"))?;
    Ok([whole(x.trim(), expected)?, whole(y.trim(), expected)?])
}
