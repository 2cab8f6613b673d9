//! Options of `upglow relight`.

use std::path::PathBuf;

use upglow_terminal::Threads;

use super::values::{lights, observers};
use super::{LightArgs, NamedCube, PaintArgs};

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct RelightArgs {
    /// Cube made by `upglow build`
    #[arg(value_name = "CUBE")]
    pub(crate) file: PathBuf,
    #[command(flatten)]
    _named_cube: NamedCube,
    /// Linear red in the RGB space of the cube, 0 to 1; up to 10 with --direct or --kind
    #[arg(value_name = "R", allow_hyphen_values = true, requires = "blue")]
    pub(crate) red: Option<String>,
    /// Linear green, like red
    #[arg(value_name = "G", allow_hyphen_values = true)]
    pub(crate) green: Option<String>,
    /// Linear blue, like red
    #[arg(value_name = "B", allow_hyphen_values = true)]
    pub(crate) blue: Option<String>,
    /// Relight the colors of this list: a CSV file with the header r,g,b or name,r,g,b
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["red", "nodes"])]
    pub(crate) colors: Option<PathBuf>,
    /// Relight all nodes of the cube
    #[arg(long, conflicts_with_all = ["red", "direct", "kind"])]
    pub(crate) nodes: bool,
    /// Fit a material to each color, with the options of the cube, instead of looking it up
    #[arg(long)]
    pub(crate) direct: bool,
    #[command(flatten)]
    pub(crate) paint: PaintArgs,
    /// Also show how far each answer may be off: the ΔE00 within which nine of ten materials are that may have
    /// the color. At most 1000 colors; each takes half a second
    #[arg(long, conflicts_with = "nodes")]
    pub(crate) band: bool,
    #[arg(
        long = "light",
        alias = "illuminant",
        value_name = "NAME|FILE",
        help = format!(
            "Light to see the colors under: {}; several may be given \
             [default: that of the cube, D65, A, E and a 365 nm lamp]",
            lights()
        )
    )]
    pub(crate) lights: Vec<String>,
    #[command(flatten)]
    pub(crate) light: LightArgs,
    #[arg(
        long = "observer",
        value_name = "NAME|FILE",
        help = format!(
            "Observer who sees them: {}; several may be given [default: that of the cube]",
            observers()
        )
    )]
    pub(crate) observers: Vec<String>,
    /// Write the table to this CSV file: a line for each color under each light
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) csv: Option<PathBuf>,
    /// Draw the colors to this SVG file: a row for each of the first 64 colors, a column for each light
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) plot: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) threads: Threads,
}
