//! What was typed.

mod pictures;

use std::ffi::OsString;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::str::FromStr;

use clap::{Parser, Subcommand};
use upglow::{Accounting, CoefficientTable, Cube, Interpolation, Mixing, QuantumYield};
use upglow_color::{Adaptation, Metric};
use upglow_fit::Method;
use upglow_shader::Language;
use upglow_terminal::{in_range, threads, whole};

pub(crate) use pictures::{
    BakeArgs, BakeForm, CheckArgs, ExamplesArgs, LintArgs, PictureArgs, ReadArgs, SampleName,
};

/// RGB colors to physically valid spectral materials, with fluorescence where no reflectance shows
/// the color.
#[derive(Clone, Debug, Parser)]
#[command(name = "upglow", version, max_term_width = 100)]
pub(crate) struct Args {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Print one JSON document instead of text
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// Show no progress
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
}

#[derive(Clone, Debug, Subcommand)]
pub(crate) enum Command {
    /// Fit a material for every node of a grid over RGB, and write them as one file
    Build(Box<BuildArgs>),
    /// Show what a cube, or a table of coefficients, is made of and how well it matches its colors
    Inspect(InspectArgs),
    /// Recompute everything from a cube's numbers; exit 1 if a physical law is broken
    Verify(VerifyArgs),
    /// Show the material of one color
    Color(ColorArgs),
    /// Write a cube for other programs: CSV, a table of coefficients, or shaders
    Export(ExportArgs),
    /// Turn pictures into spectral materials: EXR, TIFF or PNG in, EXR out
    Bake(Box<BakeArgs>),
    /// Say which texels of pictures a reflectance shows, which need fluorescence, which nothing
    /// shows
    Check(CheckArgs),
    /// Show the spectrum of one texel of a spectral or bispectral EXR
    Read(ReadArgs),
    /// Say whether files are well-formed spectral or bispectral EXR, and what is wrong
    Lint(LintArgs),
    /// Draw three pictures to try the other commands with
    Examples(ExamplesArgs),
    /// Moved to the program `upglow-study`
    #[command(hide = true)]
    Figures(MovedArgs),
    /// Moved to the program `upglow-study`
    #[command(hide = true)]
    Reproduce(MovedArgs),
}

/// The words after a command that is now in another program.
#[derive(Clone, Debug, clap::Args)]
#[command(disable_help_flag = true)]
pub(crate) struct MovedArgs {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    _words: Vec<OsString>,
}

#[derive(Clone, Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub(crate) struct BuildArgs {
    /// Cube to write
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: PathBuf,

    /// RGB space: acescg, aces2065-1, rec2020, p3-d65, srgb, prophoto, adobe-rgb, xyz, or eight
    /// numbers Rx,Ry,Gx,Gy,Bx,By,Wx,Wy
    #[arg(long, default_value = "acescg", help_heading = "What RGB means")]
    pub(crate) space: String,
    /// Light: D65, D60, D55, D50, A, E, or a CSV file with the header `wavelength_nm,power`
    #[arg(long, default_value = "D65", value_name = "NAME|FILE", help_heading = "What RGB means")]
    pub(crate) illuminant: String,
    /// Eye: cie-1931-2deg, or a CSV file with the header `wavelength_nm,x,y,z`
    #[arg(
        long,
        default_value = "cie-1931-2deg",
        value_name = "NAME|FILE",
        help_heading = "What RGB means"
    )]
    pub(crate) observer: String,
    /// Chromatic adaptation from the white of the space to that of the light: bradford or none
    #[arg(long, default_value = "bradford", value_name = "NAME", help_heading = "What RGB means")]
    pub(crate) adapt: Adaptation,

    /// Fluorescence: dyes (measured), analytic (by formula) or reflectance (none)
    #[arg(long, default_value = "dyes", help_heading = "Model")]
    pub(crate) model: ModelName,
    /// Dyes: seed8, open8, wide14, or a folder of CSV files with the header
    /// `wavelength_nm,absorption,emission` [default: seed8]
    #[arg(long, value_name = "NAME|FOLDER", help_heading = "Model")]
    pub(crate) dyes: Option<String>,
    /// What dyes conserve when they give light back: energy or photon [default: energy]
    #[arg(long, value_name = "NAME", help_heading = "Model")]
    pub(crate) accounting: Option<Accounting>,
    /// Whether two dyes share what they absorb: pooled or separate [default: pooled]
    #[arg(long, value_name = "NAME", help_heading = "Model")]
    pub(crate) mixing: Option<Mixing>,
    /// Share of absorbed light that comes out: 0 to 1, or measured (dyes only) [default: 1]
    #[arg(long, value_name = "Q|measured", help_heading = "Model")]
    pub(crate) quantum_yield: Option<QuantumYield>,
    /// Load the dyes to this optical density at their peak [default: thin solution]
    #[arg(long, value_name = "A", value_parser = number, help_heading = "Model")]
    pub(crate) optical_density: Option<f64>,
    /// Full width at half maximum of the analytic absorption, 15 to 80 nm [default: 50]
    #[arg(long, value_name = "NM", value_parser = number, help_heading = "Model")]
    pub(crate) absorption_fwhm_nm: Option<f64>,
    /// Full width at half maximum of the analytic emission, 15 to 80 nm [default: 45]
    #[arg(long, value_name = "NM", value_parser = number, help_heading = "Model")]
    pub(crate) emission_fwhm_nm: Option<f64>,

    /// Color difference to minimize: de2000, de76 or rgb
    #[arg(long, default_value = "de2000", value_name = "NAME", help_heading = "Fit")]
    pub(crate) metric: Metric,
    /// Nodes along each axis, 2 to 256
    #[arg(long, default_value = "32", value_name = "N", value_parser = resolution, help_heading = "Fit")]
    pub(crate) resolution: usize,
    /// Greatest slope of any reflectance, 0.0001 to 0.2 per nm, or none
    #[arg(long, default_value = "0.01", value_name = "SLOPE|none", help_heading = "Fit")]
    pub(crate) slope_max_per_nm: SlopeLimit,
    /// How to search: search (ours), exhaustive (slower, its yardstick), konig2020 or
    /// konig2020-features (that paper's, moving coefficients or features)
    #[arg(long, default_value = "search", value_name = "NAME", help_heading = "Fit")]
    pub(crate) method: Method,
    /// How often a node that missed its color tries its neighbors' materials [default: 2, and 4
    /// for those of konig2020]
    #[arg(long, value_name = "N", value_parser = count, help_heading = "Fit")]
    pub(crate) sweeps: Option<u32>,
    /// Threads; the file does not depend on it [default: one for each core]
    #[arg(long, value_name = "N", value_parser = threads, help_heading = "Fit")]
    pub(crate) threads: Option<NonZeroUsize>,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct InspectArgs {
    /// Cube made by `upglow build`, or a table of coefficients of any program (.coeff)
    pub(crate) file: PathBuf,
    /// RGB space of a table of coefficients, which does not name it
    #[arg(long)]
    pub(crate) space: Option<String>,
    /// Light of a table of coefficients: D65, D60, D55, D50, A, E, or a CSV file [default: D65]
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) illuminant: Option<String>,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct VerifyArgs {
    /// Cube made by `upglow build`
    pub(crate) file: PathBuf,
    /// Colors between the nodes to try
    #[arg(long, default_value = "1000000", value_name = "N", value_parser = points)]
    pub(crate) points: usize,
    /// What stands between the nodes: blend, none, coefficients, features or hybrid
    #[arg(long, default_value = "blend", value_name = "MODE")]
    pub(crate) interpolation: Interpolation,
    /// Where the random colors start; the same seed draws the same ones
    #[arg(long, default_value = "0", value_name = "N", value_parser = seed)]
    pub(crate) seed: u64,
    /// Threads; the result does not depend on it [default: one for each core]
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ColorArgs {
    /// Cube made by `upglow build`
    pub(crate) file: PathBuf,
    /// Linear red in the cube's RGB space, 0 to 1; with --direct to 10
    #[arg(value_name = "R", allow_hyphen_values = true)]
    pub(crate) red: String,
    /// Linear green
    #[arg(value_name = "G", allow_hyphen_values = true)]
    pub(crate) green: String,
    /// Linear blue
    #[arg(value_name = "B", allow_hyphen_values = true)]
    pub(crate) blue: String,
    /// What stands between the nodes: blend, none, coefficients, features or hybrid
    /// [default: blend]
    #[arg(long, value_name = "MODE", conflicts_with = "direct")]
    pub(crate) interpolation: Option<Interpolation>,
    /// Fit this one color as the cube's nodes were fitted, instead of looking it up
    #[arg(long)]
    pub(crate) direct: bool,
    /// Draw the material's curves as an SVG file
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) plot: Option<PathBuf>,
    /// Draw the curves in text although standard output is not a terminal
    #[arg(long, conflicts_with = "json")]
    pub(crate) plot_terminal: bool,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ExportArgs {
    /// Cube made by `upglow build`
    pub(crate) file: PathBuf,
    /// File to write
    pub(crate) output: PathBuf,
    /// csv (every node a line), coeff (reflectances only, for Mitsuba 3, pbrt-v4, colour-science), or
    /// wgsl, glsl, hlsl or osl (functions, with their textures beside them)
    /// [default: as the output is named]
    #[arg(long, value_name = "NAME")]
    pub(crate) format: Option<ExportFormat>,
    /// Nodes along each axis of a coeff table, 2 to 128 [default: 64]
    #[arg(long, value_name = "N", value_parser = table_resolution)]
    pub(crate) resolution: Option<usize>,
    /// Threads; the file does not depend on it [default: one for each core]
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
}

/// The kinds of exported file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ExportFormat {
    Csv,
    Coeff,
    Shader(Language),
}

impl ExportFormat {
    pub(crate) const ALL: [Self; 6] = [
        Self::Csv,
        Self::Coeff,
        Self::Shader(Language::Wgsl),
        Self::Shader(Language::Glsl),
        Self::Shader(Language::Hlsl),
        Self::Shader(Language::Osl),
    ];

    /// The word that is typed, and the suffix of the files.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Coeff => "coeff",
            Self::Shader(language) => language.name(),
        }
    }
}

impl FromStr for ExportFormat {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        named("format", &Self::ALL.map(|format| (format.name(), format)), name)
    }
}

/// The value of a word, or what was expected.
fn named<T: Copy>(what: &str, known: &[(&str, T)], name: &str) -> Result<T, String> {
    known.iter().find(|(word, _)| *word == name).map(|(_, value)| *value).ok_or_else(|| {
        let words: Vec<&str> = known.iter().map(|(word, _)| *word).collect();
        let words = match &words[..] {
            [rest @ .., last] if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
            words => words.concat(),
        };
        format!("unknown {what} {name:?}, expected {words}")
    })
}

/// The kinds of model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ModelName {
    Dyes,
    Analytic,
    Reflectance,
}

impl ModelName {
    /// The word that is typed.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Dyes => "dyes",
            Self::Analytic => "analytic",
            Self::Reflectance => "reflectance",
        }
    }
}

impl FromStr for ModelName {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        [Self::Dyes, Self::Analytic, Self::Reflectance]
            .into_iter()
            .find(|model| model.name() == name)
            .ok_or_else(|| {
                format!("unknown model {name:?}, expected dyes, analytic or reflectance")
            })
    }
}

/// The greatest slope of a reflectance, 1/nm; `None` for no limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SlopeLimit(pub(crate) Option<f64>);

impl FromStr for SlopeLimit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "none" => Ok(Self(None)),
            _ => text
                .parse()
                .map(|slope| Self(Some(slope)))
                .map_err(|_| format!("{text:?}, expected a number of 1/nm or none")),
        }
    }
}

fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| format!("{text:?}, expected a number"))
}

fn count(text: &str) -> Result<u32, String> {
    whole(text, "a whole number of 0 or more")
}

fn seed(text: &str) -> Result<u64, String> {
    whole(text, "a whole number of 0 or more")
}

fn points(text: &str) -> Result<usize, String> {
    whole(text, "a whole number of 0 or more")
}

fn resolution(text: &str) -> Result<usize, String> {
    in_range(Cube::RESOLUTIONS, text)
}

fn table_resolution(text: &str) -> Result<usize, String> {
    in_range(CoefficientTable::RESOLUTIONS, text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_fit_together() {
        Args::command().debug_assert();
    }

    #[test]
    fn no_slope_limit_has_a_word() {
        assert_eq!("none".parse(), Ok(SlopeLimit(None)));
        assert_eq!("0.02".parse(), Ok(SlopeLimit(Some(0.02))));
        assert!("steep".parse::<SlopeLimit>().is_err());
    }

    #[test]
    fn a_resolution_out_of_range_is_refused() {
        assert_eq!(resolution("32"), Ok(32));
        for text in ["1", "257", "-4", "many", "4.5"] {
            assert!(resolution(text).is_err_and(|e| e.ends_with("from 2 to 256")), "{text}");
        }
    }
}
