//! The options of `upglow build`.

use std::path::PathBuf;

use upglow::{Accounting, Cube, Mixing, QuantumYield};
use upglow_color::{Adaptation, Metric, RgbSpace, choices};
use upglow_fit::Method;
use upglow_terminal::{Threads, count, in_range, number, word};

use super::values::{SlopeLimit, rgb_space, slope_limit};

#[derive(Clone, Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub(crate) struct BuildArgs {
    /// Cube to write
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) contract: ContractArgs,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    #[command(flatten)]
    pub(crate) fit: FitArgs,
}

#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "What RGB means")]
pub(crate) struct ContractArgs {
    /// RGB space: acescg, aces2065-1, rec2020, p3-d65, srgb, prophoto, adobe-rgb, xyz, or eight
    /// chromaticities Rx,Ry,Gx,Gy,Bx,By,Wx,Wy
    #[arg(long, default_value = "acescg", value_parser = rgb_space)]
    pub(crate) space: RgbSpace,
    /// Light: D65, D60, D55, D50, A, E, or a CSV file with the header `wavelength_nm,power`
    #[arg(long, default_value = "D65", value_name = "NAME|FILE")]
    pub(crate) illuminant: String,
    /// Observer: cie-1931-2deg, or a CSV file of color-matching functions with the header
    /// `wavelength_nm,x,y,z`
    #[arg(long, default_value = "cie-1931-2deg", value_name = "NAME|FILE")]
    pub(crate) observer: String,
    /// Chromatic adaptation from the white of the RGB space to that of the light
    #[arg(long, default_value_t, value_name = "NAME", value_parser = word::<Adaptation>())]
    pub(crate) adapt: Adaptation,
}

#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Model")]
pub(crate) struct ModelArgs {
    /// How fluorescence is described: dyes uses measured spectra, analytic uses formulas,
    /// reflectance has no fluorescence
    #[arg(long = "model", default_value_t = ModelName::Dyes, value_name = "NAME", value_parser = word::<ModelName>())]
    pub(crate) name: ModelName,
    /// Set of dyes: konig8, open8, wide14, or a folder of CSV files with the header
    /// `wavelength_nm,absorption,emission` [default: konig8]
    #[arg(long, value_name = "NAME|FOLDER")]
    pub(crate) dyes: Option<String>,
    /// Divide the absorption and the emission of each dye in the folder by their peaks, for curves in
    /// other units than fractions
    #[arg(long)]
    pub(crate) normalize_dyes: bool,
    /// What is conserved when absorbed light is re-emitted: energy, or the number of photons
    /// [default: energy]
    #[arg(long, value_name = "NAME", value_parser = word::<Accounting>())]
    pub(crate) accounting: Option<Accounting>,
    /// Whether the two dyes of a material share the light they absorb (pooled) or each re-emits its
    /// own part (separate) [default: pooled]
    #[arg(long, value_name = "NAME", value_parser = word::<Mixing>())]
    pub(crate) mixing: Option<Mixing>,
    /// Fraction of absorbed light that is re-emitted, 0 to 1; measured takes the published value of
    /// each dye [default: 1]
    #[arg(long, value_name = "Q|measured")]
    pub(crate) quantum_yield: Option<QuantumYield>,
    /// Peak optical density of the dyes, above 0 [default: that of a thin solution, whose
    /// absorption curve is used as measured]
    #[arg(long, value_name = "A", value_parser = number)]
    pub(crate) optical_density: Option<f64>,
    /// Full width at half maximum of the analytic absorption, 15 to 80 nm [default: 50]
    #[arg(long, value_name = "NM", value_parser = number)]
    pub(crate) absorption_fwhm_nm: Option<f64>,
    /// Full width at half maximum of the analytic emission, 15 to 80 nm [default: 45]
    #[arg(long, value_name = "NM", value_parser = number)]
    pub(crate) emission_fwhm_nm: Option<f64>,
}

#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Fit")]
pub(crate) struct FitArgs {
    /// Color difference to minimize: CIEDE2000, CIE 1976 or the distance in RGB
    #[arg(long, default_value_t = Metric::De2000, value_name = "NAME", value_parser = word::<Metric>())]
    pub(crate) metric: Metric,
    /// Number of nodes along each axis, 2 to 256
    #[arg(long, default_value = "32", value_name = "N", value_parser = in_range(Cube::RESOLUTIONS))]
    pub(crate) resolution: usize,
    /// Greatest slope of any reflectance, 0.0001 to 0.2 per nm, or none for no limit
    #[arg(long, default_value = "0.01", value_name = "SLOPE|none", value_parser = slope_limit)]
    pub(crate) slope_max_per_nm: SlopeLimit,
    /// How materials are searched for: search is our method and exhaustive its slow reference;
    /// konig2020 and konig2020-features are the methods of König et al. 2020, which vary
    /// coefficients or features
    #[arg(long, default_value_t, value_name = "NAME", value_parser = word::<Method>())]
    pub(crate) method: Method,
    /// How often a node that missed its color tries the materials of its neighbors [default: 2; 4
    /// for konig2020 and konig2020-features]
    #[arg(long, value_name = "N", value_parser = count::<u32>)]
    pub(crate) sweeps: Option<u32>,
    #[command(flatten)]
    pub(crate) threads: Threads,
}

/// The kinds of model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ModelName {
    Dyes,
    Analytic,
    Reflectance,
}

choices!(ModelName, "model", Dyes = "dyes", Analytic = "analytic", Reflectance = "reflectance",);
