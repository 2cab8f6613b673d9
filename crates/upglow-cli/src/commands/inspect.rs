//! `upglow inspect`: what a cube is made of.

use serde::Serialize;
use upglow::{AnalyticModel, Cube, DyeModel, Model};
use upglow_terminal::{Failure, io_message};

use super::inspect_table;
use super::summary::SummaryReport;
use crate::args::InspectArgs;
use crate::files;
use crate::output::{Format, Lines, Report, Side, Table};

#[derive(Clone, Debug, Serialize)]
struct InspectReport {
    file: String,
    bytes: u64,
    resolution: usize,
    contract: ContractReport,
    model: ModelReport,
    fit: FitReport,
    summary: SummaryReport,
}

#[derive(Clone, Debug, Serialize)]
struct ContractReport {
    rgb_space: String,
    /// Chromaticities (x, y) of red, green and blue.
    primaries_xy: [[f64; 2]; 3],
    white_xy: [f64; 2],
    illuminant: String,
    observer: String,
    adaptation: String,
}

#[derive(Clone, Debug, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum ModelReport {
    Reflectance,
    Dyes {
        set: String,
        dyes: Vec<DyeReport>,
        mixing: String,
        accounting: String,
        quantum_yield: String,
        optical_density: Option<f64>,
    },
    Analytic {
        absorption_fwhm_nm: f64,
        emission_fwhm_nm: f64,
        accounting: String,
        quantum_yield: f64,
    },
}

#[derive(Clone, Debug, Serialize)]
struct DyeReport {
    name: String,
    /// The yield that the model uses.
    quantum_yield: f64,
    measured_quantum_yield: Option<f64>,
    mean_emission_nm: f64,
    provenance: String,
}

#[derive(Clone, Debug, Serialize)]
struct FitReport {
    metric: String,
    slope_max_per_nm: Option<f64>,
    sweeps: u32,
    method: String,
    evaluations: u64,
}

pub(crate) fn run(args: &InspectArgs, format: Format) -> Result<(), Failure> {
    if inspect_table::is_table(&args.file) {
        return inspect_table::run(args, format);
    }
    let given = [("--space", &args.space), ("--illuminant", &args.illuminant)];
    if let Some((option, _)) = given.into_iter().find(|(_, value)| value.is_some()) {
        let message = "given for a cube, which names its own; expected a table of coefficients";
        return Err(Failure::option(option, message));
    }
    let cube = files::read_cube(&args.file)?;
    let bytes =
        args.file.metadata().map_err(|error| Failure::file(&args.file, io_message(&error)))?.len();
    format.print(&InspectReport::new(args.file.display().to_string(), bytes, &cube))
}

impl InspectReport {
    fn new(file: String, bytes: u64, cube: &Cube) -> Self {
        let (contract, fit) = (cube.contract(), cube.fit());
        Self {
            file,
            bytes,
            resolution: cube.resolution(),
            contract: ContractReport {
                rgb_space: contract.space.name().into(),
                primaries_xy: contract.space.primaries(),
                white_xy: contract.space.white(),
                illuminant: contract.illuminant.name().into(),
                observer: contract.observer.name().into(),
                adaptation: contract.adaptation.to_string(),
            },
            model: ModelReport::new(cube.model()),
            fit: FitReport {
                metric: fit.metric.clone(),
                slope_max_per_nm: fit.slope_max_per_nm,
                sweeps: fit.sweeps,
                method: fit.method.clone(),
                evaluations: fit.evaluations,
            },
            summary: SummaryReport::of(cube),
        }
    }
}

impl ModelReport {
    fn new(model: &Model) -> Self {
        match model {
            Model::Reflectance => Self::Reflectance,
            Model::Dyes(model) => Self::of_dyes(model),
            Model::Analytic(model) => Self::of_bells(model),
        }
    }

    fn of_dyes(model: &DyeModel) -> Self {
        let options = model.options();
        let dyes = model.set().dyes().iter().zip(model.curves()).map(|(dye, curves)| DyeReport {
            name: dye.name.clone(),
            quantum_yield: curves.quantum_yield,
            measured_quantum_yield: dye.quantum_yield,
            mean_emission_nm: curves.mean_emission_nm,
            provenance: dye.provenance.clone(),
        });
        Self::Dyes {
            set: model.set().name().into(),
            dyes: dyes.collect(),
            mixing: options.mixing.to_string(),
            accounting: options.accounting.to_string(),
            quantum_yield: options.quantum_yield.to_string(),
            optical_density: options.optical_density,
        }
    }

    fn of_bells(model: &AnalyticModel) -> Self {
        Self::Analytic {
            absorption_fwhm_nm: model.absorption_fwhm_nm(),
            emission_fwhm_nm: model.emission_fwhm_nm(),
            accounting: model.accounting().to_string(),
            quantum_yield: model.quantum_yield(),
        }
    }

    fn add_to(&self, lines: &mut Lines) {
        match self {
            Self::Reflectance => {
                lines.add("model", "reflectance, no fluorescence");
            }
            Self::Dyes { set, dyes, mixing, accounting, quantum_yield, optical_density } => {
                let density =
                    optical_density.map_or("none, a thin solution".into(), |a| a.to_string());
                lines
                    .add("model", "dyes")
                    .add("dyes", format_args!("{set}, {} in a ring", dyes.len()))
                    .add("mixing", mixing)
                    .add("accounting", accounting)
                    .add("quantum yield", quantum_yield)
                    .add("optical density", density);
            }
            Self::Analytic { absorption_fwhm_nm, emission_fwhm_nm, accounting, quantum_yield } => {
                lines
                    .add("model", "analytic")
                    .add("absorption FWHM", format_args!("{absorption_fwhm_nm} nm"))
                    .add("emission FWHM", format_args!("{emission_fwhm_nm} nm"))
                    .add("accounting", accounting)
                    .add("quantum yield", quantum_yield);
            }
        }
    }

    /// The dyes as a table; nothing for other models.
    fn dye_table(&self) -> String {
        let Self::Dyes { dyes, .. } = self else { return String::new() };
        let mut table = Table::new([
            ("dye", Side::Left),
            ("yield used", Side::Right),
            ("yield measured", Side::Right),
            ("mean emission", Side::Right),
        ]);
        for dye in dyes {
            let measured = dye.measured_quantum_yield.map_or("unknown".into(), |q| q.to_string());
            table.add([
                dye.name.clone(),
                dye.quantum_yield.to_string(),
                measured,
                format!("{:.0} nm", dye.mean_emission_nm),
            ]);
        }
        let mut sources = Lines::default();
        for dye in dyes {
            sources.add(&dye.name, &dye.provenance);
        }
        format!("\n{table}\nWhere the dyes come from\n{sources}")
    }
}

impl Report for InspectReport {
    fn text(&self) -> String {
        let contract = &self.contract;
        let [red, green, blue] = contract.primaries_xy.map(|[x, y]| format!("({x}, {y})"));
        let [x, y] = contract.white_xy;
        let slope = self.fit.slope_max_per_nm.map_or("none".into(), |s| format!("{s} per nm"));
        let mut lines = Lines::default();
        lines
            .add("file", format_args!("{}, {}", self.file, files::size(self.bytes)))
            .add("resolution", format_args!("{0} × {0} × {0}", self.resolution))
            .add("RGB space", &contract.rgb_space)
            .add("primaries", format_args!("red {red}, green {green}, blue {blue}"))
            .add("white", format_args!("({x}, {y})"))
            .add("illuminant", &contract.illuminant)
            .add("observer", &contract.observer)
            .add("adaptation", &contract.adaptation);
        self.model.add_to(&mut lines);
        lines
            .add("metric", &self.fit.metric)
            .add("slope limit", slope)
            .add("method", &self.fit.method)
            .add("sweeps", self.fit.sweeps)
            .add("evaluations", self.fit.evaluations);
        self.summary.add_to(&mut lines);
        format!("{lines}{}", self.model.dye_table())
    }
}
