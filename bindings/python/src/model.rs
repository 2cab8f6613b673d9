//! Models: what fluoresces.

use std::path::PathBuf;

use pyo3::prelude::*;
use upglow::{
    Accounting, AnalyticModel, DyeModel, DyeOptions, DyeSetError, FilmModel, Mixing, QuantumYield,
};
use upglow_color::MeasuredDye;
use upglow_fit::Preset;

use crate::errors::{os_error, value_error};
use crate::illuminant::Illuminant;
use crate::word::Word;

/// A ring of measured dyes.
#[pyclass(frozen, module = "upglow._upglow")]
#[derive(Debug)]
pub(crate) struct DyeSet(upglow::DyeSet);

impl DyeSet {
    /// The dyes, in ring order.
    pub(crate) fn dyes_of_set(&self) -> Vec<MeasuredDye> {
        self.0.dyes().to_vec()
    }
}

/// A dye as Python gives it: name, wavelengths (nm), absorption, emission, quantum yield.
type Sampled = (String, Vec<f64>, Vec<f64>, Vec<f64>, Option<f64>);

#[pymethods]
impl DyeSet {
    /// The names of the built-in sets.
    #[staticmethod]
    fn names() -> Vec<&'static str> {
        MeasuredDye::set_names().collect()
    }

    /// The built-in set of this name.
    #[staticmethod]
    fn named(name: &str) -> PyResult<Self> {
        upglow::DyeSet::named(name).map(Self).map_err(|error| set_error(&error))
    }

    /// The dyes in a folder of CSV files; with `normalize`, curves are divided by their peaks.
    #[staticmethod]
    fn from_folder(path: PathBuf, normalize: bool) -> PyResult<Self> {
        let set = if normalize {
            upglow::DyeSet::from_folder_normalized(&path)
        } else {
            upglow::DyeSet::from_folder(&path)
        };
        set.map(Self).map_err(|error| set_error(&error))
    }

    /// A ring of sampled dyes, in their order; with `normalize`, curves are divided by their peaks.
    #[staticmethod]
    fn from_samples(name: &str, dyes: Vec<Sampled>, normalize: bool) -> PyResult<Self> {
        let scaled = |dye: MeasuredDye| if normalize { dye.normalized() } else { dye };
        let dyes =
            dyes.into_iter().map(|dye| measured(dye).map(scaled)).collect::<PyResult<_>>()?;
        upglow::DyeSet::new(name, dyes).map(Self).map_err(|error| set_error(&error))
    }

    /// The name that files state.
    #[getter]
    fn name(&self) -> &str {
        self.0.name()
    }

    /// The dyes' names in ring order.
    #[getter]
    fn dyes(&self) -> Vec<String> {
        self.0.dyes().iter().map(|dye| dye.name.clone()).collect()
    }
}

fn measured((name, nm, absorption, emission, quantum_yield): Sampled) -> PyResult<MeasuredDye> {
    let dye = MeasuredDye::from_samples(&name, &nm, &absorption, &emission)
        .map_err(|error| value_error(format_args!("dye {name}: {error}")))?;
    Ok(MeasuredDye { quantum_yield, provenance: "given in Python".to_owned(), ..dye })
}

fn set_error(error: &DyeSetError) -> PyErr {
    match error {
        DyeSetError::Read { path, cause } => os_error(path, cause),
        error => value_error(error),
    }
}

/// How fluorescence is described, and the rules of re-emission.
#[pyclass(frozen, module = "upglow._upglow")]
#[derive(Debug)]
pub(crate) struct Model(pub(crate) upglow::Model);

/// A quantum yield, as Python gives it.
#[derive(FromPyObject)]
enum Yield {
    Number(f64),
    Word(String),
}

impl Yield {
    fn resolved(self) -> PyResult<QuantumYield> {
        match self {
            Self::Number(q) => Ok(QuantumYield::Fixed(q)),
            Self::Word(word) => word.parse().map_err(value_error),
        }
    }
}

#[pymethods]
impl Model {
    /// No fluorescence.
    #[staticmethod]
    fn reflectance() -> Self {
        Self(upglow::Model::Reflectance)
    }

    /// That of a preset.
    #[staticmethod]
    fn of_preset(preset: Word<Preset>) -> Self {
        Self(preset.0.model())
    }

    /// Absorption and emission by formula; widths are nm.
    #[staticmethod]
    fn analytic(
        absorption_fwhm_nm: f64,
        emission_fwhm_nm: f64,
        accounting: Word<Accounting>,
        quantum_yield: f64,
    ) -> PyResult<Self> {
        AnalyticModel::new(absorption_fwhm_nm, emission_fwhm_nm, accounting.0, quantum_yield)
            .map(|model| Self(upglow::Model::Analytic(model)))
            .map_err(value_error)
    }

    /// Neighbors of a ring of measured dyes.
    #[staticmethod]
    fn dyes(
        set: &DyeSet,
        accounting: Word<Accounting>,
        mixing: Word<Mixing>,
        quantum_yield: Yield,
        optical_density: Option<f64>,
    ) -> PyResult<Self> {
        let options = DyeOptions {
            accounting: accounting.0,
            mixing: mixing.0,
            quantum_yield: quantum_yield.resolved()?,
            optical_density,
        };
        let model = DyeModel::new(set.0.clone(), options).map_err(value_error)?;
        Ok(Self(upglow::Model::Dyes(model)))
    }

    /// Any two of a set of measured dyes in a film.
    #[staticmethod]
    fn film(set: &DyeSet, accounting: Word<Accounting>, quantum_yield: Yield) -> PyResult<Self> {
        FilmModel::new(set.0.clone(), accounting.0, quantum_yield.resolved()?)
            .map(|model| Self(upglow::Model::Film(model)))
            .map_err(value_error)
    }

    /// `reflectance`, `dyes`, `film` or `analytic`.
    #[getter]
    fn name(&self) -> &'static str {
        self.0.name()
    }

    /// What is to say about its materials under a light.
    fn missing_ultraviolet(&self, light: &Illuminant) -> Option<String> {
        self.0.missing_ultraviolet(&light.0).map(|missing| missing.to_string())
    }

    /// Dyes without a published quantum yield; with `measured`, their yield is taken as 1.
    #[getter]
    fn without_published_yield(&self) -> Vec<String> {
        let without = self.0.dyes().map(DyeModel::without_published_yield).unwrap_or_default();
        without.into_iter().map(str::to_owned).collect()
    }
}
