//! The options of `upglow build`.

use std::path::PathBuf;

use upglow::{Accounting, Cube, Mixing, Model, QuantumYield};
use upglow_color::{Adaptation, Choice, Metric, RgbSpace, choices};
use upglow_fit::{FitOptions, Method, Preset};
use upglow_terminal::{Threads, count, in_range, number, word};

use super::LightArgs;
use super::values::{SlopeLimit, lights, observers, rgb_space, slope_limit};

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
    #[arg(
        long,
        visible_alias = "light",
        default_value = "D65",
        value_name = "NAME|FILE",
        help = format!("Light: {}", lights())
    )]
    pub(crate) illuminant: String,
    #[command(flatten)]
    pub(crate) light: LightArgs,
    #[arg(
        long,
        default_value = "cie-1931-2deg",
        value_name = "NAME|FILE",
        help = format!("Observer: {}", observers())
    )]
    pub(crate) observer: String,
    /// Chromatic adaptation from the white of the RGB space to that of the light
    #[arg(long, default_value_t, value_name = "NAME", value_parser = word::<Adaptation>())]
    pub(crate) adapt: Adaptation,
}

#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Model")]
pub(crate) struct ModelArgs {
    /// Model and options of the fit by one word; the options below override them. natural: films of
    /// dyes that conserve photons, over reflectances no steeper than those of measured surfaces;
    /// konig2020, jung2019 and jakob2019: the models of these papers
    #[arg(long, default_value_t, value_name = "NAME", value_parser = word::<Preset>())]
    pub(crate) preset: Preset,
    /// How fluorescence is described: film is any two dyes of a set, each at an optical density of its
    /// own, dyes is two neighbors of a ring of dyes, analytic uses formulas, reflectance has no
    /// fluorescence [default: that of the preset]
    #[arg(long = "model", value_name = "NAME", value_parser = word::<ModelName>())]
    pub(crate) name: Option<ModelName>,
    /// Set of dyes: wide8, konig8, open8, wide14, or a folder of CSV files with the header
    /// `wavelength_nm,absorption,emission` [default: that of the preset, or konig8]
    #[arg(long, value_name = "NAME|FOLDER")]
    pub(crate) dyes: Option<String>,
    /// Divide the absorption and the emission of each dye in the folder by their peaks, for curves in
    /// other units than fractions
    #[arg(long)]
    pub(crate) normalize_dyes: bool,
    /// What is conserved when absorbed light is re-emitted: energy, or the number of photons
    /// [default: that of the preset]
    #[arg(long, value_name = "NAME", value_parser = word::<Accounting>())]
    pub(crate) accounting: Option<Accounting>,
    /// Whether the two dyes of a material share the light they absorb (pooled) or each re-emits its
    /// own part (separate) [default: pooled]
    #[arg(long, value_name = "NAME", value_parser = word::<Mixing>())]
    pub(crate) mixing: Option<Mixing>,
    /// Fraction of absorbed light that is re-emitted, 0 to 1; measured takes the published value of
    /// each dye [default: that of the preset, 1]
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
    /// Color difference to minimize: CIEDE2000, CIE 1976 or the distance in RGB [default: de2000]
    #[arg(long, value_name = "NAME", value_parser = word::<Metric>())]
    pub(crate) metric: Option<Metric>,
    /// Number of nodes along each axis, 2 to 256
    #[arg(long, default_value = "32", value_name = "N", value_parser = in_range(Cube::RESOLUTIONS))]
    pub(crate) resolution: usize,
    #[arg(long, value_name = "SLOPE|none", value_parser = slope_limit, help = slope_max_help())]
    pub(crate) slope_max_per_nm: Option<SlopeLimit>,
    #[arg(long, value_name = "SLOPE|none", value_parser = slope_limit, help = slope_under_dyes_help())]
    pub(crate) slope_under_dyes_per_nm: Option<SlopeLimit>,
    #[arg(long, value_name = "NAME", value_parser = word::<SlopeLimits>(), help = slope_limits_help())]
    pub(crate) slope_limits: Option<SlopeLimits>,
    /// How materials are searched for: search is our method and exhaustive its slow reference;
    /// konig2020 and konig2020-features are the methods of König et al. 2020, which vary
    /// coefficients or features [default: search]
    #[arg(long, value_name = "NAME", value_parser = word::<Method>())]
    pub(crate) method: Option<Method>,
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
    Film,
    Dyes,
    Analytic,
    Reflectance,
}

choices!(
    ModelName,
    "model",
    Film = "film",
    Dyes = "dyes",
    Analytic = "analytic",
    Reflectance = "reflectance",
);

impl From<&Model> for ModelName {
    fn from(model: &Model) -> Self {
        match model {
            Model::Film(_) => Self::Film,
            Model::Dyes(_) => Self::Dyes,
            Model::Analytic(_) => Self::Analytic,
            Model::Reflectance => Self::Reflectance,
        }
    }
}

/// Whether the slope limits hold for every color.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SlopeLimits {
    Hard,
    Relaxed,
}

choices!(SlopeLimits, "kind of slope limits", Hard = "hard", Relaxed = "relaxed",);

fn slope_max_help() -> String {
    let limit = |options: &FitOptions| limit_text(options.slope_max_per_nm);
    "Greatest slope of a reflectance without fluorescence, 0.0001 to 0.2 per nm, or none for 0.2; a \
     color that such a reflectance matches gets no dye"
        .to_owned()
        + &by_preset(limit)
}

fn slope_under_dyes_help() -> String {
    let limit = |options: &FitOptions| limit_text(options.slope_under_dyes_per_nm);
    "Greatest slope of a reflectance under fluorescence, at most --slope-max-per-nm, which it follows \
     where the preset has one limit for both"
        .to_owned()
        + &by_preset(limit)
}

fn slope_limits_help() -> String {
    let word = |options: &FitOptions| {
        let limits = if options.relaxed { SlopeLimits::Relaxed } else { SlopeLimits::Hard };
        limits.to_string()
    };
    "Whether the slope limits hold for every color (hard), or a color that nothing within them matches \
     gets a steeper reflectance (relaxed)"
        .to_owned()
        + &by_preset(word)
}

/// A slope limit in words.
pub(crate) fn limit_text(limit: Option<f64>) -> String {
    limit.map_or("none".into(), |limit| limit.to_string())
}

/// The default of an option by preset.
fn by_preset(value: impl Fn(&FitOptions) -> String) -> String {
    let of = |preset: &Preset| format!("{preset}: {}", value(&preset.options()));
    let values: Vec<String> = Preset::ALL.iter().map(of).collect();
    format!(" [default by preset: {}]", values.join(", "))
}
