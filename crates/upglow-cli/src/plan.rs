//! Checks the options and turns them into values of the libraries.

use std::error::Error;
use std::ffi::OsStr;
use std::path::Path;

use upglow::{
    AnalyticModel, DyeModel, DyeOptions, DyeSet, DyeSetError, FilmModel, Model, ModelError,
    QuantumYield,
};
use upglow_color::{Choice, Contract, Illuminant, LinearRgb, MeasuredDye, Observer};
use upglow_fit::{FitOptions, FitOptionsError, Fitter, GivenOptions, Preset};
use upglow_terminal::Failure;

use crate::args::{BuildArgs, ContractArgs, FitArgs, LightArgs, ModelArgs, ModelName, SlopeLimits};
use crate::files;

/// A cube to build.
#[derive(Clone, Debug)]
pub(crate) struct BuildPlan {
    pub(crate) contract: Contract,
    pub(crate) model: Model,
    pub(crate) options: FitOptions,
}

impl BuildPlan {
    /// Checks everything that can be checked before the work starts; the output last.
    pub(crate) fn new(args: &BuildArgs) -> Result<Self, Failure> {
        let plan = Self::without_output(args)?;
        files::check_ending(&args.output, files::CUBE)?;
        files::check_output(&args.output)?;
        Ok(plan)
    }

    /// Checks everything but the output.
    pub(crate) fn without_output(args: &BuildArgs) -> Result<Self, Failure> {
        let contract = contract(&args.contract)?;
        let model = model(args)?;
        let options = options(args.model.preset, &args.fit);
        options.check(&model).map_err(|error| options_failure(error, &options))?;
        Ok(Self { contract, model, options })
    }
}

/// The options of the preset, with those that were given in their place.
fn options(preset: Preset, args: &FitArgs) -> FitOptions {
    preset.options().with(GivenOptions {
        metric: args.metric,
        slope_max_per_nm: args.slope_max_per_nm,
        slope_under_dyes_per_nm: args.slope_under_dyes_per_nm,
        relaxed: args.slope_limits.map(|kind| kind == SlopeLimits::Relaxed),
        sweeps: args.sweeps,
        method: args.method,
    })
}

/// Names the option that the options of a fit are refused for.
pub(crate) fn options_failure(error: FitOptionsError, options: &FitOptions) -> Failure {
    // By its bits, because NaN equals nothing.
    let is_alone = |found: f64| options.slope_max_per_nm.map(f64::to_bits) == Some(found.to_bits());
    let option = match error {
        FitOptionsError::Slope { found } if is_alone(found) => "--slope-max-per-nm",
        FitOptionsError::Slope { .. } | FitOptionsError::UnderDyes { .. } => {
            "--slope-under-dyes-per-nm"
        }
        FitOptionsError::PaperModel { .. } | FitOptionsError::PaperLimits { .. } => "--method",
        _ => "build",
    };
    Failure::option(option, error)
}

fn contract(args: &ContractArgs) -> Result<Contract, Failure> {
    checked(Contract {
        space: args.space.clone(),
        illuminant: light("--illuminant", &args.illuminant, &args.light)?,
        observer: observer(&args.observer)?,
        adaptation: args.adapt,
    })
}

/// Returns an error if the observer does not see the light.
pub(crate) fn checked(contract: Contract) -> Result<Contract, Failure> {
    let is_named = Illuminant::named(contract.illuminant.name()).is_ok();
    let option = if is_named { "--observer" } else { "--illuminant" };
    contract.check().map_err(|error| Failure::option(option, error))?;
    Ok(contract)
}

/// The observer of a name or file, given with `--observer`.
pub(crate) fn observer(text: &str) -> Result<Observer, Failure> {
    named_or_read("--observer", text, "x,y,z", Observer::named, |path, text| {
        Observer::from_csv_file(path, text).map_err(|error| Failure::file(path, error))
    })
}

/// The lights to see a material under besides the cube's own: those that were given with `--light`, or standard
/// lights and an ultraviolet lamp.
pub(crate) fn lights_to_see(
    texts: &[String],
    args: &LightArgs,
) -> Result<Vec<Illuminant>, Failure> {
    let given = lights("--light", texts, args)?;
    if given.is_empty() {
        let standard = LIGHTS.iter().filter_map(|name| Illuminant::named(name).ok());
        return Ok(standard.chain([Illuminant::mineral_lamp()]).collect());
    }
    Ok(given)
}

/// The standard lights.
const LIGHTS: [&str; 3] = ["D65", "A", "E"];

/// The light of a name or file, given with `option`.
pub(crate) fn light(option: &str, text: &str, args: &LightArgs) -> Result<Illuminant, Failure> {
    let mut lights = lights(option, &[text], args)?;
    Ok(lights.remove(0))
}

/// The lights of names or files, given with `option`.
pub(crate) fn lights(
    option: &str,
    texts: &[impl AsRef<str>],
    args: &LightArgs,
) -> Result<Vec<Illuminant>, Failure> {
    let is_built_in = |text: &str| Illuminant::named(text).is_ok();
    if args.ends.is_some() && texts.iter().all(|text| is_built_in(text.as_ref())) {
        let message =
            format!("given without a light from a file, expected {option} with a CSV file");
        return Err(Failure::option("--light-ends", message));
    }
    let read = |path: &Path, text: &str| {
        Illuminant::from_csv_file(path, text, args.ends).map_err(|error| {
            let has_choice = args.ends.is_none() && error.lacks_ends();
            let hint = "; --light-ends zero or hold says what is beyond";
            Failure::file(path, error).with(if has_choice { hint } else { "" })
        })
    };
    let light =
        |text: &_| named_or_read(option, AsRef::as_ref(text), "power", Illuminant::named, read);
    texts.iter().map(light).collect()
}

/// The built-in value of this name, or that of the CSV file at this path, named after the file.
fn named_or_read<T, E: Error + Send + Sync + 'static>(
    option: &str,
    text: &str,
    columns: &str,
    named: fn(&str) -> Result<T, E>,
    from_csv_file: impl Fn(&Path, &str) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let path = Path::new(text);
    match named(text) {
        Err(_) if is_path(path) => {
            let expected = format!("a CSV file with the header wavelength_nm,{columns}");
            let text = files::read_text(path, &expected)?;
            from_csv_file(path, &text)
        }
        named => named.map_err(|error| Failure::option(option, error)),
    }
}

/// Whether a word that is no built-in name looks like a path. `FL3.16` and `500.5K` do not.
fn is_path(path: &Path) -> bool {
    let has_letter_first = |suffix: &str| suffix.starts_with(char::is_alphabetic);
    let suffix = path.extension().and_then(OsStr::to_str);
    path.exists() || path.components().count() > 1 || suffix.is_some_and(has_letter_first)
}

/// Returns an error for an option that was given but would be ignored, because it does not apply to
/// what the option `chooser` chose. Each option comes with whether it was given, and its choices.
pub(crate) fn refuse_ignored<T: Choice + PartialEq>(
    chooser: &str,
    chosen: T,
    options: &[(&str, bool, &[T])],
) -> Result<(), Failure> {
    let ignored = |(_, given, choices): &&(&str, bool, &[T])| *given && !choices.contains(&chosen);
    let Some((option, _, choices)) = options.iter().find(ignored) else { return Ok(()) };
    let (found, expected) = (chosen.name(), T::words(choices));
    let message = format!("given with {chooser} {found}, expected {chooser} {expected}");
    Err(Failure::option(option, message))
}

fn model(args: &BuildArgs) -> Result<Model, Failure> {
    use ModelName::{Analytic, Dyes, Film};
    let BuildArgs { model: args, fit, .. } = args;
    let preset = args.preset.model();
    let name = args.name.unwrap_or(ModelName::from(&preset));
    let under_dyes = fit.slope_under_dyes_per_nm.is_some();
    let options: [(&str, bool, &[ModelName]); 9] = [
        ("--dyes", args.dyes.is_some(), &[Film, Dyes]),
        ("--normalize-dyes", args.normalize_dyes, &[Film, Dyes]),
        ("--mixing", args.mixing.is_some(), &[Dyes]),
        ("--optical-density", args.optical_density.is_some(), &[Dyes]),
        ("--accounting", args.accounting.is_some(), &[Film, Dyes, Analytic]),
        ("--quantum-yield", args.quantum_yield.is_some(), &[Film, Dyes, Analytic]),
        ("--slope-under-dyes-per-nm", under_dyes, &[Film, Dyes, Analytic]),
        ("--absorption-fwhm-nm", args.absorption_fwhm_nm.is_some(), &[Analytic]),
        ("--emission-fwhm-nm", args.emission_fwhm_nm.is_some(), &[Analytic]),
    ];
    refuse_ignored("--model", name, &options)?;
    match name {
        ModelName::Reflectance => Ok(Model::Reflectance),
        ModelName::Film => film_model(args, &preset).map(Model::Film),
        ModelName::Dyes => dye_model(args, &preset).map(Model::Dyes),
        ModelName::Analytic => analytic_model(args, &preset).map(Model::Analytic),
    }
}

fn film_model(args: &ModelArgs, preset: &Model) -> Result<FilmModel, Failure> {
    let DyeOptions { accounting, quantum_yield, .. } = rules(args, preset);
    FilmModel::new(dye_set(args, preset)?, accounting, quantum_yield).map_err(model_failure)
}

fn dye_model(args: &ModelArgs, preset: &Model) -> Result<DyeModel, Failure> {
    let set = dye_set(args, preset)?;
    DyeModel::new(set, rules(args, preset)).map_err(model_failure)
}

/// The rules of re-emission: those that were given, or else those of the preset.
fn rules(args: &ModelArgs, preset: &Model) -> DyeOptions {
    let ring = match preset {
        Model::Dyes(ring) => ring.options(),
        _ => DyeOptions::default(),
    };
    let accounting = args.accounting.or(preset.accounting());
    let quantum_yield = args.quantum_yield.or(preset.quantum_yield());
    DyeOptions {
        accounting: accounting.unwrap_or(ring.accounting),
        mixing: args.mixing.unwrap_or(ring.mixing),
        quantum_yield: quantum_yield.unwrap_or(ring.quantum_yield),
        optical_density: args.optical_density.or(ring.optical_density),
    }
}

/// The dyes that were given, or else those of the preset, or else those of the paper.
fn dye_set(args: &ModelArgs, preset: &Model) -> Result<DyeSet, Failure> {
    if let Some(text) = &args.dyes {
        return named_or_folder(text, args.normalize_dyes);
    }
    if args.normalize_dyes {
        return Err(not_normalized("without --dyes"));
    }
    let paper = Preset::Konig2020.model();
    let dyes = preset.dyes().or(paper.dyes()).expect("the paper's model has dyes");
    Ok(dyes.set().clone())
}

fn named_or_folder(text: &str, normalize: bool) -> Result<DyeSet, Failure> {
    let path = Path::new(text);
    match DyeSet::named(text) {
        Err(DyeSetError::Unknown { .. }) if is_path(path) => {
            let entries = path.read_dir().into_iter().flatten().flatten();
            entries.map(|entry| entry.path()).try_for_each(|file| files::note_input(&file))?;
            let set = if normalize {
                DyeSet::from_folder_normalized(path)
            } else {
                DyeSet::from_folder(path)
            };
            set.map_err(|error| folder_failure(path, error))
        }
        Ok(_) if normalize => Err(not_normalized(&format!("with --dyes {text}"))),
        named => named.map_err(|error| Failure::option("--dyes", error)),
    }
}

/// The dyes of a set or folder, given with `--dyes` of `fit-matrix`.
pub(crate) fn matrix_dyes(text: &str) -> Result<Vec<MeasuredDye>, Failure> {
    named_or_folder(text, false).map(|set| set.dyes().to_vec())
}

/// Only the curves of files may be in other units than fractions.
fn not_normalized(found: &str) -> Failure {
    let message = format!("given {found}, expected --dyes with a folder of CSV files");
    Failure::option("--normalize-dyes", message)
}

/// Names the invalid file in the folder.
fn folder_failure(folder: &Path, error: DyeSetError) -> Failure {
    match error {
        DyeSetError::Read { path, cause } => {
            Failure::system(&path, &cause, "a folder of CSV files")
        }
        DyeSetError::Csv { path, cause } => Failure::file(&path, cause),
        DyeSetError::List { path, problem } => Failure::file(&path, problem),
        error => Failure::file(folder, error),
    }
}

fn analytic_model(args: &ModelArgs, preset: &Model) -> Result<AnalyticModel, Failure> {
    let defaults = match preset {
        Model::Analytic(bells) => *bells,
        _ => AnalyticModel::default(),
    };
    let DyeOptions { accounting, quantum_yield, .. } = rules(args, preset);
    let quantum_yield = match quantum_yield {
        QuantumYield::Fixed(quantum_yield) => quantum_yield,
        QuantumYield::Measured => {
            let message = "measured with --model analytic, expected a number from 0 to 1";
            return Err(Failure::option("--quantum-yield", message));
        }
    };
    // One width at a time, so that the message names the option.
    let absorption_fwhm_nm = args.absorption_fwhm_nm.unwrap_or(defaults.absorption_fwhm_nm());
    let emission_fwhm_nm = args.emission_fwhm_nm.unwrap_or(defaults.emission_fwhm_nm());
    let new = |absorption_fwhm_nm, emission_fwhm_nm| {
        AnalyticModel::new(absorption_fwhm_nm, emission_fwhm_nm, accounting, quantum_yield)
    };
    new(absorption_fwhm_nm, defaults.emission_fwhm_nm()).map_err(|error| match error {
        ModelError::Width { .. } => Failure::option("--absorption-fwhm-nm", error),
        error => model_failure(error),
    })?;
    new(absorption_fwhm_nm, emission_fwhm_nm).map_err(model_failure)
}

fn model_failure(error: ModelError) -> Failure {
    let option = match error {
        ModelError::QuantumYield { .. } => "--quantum-yield",
        ModelError::OpticalDensity { .. } => "--optical-density",
        ModelError::Width { .. } => "--emission-fwhm-nm",
        _ => "--model",
    };
    Failure::option(option, error)
}

/// The color on the command line, in the range of a look-up or of a direct fit.
pub(crate) fn color(texts: [&str; 3], direct: bool) -> Result<LinearRgb, Failure> {
    let mut rgb = [0.0; 3];
    for ((value, text), channel) in rgb.iter_mut().zip(texts).zip(["R", "G", "B"]) {
        *value = component(text, direct).map_err(|fault| Failure::input(channel, fault))?;
    }
    Ok(LinearRgb(rgb))
}

/// One component of a color, or what is wrong with it.
pub(crate) fn component(text: &str, direct: bool) -> Result<f64, String> {
    let brightest = Fitter::BRIGHTEST;
    let most = if direct { brightest } else { 1.0 };
    Err(match text.trim().parse::<f64>() {
        Ok(value) if (0.0..=most).contains(&value) => return Ok(value),
        Ok(value) if (0.0..=brightest).contains(&value) => format!(
            "{text} is beyond the cube, expected 0 to 1, or --direct, which fits colors up to {brightest}"
        ),
        Ok(_) => format!("{text}, expected 0 to {most}"),
        Err(_) => format!("{text:?}, expected a number from 0 to {most}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_out_of_range_are_refused() {
        assert_eq!(component("0.5", false), Ok(0.5));
        assert_eq!(component("1.58", true), Ok(1.58));
        for (text, direct, fault) in [
            ("-0.5", false, "-0.5, expected 0 to 1"),
            ("NaN", false, "NaN, expected 0 to 1"),
            ("inf", true, "inf, expected 0 to 10"),
            ("blue", false, "\"blue\", expected a number from 0 to 1"),
            (
                "1.58",
                false,
                "1.58 is beyond the cube, expected 0 to 1, or --direct, which fits colors up to 10",
            ),
        ] {
            assert_eq!(component(text, direct), Err(fault.into()));
        }
        let refused = color(["0", "-1", "0"], false);
        assert_eq!(refused, Err(Failure::Input("G: -1, expected 0 to 1".into())));
    }

    #[test]
    fn words_with_a_folder_or_suffix_are_paths() {
        assert!(is_path(Path::new("lamps/f11")) && is_path(Path::new("f11.csv")));
        assert!(!is_path(Path::new("F11")));
    }
}
