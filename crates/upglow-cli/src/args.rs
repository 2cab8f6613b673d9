//! The command line: each option is one field here, with its name, value, default and help.

mod build;
mod cube_first;
#[cfg(feature = "explore")]
mod explore;
mod fit_matrix;
mod manual;
mod pictures;
mod relight;
mod usage;
mod values;

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::{Parser, Subcommand};
use upglow::{CoefficientTable, Interpolation};
use upglow_color::{Ends, RgbSpace, choices};
use upglow_fit::{MaterialSet, PaintKind, ReachView};
use upglow_shader::{Language, LutFormat, LutLattice};
use upglow_terminal::{Console, Threads, count, in_range, word};

pub(crate) use build::{
    BuildArgs, ContractArgs, FitArgs, ModelArgs, ModelName, SlopeLimits, limit_text,
};
use cube_first::NamedCube;
pub(crate) use cube_first::with_cube_first;
#[cfg(feature = "explore")]
pub(crate) use explore::{BuildWords, ExploreArgs};
pub(crate) use fit_matrix::FitMatrixArgs;
pub(crate) use manual::{CompletionsArgs, ManArgs};
pub(crate) use pictures::{
    BakeArgs, BakeForm, BakeFormat, CheckArgs, ExamplesArgs, LintArgs, ReadArgs, SampleName,
};
pub(crate) use relight::RelightArgs;
pub(crate) use values::SlopeLimit;
use values::{lights, rgb_space, slope_limit};

/// Turns RGB colors into physically valid spectral materials, with fluorescence where no
/// reflectance can match the color.
#[derive(Clone, Debug, Parser)]
#[command(name = "upglow", version, max_term_width = 100, after_help = usage::PROGRAM)]
pub(crate) struct Args {
    #[command(subcommand)]
    pub(crate) command: Command,
    #[command(flatten)]
    pub(crate) console: Console,
}

#[derive(Clone, Debug, Subcommand)]
pub(crate) enum Command {
    /// Fit a material to every node of a grid over RGB and write them all to one file, a cube
    #[command(after_help = usage::BUILD)]
    Build(Box<BuildArgs>),
    /// Show what a cube or a coefficient table contains and how well it matches its colors
    #[command(after_help = usage::INSPECT)]
    Inspect(InspectArgs),
    /// Recompute the physics of a cube from its stored numbers; exit with 1 if a law is broken
    #[command(after_help = usage::VERIFY)]
    Verify(VerifyArgs),
    /// Show the material of one color
    #[command(after_help = usage::COLOR)]
    Color(ColorArgs),
    /// Fit a material to a measured re-radiation (Donaldson) matrix
    #[command(after_help = usage::FIT_MATRIX)]
    FitMatrix(FitMatrixArgs),
    /// Show how colors look under other lights and for other observers, as a table and as swatches
    #[command(after_help = usage::RELIGHT)]
    Relight(RelightArgs),
    /// Convert a cube for other programs: CSV, coefficient table or shader source, or a page to explore it
    #[command(after_help = usage::EXPORT)]
    Export(ExportArgs),
    /// Convert pictures to files of materials, spectra or colors under a light
    #[command(after_help = usage::BAKE)]
    Bake(Box<BakeArgs>),
    /// Report which texels of pictures a reflectance can match, which need fluorescence, and which
    /// no material can match
    #[command(after_help = usage::CHECK)]
    Check(Box<CheckArgs>),
    /// Show the spectrum or material of one texel of a baked or spectral EXR
    #[command(after_help = usage::READ)]
    Read(ReadArgs),
    /// Report whether files are well-formed spectral or bispectral EXR; exit with 1 if one is not
    #[command(after_help = usage::LINT)]
    Lint(LintArgs),
    /// Explore a cube in a browser: pick colors, see their spectra, light them, build other cubes
    #[cfg(feature = "explore")]
    #[command(after_help = usage::EXPLORE)]
    Explore(ExploreArgs),
    /// Explore a cube in a browser; in builds with the feature explore
    #[cfg(not(feature = "explore"))]
    Explore(MovedArgs),
    /// Draw example pictures to try the other commands on
    #[command(after_help = usage::EXAMPLES)]
    Examples(ExamplesArgs),
    /// Print the script with which a shell completes command lines
    #[command(hide = true)]
    Completions(CompletionsArgs),
    /// Write a manual page for each command
    #[command(hide = true)]
    Man(ManArgs),
    /// Moved to the program `upglow-study`
    #[command(hide = true)]
    Figures(MovedArgs),
    /// Moved to the program `upglow-study`
    #[command(hide = true)]
    Reproduce(MovedArgs),
}

/// What is known of the paint that has a color.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct PaintArgs {
    /// Choose by what paints are like, among all built-in dyes with yields of their own: any, which fluoresces
    /// if its color is unlikely otherwise; ordinary, which does not; fluorescent, which does
    #[arg(long, value_name = "NAME", value_parser = word::<PaintKind>(), conflicts_with = "direct")]
    pub(crate) kind: Option<PaintKind>,
    /// Which material is chosen so: single, the material from which those that may have the color differ least;
    /// mixture, a blend of up to four that comes near to the mean of all [default: single]
    #[arg(long, value_name = "NAME", value_parser = word::<AnswerName>())]
    pub(crate) answer: Option<AnswerName>,
}

/// One material or a blend.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum AnswerName {
    #[default]
    Single,
    Mixture,
}

choices!(AnswerName, "answer", Single = "single", Mixture = "mixture");

/// How lights are read from files.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct LightArgs {
    /// Power of a light from a file beyond its samples, if they end within 300 to 830 nm: zero, or
    /// hold for that of the nearest sample [default: such a file is refused]
    #[arg(long = "light-ends", value_name = "NAME", value_parser = word::<Ends>())]
    pub(crate) ends: Option<Ends>,
}

/// The arguments of a command that is in another program or build.
#[derive(Clone, Debug, clap::Args)]
#[command(disable_help_flag = true)]
pub(crate) struct MovedArgs {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    _words: Vec<OsString>,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct InspectArgs {
    /// Cube made by `upglow build`, or coefficient table of any program (.coeff)
    pub(crate) file: PathBuf,
    #[command(flatten)]
    _named_cube: NamedCube,
    /// RGB space of a coefficient table, which does not store it: a name or eight numbers, as for
    /// `upglow build`
    #[arg(long, value_parser = rgb_space)]
    pub(crate) space: Option<RgbSpace>,
    #[arg(
        long,
        visible_alias = "light",
        value_name = "NAME|FILE",
        help = format!("Light of a coefficient table: {} [default: D65]", lights())
    )]
    pub(crate) illuminant: Option<String>,
    #[command(flatten)]
    pub(crate) light: LightArgs,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct VerifyArgs {
    /// Cube made by `upglow build`
    #[arg(value_name = "CUBE")]
    pub(crate) file: PathBuf,
    #[command(flatten)]
    _named_cube: NamedCube,
    /// Number of random colors to try between the nodes
    #[arg(long, default_value = "1000000", value_name = "N", value_parser = count::<usize>)]
    pub(crate) points: usize,
    /// How colors between the nodes get their material: blend mixes those of the four nodes around
    /// the color, none takes the nearest one, the others interpolate parameters as in König et al. 2020
    #[arg(long, default_value_t, value_name = "NAME", value_parser = word::<Interpolation>())]
    pub(crate) interpolation: Interpolation,
    /// Seed of the random colors; the same seed draws the same colors
    #[arg(long, default_value = "0", value_name = "N", value_parser = count::<u64>)]
    pub(crate) seed: u64,
    #[command(flatten)]
    pub(crate) threads: Threads,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ColorArgs {
    /// Cube made by `upglow build`
    #[arg(value_name = "CUBE")]
    pub(crate) file: PathBuf,
    #[command(flatten)]
    _named_cube: NamedCube,
    /// Linear red in the RGB space of the cube, 0 to 1; up to 10 with --direct, --kind or --known
    #[arg(value_name = "R", allow_hyphen_values = true)]
    pub(crate) red: String,
    /// Linear green, like red
    #[arg(value_name = "G", allow_hyphen_values = true)]
    pub(crate) green: String,
    /// Linear blue, like red
    #[arg(value_name = "B", allow_hyphen_values = true)]
    pub(crate) blue: String,
    /// How a color between the nodes gets its material: blend mixes those of the four nodes around
    /// it, none takes the nearest one, the others interpolate parameters as in König et al. 2020
    /// [default: blend]
    #[arg(long, value_name = "NAME", value_parser = word::<Interpolation>(), conflicts_with = "direct")]
    pub(crate) interpolation: Option<Interpolation>,
    /// Fit a material to this color, with the options of the cube, instead of looking it up
    #[arg(long)]
    pub(crate) direct: bool,
    #[command(flatten)]
    pub(crate) paint: PaintArgs,
    /// A light under which the color is known too, and the color: linear RGB as this command shows it under
    /// the light. The material that has both is chosen, or for two lights that has all three; --kind is then any
    /// unless it is given
    #[arg(
        long,
        num_args = 4,
        value_names = ["LIGHT", "R", "G", "B"],
        allow_hyphen_values = true,
        conflicts_with_all = ["direct", "interpolation"]
    )]
    pub(crate) known: Vec<String>,
    /// With --kind or --known: write the single best material as a cube of 2³ nodes that are all the same, which
    /// every command that reads cubes can use
    #[arg(long, short, value_name = "FILE.safetensors")]
    pub(crate) output: Option<PathBuf>,
    #[arg(
        long = "light",
        alias = "illuminant",
        value_name = "NAME|FILE",
        help = format!(
            "Also show its color under this light: {}; several may be given \
             [default: D65, A, E and a 365 nm lamp]",
            lights()
        )
    )]
    pub(crate) lights: Vec<String>,
    #[command(flatten)]
    pub(crate) light: LightArgs,
    /// Also show the material for an engine that keeps light in this RGB space, linear, and ultraviolet: its 4×4 matrix,
    /// and the four numbers of the lights
    #[arg(long, value_name = "SPACE", value_parser = rgb_space)]
    pub(crate) engine: Option<RgbSpace>,
    /// Draw the curves of the material to this SVG file
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) plot: Option<PathBuf>,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ExportArgs {
    /// Cube made by `upglow build`
    #[arg(value_name = "CUBE")]
    pub(crate) file: PathBuf,
    #[command(flatten)]
    _named_cube: NamedCube,
    /// The file to write, where it is not given by --output
    #[arg(value_name = "OUTPUT", required_unless_present = "output")]
    named: Option<PathBuf>,
    /// File to write
    #[arg(long, short, value_name = "FILE", conflicts_with = "named")]
    output: Option<PathBuf>,
    /// csv: one line per node; coeff: reflectances only, for Mitsuba 3 and colour-science; html: a page
    /// to explore it with, offline; mtlx: a MaterialX surface with its color under --light, for RGB
    /// renderers, and the same for USD; clf, cube: a table of the nearest colors that materials show, for
    /// color management; js: a module of JavaScript, and the others shader source, with textures beside
    /// them [default: by the suffix of the output]
    #[arg(long, value_name = "NAME", value_parser = word::<ExportFormat>())]
    pub(crate) format: Option<ExportFormat>,
    /// Nodes along each axis of a coeff table, 2 to 128 [default: 64], or of a clf or cube table, 2 to 129
    /// [default: 65, or for the colors of the cube as many as it has]
    #[arg(long, value_name = "N", value_parser = in_range(TABLE_RESOLUTIONS))]
    pub(crate) resolution: Option<usize>,
    /// The materials of a clf or cube table. cube: those that this cube returns; reflectance: every
    /// reflectance, without dyes; any: every material, fluorescent or not [default: cube]
    #[arg(long, value_name = "NAME", value_parser = word::<MaterialSet>())]
    pub(crate) target: Option<MaterialSet>,
    /// What a clf or cube table shows. nearest: the nearest color of the materials; out-of-reach: the
    /// color itself, but flat magenta or green where the materials do not show it [default: nearest]
    #[arg(long, value_name = "NAME", value_parser = word::<ReachView>())]
    pub(crate) show: Option<ReachView>,
    /// Greatest slope of the reflectances of a coeff table, 0.0001 to 0.2 per nm, or none for 0.2
    /// [default: none, as in Jakob and Hanika 2019]
    #[arg(long, value_name = "SLOPE|none", value_parser = slope_limit)]
    pub(crate) slope_max_per_nm: Option<SlopeLimit>,
    #[arg(
        long = "light",
        alias = "illuminant",
        value_name = "NAME|FILE",
        help = format!("Light of the colors of mtlx: {} [default: that of the cube]", lights())
    )]
    pub(crate) light: Option<String>,
    #[command(flatten)]
    pub(crate) light_file: LightArgs,
    /// Write the 4×4 matrices of materials instead of their spectra, for an engine that keeps light in this RGB space,
    /// linear, and ultraviolet (shaders only)
    #[arg(long, value_name = "SPACE", value_parser = rgb_space)]
    pub(crate) engine: Option<RgbSpace>,
    #[command(flatten)]
    pub(crate) threads: Threads,
}

impl ExportArgs {
    /// Where the file goes.
    pub(crate) fn output(&self) -> &Path {
        self.named.as_deref().or(self.output.as_deref()).unwrap_or(Path::new(""))
    }
}

/// The kinds of exported file; the word is also the suffix of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ExportFormat {
    Csv,
    Coeff,
    Html,
    MaterialX,
    Lut(LutFormat),
    Shader(Language),
}

/// Nodes along an axis of a coeff table or of a LUT; which of both is checked with the format.
const TABLE_RESOLUTIONS: [usize; 2] =
    [CoefficientTable::RESOLUTIONS[0], LutLattice::RESOLUTIONS[1]];

choices!(
    ExportFormat,
    "format",
    Csv = "csv",
    Coeff = "coeff",
    Html = "html",
    MaterialX = "mtlx",
    Lut(LutFormat::Clf) = "clf",
    Lut(LutFormat::Cube) = "cube",
    Shader(Language::Wgsl) = "wgsl",
    Shader(Language::Glsl) = "glsl",
    Shader(Language::Hlsl) = "hlsl",
    Shader(Language::Osl) = "osl",
    Shader(Language::JavaScript) = "js",
);

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_fit_together() {
        Args::command().debug_assert();
    }
}
