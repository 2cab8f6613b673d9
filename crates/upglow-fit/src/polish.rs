//! One material per texel, instead of a blend of four.

mod candidate;
mod corner;
mod descent;
mod emission;
mod repeats;
mod start;
mod texel;

use upglow::{Cube, FitRecord, Fluorescence, LengthError, Model, Node};
use upglow_color::{LinearRgb, Matrix3};

use crate::fitter::Fitter;
use crate::options::{FitOptions, FitOptionsError};
use crate::problem::parabola::UNIT_NM;
use crate::problem::single_sums::SingleSums;
use corner::{Corners, Slot};
use emission::Emission;
use repeats::Repeats;
use start::{Family, Glow};
use texel::Texel;

/// Finds one material for each of millions of colors, for textures.
///
/// A blend mixes four materials; a texture stores one. The mean of the materials at the corners of a
/// color's tetrahedron starts near the color, and a few Newton steps of least length, with sums in
/// single precision, lead to it. Similar colors get similar materials.
///
/// Materials respect the cube's slope limits, that under dyes if any node around the color has dyes. A
/// material is steeper only between steeper nodes, or by the cube's own rule if its limits are relaxed. Grays are flat and do not fluoresce if the cube's contract
/// makes white the perfect diffuser, and a material between some that do not fluoresce does not
/// either. Each color is processed alone: results do not depend on how an image is divided into
/// batches, or on the processor.
///
/// # Examples
///
/// ```
/// use upglow::Node;
/// use upglow_color::Contract;
/// use upglow_fit::{Polisher, Preset, Unwatched, build_cube};
///
/// let preset = Preset::Konig2020;
/// let (model, options) = (preset.model(), preset.options());
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
    corners: Vec<Slot>,
    /// Emission of each pair of dyes.
    emissions: Vec<Emission>,
    xyz_from_rgb: Matrix3,
    /// One over X, Y, Z of the perfect diffuser.
    per_white: [f64; 3],
    grays_are_flat: bool,
    slope_limits_per_nm: SlopeLimits,
}

/// The greatest slopes of texels between corners that are not steeper, 1/nm.
#[derive(Clone, Copy, Debug)]
struct SlopeLimits {
    /// Where nothing fluoresces.
    alone: f64,
    under_dyes: f64,
}

/// If grays are flat, white differs from the perfect diffuser by less than this: rounding only.
const FLAT: f64 = 1e-9;

impl<'c> Polisher<'c> {
    /// Prepares for the colors of a cube.
    ///
    /// # Errors
    ///
    /// [`FitOptionsError`] if the cube's slope limit is out of the range for fits.
    pub fn new(cube: &'c Cube) -> Result<Self, FitOptionsError> {
        let &FitRecord { slope_max_per_nm, slope_under_dyes_per_nm, relaxed, .. } = cube.fit();
        let options = FitOptions {
            slope_max_per_nm,
            slope_under_dyes_per_nm,
            relaxed,
            ..FitOptions::default()
        };
        let fitter = Fitter::new(cube.contract(), cube.model(), options)?;
        let model = fitter.model();
        let corners = (0..cube.nodes().len()).map(|_| Slot::default()).collect();
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
        let slope_limits_per_nm = SlopeLimits {
            alone: fitter.alone.slope_limit_per_nm,
            under_dyes: fitter.main().slope_limit_per_nm,
        };
        Ok(Self {
            cube,
            corners,
            emissions,
            xyz_from_rgb,
            per_white,
            grays_are_flat,
            slope_limits_per_nm,
            fitter,
        })
    }

    fn sums(&self) -> &SingleSums {
        &self.fitter.context.single_sums
    }

    /// One material for each RGB. It matches if the corners' materials match their colors, as far as
    /// the search finds a single material that does.
    ///
    /// `de2000` of a texel is the difference from the color under the contract, by sums over 5 nm, or,
    /// for a match, a bound below 0.01. If no material matches, the texel gets the nearest one found,
    /// which can be further from the color than the blend of four materials.
    ///
    /// An RGB with a component that is NaN or not in 0..=1 has no material: all numbers of its texel are
    /// NaN. Returns how many there are.
    ///
    /// # Errors
    ///
    /// [`LengthError`] if the arrays differ in length; `out` is then untouched.
    pub fn polish(&self, rgb: &[[f32; 3]], out: &mut [Node]) -> Result<usize, LengthError> {
        self.each(rgb, out, |rgb, corners| Texel::new(self, rgb, corners).polish())
    }

    /// The same with a single step, in less than half the time: most colors are matched, but none is
    /// checked. `de2000` is NaN for all but grays.
    ///
    /// An RGB with a component that is NaN or not in 0..=1 gets a texel of NaN. Returns how many there are.
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
                None => {
                    let rgb = LinearRgb(rgb[texel].map(f64::from));
                    let model = self.fitter.model();
                    let corner = |(index, weight): (usize, f64)| {
                        (weight, self.corners[index].get(self.cube, index, model))
                    };
                    let corners = self.cube.corners(rgb);
                    corners.map_or(NOWHERE, |corners| material(rgb, &corners.map(corner)))
                }
            };
        }
        Ok(outside)
    }
}

/// The texel of a color outside the cube.
const NOWHERE: Node = Node {
    reflectance: [f32::NAN; 3],
    dyes: [0; 2],
    fluorescence: [f32::NAN; 3],
    de2000: f32::NAN,
};

impl Glow {
    fn fluorescence(&self) -> Fluorescence {
        let [concentration, u, v] = self.numbers;
        match self.family {
            Family::Pair(first) if concentration > 0.0 => {
                Fluorescence::Dyes { first, weight: u, concentration }
            }
            Family::Film([first, second]) => {
                Fluorescence::film((first, concentration), (second, u))
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
