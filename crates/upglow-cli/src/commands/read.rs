//! `upglow read`: shows the spectrum or material of one texel.

use serde::Serialize;
use upglow::{Fluorescence, Material, Model};
use upglow_image::{ExrReader, Form, FormError, MaterialPicture, SpectralPicture, SpectralTexel};
use upglow_terminal::{Console, Failure, Report};

use super::material_report::{ReflectanceReport, dye_names};
use crate::args::ReadArgs;
use crate::output::{Lines, Side, Table};
use crate::pictures;

/// The position of the texel.
#[derive(Debug, Serialize)]
struct Texel {
    file: String,
    x: usize,
    y: usize,
}

#[derive(Debug, Serialize)]
struct SpectrumReport {
    #[serde(flatten)]
    texel: Texel,
    #[serde(flatten)]
    spectrum: SpectralTexel,
}

/// The parameters of a baked material.
#[derive(Debug, Serialize)]
struct MaterialReport {
    #[serde(flatten)]
    texel: Texel,
    #[serde(flatten)]
    reflectance: ReflectanceReport,
    dye: Option<String>,
    /// The next dye in the ring, or the second dye of a film, which is the first one again if there is
    /// no other.
    neighbor: Option<String>,
    weight: Option<f64>,
    /// Optical densities of the dyes of a film.
    densities: Option<[f64; 2]>,
    emission_peak_nm: Option<f64>,
    stokes_shift_nm: Option<f64>,
    /// `None` for a film.
    concentration: Option<f64>,
}

pub(crate) fn run(args: &ReadArgs, console: &Console) -> Result<(), Failure> {
    pictures::check_there(&args.file, "a spectral or material EXR")?;
    let reader = ExrReader::open(&args.file).map_err(|error| Failure::file(&args.file, error))?;
    check_position(args.at, reader.size())?;
    let [x, y] = args.at;
    let texel = Texel { file: args.file.display().to_string(), x, y };
    if MaterialPicture::is_stated(&reader) {
        let picture = MaterialPicture::open(&args.file);
        let found = picture.and_then(|mut picture| {
            Ok(MaterialReport::new(texel, picture.at(x, y)?, picture.model()))
        });
        return console.print(&found.map_err(|error| Failure::file(&args.file, error))?);
    }
    let picture = SpectralPicture::open(&args.file);
    let found =
        picture.and_then(|mut picture| Ok(SpectrumReport { texel, spectrum: picture.at(x, y)? }));
    let found = found.map_err(|error| match (&error, Form::stated(&reader)) {
        (FormError::NotSpectral, Some("radiance")) => {
            let message = "colors under a light, expected a file baked as material or spectral";
            Failure::file(&args.file, message)
        }
        (FormError::NotSpectral, Some("rgbu")) => {
            let message = "parts of 4×4 matrices, expected a file baked as material or spectral";
            Failure::file(&args.file, message)
        }
        _ => Failure::file(&args.file, error),
    })?;
    console.print(&found)
}

fn check_position([x, y]: [usize; 2], [width, height]: [usize; 2]) -> Result<(), Failure> {
    if x < width && y < height {
        return Ok(());
    }
    let [right, bottom] = [width - 1, height - 1];
    let message = format!("{x},{y} is outside the picture, expected 0,0 to {right},{bottom}");
    Err(Failure::option("--at", message))
}

impl MaterialReport {
    fn new(texel: Texel, material: Material, model: &Model) -> Self {
        let Material { reflectance, fluorescence } = material;
        let [dye, neighbor] = dye_names(fluorescence, model)
            .map_or([None, None], |names| names.map(|name| Some(name.to_owned())));
        let weight = match fluorescence {
            Fluorescence::Dyes { weight, .. } => Some(weight),
            _ => None,
        };
        let bells = match fluorescence {
            Fluorescence::Analytic { emission_peak_nm, stokes_shift_nm, .. } => {
                Some((emission_peak_nm, stokes_shift_nm))
            }
            _ => None,
        };
        let densities = match (fluorescence, model) {
            (Fluorescence::Film { densities, .. }, _) => Some(densities),
            (_, Model::Film(_)) => Some([0.0; 2]),
            _ => None,
        };
        Self {
            texel,
            reflectance: reflectance.into(),
            dye,
            neighbor,
            weight,
            densities,
            emission_peak_nm: bells.map(|(peak, _)| peak),
            stokes_shift_nm: bells.map(|(_, shift)| shift),
            concentration: densities.is_none().then_some(fluorescence.dose()),
        }
    }
}

impl Texel {
    fn lines(&self) -> Lines {
        let mut lines = Lines::default();
        lines.add("texel", format_args!("{},{} of {}", self.x, self.y, self.file));
        lines
    }
}

impl Report for MaterialReport {
    fn text(&self) -> String {
        let Self { reflectance: shape, .. } = self;
        let upglow::Sigmoid { c0, c1, c2 } = shape.coefficients;
        let mut lines = self.texel.lines();
        lines
            .add("reflectance", format_args!("c0 {c0:.6e}, c1 {c1:.6e}, c2 {c2:.6e}, λ in nm"))
            .add("steepest", format_args!("{:.5} per nm", shape.steepest_per_nm));
        if let (Some(dye), Some(neighbor), Some(weight)) = (&self.dye, &self.neighbor, self.weight)
        {
            let (first, second) = (100.0 * (1.0 - weight), 100.0 * weight);
            lines.add("dyes", format_args!("{first:.1} % {dye}, {second:.1} % {neighbor}"));
        }
        if let (Some(peak), Some(shift)) = (self.emission_peak_nm, self.stokes_shift_nm) {
            lines.add("emission", format_args!("peak {peak:.1} nm, Stokes shift {shift:.1} nm"));
        }
        if let Some(concentration) = self.concentration {
            lines.add("concentration", format_args!("{concentration:.4}"));
        }
        if let Some(densities) = self.densities {
            let films = [&self.dye, &self.neighbor].into_iter().flatten().zip(densities);
            for (dye, density) in films.filter(|(_, density)| *density > 0.0) {
                lines.add("film", format_args!("density {density:.4} of {dye}"));
            }
            lines.add("dose", format_args!("{:.4}", densities[0] + densities[1]));
        }
        lines.to_string()
    }
}

impl SpectrumReport {
    /// The share of the light at an incident wavelength that leaves at longer ones, and the wavelength
    /// at which most of it leaves.
    fn moved(&self, nm: f64) -> Option<(f32, f64)> {
        // They are sorted by incident wavelength, and there may be as many as a file has channels.
        let all = &self.spectrum.reradiation;
        let first = all.partition_point(|(incident, ..)| *incident < nm);
        let same = || all[first..].iter().take_while(|(incident, ..)| *incident == nm);
        let row = || same().filter(|(_, _, v)| *v > 0.0);
        let most = row().max_by(|a, b| a.2.total_cmp(&b.2))?;
        Some((row().map(|(_, _, v)| v).sum(), most.1))
    }
}

impl Report for SpectrumReport {
    fn text(&self) -> String {
        let mut lines = self.texel.lines();
        if let Some([r, g, b]) = self.spectrum.preview {
            lines.add("preview", format_args!("{r:.4}, {g:.4}, {b:.4}"));
        }
        let mut table = Table::new([
            ("nm", Side::Right),
            (
                if self.spectrum.reflectance.is_empty() { "radiance" } else { "reflectance" },
                Side::Right,
            ),
            ("moved", Side::Right),
            ("most to nm", Side::Right),
        ]);
        for (nm, value) in self.spectrum.reflectance.iter().chain(&self.spectrum.radiance) {
            let (share, to) = match self.moved(*nm) {
                Some((share, to_nm)) => (format!("{share:.4}"), to_nm.to_string()),
                None => (String::new(), String::new()),
            };
            table.add([nm.to_string(), format!("{value:.4}"), share, to]);
        }
        format!("{lines}\n{table}")
    }
}
