//! `upglow color`: the material of one color.

use std::io::{IsTerminal, stdout};

use upglow::{Cube, Mixture, ModelOnGrid};
use upglow_color::{
    Adaptation, ColorSolids, Colorimetry, Contract, Grid, Illuminant, LinearRgb, Metric, Nearest,
    RgbSpace, StandingKind, Xyz,
};
use upglow_fit::{FitOptions, Fitter, Method};
use upglow_terminal::Failure;

use super::color_report::{
    ColorReport, CurvesReport, Drawing, LightReport, PartReport, StandingReport,
};
use crate::args::ColorArgs;
use crate::files;
use crate::output::Format;
use crate::plan::{ColorPlan, Way};
use crate::plot::{Curves, Figure, Swatch, svg, terminal};

/// The lights that the material is shown under, beside the cube's own.
const LIGHTS: [&str; 3] = ["D65", "A", "E"];

/// An ultraviolet lamp as is sold for minerals and banknotes: what shines under it fluoresces.
const LAMP_PEAK_NM: f64 = 365.0;
const LAMP_FWHM_NM: f64 = 12.0;

pub(crate) fn run(args: &ColorArgs, format: Format) -> Result<(), Failure> {
    let plan = ColorPlan::new(args)?;
    let cube = files::read_cube(&plan.file)?;
    let mixture = material(&plan, &cube)?;
    let shown = Shown::new(&cube, &mixture, plan.rgb);
    if let Some(path) = &plan.plot {
        files::write(path, svg::draw(&shown.figure(&plan)).as_bytes())?;
    }
    format.print(&shown.report(&plan, format))
}

/// The material that the plan asks for.
fn material<'c>(plan: &ColorPlan, cube: &'c Cube) -> Result<Mixture<'c>, Failure> {
    let refused = |error| Failure::file(&plan.file, error);
    match plan.way {
        Way::Lookup(interpolation) => {
            cube.lookup(plan.rgb, interpolation).map_err(|error| Failure::input("R G B", error))
        }
        Way::Direct => {
            let record = cube.fit();
            let options = FitOptions {
                metric: record.metric.parse::<Metric>().map_err(|e| refused(e.to_string()))?,
                slope_max_per_nm: record.slope_max_per_nm,
                sweeps: record.sweeps,
                method: record.method.parse::<Method>().map_err(|e| refused(e.to_string()))?,
            };
            let fitter = Fitter::new(cube.contract(), cube.model(), options)
                .map_err(|error| refused(error.to_string()))?;
            let fit = fitter.fit(plan.rgb).map_err(|error| Failure::input("R G B", error))?;
            Ok(Mixture::of(cube.model(), fit.material()))
        }
    }
}

/// A material beside the color that it stands for.
struct Shown<'a> {
    cube: &'a Cube,
    mixture: &'a Mixture<'a>,
    rgb: LinearRgb,
    colorimetry: Colorimetry,
    target: Xyz,
    color: Xyz,
    curves: Curves,
}

impl<'a> Shown<'a> {
    fn new(cube: &'a Cube, mixture: &'a Mixture<'a>, rgb: LinearRgb) -> Self {
        let colorimetry = cube.contract().on(Grid::FIT);
        let target = colorimetry.xyz_from_rgb(rgb);
        let color = mixture.color(&ModelOnGrid::new(cube.model(), &colorimetry));
        let curves = Curves::of(mixture, &colorimetry);
        Self { cube, mixture, rgb, target, color, curves, colorimetry }
    }

    fn de2000(&self, color: Xyz) -> f64 {
        Metric::De2000.distance(&self.colorimetry, self.target, color)
    }

    fn report(&self, plan: &ColorPlan, format: Format) -> ColorReport {
        let drawing = match format {
            Format::Json => None,
            Format::Text if stdout().is_terminal() => {
                let colored = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
                Some(terminal::draw(&self.curves, colored))
            }
            Format::Text => plan.plot_terminal.then(|| terminal::draw(&self.curves, false)),
        };
        ColorReport {
            file: plan.file.display().to_string(),
            rgb_space: self.cube.contract().space.name().into(),
            rgb: self.rgb.0,
            xyz: self.target.0,
            interpolation: match plan.way {
                Way::Lookup(interpolation) => Some(interpolation.to_string()),
                Way::Direct => None,
            },
            de2000: self.de2000(self.color),
            standing: self.standing(),
            parts: self
                .mixture
                .parts()
                .map(|part| PartReport::new(part, self.cube.model()))
                .collect(),
            illuminant: self.cube.contract().illuminant.name().into(),
            adaptation: self.cube.contract().adaptation.to_string(),
            lights: self.lights(),
            plot: plan.plot.as_ref().map(|path| path.display().to_string()),
            curves: CurvesReport::new(&self.curves),
            drawing: Drawing(drawing),
        }
    }

    fn standing(&self) -> StandingReport {
        let standing = ColorSolids::new(&self.colorimetry).standing(self.target);
        let Nearest { distance, de2000, .. } = standing.beyond();
        match standing.kind {
            StandingKind::Reflectance => StandingReport::Reflectance,
            StandingKind::NeedsFluorescence => StandingReport::NeedsFluorescence {
                reflectance_distance_xyz: distance,
                reflectance_de2000: de2000,
            },
            StandingKind::Unreachable => StandingReport::Unreachable {
                fluorescence_distance_xyz: distance,
                fluorescence_de2000: de2000,
            },
        }
    }

    /// The material under the cube's own light, the standard ones, and an ultraviolet lamp.
    fn lights(&self) -> Vec<LightReport> {
        let contract = self.cube.contract();
        let own = contract.illuminant.name();
        let standard = LIGHTS.iter().filter(|&&name| name != own);
        let standard = standard.filter_map(|name| Illuminant::named(name).ok());
        let mut lights = vec![self.under(own, &self.colorimetry)];
        lights.extend(standard.map(|illuminant| {
            let name = illuminant.name().to_owned();
            let contract = Contract { illuminant, ..contract.clone() };
            self.under(&name, &contract.on(Grid::FIT))
        }));
        let name = format!("{LAMP_PEAK_NM} nm lamp");
        let lamp = Illuminant::line(&name, LAMP_PEAK_NM, LAMP_FWHM_NM);
        lights.push(self.under(&name, &self.colorimetry.relit(&contract.observer, &lamp)));
        lights
    }

    fn under(&self, name: &str, colorimetry: &Colorimetry) -> LightReport {
        let xyz = self.mixture.color(&ModelOnGrid::new(self.cube.model(), colorimetry));
        LightReport { name: name.into(), xyz: xyz.0, rgb: colorimetry.rgb_from_xyz(xyz).0 }
    }

    fn figure(&self, plan: &ColorPlan) -> Figure<'_> {
        let screen = Contract {
            space: RgbSpace::named("srgb").unwrap_or_default(),
            adaptation: Adaptation::Bradford,
            ..self.cube.contract().clone()
        };
        let screen = screen.on(Grid::FIT);
        let swatch = |xyz| Swatch::from_linear(screen.rgb_from_xyz(xyz));
        let way = match plan.way {
            Way::Lookup(interpolation) => format!("looked up, {interpolation}"),
            Way::Direct => "fitted directly".into(),
        };
        Figure {
            curves: &self.curves,
            target: swatch(self.target),
            result: swatch(self.color),
            caption: self.caption(way),
        }
    }

    /// Lines under the swatches of a figure.
    fn caption(&self, way: String) -> Vec<String> {
        let contract = self.cube.contract();
        let [r, g, b] = self.rgb.0;
        let mut lines = vec![
            format!("{} ({r}, {g}, {b})", contract.space.name()),
            format!("under {}, {}", contract.illuminant.name(), contract.observer.name()),
            way,
            format!("ΔE00 {:.2}", self.de2000(self.color)),
        ];
        let fluorescence: Vec<String> = self
            .mixture
            .parts()
            .filter_map(|part| PartReport::new(part, self.cube.model()).fluorescence)
            .flat_map(|fluorescence| fluorescence.names())
            .collect();
        let mut seen = Vec::new();
        for name in fluorescence {
            if !seen.contains(&name) {
                seen.push(name);
            }
        }
        lines.extend(seen);
        lines
    }
}
