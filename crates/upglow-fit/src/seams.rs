//! Seams: how even a gradient stays under another light.

use upglow::{ColorTable, Cube, Interpolation, ModelOnGrid};
use upglow_color::rounding::to_single;
use upglow_color::{
    Contract, Grid, Illuminant, Lab, LinearRgb, Metric, Spectrum, Xyz, lab_from_xyz,
};

use crate::verify::random_rgb;

/// How uneven gradients become under one light.
///
/// Between two colors that a cube matches, the colors of its materials are even under the contract's
/// light. Under another light they are not where the materials differ, which shows as a band. The number
/// for a gradient is its greatest step under the other light over its greatest step under the
/// contract's, in ΔE76; 1 is no seam.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[must_use]
pub struct Seam {
    /// The light.
    pub light: String,
    /// How many gradients were measured.
    pub gradients: usize,
    /// The median over the gradients.
    pub median: f64,
    /// The number that one gradient in ten exceeds.
    pub p90: f64,
    /// The greatest.
    pub worst: f64,
}

/// Straight gradients between pseudo-random colors.
const GRADIENTS: usize = 1000;
const STEPS: u16 = 256;
/// A color is matched if the blend of its materials is this near, ΔE00.
const MATCHED: f64 = 0.1;
/// Gradients with smaller steps are gray in gray and have no seams, ΔE76.
const LEAST_STEP: f64 = 0.02;

/// The lights under which seams are measured: incandescent light, a white LED, and an ultraviolet lamp.
pub(crate) fn lights() -> [Illuminant; 3] {
    let named = |name| Illuminant::named(name).expect("it is built in");
    [named("A"), named("LED-B3"), ultraviolet_lamp()]
}

/// A lamp at 365 nm, 20 nm wide at half of its greatest power, with a twentieth of daylight.
///
/// The line is a Gaussian of power 100 at its peak; D65, which has power 100 at 560 nm, is multiplied by 0.05.
/// Each has about half of the power.
pub(crate) fn ultraviolet_lamp() -> Illuminant {
    let line = Illuminant::line("line", 365.0, 20.0).expect("it is a line");
    let daylight = Illuminant::named("D65").expect("it is built in");
    let power = line.power().values().iter().zip(daylight.power().values());
    let power = power.map(|(line, day)| line + 0.05 * day).collect();
    let power = Spectrum::new(Grid::FINE, power).expect("sums of finite numbers");
    Illuminant::from_spectrum("UV lamp", &power).expect("it has visible power")
}

/// The seams of a cube's gradients under incandescent light, a white LED and an ultraviolet lamp.
pub fn seams(cube: &Cube) -> Vec<Seam> {
    let contract = cube.contract();
    let home = Colors::new(cube, contract);
    let gradients = gradients(cube);
    let steps: Vec<f64> = gradients.iter().map(|ends| home.greatest_step(ends)).collect();
    lights()
        .into_iter()
        .map(|illuminant| {
            let light = illuminant.name().to_owned();
            let away = Colors::new(cube, &Contract { illuminant, ..contract.clone() });
            let pairs = gradients.iter().zip(&steps).filter(|(_, step)| **step > LEAST_STEP);
            let mut ratios: Vec<f64> =
                pairs.map(|(ends, step)| away.greatest_step(ends) / step).collect();
            ratios.sort_by(f64::total_cmp);
            let rank = |share: usize| ratios.get((ratios.len() * share).div_ceil(100).max(1) - 1);
            let at = |share| rank(share).copied().unwrap_or(1.0);
            let gradients = ratios.len();
            Seam { light, gradients, median: at(50), p90: at(90), worst: at(100) }
        })
        .collect()
}

/// Pairs of colors that the cube matches.
fn gradients(cube: &Cube) -> Vec<[[f64; 3]; 2]> {
    let colorimetry = cube.contract().on(Grid::FIT);
    let sums = ModelOnGrid::new(cube.model(), &colorimetry);
    let is_matched = |rgb: &[f64; 3]| {
        let color = LinearRgb(*rgb);
        cube.lookup(color, Interpolation::Blend).is_ok_and(|mixture| {
            let target = colorimetry.xyz_from_rgb(color);
            Metric::De2000.distance(&colorimetry, target, mixture.color(&sums)) <= MATCHED
        })
    };
    let mut colors = (0..8 * GRADIENTS).map(|i| random_rgb(0, i).0).filter(is_matched);
    let mut gradients = Vec::with_capacity(GRADIENTS);
    while gradients.len() < GRADIENTS {
        let (Some(one), Some(two)) = (colors.next(), colors.next()) else { break };
        gradients.push([one, two]);
    }
    gradients
}

/// The colors of a cube's materials under one light.
struct Colors {
    table: ColorTable,
    white: Xyz,
}

impl Colors {
    fn new(cube: &Cube, contract: &Contract) -> Self {
        let colorimetry = contract.on(Grid::FIT);
        Self { table: cube.color_table(&colorimetry), white: colorimetry.white() }
    }

    /// The greatest difference between neighbors on the line between two colors, ΔE76.
    fn greatest_step(&self, [one, two]: &[[f64; 3]; 2]) -> f64 {
        let rgb: Vec<[f32; 3]> = (0..STEPS)
            .map(|i| {
                let t = f64::from(i) / f64::from(STEPS - 1);
                [0, 1, 2].map(|k| to_single((1.0 - t) * one[k] + t * two[k]))
            })
            .collect();
        let mut xyz = vec![[0.0; 3]; rgb.len()];
        self.table.xyz(&rgb, &mut xyz).expect("as many colors");
        let lab: Vec<Lab> =
            xyz.iter().map(|c| lab_from_xyz(Xyz(c.map(f64::from)), self.white)).collect();
        lab.windows(2).map(|pair| pair[0].de76(pair[1])).fold(0.0, f64::max)
    }
}
