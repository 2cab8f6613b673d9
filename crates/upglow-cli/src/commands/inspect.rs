//! `upglow inspect`: shows the contents of a cube.

use serde::Serialize;
use upglow::{
    Accounting, AnalyticModel, Cube, DyeModel, DyeOptions, FitRecord, Model, QuantumYield,
};
use upglow_color::Contract;
use upglow_fit::{CubeSummary, Seam, seams};
use upglow_terminal::{Console, Failure, Report};

use super::inspect_table;
use crate::args::{InspectArgs, SlopeLimits};
use crate::files;
use crate::output::{Lines, Side, Table, warn_of_own_light};

#[derive(Debug, Serialize)]
struct InspectReport<'a> {
    file: String,
    bytes: u64,
    resolution: usize,
    contract: &'a Contract,
    model: ModelReport<'a>,
    fit: &'a FitRecord,
    summary: CubeSummary,
    seams: Vec<Seam>,
    /// What the cube's light lacks that its dyes absorb.
    missing_ultraviolet: Option<String>,
}

#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum ModelReport<'a> {
    Reflectance,
    Dyes {
        set: &'a str,
        dyes: Vec<DyeReport<'a>>,
        #[serde(flatten)]
        options: DyeOptions,
    },
    Film {
        set: &'a str,
        dyes: Vec<DyeReport<'a>>,
        accounting: Accounting,
        quantum_yield: QuantumYield,
    },
    Analytic(AnalyticModel),
}

#[derive(Debug, Serialize)]
struct DyeReport<'a> {
    name: &'a str,
    /// The yield that the model uses.
    quantum_yield: f64,
    measured_quantum_yield: Option<f64>,
    mean_emission_nm: f64,
    provenance: &'a str,
}

pub(crate) fn run(args: InspectArgs, console: &Console) -> Result<(), Failure> {
    if inspect_table::is_table(&args.file) {
        return inspect_table::run(args, console);
    }
    let cube = files::read_cube(&args.file)?;
    let given = [
        ("--space", args.space.is_some()),
        ("--illuminant", args.illuminant.is_some()),
        ("--light-ends", args.light.ends.is_some()),
    ];
    if let Some((option, _)) = given.into_iter().find(|(_, given)| *given) {
        let message = "given for a cube, which stores its own, expected a coefficient table";
        return Err(Failure::option(option, message));
    }
    console.print(&InspectReport {
        file: args.file.display().to_string(),
        bytes: files::bytes(&args.file)?,
        resolution: cube.resolution(),
        contract: cube.contract(),
        model: ModelReport::new(&cube),
        fit: cube.fit(),
        summary: CubeSummary::of(&cube),
        seams: seams(&cube),
        missing_ultraviolet: warn_of_own_light(&cube),
    })
}

impl<'a> ModelReport<'a> {
    fn new(cube: &'a Cube) -> Self {
        match cube.model() {
            Model::Reflectance => Self::Reflectance,
            Model::Dyes(model) => Self::Dyes {
                set: model.set().name(),
                dyes: DyeReport::of(model),
                options: model.options(),
            },
            Model::Film(model) => Self::Film {
                set: model.dyes().set().name(),
                dyes: DyeReport::of(model.dyes()),
                accounting: model.accounting(),
                quantum_yield: model.quantum_yield(),
            },
            Model::Analytic(model) => Self::Analytic(*model),
        }
    }

    fn add_to(&self, lines: &mut Lines) {
        match self {
            Self::Reflectance => {
                lines.add("model", "reflectance, no fluorescence");
            }
            Self::Dyes { set, dyes, options } => {
                let density = options
                    .optical_density
                    .map_or("that of a thin solution".into(), |a| a.to_string());
                lines
                    .add("model", "dyes")
                    .add("dyes", format_args!("{set}, {} in a ring", dyes.len()))
                    .add("mixing", options.mixing)
                    .add("accounting", options.accounting)
                    .add("quantum yield", options.quantum_yield)
                    .add("optical density", density);
            }
            Self::Film { set, dyes, accounting, quantum_yield } => {
                lines
                    .add("model", "film")
                    .add("dyes", format_args!("{set}, any two of {}", dyes.len()))
                    .add("accounting", accounting)
                    .add("quantum yield", quantum_yield);
            }
            Self::Analytic(model) => {
                lines
                    .add("model", "analytic")
                    .add("absorption FWHM", format_args!("{} nm", model.absorption_fwhm_nm()))
                    .add("emission FWHM", format_args!("{} nm", model.emission_fwhm_nm()))
                    .add("accounting", model.accounting())
                    .add("quantum yield", model.quantum_yield());
            }
        }
    }

    /// The dyes as a table; empty for other models.
    fn dye_table(&self) -> String {
        let (Self::Dyes { dyes, .. } | Self::Film { dyes, .. }) = self else {
            return String::new();
        };
        let mut table = Table::new([
            ("dye", Side::Left),
            ("yield used", Side::Right),
            ("yield measured", Side::Right),
            ("mean emission", Side::Right),
        ]);
        let mut sources = Lines::default();
        for dye in dyes {
            let measured = dye.measured_quantum_yield.map_or("unknown".into(), |q| q.to_string());
            table.add([
                dye.name.to_owned(),
                dye.quantum_yield.to_string(),
                measured,
                format!("{:.0} nm", dye.mean_emission_nm),
            ]);
            sources.add(dye.name, dye.provenance);
        }
        format!("\n{table}\nSources of the dyes\n{sources}")
    }
}

impl<'a> DyeReport<'a> {
    fn of(model: &'a DyeModel) -> Vec<Self> {
        let dyes = model.set().dyes().iter().zip(model.curves());
        let report = dyes.map(|(dye, curves)| Self {
            name: &dye.name,
            quantum_yield: curves.quantum_yield,
            measured_quantum_yield: dye.quantum_yield,
            mean_emission_nm: curves.mean_emission_nm,
            provenance: &dye.provenance,
        });
        report.collect()
    }
}

impl InspectReport<'_> {
    fn slope_limits(&self) -> String {
        let FitRecord { slope_max_per_nm, slope_under_dyes_per_nm, relaxed, .. } = self.fit;
        let text = |limit: Option<f64>| limit.map_or("none".into(), |s| format!("{s} per nm"));
        let kind = if *relaxed { SlopeLimits::Relaxed } else { SlopeLimits::Hard };
        if matches!(self.model, ModelReport::Reflectance) {
            return format!("{}, {kind}", text(*slope_max_per_nm));
        }
        let [alone, under_dyes] = [slope_max_per_nm, slope_under_dyes_per_nm].map(|l| text(*l));
        format!("{alone}; under dyes {under_dyes}; {kind}")
    }
}

impl Report for InspectReport<'_> {
    fn text(&self) -> String {
        let Contract { space, illuminant, observer, adaptation } = self.contract;
        let [red, green, blue] = space.primaries().map(|[x, y]| format!("({x}, {y})"));
        let [x, y] = space.white();
        let mut lines = Lines::default();
        lines
            .add_file("file", &self.file, self.bytes)
            .add("resolution", format_args!("{0} × {0} × {0}", self.resolution))
            .add("RGB space", space.name())
            .add("primaries", format_args!("red {red}, green {green}, blue {blue}"))
            .add("white", format_args!("({x}, {y})"))
            .add("illuminant", illuminant.name())
            .add("observer", observer.name())
            .add("adaptation", adaptation);
        self.model.add_to(&mut lines);
        lines
            .add("preset", self.fit.preset.as_deref().unwrap_or("none"))
            .add("metric", &self.fit.metric)
            .add("slope limits", self.slope_limits())
            .add("method", &self.fit.method)
            .add("sweeps", self.fit.sweeps)
            .add("evaluations", self.fit.evaluations)
            .add_summary(&self.summary);
        for Seam { light, p90, worst, .. } in &self.seams {
            let numbers = format_args!("{p90:.2} in one gradient of ten, {worst:.1} at most");
            lines.add(format_args!("seams, {light}"), numbers);
        }
        format!("{lines}{}", self.model.dye_table())
    }
}
