//! One material for each texel: from a cube's blend to six numbers.

mod candidate;
mod corner;
mod descent;
mod emission;
mod repeats;
mod start;
mod sums;
mod texel;

use upglow::{AnalyticModel, Cube, Fluorescence, LengthError, Model, Node};
use upglow_color::{LinearRgb, Matrix3};

use crate::fitter::Fitter;
use crate::options::{FitOptions, FitOptionsError};
use crate::problem::parabola::UNIT_NM;
use corner::{Corner, Corners};
use emission::Emission;
use repeats::Repeats;
use start::{Family, Glow};
use sums::SingleSums;
use texel::Texel;

/// Finds one material for each of millions of colors: what a texture stores.
///
/// A blend mixes four materials; a texture stores one. From the materials at the corners of a
/// color's tetrahedron it starts near the color, and a few of Newton's steps of least length, in
/// single precision, lead to it: neighbors end as neighbors.
///
/// What it finds respects the cube's slope limit. Grays are flat and do not fluoresce where the
/// cube's contract makes white the perfect diffuser, and between materials that do not fluoresce
/// no material does. Each color is worked on alone: how an image is cut into batches, and what the
/// processor can do, changes no bit.
///
/// # Examples
///
/// ```
/// use upglow::{DyeModel, DyeOptions, DyeSet, Model, Node};
/// use upglow_color::Contract;
/// use upglow_fit::{FitOptions, Polisher, Unwatched, build_cube};
///
/// let model = Model::Dyes(DyeModel::new(DyeSet::named("konig8")?, DyeOptions::default())?);
/// let options = FitOptions::default();
/// let cube = build_cube(&Contract::default(), &model, options, 5, &Unwatched)?;
/// let polisher = Polisher::new(&cube)?;
/// let mut texels = [Node::default(); 2];
/// let outside = polisher.polish(&[[0.2, 0.5, 0.3], [1.5, 0.0, 0.0]], &mut texels)?;
/// assert_eq!(outside, 1);
/// assert!(texels[0].de2000 < 0.01 && texels[1].de2000.is_nan());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
#[must_use]
pub struct Polisher<'c> {
    cube: &'c Cube,
    fitter: Fitter,
    sums: SingleSums,
    corners: Vec<Corner>,
    /// Of each pair of dyes.
    emissions: Vec<Emission>,
    xyz_from_rgb: Matrix3,
    /// One over X, Y, Z of the perfect diffuser.
    per_white: [f64; 3],
    grays_are_flat: bool,
    slope_limit_per_nm: f64,
}

/// Ranges of the bells' emission peaks and Stokes shifts.
const BELL_RANGES_NM: [[f64; 2]; 2] =
    [AnalyticModel::EMISSION_PEAKS_NM, AnalyticModel::STOKES_SHIFTS_NM];

/// A wavelength difference in the fits' unit.
fn in_units(nm: f64) -> f64 {
    nm / UNIT_NM
}

/// White differs from the perfect diffuser by less than this where grays are flat: rounding only.
const FLAT: f64 = 1e-9;

impl<'c> Polisher<'c> {
    /// Prepares the polishing of colors of a cube.
    ///
    /// # Errors
    ///
    /// [`FitOptionsError`] if the cube's slope limit is one that no fit can keep.
    pub fn new(cube: &'c Cube) -> Result<Self, FitOptionsError> {
        let slope_max_per_nm = cube.fit().slope_max_per_nm;
        let options = FitOptions { slope_max_per_nm, ..FitOptions::default() };
        let fitter = Fitter::new(cube.contract(), cube.model(), options)?;
        let model = fitter.model();
        let corners = (0..cube.nodes().len()).map(|i| Corner::new(cube, i, model)).collect();
        let emissions = match cube.model() {
            Model::Dyes(dyes) => {
                (0..dyes.pairs()).map(|first| Emission::new(model, dyes, first)).collect()
            }
            _ => Vec::new(),
        };
        let colorimetry = model.colorimetry();
        let (diffuser, white) =
            (colorimetry.white(), colorimetry.xyz_from_rgb(LinearRgb([1.0; 3])));
        let xyz_from_rgb = colorimetry.xyz_from_rgb_matrix();
        let per_white = diffuser.0.map(|v| 1.0 / v);
        let grays_are_flat = (white - diffuser).0.iter().all(|v| v.abs() < FLAT);
        let sums = SingleSums::new(model);
        let slope_limit_per_nm = fitter.context.slope_limit_per_nm;
        Ok(Self {
            cube,
            sums,
            corners,
            emissions,
            xyz_from_rgb,
            per_white,
            grays_are_flat,
            slope_limit_per_nm,
            fitter,
        })
    }

    /// One material for each RGB, which shows it wherever the corners' materials show theirs and
    /// this fitter knows a single one that does.
    ///
    /// `de2000` of a texel is at least what the color differs under the contract, sums over 5 nm:
    /// that itself, or a bound below 0.01 where the color is matched. Where no material matches it
    /// is the nearest found; it can be further from the color than the blend is, which is four
    /// materials.
    ///
    /// An RGB with a component that is not a number in 0..=1 has no material: all numbers of its
    /// texel are not-a-number. Returns how many those are.
    ///
    /// # Errors
    ///
    /// [`LengthError`] if the arrays differ in length; `out` is then untouched.
    pub fn polish(&self, rgb: &[[f32; 3]], out: &mut [Node]) -> Result<usize, LengthError> {
        self.each(rgb, out, |rgb, corners| Texel::new(self, rgb, corners).polish())
    }

    /// The same with one step instead of as many as it takes, and in less than half the time: most
    /// colors are matched, but none is checked. `de2000` is not-a-number for all but grays.
    ///
    /// What is outside has a reflectance of not-a-numbers. Returns how many those are.
    ///
    /// # Errors
    ///
    /// As [`Polisher::polish`].
    pub fn interpolate(&self, rgb: &[[f32; 3]], out: &mut [Node]) -> Result<usize, LengthError> {
        self.each(rgb, out, |rgb, corners| Texel::new(self, rgb, corners).interpolate())
    }

    fn each(
        &self,
        rgb: &[[f32; 3]],
        out: &mut [Node],
        material: impl Fn(LinearRgb, &Corners<'_>) -> Node,
    ) -> Result<usize, LengthError> {
        if rgb.len() != out.len() {
            return Err(LengthError { found: out.len(), expected: rgb.len() });
        }
        let mut outside = 0;
        let mut repeats = Repeats::new(rgb.len());
        for texel in 0..rgb.len() {
            if !rgb[texel].iter().all(|v| (0.0..=1.0).contains(v)) {
                outside += 1;
                out[texel] = NOWHERE;
                continue;
            }
            out[texel] = match repeats.earlier(rgb, texel) {
                Some(earlier) => out[earlier],
                None => self.at(rgb[texel], &material),
            };
        }
        Ok(outside)
    }

    #[inline(always)]
    fn at(
        &self,
        [red, green, blue]: [f32; 3],
        material: &impl Fn(LinearRgb, &Corners<'_>) -> Node,
    ) -> Node {
        let rgb = LinearRgb([f64::from(red), f64::from(green), f64::from(blue)]);
        let Ok([a, b, c, d]) = self.cube.corners(rgb) else { return NOWHERE };
        let corner = |(index, weight): (usize, f64)| (weight, &self.corners[index]);
        material(rgb, &[corner(a), corner(b), corner(c), corner(d)])
    }
}

/// What stands for no material.
const NOWHERE: Node =
    Node { reflectance: [f32::NAN; 3], dye: 0, fluorescence: [f32::NAN; 3], de2000: f32::NAN };

impl Glow {
    fn fluorescence(&self) -> Fluorescence {
        let [concentration, u, v] = self.numbers;
        match self.family {
            Family::Pair(first) if concentration > 0.0 => {
                Fluorescence::Dyes { first, weight: u, concentration }
            }
            Family::Bells if concentration > 0.0 => Fluorescence::Analytic {
                emission_peak_nm: u * UNIT_NM,
                stokes_shift_nm: v * UNIT_NM,
                concentration,
            },
            _ => Fluorescence::None,
        }
    }
}
