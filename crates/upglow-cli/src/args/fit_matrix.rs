//! The options of `upglow fit-matrix`.

use std::path::PathBuf;

use upglow_color::{BispectralUnit, choices};
use upglow_fit::MatrixReflectance;
use upglow_terminal::{in_range, word};

use super::LightArgs;
use super::values::{lights, position};

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct FitMatrixArgs {
    /// Measured re-radiation matrix: a BFC-450 file (.bfc), CSV with named axes (.csv), or a bispectral
    /// EXR (.exr)
    pub(crate) file: PathBuf,
    /// Texel of an EXR, as two numbers X,Y from the top left [default: the mean of all]
    #[arg(long, value_name = "X,Y", value_parser = position)]
    pub(crate) at: Option<[usize; 2]>,
    /// Unit of an EXR that does not state it: a share of the power that arrives, within the band where it
    /// leaves or per nm there
    #[arg(long, value_name = "UNIT", value_parser = word::<UnitName>())]
    pub(crate) unit: Option<UnitName>,
    /// Dyes that may emit: measured, with the absorption and emission of the matrix; all, the built-in
    /// ones; a dye set; or a folder, as for `upglow build`
    #[arg(long, value_name = "measured|all|SET|FOLDER", default_value = "measured")]
    pub(crate) dyes: String,
    /// How many dyes emit, 1 or 2 [default: 1 of the matrix; of others, what comes nearest]
    #[arg(long, value_name = "N", value_parser = in_range([1, 2]))]
    pub(crate) count: Option<usize>,
    /// What is reflected: measured, as a dye without emission over white, beside one emitting dye of the
    /// matrix; or the nearest sigmoid [default: what comes nearest]
    #[arg(long, value_name = "NAME", value_parser = word::<MatrixReflectance>())]
    pub(crate) reflectance: Option<MatrixReflectance>,
    #[arg(
        long = "light",
        alias = "illuminant",
        value_name = "NAME|FILE",
        help = format!(
            "Compare the colors under this light: {}; several may be given \
             [default: D65, A, E, D65-cut400, FL2, HP5 and a 365 nm lamp]",
            lights()
        )
    )]
    pub(crate) lights: Vec<String>,
    #[command(flatten)]
    pub(crate) light: LightArgs,
    /// Draw both matrices and their radiance factors under D65 to this SVG file
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) plot: Option<PathBuf>,
    /// Write the material as a cube of 2³ nodes that are all the same, which every command that reads
    /// cubes can use
    #[arg(long, short, value_name = "FILE.safetensors")]
    pub(crate) output: Option<PathBuf>,
}

/// [`BispectralUnit`] in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum UnitName {
    PerBand,
    PerNm,
}

choices!(UnitName, "unit", PerBand = "per-band", PerNm = "per-nm");

impl From<UnitName> for BispectralUnit {
    fn from(name: UnitName) -> Self {
        match name {
            UnitName::PerBand => Self::PerBand,
            UnitName::PerNm => Self::PerNm,
        }
    }
}
