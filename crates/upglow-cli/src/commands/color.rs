//! `upglow color`: shows the material of one color.

use std::path::Path;

use upglow::{Cube, Interpolation, Mixture, ModelOnGrid};
use upglow_color::{
    ColorSolids, Colorimetry, Contract, Grid, Illuminant, LinearRgb, Metric, Screen, Xyz,
};
use upglow_fit::{FitOptions, Fitter, MaterialKind, Relighting, View};
use upglow_terminal::{Console, Failure};

use super::color_report::{ColorReport, LightReport, PartReport};
use crate::args::ColorArgs;
use crate::output::warn_of_ultraviolet;
use crate::plot::{Curves, Figure, Swatch, svg};
use crate::{files, plan};

pub(crate) fn run(args: &ColorArgs, console: &Console) -> Result<(), Failure> {
    let rgb = plan::color([&args.red, &args.green, &args.blue], args.direct)?;
    if let Some(plot) = &args.plot {
        files::check_ending(plot, files::SVG)?;
        files::check_output_of(plot, Some(&args.file), &files::really(&[]))?;
    }
    let lights = plan::lights_to_see(&args.lights, &args.light)?;
    let cube = files::read_cube(&args.file)?;
    let interpolation = (!args.direct).then(|| args.interpolation.unwrap_or_default());
    let mixture = match interpolation {
        Some(interpolation) => cube.lookup(rgb, interpolation).map_err(no_material)?,
        None => {
            let fit = fitter_of(&cube, &args.file)?.fit(rgb).map_err(no_material)?;
            Mixture::of(cube.model(), fit.material())
        }
    };
    let shown = Shown::new(&cube, &mixture, rgb, interpolation, lights);
    if let Some(path) = &args.plot {
        files::write(path, svg::draw(&shown.figure()).as_bytes())?;
    }
    console.print(&shown.report(args))
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
    /// `None` for a material that was fitted to this color.
    interpolation: Option<Interpolation>,
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
        interpolation: Option<Interpolation>,
        lights: Vec<Illuminant>,
    ) -> Self {
        let colorimetry = cube.contract().on(Grid::FIT);
        let target = colorimetry.xyz_from_rgb(rgb);
        let color = mixture.color(&ModelOnGrid::new(cube.model(), &colorimetry));
        let curves = Curves::of(mixture, &colorimetry);
        Self { cube, mixture, rgb, interpolation, lights, target, color, curves, colorimetry }
    }

    fn de2000(&self, color: Xyz) -> f64 {
        Metric::De2000.distance(&self.colorimetry, self.target, color)
    }

    fn report(&'a self, args: &ColorArgs) -> ColorReport<'a> {
        let Contract { space, illuminant, adaptation, .. } = self.cube.contract();
        let standing = ColorSolids::new(&self.colorimetry).standing(self.target);
        ColorReport {
            file: args.file.display().to_string(),
            rgb_space: space.name(),
            rgb: self.rgb,
            xyz: self.target,
            interpolation: self.interpolation,
            de2000: self.de2000(self.color),
            kind: self.kind(),
            standing: standing.into(),
            reachable: standing,
            parts: self.parts(),
            illuminant: illuminant.name(),
            adaptation: *adaptation,
            lights: self.lights(),
            plot: args.plot.as_ref().map(|path| path.display().to_string()),
            curves: &self.curves,
        }
    }

    fn kind(&self) -> MaterialKind {
        MaterialKind::of_mixture(self.mixture, self.de2000(self.color), self.cube.fit())
    }

    fn parts(&self) -> Vec<PartReport<'_>> {
        self.mixture.parts().map(|part| PartReport::new(part, self.cube.model())).collect()
    }

    /// How the material looks under the cube's own light and the others.
    fn lights(&self) -> Vec<LightReport> {
        let Contract { illuminant: own, observer, .. } = self.cube.contract();
        let relighting = Relighting::of_mixture(self.cube, self.mixture);
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
        let origin = self.interpolation.map(|interpolation| format!("looked up, {interpolation}"));
        let mut lines = vec![
            format!("{} ({r}, {g}, {b})", contract.space.name()),
            format!("under {}, {}", contract.illuminant.name(), contract.observer.name()),
            origin.unwrap_or("fitted directly".into()),
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
