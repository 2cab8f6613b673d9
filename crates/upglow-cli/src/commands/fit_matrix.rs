//! `upglow fit-matrix`: the material of a measured re-radiation matrix.

use std::path::Path;

use serde::Serialize;
use upglow::{DyeModel, DyeSetError, Fluorescence};
use upglow_color::{
    BispectralUnit, Choice as _, Contract, DonaldsonMatrix, Illuminant, MatrixSums, MeasuredDye,
};
use upglow_fit::{
    MatrixDifference, MatrixDyes, MatrixFit, MatrixFitError, MatrixFitOptions, OwnMaterialError,
    fit_matrix,
};
use upglow_image::{FormError, SpectralPicture};
use upglow_terminal::{Console, Failure, Report};

use super::material_report::ReflectanceReport;
use crate::args::FitMatrixArgs;
use crate::output::{Lines, Side, Table, triple};
use crate::plot::matrix::{MatrixFigure, draw};
use crate::{files, pictures, plan};

const A_MATRIX: &str = "a measured matrix, .bfc, .csv or .exr";

/// The lights of a comparison if none is given: daylight with and without ultraviolet, lamps with and without
/// lines, and an ultraviolet lamp.
fn lights(args: &FitMatrixArgs) -> Result<Vec<Illuminant>, Failure> {
    let given = plan::lights("--light", &args.lights, &args.light)?;
    if !given.is_empty() {
        return Ok(given);
    }
    let named = ["D65", "A", "E", "D65-cut400", "FL2", "HP5"]
        .map(|name| Illuminant::named(name).expect("the light is built in"));
    Ok(named.into_iter().chain([Illuminant::mineral_lamp()]).collect())
}

pub(crate) fn run(args: &FitMatrixArgs, console: &Console) -> Result<(), Failure> {
    for (output, endings) in [(&args.plot, files::SVG), (&args.output, files::CUBE)] {
        let Some(output) = output else { continue };
        files::check_ending(output, endings)?;
        files::check_output(output)?;
    }
    let dyes = match args.dyes.as_str() {
        "measured" => MatrixDyes::Measured,
        "all" => MatrixDyes::Of(MeasuredDye::all().collect()),
        text => MatrixDyes::Of(plan::matrix_dyes(text).map_err(|failure| match failure {
            // Of the words, the plan knows those of `upglow build`.
            Failure::Usage(_) => failure.with(", or measured or all"),
            failure => failure,
        })?),
    };
    let options = MatrixFitOptions { dyes, count: args.count, reflectance: args.reflectance };
    let lights = lights(args)?;
    let measured = read(args)?;
    let fit = fit_matrix(&measured, &options).map_err(|error| refused(error, &args.file))?;
    let differences: Vec<MatrixDifference> = lights
        .iter()
        .map(|light| fit.difference(&measured, light))
        .collect::<Result<_, _>>()
        .map_err(|error| Failure::file(&args.file, error))?;
    if let Some(path) = &args.output {
        let cube = fit.to_cube().map_err(|error| Failure::file(&args.file, error))?;
        files::write_cube(path, &cube)?;
    }
    let report = MatrixReport::new(args, &measured, &fit, &lights, differences);
    if let Some(path) = &args.plot {
        let contract = Contract::default();
        let sums = MatrixSums::new(&measured, &contract.illuminant, &contract.observer)
            .map_err(|error| Failure::file(&args.file, error))?;
        let figure = MatrixFigure {
            measured: &measured,
            fitted: fit.matrix(),
            sums: &sums,
            caption: report.caption(),
        };
        files::write(path, draw(&figure).as_bytes())?;
    }
    console.print(&report)
}

/// Names the option or the file that prevents a fit.
fn refused(error: MatrixFitError, file: &Path) -> Failure {
    if let MatrixFitError::Material(OwnMaterialError::Dyes(cause)) = &error
        && let DyeSetError::AntiStokes { absorption_nm, emission_nm, .. } = **cause
    {
        let message = format!(
            "light that arrives at {absorption_nm:.0} nm leaves at {emission_nm:.0} nm, in the mean, expected \
             longer wavelengths to leave; are the axes exchanged?"
        );
        return Failure::file(file, message);
    }
    match error {
        error @ MatrixFitError::Reflectance { .. } => Failure::option("--reflectance", error),
        error @ MatrixFitError::Material(_) => Failure::option("--dyes", error),
        error => Failure::file(file, error),
    }
}

/// Reads the matrix in the form that the name of its file tells.
fn read(args: &FitMatrixArgs) -> Result<DonaldsonMatrix, Failure> {
    let path = &args.file;
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if ending != "exr" {
        for (option, is_given) in [("--at", args.at.is_some()), ("--unit", args.unit.is_some())] {
            if is_given {
                let message = format!("given with a file .{ending}, expected it with an EXR");
                return Err(Failure::option(option, message));
            }
        }
    }
    match ending.as_str() {
        "bfc" => {
            let text = files::read_text(path, "a BFC-450 matrix, a text file")?;
            DonaldsonMatrix::from_bfc(&text).map_err(|error| Failure::file(path, error))
        }
        "csv" => {
            let text = files::read_text(path, "a matrix as CSV with named axes")?;
            DonaldsonMatrix::from_csv(&text).map_err(|error| Failure::file(path, error))
        }
        "exr" => {
            pictures::check_there(path, "a measured matrix as OpenEXR")?;
            let unit = args.unit.map(BispectralUnit::from);
            let found =
                SpectralPicture::open(path).and_then(|mut picture| picture.matrix(args.at, unit));
            found.map_err(|error| {
                let hint = match error {
                    FormError::Unit => ": --unit per-band or per-nm",
                    _ => "",
                };
                Failure::file(path, error).with(hint)
            })
        }
        _ => {
            let found =
                if ending.is_empty() { "no ending".into() } else { format!("a file .{ending}") };
            Err(Failure::file(path, format!("{found}, expected {A_MATRIX}")))
        }
    }
}

#[derive(Debug, Serialize)]
struct MatrixReport {
    file: String,
    /// First and last wavelength, nm, and their number.
    incident: Axis,
    outgoing: Axis,
    /// In which unit the file has its values.
    unit: &'static str,
    /// Whether the diagonal holds reflected and re-emitted light together, or reflected light alone.
    diagonal: &'static str,
    noise: Option<Noise>,
    reflectance: ReflectanceReport,
    dyes: Vec<DyeReport>,
    lights: Vec<LightReport>,
    mean_de2000: f64,
    max_de2000: f64,
    plot: Option<String>,
    output: Option<String>,
    /// Share of the power that arrives in a band that leaves in another, `[outgoing][incident]`.
    fitted_per_band: Vec<Vec<f64>>,
}

/// How far the material is from the matrix under a light.
#[derive(Clone, Debug, Serialize)]
struct LightReport {
    #[serde(flatten)]
    difference: MatrixDifference,
    /// What the light lacks that the matrix moves to other wavelengths.
    missing_ultraviolet: Option<String>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct Axis {
    first_nm: f64,
    last_nm: f64,
    count: usize,
}

/// What is below the diagonal, per band.
#[derive(Clone, Copy, Debug, Serialize)]
struct Noise {
    root_mean_square: f64,
    greatest: f64,
}

#[derive(Clone, Debug, Serialize)]
struct DyeReport {
    name: String,
    optical_density: f64,
    quantum_yield: f64,
    mean_emission_nm: f64,
}

impl Axis {
    fn of(nm: &[f64]) -> Self {
        Self { first_nm: nm[0], last_nm: nm[nm.len() - 1], count: nm.len() }
    }

    fn text(self) -> String {
        let Self { first_nm, last_nm, count } = self;
        format!("{first_nm} to {last_nm} nm, {count} bands")
    }
}

impl MatrixReport {
    fn new(
        args: &FitMatrixArgs,
        measured: &DonaldsonMatrix,
        fit: &MatrixFit,
        lights: &[Illuminant],
        differences: Vec<MatrixDifference>,
    ) -> Self {
        let path =
            |path: &Option<std::path::PathBuf>| path.as_ref().map(|p| p.display().to_string());
        let noise = |[root_mean_square, greatest]: [f64; 2]| Noise { root_mean_square, greatest };
        let each = || differences.iter().map(|light| light.de2000);
        let (mean_de2000, max_de2000) =
            (each().sum::<f64>() / differences.len() as f64, each().fold(0.0, f64::max));
        let under = |(light, difference): (&Illuminant, MatrixDifference)| LightReport {
            difference,
            missing_ultraviolet: measured.missing_ultraviolet(light).map(|m| m.to_string()),
        };
        Self {
            file: args.file.display().to_string(),
            incident: Axis::of(measured.incident_nm()),
            outgoing: Axis::of(measured.outgoing_nm()),
            unit: measured.unit().name(),
            diagonal: measured.diagonal().name(),
            noise: measured.noise().map(noise),
            reflectance: fit.material().reflectance.into(),
            dyes: fit.model().dyes().map_or_else(Vec::new, |dyes| dye_reports(fit, dyes)),
            mean_de2000,
            max_de2000,
            plot: path(&args.plot),
            output: path(&args.output),
            fitted_per_band: fit.matrix().factors().to_vec(),
            lights: lights.iter().zip(differences).map(under).collect(),
        }
    }

    fn differences(&self) -> impl Iterator<Item = &MatrixDifference> {
        self.lights.iter().map(|light| &light.difference)
    }

    /// The lines beside the figure.
    fn caption(&self) -> Vec<String> {
        let mut lines =
            vec![format!("mean ΔE00 {:.2} over {} lights", self.mean_de2000, self.lights.len())];
        lines.extend(
            self.differences().map(|light| format!("{}: {:.2}", light.light, light.de2000)),
        );
        lines.push(String::new());
        for dye in &self.dyes {
            lines.push(dye.name.clone());
            lines.push(format!(
                "density {:.2}, yield {:.2}",
                dye.optical_density, dye.quantum_yield
            ));
        }
        lines
    }
}

fn dye_reports(fit: &MatrixFit, model: &DyeModel) -> Vec<DyeReport> {
    let Fluorescence::Film { .. } = fit.material().fluorescence else { return Vec::new() };
    let dyes = fit.material().fluorescence.dyes(model);
    let report = |&(number, optical_density): &(usize, f64)| {
        let curves = &model.curves()[number];
        DyeReport {
            name: model.set().dyes()[number].name.clone(),
            optical_density,
            quantum_yield: curves.quantum_yield,
            mean_emission_nm: curves.mean_emission_nm,
        }
    };
    dyes.iter().filter(|(_, density)| *density > 0.0).map(report).collect()
}

impl Report for MatrixReport {
    fn text(&self) -> String {
        let upglow::Sigmoid { c0, c1, c2 } = self.reflectance.coefficients;
        let mut lines = Lines::default();
        lines
            .add("matrix", &self.file)
            .add("arriving", self.incident.text())
            .add("leaving", self.outgoing.text())
            .add("values", format_args!("{}, as the file has them", self.unit))
            .add(
                "diagonal",
                match self.diagonal {
                    "together" => "reflected and re-emitted light together",
                    _ => "reflected light alone",
                },
            );
        if let Some(Noise { root_mean_square, greatest }) = self.noise {
            let text =
                format!("{root_mean_square:.5} per band below the diagonal, {greatest:.5} at most");
            lines.add("noise", text);
        }
        match self.reflectance.steepest_per_nm {
            0.0 => lines.add(
                "reflectance",
                format_args!("flat, {:.4}", self.reflectance.coefficients.at(550.0)),
            ),
            _ => lines
                .add("reflectance", format_args!("c0 {c0:.6e}, c1 {c1:.6e}, c2 {c2:.6e}, λ in nm")),
        };
        if let Some(plot) = &self.plot {
            lines.add("plot", plot);
        }
        if let Some(output) = &self.output {
            lines.add("cube", output);
        }
        let right = |name| (name, Side::Right);
        let mut dyes = Table::new([
            ("dye", Side::Left),
            right("density"),
            right("yield"),
            right("emission nm"),
        ]);
        for dye in &self.dyes {
            let emits = dye.quantum_yield > 0.0;
            let emission =
                if emits { format!("{:.1}", dye.mean_emission_nm) } else { "none".into() };
            let numbers = [dye.optical_density, dye.quantum_yield].map(|v| format!("{v:.4}"));
            let [density, quantum_yield] = numbers;
            dyes.add([dye.name.clone(), density, quantum_yield, emission]);
        }
        let dyes = if dyes.is_empty() { "no dye\n".into() } else { dyes.to_string() };
        let mut colors = Table::new([
            ("light", Side::Left),
            right("ΔE00"),
            right("noise"),
            right("X        Y        Z"),
            right("fitted X        Y        Z"),
        ]);
        for light in self.differences() {
            colors.add([
                light.light.clone(),
                format!("{:.2}", light.de2000),
                format!("{:.2}", light.noise_de2000),
                triple(light.measured.0),
                triple(light.fitted.0),
            ]);
        }
        let dark: Vec<&str> =
            self.differences().filter(|l| !l.is_adapted).map(|l| l.light.as_str()).collect();
        let note = match dark.as_slice() {
            [] => String::new(),
            dark => format!(
                "{}: as much power as D65, to which the observer is adapted.\n",
                dark.join(", ")
            ),
        };
        let missing = self.lights.iter().filter_map(|light| light.missing_ultraviolet.as_ref());
        let missing: String = missing.map(|sentence| format!("{sentence}.\n")).collect();
        let (mean, max) = (self.mean_de2000, self.max_de2000);
        format!(
            "{lines}\n{dyes}\n{colors}mean {mean:.2}, greatest {max:.2} ΔE00. Noise: what leaving out all \
             below the diagonal would change.\n{note}{missing}"
        )
    }
}
