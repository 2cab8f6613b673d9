//! What was typed, checked and resolved: what is to be done.

use std::fmt::Display;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use upglow::{
    AnalyticModel, DyeModel, DyeOptions, DyeSet, DyeSetError, Interpolation, Model, ModelError,
    QuantumYield,
};
use upglow_color::{Contract, Illuminant, LinearRgb, Observer, RgbSpace};
use upglow_fit::{FitOptions, Fitter};
use upglow_terminal::Failure;

use crate::args::{BuildArgs, ColorArgs, ModelName};
use crate::files;

/// A cube to build.
#[derive(Clone, Debug)]
pub(crate) struct BuildPlan {
    pub(crate) contract: Contract,
    pub(crate) model: Model,
    pub(crate) options: FitOptions,
    pub(crate) resolution: usize,
    pub(crate) threads: Option<NonZeroUsize>,
    pub(crate) output: PathBuf,
}

impl BuildPlan {
    /// Checks everything that can be checked before the work starts, the output last.
    pub(crate) fn new(args: &BuildArgs) -> Result<Self, Failure> {
        let contract = Contract {
            space: space(&args.space)?,
            illuminant: light("--illuminant", &args.illuminant)?,
            observer: observer("--observer", &args.observer)?,
            adaptation: args.adapt,
        };
        check(&contract)?;
        let model = model(args)?;
        let options = FitOptions {
            metric: args.metric,
            slope_max_per_nm: args.slope_max_per_nm.0,
            sweeps: args.sweeps.unwrap_or(args.method.default_sweeps()),
            method: args.method,
        };
        Fitter::new(&contract, &model, options)
            .map_err(|error| Failure::option("--slope-max-per-nm", error))?;
        files::check_output(&args.output)?;
        Ok(Self {
            contract,
            model,
            options,
            resolution: args.resolution,
            threads: args.threads,
            output: args.output.clone(),
        })
    }
}

pub(crate) fn space(text: &str) -> Result<RgbSpace, Failure> {
    let refused = |error| Failure::option("--space", error);
    let numbers: Option<Vec<f64>> = text.split(',').map(|cell| cell.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[rx, ry, gx, gy, bx, by, wx, wy]) => {
            RgbSpace::custom("custom", [[rx, ry], [gx, gy], [bx, by]], [wx, wy]).map_err(refused)
        }
        _ => RgbSpace::named(text).map_err(refused),
    }
}

/// A light by name or file, given with `option`.
pub(crate) fn light(option: &'static str, text: &str) -> Result<Illuminant, Failure> {
    named_or_read(option, text, "power", Illuminant::named, Illuminant::from_csv)
}

/// An observer by name or file, given with `option`.
fn observer(option: &'static str, text: &str) -> Result<Observer, Failure> {
    named_or_read(option, text, "x,y,z", Observer::named, Observer::from_csv)
}

/// What a built-in name says, else the CSV file at that path, which is called like itself.
fn named_or_read<T, E: Display>(
    option: &'static str,
    text: &str,
    columns: &str,
    named: fn(&str) -> Result<T, E>,
    from_csv: fn(&str, &str) -> Result<T, E>,
) -> Result<T, Failure> {
    let path = Path::new(text);
    match named(text) {
        Err(_) if is_path(path) => {
            let expected = format!("a CSV file with the header wavelength_nm,{columns}");
            let text = files::read_text(path, &expected)?;
            let name = path.file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default();
            from_csv(&name, &text).map_err(|error| Failure::file(path, error))
        }
        named => named.map_err(|error| Failure::option(option, error)),
    }
}

/// Refuses a light that the observer does not see.
pub(crate) fn check(contract: &Contract) -> Result<(), Failure> {
    contract.check().map_err(|error| Failure::option("--illuminant", error))
}

/// Whether a word that is no built-in name is meant as a file or folder.
fn is_path(path: &Path) -> bool {
    path.exists() || path.components().count() > 1 || path.extension().is_some()
}

fn model(args: &BuildArgs) -> Result<Model, Failure> {
    refuse_what_does_not_apply(args)?;
    match args.model {
        ModelName::Reflectance => Ok(Model::Reflectance),
        ModelName::Dyes => dye_model(args).map(Model::Dyes),
        ModelName::Analytic => analytic_model(args).map(Model::Analytic),
    }
}

/// No option is ignored: one that the model does not have is an error.
fn refuse_what_does_not_apply(args: &BuildArgs) -> Result<(), Failure> {
    use ModelName::{Analytic, Dyes};
    let options: [(&'static str, bool, &[ModelName]); 7] = [
        ("--dyes", args.dyes.is_some(), &[Dyes]),
        ("--mixing", args.mixing.is_some(), &[Dyes]),
        ("--optical-density", args.optical_density.is_some(), &[Dyes]),
        ("--accounting", args.accounting.is_some(), &[Dyes, Analytic]),
        ("--quantum-yield", args.quantum_yield.is_some(), &[Dyes, Analytic]),
        ("--absorption-fwhm-nm", args.absorption_fwhm_nm.is_some(), &[Analytic]),
        ("--emission-fwhm-nm", args.emission_fwhm_nm.is_some(), &[Analytic]),
    ];
    for (option, given, models) in options {
        if given && !models.contains(&args.model) {
            let names: Vec<&str> = models.iter().map(|model| model.name()).collect();
            let (found, expected) = (args.model.name(), names.join(" or "));
            return Err(Failure::option(
                option,
                format_args!("given with --model {found}, expected --model {expected}"),
            ));
        }
    }
    Ok(())
}

fn dye_model(args: &BuildArgs) -> Result<DyeModel, Failure> {
    let set = dye_set(args.dyes.as_deref().unwrap_or("seed8"))?;
    let defaults = DyeOptions::default();
    let options = DyeOptions {
        accounting: args.accounting.unwrap_or(defaults.accounting),
        mixing: args.mixing.unwrap_or(defaults.mixing),
        quantum_yield: args.quantum_yield.unwrap_or(defaults.quantum_yield),
        optical_density: args.optical_density,
    };
    DyeModel::new(set, options).map_err(model_failure)
}

fn dye_set(text: &str) -> Result<DyeSet, Failure> {
    let path = Path::new(text);
    match DyeSet::named(text) {
        Err(DyeSetError::Unknown { .. }) if is_path(path) => {
            DyeSet::from_folder(path).map_err(|error| folder_failure(path, error))
        }
        named => named.map_err(|error| Failure::option("--dyes", error)),
    }
}

/// Names the file in the folder that is at fault.
fn folder_failure(folder: &Path, error: DyeSetError) -> Failure {
    match error {
        DyeSetError::Read { path, source } => {
            let found = upglow_terminal::io_message(&source);
            Failure::file(&path, format_args!("{found}, expected a folder of CSV files"))
        }
        DyeSetError::Csv { path, source } => Failure::file(&path, source),
        DyeSetError::QuantumYield { path, dye, found } => Failure::file(
            &path,
            format_args!(
                "quantum yield {found:?} of {dye}, expected a number from 0 to 1 or nothing"
            ),
        ),
        error => Failure::file(folder, error),
    }
}

fn analytic_model(args: &BuildArgs) -> Result<AnalyticModel, Failure> {
    let defaults = AnalyticModel::default();
    let quantum_yield = match args.quantum_yield {
        None => defaults.quantum_yield(),
        Some(QuantumYield::Fixed(quantum_yield)) => quantum_yield,
        Some(QuantumYield::Measured) => {
            let message = "measured with --model analytic, expected a number from 0 to 1";
            return Err(Failure::option("--quantum-yield", message));
        }
    };
    // One width at a time, so that the message names the option.
    let absorption_fwhm_nm = args.absorption_fwhm_nm.unwrap_or(defaults.absorption_fwhm_nm());
    let emission_fwhm_nm = args.emission_fwhm_nm.unwrap_or(defaults.emission_fwhm_nm());
    let accounting = args.accounting.unwrap_or(defaults.accounting());
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

/// A color to show.
#[derive(Clone, Debug)]
pub(crate) struct ColorPlan {
    pub(crate) file: PathBuf,
    pub(crate) rgb: LinearRgb,
    pub(crate) way: Way,
    pub(crate) plot: Option<PathBuf>,
    pub(crate) plot_terminal: bool,
}

/// How a color gets its material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    Lookup(Interpolation),
    Direct,
}

impl ColorPlan {
    pub(crate) fn new(args: &ColorArgs) -> Result<Self, Failure> {
        let way = match args.direct {
            true => Way::Direct,
            false => Way::Lookup(args.interpolation.unwrap_or_default()),
        };
        let channels = [("R", &args.red), ("G", &args.green), ("B", &args.blue)];
        let mut rgb = [0.0; 3];
        for (value, (channel, text)) in rgb.iter_mut().zip(channels) {
            *value = component(channel, text, way)?;
        }
        if let Some(plot) = &args.plot {
            files::check_output(plot)?;
            files::check_distinct(&args.file, plot)?;
        }
        Ok(Self {
            file: args.file.clone(),
            rgb: LinearRgb(rgb),
            way,
            plot: args.plot.clone(),
            plot_terminal: args.plot_terminal,
        })
    }
}

/// One component of a color, in the range that the way to its material allows.
fn component(channel: &str, text: &str, way: Way) -> Result<f64, Failure> {
    let brightest = Fitter::BRIGHTEST;
    let most = match way {
        Way::Lookup(_) => 1.0,
        Way::Direct => brightest,
    };
    match text.trim().parse::<f64>() {
        Ok(value) if (0.0..=most).contains(&value) => Ok(value),
        Ok(value) if (0.0..=brightest).contains(&value) => Err(Failure::input(
            channel,
            format_args!(
                "{text} is beyond the cube, expected 0 to 1, or --direct, which fits colors up to {brightest}"
            ),
        )),
        Ok(_) => Err(Failure::input(channel, format_args!("{text}, expected 0 to {most}"))),
        Err(_) => Err(Failure::input(
            channel,
            format_args!("{text:?}, expected a number from 0 to {most}"),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(result: Result<f64, Failure>) -> String {
        match result.unwrap_err() {
            Failure::Input(line) | Failure::Usage(line) => line.to_string(),
            other => format!("{other:?}"),
        }
    }

    #[test]
    fn components_are_numbers_in_range() {
        let lookup = Way::Lookup(Interpolation::Blend);
        assert_eq!(component("R", "0.5", lookup), Ok(0.5));
        assert_eq!(component("R", "1.58", Way::Direct), Ok(1.58));
        assert_eq!(message(component("G", "-0.5", lookup)), "G: -0.5, expected 0 to 1");
        assert_eq!(message(component("G", "NaN", lookup)), "G: NaN, expected 0 to 1");
        assert_eq!(message(component("G", "inf", Way::Direct)), "G: inf, expected 0 to 10");
        assert_eq!(
            message(component("B", "blue", lookup)),
            "B: \"blue\", expected a number from 0 to 1"
        );
        assert_eq!(
            message(component("B", "1.58", lookup)),
            "B: 1.58 is beyond the cube, expected 0 to 1, or --direct, which fits colors up to 10"
        );
    }

    #[test]
    fn eight_numbers_are_a_space() {
        let custom = space("0.64,0.33,0.30,0.60,0.15,0.06,0.3127,0.3290");
        assert!(custom.is_ok_and(|space| space.name() == "custom"));
        assert!(space("rec709").is_err());
        assert!(space("0.64,0.33").is_err());
    }

    #[test]
    fn words_with_a_folder_or_suffix_are_paths() {
        assert!(is_path(Path::new("lamps/f11")) && is_path(Path::new("f11.csv")));
        assert!(!is_path(Path::new("F11")));
    }
}
