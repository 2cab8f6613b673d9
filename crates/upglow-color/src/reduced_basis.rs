//! The lights by which materials are reduced to 4×4 matrices.

use crate::colorimetry::Colorimetry;
use crate::contract::{Contract, ContractError};
use crate::grid::Grid;
use crate::illuminant::Illuminant;
use crate::reduced_matrix::{ReducedMatrix, Reduction, Xyzu};
use crate::rgb_space::RgbSpace;

/// Four parts of a contract's light, by which a light given as X, Y, Z and ultraviolet is taken for a spectrum, so
/// that materials act on it by 4×4 matrices.
///
/// A part is the contract's light times a smooth function of wavelength; the four functions, blue, green, red and
/// ultraviolet, add up to 1 ([`ReducedBasis::shares_at`]). A light of four numbers is taken for the sum of parts
/// that has them. The matrix is therefore exact under the contract's light, and near under every light that is the
/// contract's times something smooth.
///
/// # Source
///
/// Matrices of light as X, Y, Z and ultraviolet: `fichet_rgb`, which take a light for a sum of
/// matching functions. Parts of daylight are ours: lights differ less from daylight than from those.
///
/// # Examples
///
/// ```
/// use upglow_color::{Contract, Grid, Illuminant, ReducedBasis};
///
/// let basis = ReducedBasis::try_new(&Contract::default(), Grid::FIT)?;
/// let [_, y, _, u] = basis.light(&Illuminant::default()).0;
/// assert!((y - 1.0).abs() < 1e-12 && (u - 1.0).abs() < 1e-12);
/// let [_, _, _, u] = basis.light(&Illuminant::named("A")?).0;
/// assert!(u < 0.2, "incandescent light has little ultraviolet");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ReducedBasis {
    contract: Contract,
    grid: Grid,
    parts: [Colorimetry; 4],
    /// The same parts as the sensor of U sees them.
    ultraviolet: [Colorimetry; 4],
    ultraviolet_of_daylight: f64,
    reduction: Reduction,
}

/// The RGB space that an engine keeps light in: linear red, green and blue, each 1 in the contract's light, and U.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct EngineSpace {
    rgb_from_xyz: ReducedMatrix,
    xyz_from_rgb: ReducedMatrix,
}

impl EngineSpace {
    /// Red, green, blue and U of a light: C·v.
    pub fn light(&self, light: Xyzu) -> Xyzu {
        self.rgb_from_xyz * light
    }

    /// The matrix for such lights: C·M·C⁻¹.
    pub fn matrix(&self, matrix: ReducedMatrix) -> ReducedMatrix {
        self.rgb_from_xyz * matrix * self.xyz_from_rgb
    }
}

/// Why a contract's light has no such parts.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReducedBasisError {
    /// The contract is rejected.
    #[error(transparent)]
    Contract(#[from] ContractError),
    /// A part of the light has next to no power.
    #[error(
        "the light {illuminant} has {share:e} of its power in the {part} band of matrices, expected at least {LEAST_SHARE:e}"
    )]
    Dark {
        /// Name of the light.
        illuminant: String,
        /// blue, green or red.
        part: &'static str,
        /// Its share of the power.
        share: f64,
    },
    /// The observer cannot tell the parts apart.
    #[error("the observer {observer} cannot tell blue, green and red light of {illuminant} apart")]
    Alike {
        /// Name of the observer.
        observer: String,
        /// Name of the light.
        illuminant: String,
    },
}

/// Least share of a light's power in a part. With less, rounding of what the observer sees of it is no longer
/// small beside it.
const LEAST_SHARE: f64 = 1e-3;

/// Least share of ultraviolet in a light that has its own; lamps have less.
const LEAST_ULTRAVIOLET: f64 = 1e-3;

/// Where blue turns to green, and green to red, nm. Chosen by the colors of measured fluorescent samples
/// under nine lights, as [`ULTRAVIOLET_PART_NM`] and [`ULTRAVIOLET_SENSOR_NM`]; `docs/rgb-engines.md` has the
/// errors. Narrower ramps make more matrices return light stronger than it came.
const GREEN_FROM_NM: [f64; 2] = [470.0, 550.0];
const RED_FROM_NM: [f64; 2] = [540.0, 620.0];

/// Where the ultraviolet part rises and falls, nm: around 365 nm, where lamps emit and most dyes absorb. What
/// daylight has below goes with blue: if all below 400 nm is one part, the error under an ultraviolet lamp is
/// three times as large.
const ULTRAVIOLET_PART_NM: [[f64; 2]; 2] = [[340.0, 360.0], [370.0, 390.0]];

/// Where the sensor of U rises and falls, nm. It reaches into the visible: what absorbs at 380 nm absorbs at
/// 410 nm too, where lamps without ultraviolet still emit.
const ULTRAVIOLET_SENSOR_NM: [[f64; 2]; 2] = [[300.0, 380.0], [390.0, 430.0]];

/// 0 up to the first wavelength, 1 from the second.
fn ramp([from_nm, to_nm]: [f64; 2], nm: f64) -> f64 {
    ((nm - from_nm) / (to_nm - from_nm)).clamp(0.0, 1.0)
}

fn bump([rise_nm, fall_nm]: [[f64; 2]; 2], nm: f64) -> f64 {
    ramp(rise_nm, nm) - ramp(fall_nm, nm)
}

impl ReducedBasis {
    /// The parts of the contract's light by sums over `grid`.
    ///
    /// A light without ultraviolet, such as a lamp's, is divided into three parts; the fourth is then
    /// equal power in the ultraviolet band.
    ///
    /// # Errors
    ///
    /// [`ReducedBasisError`] if the contract is rejected, or its light is so narrow that a part has no power.
    pub fn try_new(contract: &Contract, grid: Grid) -> Result<Self, ReducedBasisError> {
        let own = Colorimetry::try_new(contract, grid)?;
        let daylight = Contract { illuminant: Illuminant::default(), ..contract.clone() };
        let daylight = Colorimetry::try_new(&daylight, grid)?;
        let ultraviolet_of_daylight = seen_by_u(&daylight).white().0[0];
        let power = Self::parts_of(own.wavelengths_nm(), own.irradiance());
        let total: f64 = own.irradiance().iter().sum();
        for (part, power) in ["blue", "green", "red"].into_iter().zip(&power) {
            let share = power.iter().sum::<f64>() / total;
            if share.is_nan() || share < LEAST_SHARE {
                let illuminant = contract.illuminant.name().to_owned();
                return Err(ReducedBasisError::Dark { illuminant, part, share });
            }
        }
        let parts = power.map(|power| own.with_irradiance(power));
        let ultraviolet = parts.each_ref().map(seen_by_u);
        let numbers = |part: &Colorimetry, u: &Colorimetry| {
            let [x, y, z] = part.white().0;
            Xyzu([x, y, z, u.white().0[0] / ultraviolet_of_daylight])
        };
        let lights = std::array::from_fn(|k| numbers(&parts[k], &ultraviolet[k]));
        let white = numbers(&own, &seen_by_u(&own));
        let reduction = Reduction::try_new(lights, white).ok_or_else(|| {
            let observer = contract.observer.name().to_owned();
            ReducedBasisError::Alike { observer, illuminant: contract.illuminant.name().to_owned() }
        })?;
        let contract = contract.clone();
        Ok(Self { contract, grid, parts, ultraviolet, ultraviolet_of_daylight, reduction })
    }

    /// What of a light at a wavelength is in the blue, the green, the red and the ultraviolet part; the four add up
    /// to 1.
    pub fn shares_at(nm: f64) -> [f64; 4] {
        let ultraviolet = bump(ULTRAVIOLET_PART_NM, nm);
        let [green, red] = [GREEN_FROM_NM, RED_FROM_NM].map(|ends| ramp(ends, nm));
        [1.0 - green - ultraviolet, green - red, red, ultraviolet]
    }

    /// The sensor of U: how much light at a wavelength counts, 0..=1.
    pub fn ultraviolet_at(nm: f64) -> f64 {
        bump(ULTRAVIOLET_SENSOR_NM, nm)
    }

    /// Power of the four parts of a light of this power at wavelengths, nm; `[part][wavelength]`.
    #[must_use]
    pub fn parts_of(wavelengths_nm: &[f64], power: &[f64]) -> [Vec<f64>; 4] {
        let shares: Vec<[f64; 4]> = wavelengths_nm.iter().map(|nm| Self::shares_at(*nm)).collect();
        let each = || shares.iter().zip(power);
        let ultraviolet: f64 = each().map(|(share, power)| share[3] * power).sum();
        if ultraviolet >= LEAST_ULTRAVIOLET * power.iter().sum::<f64>() {
            return [0, 1, 2, 3].map(|k| each().map(|(share, power)| share[k] * power).collect());
        }
        let of = |part: usize| -> Vec<f64> {
            match part {
                0 => each().map(|([blue, .., u], power)| (blue + u) * power).collect(),
                3 => shares.iter().map(|share| share[3]).collect(),
                k => each().map(|(share, power)| share[k] * power).collect(),
            }
        };
        [0, 1, 2, 3].map(of)
    }

    /// A light as four numbers. It is scaled so that a perfect diffuser has Y = 1; light too dark to see by, such
    /// as an ultraviolet lamp's, to as much power as the contract's light has.
    pub fn light(&self, light: &Illuminant) -> Xyzu {
        let seen = self.contract.seen_under(light, self.grid).colorimetry;
        let [x, y, z] = seen.white().0;
        Xyzu([x, y, z, self.u(seen_by_u(&seen).white().0[0])])
    }

    /// Light and matrices for an engine that keeps light in this RGB space.
    ///
    /// # Errors
    ///
    /// [`ContractError`] if the contract's light and observer do not fit the space.
    pub fn engine_space(&self, space: &RgbSpace) -> Result<EngineSpace, ContractError> {
        let contract = Contract { space: space.clone(), ..self.contract.clone() };
        let colorimetry = Colorimetry::try_new(&contract, self.grid)?;
        Ok(EngineSpace {
            rgb_from_xyz: ReducedMatrix::of_colors(colorimetry.rgb_from_xyz_matrix()),
            xyz_from_rgb: ReducedMatrix::of_colors(colorimetry.xyz_from_rgb_matrix()),
        })
    }

    /// The contract's light as four numbers.
    pub fn white(&self) -> Xyzu {
        self.reduction.white()
    }

    /// The sums over each of the four parts for the contract's observer.
    pub fn parts(&self) -> &[Colorimetry; 4] {
        &self.parts
    }

    /// The sums over each of the four parts for the sensor of U, whose result is X; [`ReducedBasis::u`] has its
    /// unit.
    pub fn parts_in_ultraviolet(&self) -> &[Colorimetry; 4] {
        &self.ultraviolet
    }

    /// U of a sum over [`ReducedBasis::ultraviolet_at`], in units of daylight's.
    pub fn u(&self, sum: f64) -> f64 {
        sum / self.ultraviolet_of_daylight
    }

    /// How matrices are made of what a material makes of the four parts.
    pub fn reduction(&self) -> &Reduction {
        &self.reduction
    }
}

fn seen_by_u(sums: &Colorimetry) -> Colorimetry {
    sums.seen_by(ReducedBasis::ultraviolet_at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_fractions_and_add_up_to_1() {
        for nm in Grid::FINE.wavelengths_nm() {
            let shares = ReducedBasis::shares_at(nm);
            assert!(shares.iter().all(|share| (0.0..=1.0).contains(share)), "{nm} {shares:?}");
            // Rounding only.
            assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-15, "{nm} {shares:?}");
        }
    }

    #[test]
    fn every_light_with_blue_green_and_red_is_a_sum_of_its_parts() {
        // Rounding only, of sums of a hundred numbers.
        const EXACT: f64 = 1e-12;
        for name in Illuminant::names() {
            let illuminant = Illuminant::named(name).unwrap();
            let contract = Contract { illuminant, ..Contract::default() };
            let basis = match ReducedBasis::try_new(&contract, Grid::FIT) {
                Ok(basis) => basis,
                Err(error) => panic!("{name}: {error}"),
            };
            let light = basis.light(&contract.illuminant);
            for k in 0..4 {
                assert!((light.0[k] - basis.white().0[k]).abs() < EXACT, "{name}");
            }
            let all = basis.parts().iter().fold(0.0, |sum, part| sum + part.white().0[0]);
            let [_, _, _, ultraviolet] = basis.parts();
            let without = all - ultraviolet.white().0[0];
            let x = basis.white().0[0];
            assert!((all - x).abs().min((without - x).abs()) < EXACT, "{name} {all} {without} {x}");
        }
    }

    #[test]
    fn a_light_of_one_line_is_refused_by_its_empty_band() {
        let illuminant = Illuminant::line("laser", 632.8, 2.0).unwrap();
        let contract = Contract { illuminant, ..Contract::default() };
        let error = ReducedBasis::try_new(&contract, Grid::FIT).unwrap_err().to_string();
        assert!(
            error.starts_with("the light laser has 0e0 of its power in the blue band"),
            "{error}"
        );
    }
}
