//! How colorful materials of each kind can be, by lightness and hue.

use rayon::prelude::*;
use upglow::{Cube, Model};
use upglow_color::rounding::to_single;
use upglow_color::{ColorSolid, ColorSolids, Contract, Grid, Lab, RgbSpace, Xyz, xyz_from_lab};
use upglow_fit::{CubeSummary, FitOptions, FitOptionsError, Fitter, Preset};

/// Lightness in steps of 3.125 from 0 to 100.
pub(crate) const LIGHTNESSES: usize = 33;
/// Hue in steps of 5°.
pub(crate) const HUES: usize = 72;
/// A reflectance within the cube's slope limit, any reflectance, any fluorescent material.
pub(crate) const KINDS: usize = 3;

/// More colorful than any fluorescent material, C*.
const MOST_CHROMA: f64 = 512.0;
/// Halvings from there: to half a unit of chroma.
const HALVINGS: u32 = 10;
/// Halvings between gray and the border of all reflectances: to less than a unit of chroma.
const HALVINGS_OF_FITS: u32 = 7;

/// Fits reflectances within a slope limit.
///
/// # Errors
///
/// [`FitOptionsError`] if the limit is out of range.
pub(crate) fn passive_fitter(
    contract: &Contract,
    slope_max_per_nm: Option<f64>,
) -> Result<Fitter, FitOptionsError> {
    let options = FitOptions {
        slope_max_per_nm,
        slope_under_dyes_per_nm: slope_max_per_nm,
        relaxed: false,
        ..Preset::default().options()
    };
    Fitter::new(contract, &Model::Reflectance, options)
}

/// The contract in a space in which all real colors have components above 0, which fits need.
pub(crate) fn all_colors(contract: &Contract) -> Contract {
    let space = RgbSpace::named("aces2065-1").unwrap_or_default();
    Contract { space, ..contract.clone() }
}

/// Greatest C* of each kind of material, `[kind][lightness][hue]`.
///
/// The search assumes that along a hue every color short of the border is within reach, as it is for
/// convex sets in all but the corners of Lab.
///
/// # Errors
///
/// [`FitOptionsError`] if the cube's slope limit is out of range.
pub(crate) fn borders(cube: &Cube) -> Result<Vec<f32>, FitOptionsError> {
    let contract = all_colors(cube.contract());
    let colorimetry = contract.on(Grid::FIT);
    let solids = ColorSolids::new(&colorimetry);
    let fitter = passive_fitter(&contract, cube.fit().slope_max_per_nm)?;
    let directions: Vec<Direction> = (0..LIGHTNESSES * HUES).map(Direction::new).collect();
    let found: Vec<[f64; KINDS]> = directions
        .into_par_iter()
        .map(|direction| {
            let color = |chroma| direction.color(chroma, colorimetry.white());
            let any = |solid: &ColorSolid| {
                furthest(MOST_CHROMA, HALVINGS, |chroma| solid.contains(color(chroma)))
            };
            let reflectance = any(&solids.reflectance);
            let smooth = furthest(reflectance, HALVINGS_OF_FITS, |chroma| {
                let fit = fitter.fit(colorimetry.rgb_from_xyz(color(chroma)));
                fit.is_ok_and(|fit| fit.de2000 <= CubeSummary::EXACT_DE2000)
            });
            [smooth, reflectance, any(&solids.fluorescence)]
        })
        .collect();
    let of_kind = |kind: usize| found.iter().map(move |chroma| chroma[kind]);
    Ok((0..KINDS).flat_map(of_kind).map(to_single).collect())
}

/// The greatest chroma that is within reach, between 0 and `most`.
fn furthest(most: f64, halvings: u32, is_reached: impl Fn(f64) -> bool) -> f64 {
    if is_reached(most) {
        return most;
    }
    let (mut inside, mut outside) = (0.0, most);
    for _ in 0..halvings {
        let middle = 0.5 * (inside + outside);
        if is_reached(middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    inside
}

/// A lightness and a hue.
struct Direction {
    lightness: f64,
    cos: f64,
    sin: f64,
}

impl Direction {
    fn new(index: usize) -> Self {
        let hue = (index % HUES) as f64 * std::f64::consts::TAU / HUES as f64;
        let lightness = (index / HUES) as f64 * 100.0 / (LIGHTNESSES - 1) as f64;
        Self { lightness, cos: hue.cos(), sin: hue.sin() }
    }

    fn color(&self, chroma: f64, white: Xyz) -> Xyz {
        let lab = Lab { l: self.lightness, a: chroma * self.cos, b: chroma * self.sin };
        xyz_from_lab(lab, white)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_cube;

    #[test]
    fn kinds_are_ordered_and_black_and_white_have_no_color() {
        let found = borders(&test_cube()).unwrap();
        let at =
            |kind: usize, row: usize, hue: usize| found[(kind * LIGHTNESSES + row) * HUES + hue];
        for hue in 0..HUES {
            for row in 0..LIGHTNESSES {
                let [smooth, passive, any] = [0, 1, 2].map(|kind| at(kind, row, hue));
                assert!(smooth <= passive && passive <= any, "{row} {hue}");
            }
            // Half a unit of chroma is the last halving.
            assert!(at(1, 0, hue) <= 0.5 && at(1, LIGHTNESSES - 1, hue) <= 0.5, "{hue}");
            // The solid of fluorescent materials goes on above white.
            assert!(at(2, LIGHTNESSES - 1, hue) > 1.0, "{hue}");
        }
    }

    #[test]
    fn a_border_divides_what_is_within_reach_from_what_is_not() {
        let cube = test_cube();
        let found = borders(&cube).unwrap();
        let colorimetry = cube.contract().on(Grid::FIT);
        let solids = ColorSolids::new(&colorimetry);
        for index in (0..LIGHTNESSES * HUES).step_by(61) {
            let direction = Direction::new(index);
            for (solid, kind) in [(&solids.reflectance, 1), (&solids.fluorescence, 2)] {
                let chroma = f64::from(found[kind * LIGHTNESSES * HUES + index]);
                let contains =
                    |chroma| solid.contains(direction.color(chroma, colorimetry.white()));
                // Halvings end within half a unit.
                assert!(contains(chroma) && !contains(chroma + 0.51), "{kind} {index} {chroma}");
            }
        }
    }
}
