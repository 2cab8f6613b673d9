//! The JSON header of a cube's file.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use upglow_color::{
    Adaptation, Contract, Grid, Illuminant, IlluminantError, MeasuredDye, NameError, Observer,
    ObserverError, RgbSpace, Spectrum,
};

use crate::cube::error::ReadCubeError;
use crate::cube::plain_json::PlainJson;
use crate::cube::{Cube, FitRecord};
use crate::material::analytic_model::AnalyticModel;
use crate::material::dye_model::{DyeModel, DyeOptions};
use crate::material::dye_set::DyeSet;
use crate::material::film_model::FilmModel;
use crate::material::model::Model;

/// Name of the file's only metadata entry.
pub(crate) const ENTRY: &str = "upglow";

/// Versions of the file format that this program reads. It writes the last one.
const FORMAT_VERSIONS: [u32; 3] = [1, WITH_OBSERVER, WITH_PAIRS];

/// The first version that holds color-matching functions; before, they are CIE 1931 2°.
const WITH_OBSERVER: u32 = 2;

/// The first version that holds two numbers of dyes for a node and two slope limits; before, there are
/// the first dye of a ring, and one hard limit for all reflectances.
const WITH_PAIRS: u32 = 3;

const FORMAT: &str = "upglow cube";

const NODE_AXES: &str = "[blue][green][red]; node i of n is i / (n - 1), linear";

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Header {
    pub(crate) format: String,
    pub(crate) format_version: u32,
    pub(crate) upglow_version: String,
    pub(crate) resolution: usize,
    pub(crate) axes: String,
    pub(crate) contract: ContractHeader,
    pub(crate) model: ModelHeader,
    pub(crate) fit: FitRecord,
    pub(crate) tensors: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ContractHeader {
    rgb_space: String,
    primaries_xy: [[f64; 2]; 3],
    white_xy: [f64; 2],
    illuminant: String,
    /// Where the power is known, if that is not everywhere and does not follow from the name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    illuminant_given_nm: Option<[u32; 2]>,
    observer: String,
    adaptation: String,
    fit_grid_nm: [u32; 3],
    table_grid_nm: [u32; 3],
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub(crate) enum ModelHeader {
    // With braces, so that unknown fields are refused.
    Reflectance {},
    Dyes {
        set: String,
        dyes: Vec<DyeHeader>,
        mixing: String,
        accounting: String,
        quantum_yield: String,
        optical_density: Option<f64>,
    },
    Film {
        set: String,
        dyes: Vec<DyeHeader>,
        accounting: String,
        quantum_yield: String,
    },
    Analytic {
        absorption_fwhm_nm: f64,
        emission_fwhm_nm: f64,
        accounting: String,
        quantum_yield: f64,
    },
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DyeHeader {
    name: String,
    measured_quantum_yield: Option<f64>,
    provenance: String,
}

/// The curves that the header of a cube names, each on [`Grid::FINE`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CubeCurves {
    /// Power of the illuminant.
    pub illuminant: Vec<f64>,
    /// Color-matching functions; `None` in files of version 1, which have CIE 1931 2°.
    pub observer: Option<[Vec<f64>; 3]>,
    /// Absorption and emission of each dye, in the order of the set.
    pub dyes: Vec<[Vec<f64>; 2]>,
}

const fn grid_numbers(grid: Grid) -> [u32; 3] {
    [grid.first_nm(), grid.last_nm(), grid.step_nm()]
}

impl Header {
    pub(crate) fn of(cube: &Cube, tensors: Vec<String>) -> Self {
        Self {
            format: FORMAT.into(),
            format_version: WITH_PAIRS,
            upglow_version: env!("CARGO_PKG_VERSION").into(),
            resolution: cube.resolution(),
            axes: NODE_AXES.into(),
            contract: ContractHeader::of(cube.contract()),
            model: ModelHeader::of(cube.model()),
            fit: cube.fit().clone(),
            tensors,
        }
    }

    /// Reads a header, refusing what this version does not know.
    pub(crate) fn parse(json: &str) -> Result<Self, ReadCubeError> {
        #[derive(Deserialize)]
        struct Version {
            format_version: u32,
        }
        let version: Version = serde_json::from_str(json).map_err(ReadCubeError::Header)?;
        if !FORMAT_VERSIONS.contains(&version.format_version) {
            let (found, newest) = (version.format_version, WITH_PAIRS);
            return Err(ReadCubeError::Version { found, newest });
        }
        serde_json::from_str::<PlainJson<true>>(json).map_err(ReadCubeError::Header)?;
        let header: Result<Self, _> = if version.format_version >= WITH_PAIRS {
            serde_json::from_str(json)
        } else {
            serde_json::from_value(with_one_limit(json, version.format_version)?)
        };
        let header = header.map_err(ReadCubeError::Header)?;
        ReadCubeError::check("format", header.format.as_str(), FORMAT)?;
        ReadCubeError::check("axes", header.axes.as_str(), NODE_AXES)?;
        if header.model.is_film() && !header.holds_pairs() {
            let expected = format!("another model in format version {}", header.format_version);
            return Err(ReadCubeError::Field {
                field: "model.kind",
                found: "film".into(),
                expected,
            });
        }
        Ok(header)
    }

    /// Whether the file holds color-matching functions.
    pub(crate) fn holds_observer(&self) -> bool {
        self.format_version >= WITH_OBSERVER
    }

    /// Whether the file holds two numbers of dyes for each node.
    pub(crate) fn holds_pairs(&self) -> bool {
        self.format_version >= WITH_PAIRS
    }
}

/// The header of an earlier version with the fields of `fit` that it did not have.
fn with_one_limit(json: &str, version: u32) -> Result<Value, ReadCubeError> {
    let mut header: Value = serde_json::from_str(json).map_err(ReadCubeError::Header)?;
    let Some(fit) = header.get_mut("fit").and_then(Value::as_object_mut) else {
        return Ok(header);
    };
    let limit = fit.get("slope_max_per_nm").cloned().unwrap_or_default();
    let added = [
        ("fit.preset", Value::Null),
        ("fit.slope_under_dyes_per_nm", limit),
        ("fit.relaxed", false.into()),
    ];
    for (field, value) in added {
        if let Some(found) = fit.insert(field.trim_start_matches("fit.").into(), value) {
            let expected = format!("none in format version {version}");
            return Err(ReadCubeError::Field { field, found: found.to_string(), expected });
        }
    }
    Ok(header)
}

impl ContractHeader {
    fn of(contract: &Contract) -> Self {
        Self {
            rgb_space: contract.space.name().into(),
            primaries_xy: contract.space.primaries(),
            white_xy: contract.space.white(),
            illuminant: contract.illuminant.name().into(),
            illuminant_given_nm: stated_nm(&contract.illuminant),
            observer: contract.observer.name().into(),
            adaptation: contract.adaptation.to_string(),
            fit_grid_nm: grid_numbers(Grid::FIT),
            table_grid_nm: grid_numbers(Grid::FINE),
        }
    }

    pub(crate) fn to_contract(
        &self,
        illuminant: Vec<f64>,
        observer: Option<[Vec<f64>; 3]>,
    ) -> Result<Contract, ReadCubeError> {
        let observer = self.to_observer(observer)?;
        ReadCubeError::check("fit_grid_nm", &self.fit_grid_nm, &grid_numbers(Grid::FIT))?;
        ReadCubeError::check("table_grid_nm", &self.table_grid_nm, &grid_numbers(Grid::FINE))?;
        let space = RgbSpace::custom(&self.rgb_space, self.primaries_xy, self.white_xy)
            .map_err(ReadCubeError::value("rgb_space"))?;
        let power =
            Spectrum::new(Grid::FINE, illuminant).map_err(ReadCubeError::value("illuminant"))?;
        let power = self.given_power(power)?;
        let illuminant = beside_later_names(
            &self.illuminant,
            &FIRST_LIGHTS,
            |name| Illuminant::from_spectrum(name, &power),
            |error| matches!(error, IlluminantError::Name(NameError::Taken { .. })),
        )
        .map_err(ReadCubeError::value("illuminant"))?;
        if stated_nm(&illuminant) != self.illuminant_given_nm {
            let found = format!("{:?}", self.illuminant_given_nm.unwrap_or_default());
            let expected = format!("none for the built-in {}", illuminant.name());
            return Err(ReadCubeError::Field { field: GIVEN_NM, found, expected });
        }
        let adaptation: Adaptation = parse_field("adaptation", &self.adaptation)?;
        let contract = Contract { space, illuminant, observer, adaptation };
        contract.check().map_err(ReadCubeError::value("contract"))?;
        Ok(contract)
    }

    /// The power of the light where it is known. It must be zero beyond.
    fn given_power(&self, power: Spectrum) -> Result<Spectrum, ReadCubeError> {
        let Some([first_nm, last_nm]) = self.illuminant_given_nm else { return Ok(power) };
        let grid = Grid::try_new(first_nm, last_nm, Grid::FINE.step_nm())
            .map_err(ReadCubeError::value(GIVEN_NM))?;
        let within = Grid::FINE.first_nm() <= first_nm && last_nm <= Grid::FINE.last_nm();
        let given = if within { power.resampled(grid) } else { power.clone() };
        if !within || given.resampled(Grid::FINE) != power {
            let expected = "the part of 300 to 830 nm where the light has power".into();
            let found = format!("[{first_nm}, {last_nm}]");
            return Err(ReadCubeError::Field { field: GIVEN_NM, found, expected });
        }
        Ok(given)
    }

    /// The observer of this name: built in, or with the file's color-matching functions.
    fn to_observer(&self, matching: Option<[Vec<f64>; 3]>) -> Result<Observer, ReadCubeError> {
        let Some([x, y, z]) = matching else {
            let observer = Observer::cie_1931_2deg();
            ReadCubeError::check("observer", self.observer.as_str(), observer.name())?;
            return Ok(observer);
        };
        let curve =
            |values| Spectrum::new(Grid::FINE, values).map_err(ReadCubeError::value("observer"));
        let matching = [curve(x)?, curve(y)?, curve(z)?];
        beside_later_names(
            &self.observer,
            &FIRST_OBSERVERS,
            |name| Observer::from_spectra(name, matching.clone()),
            |error| matches!(error, ObserverError::Name(NameError::Taken { .. })),
        )
        .map_err(ReadCubeError::value("observer"))
    }
}

const GIVEN_NM: &str = "illuminant_given_nm";

/// What a file states of where the power of a light is known.
fn stated_nm(light: &Illuminant) -> Option<[u32; 2]> {
    let fine_nm = [Grid::FINE.first_nm(), Grid::FINE.last_nm()];
    let is_stated = light.given_nm() != fine_nm && Illuminant::named(light.name()).is_err();
    is_stated.then(|| light.given_nm())
}

/// The lights that were built in before any file was written: no file has these names for other numbers.
const FIRST_LIGHTS: [&str; 10] =
    ["D65", "D60", "D55", "D50", "A", "E", "FL2", "FL11", "HP1", "LED-B3"];

/// The same of observers.
const FIRST_OBSERVERS: [&str; 2] = ["cie-1931-2deg", "CIE 1931 2°"];

/// What a file calls `name`. If that has become the name of something built in with other numbers since
/// the file was written, it is called "`name` (samples)".
fn beside_later_names<T, E>(
    name: &str,
    first: &[&str],
    make: impl Fn(&str) -> Result<T, E>,
    is_taken: impl Fn(&E) -> bool,
) -> Result<T, E> {
    match make(name) {
        Err(error) if is_taken(&error) && !first.iter().any(|n| n.eq_ignore_ascii_case(name)) => {
            make(&format!("{name} (samples)"))
        }
        made => made,
    }
}

impl ModelHeader {
    fn of(model: &Model) -> Self {
        match model {
            Model::Reflectance => Self::Reflectance {},
            Model::Dyes(model) => Self::of_dyes(model),
            Model::Film(model) => Self::Film {
                set: model.dyes().set().name().into(),
                dyes: DyeHeader::of_all(model.dyes()),
                accounting: model.accounting().to_string(),
                quantum_yield: model.quantum_yield().to_string(),
            },
            Model::Analytic(model) => Self::Analytic {
                absorption_fwhm_nm: model.absorption_fwhm_nm(),
                emission_fwhm_nm: model.emission_fwhm_nm(),
                accounting: model.accounting().to_string(),
                quantum_yield: model.quantum_yield(),
            },
        }
    }

    fn of_dyes(model: &DyeModel) -> Self {
        let DyeOptions { accounting, mixing, quantum_yield, optical_density } = model.options();
        Self::Dyes {
            set: model.set().name().into(),
            dyes: DyeHeader::of_all(model),
            mixing: mixing.to_string(),
            accounting: accounting.to_string(),
            quantum_yield: quantum_yield.to_string(),
            optical_density,
        }
    }

    /// How many dyes the model names.
    pub(crate) fn dye_count(&self) -> usize {
        match self {
            Self::Dyes { dyes, .. } | Self::Film { dyes, .. } => dyes.len(),
            _ => 0,
        }
    }

    /// Whether nodes name two dyes each.
    pub(crate) fn is_film(&self) -> bool {
        matches!(self, Self::Film { .. })
    }

    /// Whether nodes have numbers of fluorescence.
    pub(crate) fn is_fluorescent(&self) -> bool {
        !matches!(self, Self::Reflectance {})
    }

    pub(crate) fn to_model(&self, curves: Vec<[Vec<f64>; 2]>) -> Result<Model, ReadCubeError> {
        match self {
            Self::Reflectance {} => Ok(Model::Reflectance),
            Self::Dyes { set, dyes, mixing, accounting, quantum_yield, optical_density } => {
                let set = DyeHeader::to_set(dyes, set, curves)?;
                let options = DyeOptions {
                    accounting: parse_field("accounting", accounting)?,
                    mixing: parse_field("mixing", mixing)?,
                    quantum_yield: parse_field("quantum_yield", quantum_yield)?,
                    optical_density: *optical_density,
                };
                DyeModel::new(set, options).map(Model::Dyes).map_err(ReadCubeError::value("model"))
            }
            Self::Film { set, dyes, accounting, quantum_yield } => {
                let set = DyeHeader::to_set(dyes, set, curves)?;
                let accounting = parse_field("accounting", accounting)?;
                FilmModel::new(set, accounting, parse_field("quantum_yield", quantum_yield)?)
                    .map(Model::Film)
                    .map_err(ReadCubeError::value("model"))
            }
            Self::Analytic { absorption_fwhm_nm, emission_fwhm_nm, accounting, quantum_yield } => {
                let widths_nm = [*absorption_fwhm_nm, *emission_fwhm_nm];
                let accounting = parse_field("accounting", accounting)?;
                AnalyticModel::new(widths_nm[0], widths_nm[1], accounting, *quantum_yield)
                    .map(Model::Analytic)
                    .map_err(ReadCubeError::value("model"))
            }
        }
    }
}

impl DyeHeader {
    fn of_all(model: &DyeModel) -> Vec<Self> {
        let of = |dye: &MeasuredDye| Self {
            name: dye.name.clone(),
            measured_quantum_yield: dye.quantum_yield,
            provenance: dye.provenance.clone(),
        };
        model.set().dyes().iter().map(of).collect()
    }

    /// The set of these dyes with their curves.
    fn to_set(
        dyes: &[Self],
        name: &str,
        curves: Vec<[Vec<f64>; 2]>,
    ) -> Result<DyeSet, ReadCubeError> {
        let dyes = dyes.iter().zip(curves).map(|(dye, curves)| dye.to_dye(curves));
        let dyes = dyes.collect::<Result<Vec<_>, _>>()?;
        DyeSet::new(name, dyes).map_err(ReadCubeError::value("dyes"))
    }

    fn to_dye(&self, curves: [Vec<f64>; 2]) -> Result<MeasuredDye, ReadCubeError> {
        let [absorption, emission] = curves.map(|values| {
            Spectrum::new(Grid::FINE, values).map_err(ReadCubeError::value("dye curves"))
        });
        let dye = MeasuredDye {
            name: self.name.clone(),
            absorption: absorption?,
            emission: emission?,
            quantum_yield: self.measured_quantum_yield,
            provenance: self.provenance.clone(),
        };
        // A dye from a folder states its file. Earlier versions called it by the stem even where that is
        // a built-in dye with other numbers.
        let is_named_by_stem = self.provenance.strip_suffix(".csv") == Some(self.name.as_str());
        Ok(if is_named_by_stem { dye.named_after(Path::new(&self.provenance)) } else { dye })
    }
}

fn parse_field<T>(field: &'static str, text: &str) -> Result<T, ReadCubeError>
where
    T: std::str::FromStr,
    T::Err: std::error::Error + Send + Sync + 'static,
{
    text.parse().map_err(ReadCubeError::value(field))
}
