//! White, matrices and weights of a contract on a wavelength grid.

use crate::contract::{Contract, ContractError};
use crate::grid::Grid;
use crate::illuminant::Illuminant;
use crate::lab::{Lab, lab_from_xyz};
use crate::light_bands::{LightBands, Summation, total};
use crate::matrix::Matrix3;
use crate::observer::Observer;
use crate::values::{LinearRgb, Xyz};

/// White, matrices and integration weights of a [`Contract`] on a [`Grid`].
#[derive(Clone, Debug, PartialEq)]
pub struct Colorimetry {
    grid: Grid,
    summation: Summation,
    wavelengths_nm: Vec<f64>,
    irradiance: Vec<f64>,
    matching: Vec<[f64; 3]>,
    seen: Vec<[f64; 3]>,
    weights: Vec<[f64; 3]>,
    white: Xyz,
    xyz_from_rgb: Matrix3,
    rgb_from_xyz: Matrix3,
}

/// Least visible share of a light, and least X or Z of its white, where Y is 1. Below it, colors that
/// fluorescence adds or that adaptation scales leave the range of single precision when they are
/// multiplied; above it, a lamp whose light is nearly all ultraviolet would be refused.
pub(crate) const LEAST_SHARE: f64 = 1e-12;

impl Colorimetry {
    pub(crate) fn try_new(contract: &Contract, grid: Grid) -> Result<Self, ContractError> {
        let matching = contract.observer.on(grid);
        let LightBands { wavelengths_nm, power, seen, summation } =
            LightBands::new(&contract.illuminant, &contract.observer, grid);
        let luminance: f64 = power.iter().zip(&seen).map(|(l, m)| l * m[1]).sum();
        let names = || (contract.observer.name().to_owned(), contract.illuminant.name().to_owned());
        if !(luminance.is_normal() && luminance > 0.0) {
            let (observer, illuminant) = names();
            let step_nm = grid.step_nm();
            return Err(ContractError::Dark { observer, illuminant, step_nm });
        }
        let all: f64 = power.iter().sum();
        let share = luminance / (all * contract.observer.matching()[1].peak());
        if share < LEAST_SHARE {
            let (observer, illuminant) = names();
            return Err(ContractError::Dim { observer, illuminant, share });
        }
        let irradiance: Vec<f64> = power.iter().map(|l| l / luminance).collect();
        let (weights, white) = weights(&irradiance, &seen);
        let space_white = Xyz::from_chromaticity(contract.space.white());
        let xyz_from_rgb = contract.adaptation.target_from_source(space_white, white)
            * contract.space.xyz_from_rgb();
        let is_bright = white.0.iter().all(|v| (LEAST_SHARE..=LEAST_SHARE.recip()).contains(v));
        let rgb_from_xyz = xyz_from_rgb.inverse().filter(|_| is_bright).ok_or_else(|| {
            let (observer, illuminant) = names();
            ContractError::White { observer, illuminant, white: white.0 }
        })?;
        Ok(Self {
            grid,
            summation,
            wavelengths_nm,
            irradiance,
            matching,
            seen,
            weights,
            white,
            xyz_from_rgb,
            rgb_from_xyz,
        })
    }

    /// The grid of sums over emitted light.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// The wavelengths of sums over incident light, nm. For a smooth light they are those of the grid.
    /// For a light with structure between them, such as lines, they are as many other whole numbers,
    /// which include the ends of the grid and are dense where the light's structure is; sums over them
    /// are exact for reflectances that are linear between them.
    pub fn wavelengths_nm(&self) -> &[f64] {
        &self.wavelengths_nm
    }

    /// Irradiance of each band of incident light, scaled so that the perfect diffuser has Y = 1,
    /// `[wavelength]`.
    pub fn irradiance(&self) -> &[f64] {
        &self.irradiance
    }

    /// x̄, ȳ, z̄ at each wavelength of the grid, for emitted light, `[wavelength][x̄ ȳ z̄]`.
    pub fn matching(&self) -> &[[f64; 3]] {
        &self.matching
    }

    /// Mean x̄, ȳ, z̄ of each band of incident light, `[wavelength][x̄ ȳ z̄]`.
    pub(crate) fn seen(&self) -> &[[f64; 3]] {
        &self.seen
    }

    /// What a reflectance of 1 in each band of incident light adds to X, Y, Z, `[wavelength][X Y Z]`.
    pub fn weights(&self) -> &[[f64; 3]] {
        &self.weights
    }

    /// The perfect diffuser.
    pub fn white(&self) -> Xyz {
        self.white
    }

    /// The color of linear RGB.
    pub fn xyz_from_rgb(&self, rgb: LinearRgb) -> Xyz {
        Xyz(self.xyz_from_rgb * rgb.0)
    }

    /// The matrix behind [`Colorimetry::xyz_from_rgb`]; its columns are the XYZ of the primaries.
    pub fn xyz_from_rgb_matrix(&self) -> Matrix3 {
        self.xyz_from_rgb
    }

    /// Linear RGB of a color.
    pub fn rgb_from_xyz(&self, xyz: Xyz) -> LinearRgb {
        LinearRgb(self.rgb_from_xyz * xyz.0)
    }

    /// The matrix behind [`Colorimetry::rgb_from_xyz`].
    pub fn rgb_from_xyz_matrix(&self) -> Matrix3 {
        self.rgb_from_xyz
    }

    /// CIELAB of a color relative to [`Colorimetry::white`].
    pub fn lab_from_xyz(&self, xyz: Xyz) -> Lab {
        lab_from_xyz(xyz, self.white)
    }

    /// The color of a reflectance sampled at [`Colorimetry::wavelengths_nm`].
    pub fn xyz_from_reflectance(&self, reflectance: impl IntoIterator<Item = f64>) -> Xyz {
        reflectance.into_iter().zip(&self.weights).map(|(r, w)| r * Xyz(*w)).sum()
    }

    /// The same sums over light of other power, `[wavelength]`.
    pub(crate) fn with_irradiance(&self, irradiance: Vec<f64>) -> Self {
        let (weights, white) = weights(&irradiance, &self.seen);
        Self { irradiance, weights, white, ..self.clone() }
    }

    /// The same light, seen by one sensor in place of an observer: its sum is X, and Y and Z are 0.
    pub(crate) fn seen_by(&self, sensor: impl Fn(f64) -> f64) -> Self {
        let alone = |nm: f64| [sensor(nm), 0.0, 0.0];
        let matching = self.grid.wavelengths_nm().map(alone).collect();
        let seen: Vec<[f64; 3]> = self.wavelengths_nm.iter().map(|nm| alone(*nm)).collect();
        let (weights, white) = weights(&self.irradiance, &seen);
        Self { matching, seen, weights, white, ..self.clone() }
    }

    /// The same for `light`, scaled to as much power over the grid as this one has.
    ///
    /// A contract's white always has Y = 1. Lights of equal power compare instead: under an
    /// ultraviolet lamp white is nearly black, and what fluoresces is not.
    #[must_use]
    pub fn relit(&self, observer: &Observer, light: &Illuminant) -> Self {
        let matching = observer.on(self.grid);
        let LightBands { wavelengths_nm, power, seen, summation } =
            LightBands::new(light, observer, self.grid);
        let scale = total(self.grid, &self.irradiance, self.summation, summation)
            / total(self.grid, &power, summation, self.summation);
        let irradiance: Vec<f64> = power.iter().map(|l| l * scale).collect();
        let (weights, white) = weights(&irradiance, &seen);
        Self {
            summation,
            wavelengths_nm,
            irradiance,
            matching,
            seen,
            weights,
            white,
            ..self.clone()
        }
    }
}

/// Integration weights, and their sum, the white.
fn weights(irradiance: &[f64], seen: &[[f64; 3]]) -> (Vec<[f64; 3]>, Xyz) {
    let weights: Vec<_> = irradiance.iter().zip(seen).map(|(e, m)| m.map(|v| e * v)).collect();
    let white = weights.iter().copied().map(Xyz).sum();
    (weights, white)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adaptation::Adaptation;

    /// Rounding only: sums of a hundred numbers near 0.01.
    const ROUNDING: f64 = 1e-12;

    fn assert_close(found: [f64; 3], expected: [f64; 3], tolerance: f64) {
        for k in 0..3 {
            assert!((found[k] - expected[k]).abs() < tolerance, "{found:?} {expected:?}");
        }
    }

    #[test]
    fn with_bradford_rgb_1_is_the_perfect_diffuser_in_every_space() {
        for name in crate::RgbSpace::names() {
            let space = crate::RgbSpace::named(name).unwrap();
            let colorimetry = Contract { space, ..Contract::default() }.on(Grid::FIT);
            let white = colorimetry.xyz_from_rgb(LinearRgb([1.0; 3]));
            assert_close(white.0, colorimetry.white().0, ROUNDING);
        }
    }

    #[test]
    fn without_adaptation_the_diffuser_has_the_published_acescg_values() {
        let contract = Contract { adaptation: Adaptation::None, ..Contract::default() };
        let rgb = contract.on(Grid::FIT);
        let diffuser = rgb.rgb_from_xyz(rgb.white());
        // Five printed digits.
        assert_close(diffuser.0, [0.977_48, 1.002_79, 1.079_19], 1e-5);
    }

    #[test]
    fn relighting_with_the_same_light_changes_nothing() {
        let contract = Contract::default();
        let colorimetry = contract.on(Grid::FIT);
        let relit = colorimetry.relit(&contract.observer, &contract.illuminant);
        assert_close(relit.white().0, colorimetry.white().0, ROUNDING);
    }

    #[test]
    fn relighting_with_lines_gives_the_same_white_by_sums_over_5_and_1_nm() {
        // Sums of daylight over 5 nm and over 1 nm.
        const DAYLIGHT: f64 = 5e-4;
        let contract = Contract::default();
        for peak_nm in [405.2, 546.1, 588.0] {
            let line = Illuminant::line("line", peak_nm, 1.5).unwrap();
            let white = |grid| contract.on(grid).relit(&contract.observer, &line).white();
            let (fit, fine) = (white(Grid::FIT), white(Grid::FINE));
            for k in 0..3 {
                let error = (fit.0[k] - fine.0[k]).abs();
                assert!(error <= DAYLIGHT * fine.0[k], "{peak_nm} {fit:?} {fine:?}");
            }
        }
    }

    #[test]
    fn rgb_to_xyz_and_back_is_the_identity() {
        let colorimetry = Contract::default().on(Grid::FIT);
        let rgb = LinearRgb([0.9, -0.2, 1.7]);
        assert_close(colorimetry.rgb_from_xyz(colorimetry.xyz_from_rgb(rgb)).0, rgb.0, ROUNDING);
    }
}
