//! `upglow color`: shows the material of one color.

use std::path::Path;

use upglow::{Cube, FitRecord, Interpolation, Mixture, ModelOnGrid};
use upglow_color::{
    ColorSolids, Colorimetry, Contract, Grid, Illuminant, LinearRgb, Metric, Screen, Xyz,
};
use upglow_fit::{
    FitOptions, Fitter, MaterialKind, MetamerSearch, Metamers, OwnMaterial, Relighting, View,
};
use upglow_terminal::{Console, Failure};

use super::color_report::{ColorReport, LightReport, PartReport};
use super::engine::EngineReport;
use crate::args::{AnswerName, ColorArgs};
use crate::metamers::{self, KnownColor, PaintReport, known_colors};
use crate::output::warn_of_ultraviolet;
use crate::plot::{Curves, Figure, Swatch, svg};
use crate::{files, plan};

pub(crate) fn run(args: &ColorArgs, console: &Console) -> Result<(), Failure> {
    let is_search = args.paint.kind.is_some() || !args.known.is_empty();
    args.paint.check_answer(is_search, "--kind or --known")?;
    if args.output.is_some() && !is_search {
        let message = "given without --kind or --known; a cube is the output of upglow build";
        return Err(Failure::option("--output", message));
    }
    let rgb = plan::color([&args.red, &args.green, &args.blue], args.direct || is_search)?;
    for (output, endings) in [(&args.output, files::CUBE), (&args.plot, files::SVG)] {
        let Some(output) = output else { continue };
        files::check_ending(output, endings)?;
        files::check_output(output)?;
    }
    let lights = plan::lights_to_see(&args.lights, &args.light)?;
    let known = known_colors(&args.known, &args.light)?;
    let cube = files::read_cube(&args.file)?;
    if is_search {
        return run_search(args, &cube, rgb, &known, lights, console);
    }
    let interpolation = (!args.direct).then(|| args.interpolation.unwrap_or_default());
    let mixture = match interpolation {
        Some(interpolation) => cube.lookup(rgb, interpolation).map_err(no_material)?,
        None => {
            let fit = fitter_of(&cube, &args.file)?.fit(rgb).map_err(no_material)?;
            Mixture::of(cube.model(), fit.material())
        }
    };
    let origin = interpolation.map_or(Origin::Fitted, Origin::LookedUp);
    Shown::new(&cube, &mixture, rgb, origin, lights).finish(args, console)
}

/// The material of a paint that has the colors.
fn run_search(
    args: &ColorArgs,
    cube: &Cube,
    rgb: LinearRgb,
    known: &[KnownColor],
    lights: Vec<Illuminant>,
    console: &Console,
) -> Result<(), Failure> {
    let contract = cube.contract();
    let kind = args.paint.kind.unwrap_or_default();
    let search = metamers::search(contract, known, kind)?;
    let colors = std::iter::once(rgb).chain(known.iter().map(|known| known.rgb));
    let found = search.of_rgb(&colors.collect::<Vec<_>>()).map_err(metamers::refused)?;
    let probability = found.fluorescent_probability();
    let material = metamers::answer(&found, &args.paint)?;
    let mixture = material.mixture();
    if let Some(path) = &args.output {
        let single = match args.paint.answer {
            Some(AnswerName::Mixture) => &found.single().map_err(metamers::refused)?,
            _ => &material,
        };
        let cube = single.to_cube(contract, MetamerSearch::METHOD).map_err(no_material)?;
        files::write_cube(path, &cube)?;
    }
    let seen = |under: &Colorimetry| mixture.color(&ModelOnGrid::new(mixture.model(), under));
    let missing = |light: &Illuminant| {
        let missing = search.missing_ultraviolet(light);
        // Of lights that are shown the report says it.
        let is_shown = lights.iter().any(|shown| shown.name() == light.name());
        if is_shown { missing.map(|m| m.to_string()) } else { warn_of_ultraviolet(missing) }
    };
    let report = PaintReport::new(contract, &args.paint, probability, known, missing, seen);
    let origin = Origin::Searched(Box::new(report), &material, &found);
    Shown::new(cube, &mixture, rgb, origin, lights).finish(args, console)
}

/// Where a material comes from.
enum Origin<'a> {
    LookedUp(Interpolation),
    Fitted,
    Searched(Box<PaintReport>, &'a OwnMaterial, &'a Metamers),
}

fn no_material(error: impl std::error::Error + Send + Sync + 'static) -> Failure {
    Failure::input("R G B", error)
}

/// A fitter with the options of a cube from a file.
pub(super) fn fitter_of(cube: &Cube, file: &Path) -> Result<Fitter, Failure> {
    let options = FitOptions::try_from(cube.fit()).map_err(|error| Failure::file(file, error))?;
    Fitter::new(cube.contract(), cube.model(), options).map_err(|error| Failure::file(file, error))
}

/// A material and the color that it should have.
struct Shown<'a> {
    cube: &'a Cube,
    mixture: &'a Mixture<'a>,
    rgb: LinearRgb,
    origin: Origin<'a>,
    lights: Vec<Illuminant>,
    colorimetry: Colorimetry,
    target: Xyz,
    color: Xyz,
    curves: Curves,
}

impl<'a> Shown<'a> {
    fn new(
        cube: &'a Cube,
        mixture: &'a Mixture<'a>,
        rgb: LinearRgb,
        origin: Origin<'a>,
        lights: Vec<Illuminant>,
    ) -> Self {
        let colorimetry = cube.contract().on(Grid::FIT);
        let target = colorimetry.xyz_from_rgb(rgb);
        let color = mixture.color(&ModelOnGrid::new(mixture.model(), &colorimetry));
        let curves = Curves::of(mixture, &colorimetry);
        Self { cube, mixture, rgb, origin, lights, target, color, curves, colorimetry }
    }

    /// Draws it if asked to, and prints the report.
    fn finish(&self, args: &ColorArgs, console: &Console) -> Result<(), Failure> {
        if let Some(path) = &args.plot {
            files::write(path, svg::draw(&self.figure()).as_bytes())?;
        }
        let mut report = self.report(args);
        if let Some(engine) = &args.engine {
            let contract = self.cube.contract();
            report.engine = Some(EngineReport::new(contract, self.mixture, engine, &self.lights)?);
        }
        console.print(&report)
    }

    fn de2000(&self, color: Xyz) -> f64 {
        Metric::De2000.distance(&self.colorimetry, self.target, color)
    }

    fn report(&self, args: &ColorArgs) -> ColorReport<'_> {
        let Contract { space, illuminant, adaptation, .. } = self.cube.contract();
        let standing = ColorSolids::new(&self.colorimetry).standing(self.target);
        ColorReport {
            file: args.file.display().to_string(),
            rgb_space: space.name(),
            rgb: self.rgb,
            xyz: self.target,
            interpolation: match self.origin {
                Origin::LookedUp(interpolation) => Some(interpolation),
                _ => None,
            },
            paint: match &self.origin {
                Origin::Searched(paint, ..) => Some(paint),
                _ => None,
            },
            output: args.output.as_ref().map(|path| path.display().to_string()),
            de2000: self.de2000(self.color),
            kind: self.kind(),
            standing: standing.into(),
            reachable: standing,
            parts: self.parts(),
            illuminant: illuminant.name(),
            adaptation: *adaptation,
            lights: self.lights(),
            engine: None,
            plot: args.plot.as_ref().map(|path| path.display().to_string()),
            curves: &self.curves,
        }
    }

    fn kind(&self) -> MaterialKind {
        let de2000 = self.de2000(self.color);
        let is_searched = matches!(self.origin, Origin::Searched(..));
        // A material of its own has no limits of the cube.
        let record = if is_searched { &FitRecord::default() } else { self.cube.fit() };
        MaterialKind::of_mixture(self.mixture, de2000, record)
    }

    fn parts(&self) -> Vec<PartReport<'_>> {
        self.mixture.parts().map(|part| PartReport::new(part, self.mixture.model())).collect()
    }

    /// How the material looks under the cube's own light and the others.
    fn lights(&self) -> Vec<LightReport> {
        let Contract { illuminant: own, observer, .. } = self.cube.contract();
        let relighting = match &self.origin {
            Origin::Searched(_, material, metamers) => {
                let own = vec![OwnMaterial::clone(material)];
                Relighting::of_own_materials(self.cube.contract(), own)
                    .with_metamers(vec![Metamers::clone(metamers)])
            }
            _ => Relighting::of_mixture(self.cube, self.mixture),
        };
        let seen_by = relighting.seen_by(observer).expect("its observer sees its light");
        let others = self.lights.iter().filter(|light| light.name() != own.name());
        let under = |light: &Illuminant| {
            let View { seen, appearances } = seen_by.under(light);
            LightReport {
                name: light.name().into(),
                is_adapted: seen.is_adapted,
                appearance: appearances[0],
                missing_ultraviolet: warn_of_ultraviolet(self.mixture.missing_ultraviolet(light)),
            }
        };
        std::iter::once(own).chain(others).map(under).collect()
    }

    fn figure(&self) -> Figure<'_> {
        let screen = Screen::srgb(self.colorimetry.white());
        let [target, result] = screen.together([self.target, self.color]).map(Swatch::of);
        Figure { curves: &self.curves, target, result, caption: self.caption() }
    }

    /// The lines below the swatches of the figure.
    fn caption(&self) -> Vec<String> {
        let contract = self.cube.contract();
        let LinearRgb([r, g, b]) = self.rgb;
        let origin = match &self.origin {
            Origin::LookedUp(interpolation) => format!("looked up, {interpolation}"),
            Origin::Fitted => "fitted directly".into(),
            Origin::Searched(paint, ..) => format!("{} paint, {}", paint.kind, paint.answer),
        };
        let mut lines = vec![
            format!("{} ({r}, {g}, {b})", contract.space.name()),
            format!("under {}, {}", contract.illuminant.name(), contract.observer.name()),
            origin,
            format!("ΔE00 {:.2}", self.de2000(self.color)),
        ];
        for name in self.parts().iter().flat_map(PartReport::emitters) {
            if !lines.contains(&name) {
                lines.push(name);
            }
        }
        lines
    }
}
