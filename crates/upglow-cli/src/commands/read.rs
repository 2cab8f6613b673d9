//! `upglow read`: the spectrum or material of one texel.

use serde::Serialize;
use upglow::{Fluorescence, Material, Model};
use upglow_image::{
    ExrReader, MaterialPicture, SpectralPicture, SpectralPictureError, SpectralTexel, baked_form,
};
use upglow_terminal::Failure;

use crate::args::ReadArgs;
use crate::output::{Format, Lines, Report, Side, Table, unsigned_zero};
use crate::pictures;

#[derive(Clone, Debug, Serialize)]
struct ReadReport {
    file: String,
    x: usize,
    y: usize,
    /// Wavelength (nm), and share of its light that leaves at it.
    reflectance: Vec<(f64, f32)>,
    /// Wavelength (nm), radiance.
    radiance: Vec<(f64, f32)>,
    /// Incident and outgoing wavelength (nm), and the share that takes that way.
    reradiation: Vec<(f64, f64, f32)>,
    /// What the file says re-radiation is a share of.
    reradiation_unit: Option<&'static str>,
    preview: Option<[f32; 3]>,
}

/// The six numbers of a baked material, or what they mean.
#[derive(Clone, Debug, Serialize)]
struct MaterialReport {
    file: String,
    x: usize,
    y: usize,
    /// Coefficients of the reflectance for λ in nm.
    c0: f64,
    c1: f64,
    c2: f64,
    steepest_per_nm: f64,
    dye: Option<String>,
    neighbor: Option<String>,
    weight: Option<f64>,
    emission_peak_nm: Option<f64>,
    stokes_shift_nm: Option<f64>,
    concentration: f64,
}

pub(crate) fn run(args: &ReadArgs, format: Format) -> Result<(), Failure> {
    let faulty = |error: &dyn std::fmt::Display| Failure::file(&args.file, error);
    pictures::check_there(&args.file, "a spectral or material EXR")?;
    let reader = ExrReader::open(&args.file).map_err(|error| faulty(&error))?;
    check_place(args.at, reader.size())?;
    let [x, y] = args.at;
    let file = args.file.display().to_string();
    if MaterialPicture::is_stated(&reader) {
        let mut picture = MaterialPicture::open(&args.file).map_err(|error| faulty(&error))?;
        let material = picture.at(x, y).map_err(|error| faulty(&error))?;
        return format.print(&MaterialReport::new(file, args.at, material, picture.model()));
    }
    let open = SpectralPicture::open(&args.file);
    let mut picture = open.map_err(|error| match (&error, baked_form(reader.attributes())) {
        (SpectralPictureError::NotSpectral, Some("radiance")) => {
            faulty(&"colors under a light, expected a file baked as material or spectral")
        }
        _ => faulty(&error),
    })?;
    let unit = picture.bispectral_unit().map(upglow_image::BispectralUnit::name);
    let texel = picture.at(x, y).map_err(|error| faulty(&error))?;
    format.print(&ReadReport::new(file, args.at, unit, texel))
}

fn check_place([x, y]: [usize; 2], [width, height]: [usize; 2]) -> Result<(), Failure> {
    if x < width && y < height {
        return Ok(());
    }
    let [right, bottom] = [width - 1, height - 1];
    Err(Failure::option(
        "--at",
        format_args!("{x},{y} is outside the picture, expected 0,0 to {right},{bottom}"),
    ))
}

impl MaterialReport {
    fn new(file: String, [x, y]: [usize; 2], material: Material, model: &Model) -> Self {
        let Material { reflectance, fluorescence } = material;
        let [c0, c1, c2] = [reflectance.c0, reflectance.c1, reflectance.c2].map(unsigned_zero);
        let mut report = Self {
            file,
            x,
            y,
            c0,
            c1,
            c2,
            steepest_per_nm: reflectance.steepest_slope_per_nm(),
            dye: None,
            neighbor: None,
            weight: None,
            emission_peak_nm: None,
            stokes_shift_nm: None,
            concentration: fluorescence.concentration(),
        };
        match (fluorescence, model) {
            (Fluorescence::Dyes { first, weight, .. }, Model::Dyes(dyes)) => {
                let name = |dye: usize| Some(dyes.set().dyes()[dye].name.clone());
                (report.dye, report.neighbor) = (name(first), name(dyes.partner(first)));
                report.weight = Some(weight);
            }
            (Fluorescence::Analytic { emission_peak_nm, stokes_shift_nm, .. }, _) => {
                report.emission_peak_nm = Some(emission_peak_nm);
                report.stokes_shift_nm = Some(stokes_shift_nm);
            }
            _ => {}
        }
        report
    }
}

impl Report for MaterialReport {
    fn text(&self) -> String {
        let Self { c0, c1, c2, steepest_per_nm, concentration, .. } = self;
        let mut lines = Lines::default();
        lines
            .add("texel", format_args!("{},{} of {}", self.x, self.y, self.file))
            .add("reflectance", format_args!("c0 {c0:.6e}, c1 {c1:.6e}, c2 {c2:.6e}, λ in nm"))
            .add("steepest", format_args!("{steepest_per_nm:.5} per nm"));
        if let (Some(dye), Some(neighbor), Some(weight)) = (&self.dye, &self.neighbor, self.weight)
        {
            let (first, second) = (100.0 * (1.0 - weight), 100.0 * weight);
            lines.add("dyes", format_args!("{first:.1} % {dye}, {second:.1} % {neighbor}"));
        }
        if let (Some(peak), Some(shift)) = (self.emission_peak_nm, self.stokes_shift_nm) {
            lines.add("emission", format_args!("peak {peak:.1} nm, Stokes shift {shift:.1} nm"));
        }
        lines.add("concentration", format_args!("{concentration:.4}"));
        lines.to_string()
    }
}

impl ReadReport {
    fn new(
        file: String,
        [x, y]: [usize; 2],
        unit: Option<&'static str>,
        texel: SpectralTexel,
    ) -> Self {
        let pairs = texel.reradiation.iter().map(|r| (r.in_nm, r.out_nm, r.value));
        Self {
            file,
            x,
            y,
            reradiation: pairs.collect(),
            reradiation_unit: unit,
            reflectance: texel.reflectance,
            radiance: texel.radiance,
            preview: texel.preview,
        }
    }

    /// For each incident wavelength: the share that leaves at longer ones, and where most of it does.
    fn moved(&self, nm: f64) -> Option<(f32, f64)> {
        let row = || self.reradiation.iter().filter(|(i, _, v)| *i == nm && *v > 0.0);
        let most = row().max_by(|a, b| a.2.total_cmp(&b.2))?;
        Some((row().map(|(_, _, v)| v).sum(), most.1))
    }
}

impl Report for ReadReport {
    fn text(&self) -> String {
        let mut lines = Lines::default();
        lines.add("texel", format_args!("{},{} of {}", self.x, self.y, self.file));
        if let Some([r, g, b]) = self.preview {
            lines.add("preview", format_args!("{r:.4}, {g:.4}, {b:.4}"));
        }
        let mut table = Table::new([
            ("nm", Side::Right),
            (if self.reflectance.is_empty() { "radiance" } else { "reflectance" }, Side::Right),
            ("moved", Side::Right),
            ("most to nm", Side::Right),
        ]);
        for (nm, value) in self.reflectance.iter().chain(&self.radiance) {
            let (share, to) = match self.moved(*nm) {
                Some((share, to_nm)) => (format!("{share:.4}"), to_nm.to_string()),
                None => (String::new(), String::new()),
            };
            table.add([nm.to_string(), format!("{value:.4}"), share, to]);
        }
        format!("{lines}\n{table}")
    }
}
