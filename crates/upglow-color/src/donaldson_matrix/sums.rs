//! A light and an observer on the axes of a matrix.

use super::DonaldsonMatrix;
use crate::contract::{Contract, ContractError, DARK};
use crate::illuminant::Illuminant;
use crate::lab::{Lab, lab_from_xyz};
use crate::light_bands::LightBands;
use crate::matrix::Matrix3;
use crate::observer::Observer;
use crate::values::Xyz;

/// The sums of matrices of the same axes under one light for one observer.
///
/// X, Y, Z = Σₒ x̄ȳz̄(o) Σᵢ D(o, i)·E(i): the power E that arrives in each incident band, and the
/// color-matching functions at each outgoing wavelength. A smooth light is sampled; one with structure
/// between the wavelengths, such as lines, is divided between the two around each nanometer of it. Light
/// beyond the incident wavelengths is left out. So is light beyond the outgoing ones in the white, against
/// which colors are seen.
///
/// # Source
///
/// `astm_e2152`.
#[derive(Clone, Debug, PartialEq)]
pub struct MatrixSums {
    arriving: Vec<f64>,
    matching: Vec<[f64; 3]>,
    diffuser: Xyz,
    white: Xyz,
    is_adapted: bool,
}

impl MatrixSums {
    /// The sums for the axes of `matrix`, scaled so that the perfect diffuser has Y = 1.
    ///
    /// # Errors
    ///
    /// [`ContractError`] if the observer sees nothing of the light.
    pub fn new(
        matrix: &DonaldsonMatrix,
        light: &Illuminant,
        observer: &Observer,
    ) -> Result<Self, ContractError> {
        let unscaled = Self::unscaled(matrix, light, observer);
        let luminance = unscaled.white.0[1];
        if !(luminance.is_normal() && luminance > 0.0) {
            let (observer, illuminant) = (observer.name().into(), light.name().into());
            let step_nm = step_nm(matrix);
            return Err(ContractError::Dark { observer, illuminant, step_nm });
        }
        Ok(unscaled.scaled(luminance.recip()))
    }

    /// The sums under `light` for an observer who is adapted to it; or, if it is too dark for that, under as
    /// much power of it as the contract's light has, for an observer who is adapted to the latter.
    pub(super) fn seen_under(
        matrix: &DonaldsonMatrix,
        contract: &Contract,
        light: &Illuminant,
    ) -> Result<Self, ContractError> {
        let observer = &contract.observer;
        let own = Self::new(matrix, &contract.illuminant, observer)?;
        let other = Self::unscaled(matrix, light, observer);
        let power = |sums: &Self| sums.arriving.iter().sum::<f64>();
        let relit = other.scaled_to(power(&own));
        match Self::new(matrix, light, observer) {
            Ok(adapted) if relit.diffuser.0[1] >= DARK => Ok(adapted),
            _ => Ok(Self { white: own.white, is_adapted: false, ..relit }),
        }
    }

    fn unscaled(matrix: &DonaldsonMatrix, light: &Illuminant, observer: &Observer) -> Self {
        let on = |axis: &[f64]| LightBands::power_around(light, observer, axis);
        let arriving = on(&matrix.incident_nm);
        let at = |nm: &f64| observer.matching().each_ref().map(|curve| curve.at(*nm));
        let matching: Vec<[f64; 3]> = matrix.outgoing_nm.iter().map(at).collect();
        let common: Vec<[usize; 2]> = matrix.diagonal_bands().collect();
        // The diffuser is the matrix with 1 on its diagonal, where that is complete.
        let diffuser: Xyz = if common.len() == matrix.outgoing_nm.len() {
            common.iter().map(|&[o, i]| arriving[i] * Xyz(matching[o])).sum()
        } else {
            let leaving = on(&matrix.outgoing_nm);
            leaving.iter().zip(&matching).map(|(e, m)| *e * Xyz(*m)).sum()
        };
        Self { arriving, matching, diffuser, white: diffuser, is_adapted: true }
    }

    fn scaled(mut self, factor: f64) -> Self {
        self.arriving.iter_mut().for_each(|power| *power *= factor);
        self.diffuser = factor * self.diffuser;
        self.white = factor * self.white;
        self
    }

    /// With this power in all bands together, if there is any.
    fn scaled_to(self, power: f64) -> Self {
        let found: f64 = self.arriving.iter().sum();
        if found > 0.0 { self.scaled(power / found) } else { self }
    }

    /// Power that arrives in each incident band.
    pub fn arriving(&self) -> &[f64] {
        &self.arriving
    }

    /// x̄, ȳ, z̄ at each outgoing wavelength.
    pub fn matching(&self) -> &[[f64; 3]] {
        &self.matching
    }

    /// The perfect diffuser under this light.
    pub fn diffuser(&self) -> Xyz {
        self.diffuser
    }

    /// What the observer sees as white.
    pub fn white(&self) -> Xyz {
        self.white
    }

    /// Whether that is the diffuser under this light, and not under a brighter one.
    pub fn is_adapted(&self) -> bool {
        self.is_adapted
    }

    /// The color of a matrix on these axes.
    pub fn color(&self, matrix: &DonaldsonMatrix) -> Xyz {
        let leaving = matrix.leaving(&self.arriving);
        leaving.into_iter().zip(&self.matching).map(|(power, m)| power * Xyz(*m)).sum()
    }

    /// CIELAB of a color relative to [`MatrixSums::white`].
    pub fn lab_from_xyz(&self, xyz: Xyz) -> Lab {
        lab_from_xyz(xyz, self.white)
    }

    /// [`difference_by_xyz`](crate::difference_by_xyz) against the white.
    pub fn difference_by_xyz(&self, color: Xyz) -> Matrix3 {
        crate::difference_by_xyz(color, self.white)
    }

    /// The radiance factor of a matrix at each outgoing wavelength: what leaves there over what would leave
    /// of the perfect diffuser; `None` where no light arrives.
    #[must_use]
    pub fn radiance_factor(&self, matrix: &DonaldsonMatrix) -> Vec<Option<f64>> {
        let leaving = matrix.leaving(&self.arriving);
        let mut factors = vec![None; leaving.len()];
        for [o, i] in matrix.diagonal_bands() {
            let arriving = self.arriving[i];
            factors[o] = (arriving > 0.0).then(|| leaving[o] / arriving);
        }
        factors
    }
}

/// The step of the incident wavelengths, nm, for messages.
fn step_nm(matrix: &DonaldsonMatrix) -> u32 {
    crate::rounding::whole(matrix.incident_nm[1] - matrix.incident_nm[0]).try_into().unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::super::BispectralUnit;
    use super::*;
    use crate::grid::Grid;

    /// Numbers without a pattern, from 0 to 1.
    fn noise(seed: usize) -> f64 {
        let bits = (seed as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let bits = (bits ^ (bits >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        ((bits ^ (bits >> 32)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn axis(first: f64, last: f64, step: f64) -> Vec<f64> {
        (0..).map(|k| first + step * f64::from(k)).take_while(|nm| *nm <= last).collect()
    }

    fn random(incident: Vec<f64>, outgoing: Vec<f64>) -> DonaldsonMatrix {
        let row = |o| (0..incident.len()).map(|i| noise(o * 1000 + i)).collect();
        let rows = (0..outgoing.len()).map(row).collect();
        DonaldsonMatrix::try_new(incident, outgoing, rows, BispectralUnit::PerBand).unwrap()
    }

    #[test]
    fn sums_are_the_product_of_matrix_and_light() {
        // The goal; both are sums of the same products in another order.
        const GOAL: f64 = 1e-6;
        let matrix = random(axis(300.0, 780.0, 10.0), axis(380.0, 780.0, 10.0));
        let observer = Observer::default();
        for name in ["D65", "A", "E"] {
            let light = Illuminant::named(name).unwrap();
            let found = matrix.color(&light, &observer).unwrap();
            // Column by column, with the samples of light and observer.
            let (mut sums, mut white) = ([0.0; 3], 0.0);
            for (i, nm) in matrix.incident_nm().iter().enumerate() {
                for (o, out_nm) in matrix.outgoing_nm().iter().enumerate() {
                    let seen = observer.matching().each_ref().map(|curve| curve.at(*out_nm));
                    let power = light.power().at(*nm) * matrix.factors()[o][i];
                    (0..3).for_each(|k| sums[k] += power * seen[k]);
                    white += if out_nm == nm { light.power().at(*nm) * seen[1] } else { 0.0 };
                }
            }
            for k in 0..3 {
                assert!((found.0[k] - sums[k] / white).abs() < GOAL, "{name} {found:?} {sums:?}");
            }
        }
    }

    #[test]
    fn a_gray_has_the_same_share_of_white_under_every_light_on_every_axis() {
        // Rounding only.
        const ROUNDING: f64 = 1e-12;
        let irregular = vec![300.0, 330.0, 371.0, 400.0, 412.5, 480.0, 555.0, 610.0, 700.0, 760.0];
        for nm in [axis(300.0, 780.0, 10.0), axis(350.0, 750.0, 5.0), irregular] {
            let gray = random(nm.clone(), nm).with_factors(|o, i| if o == i { 0.25 } else { 0.0 });
            for name in Illuminant::names() {
                let light = Illuminant::named(name).unwrap();
                let sums = MatrixSums::new(&gray, &light, &Observer::default()).unwrap();
                let (color, white) = (sums.color(&gray), sums.white());
                let is_gray = |k: usize| (color.0[k] - 0.25 * white.0[k]).abs() < ROUNDING;
                assert!((0..3).all(is_gray) && (white.0[1] - 1.0).abs() < ROUNDING, "{name}");
                let factors = sums.radiance_factor(&gray);
                assert!(factors.iter().flatten().all(|f| (f - 0.25).abs() < ROUNDING));
            }
        }
    }

    #[test]
    fn whites_on_the_axes_are_those_of_sums_over_1_nm() {
        // Sums over 10 nm of a lamp with lines, whose observer is sampled every 10 nm.
        const QUADRATURE: f64 = 0.02;
        let gray = random(axis(300.0, 780.0, 10.0), axis(380.0, 780.0, 10.0));
        for name in ["D65", "A", "FL2", "HP1"] {
            let illuminant = Illuminant::named(name).unwrap();
            let found = MatrixSums::new(&gray, &illuminant, &Observer::default()).unwrap().white();
            let expected = Contract { illuminant, ..Contract::default() }.on(Grid::FINE).white();
            for k in 0..3 {
                let error = (found.0[k] / expected.0[k] - 1.0).abs();
                assert!(error < QUADRATURE, "{name} {found:?} {expected:?}");
            }
        }
    }

    #[test]
    fn small_differences_are_linear_in_xyz() {
        // Curvature over the step.
        const CURVATURE: f64 = 1e-3;
        let gray = random(axis(300.0, 780.0, 10.0), axis(380.0, 780.0, 10.0));
        let sums = MatrixSums::new(&gray, &Illuminant::default(), &Observer::default()).unwrap();
        let white = sums.white();
        for color in [Xyz([0.3, 0.4, 0.1]), 0.5 * white, Xyz([0.2, 0.01, -0.001])] {
            let near = color + Xyz([1e-6, -2e-6, 1.5e-6]);
            let by_xyz = sums.difference_by_xyz(color) * (near - color).0;
            let norm = by_xyz.iter().map(|v| v * v).sum::<f64>().sqrt();
            let [one, two] = [color, near].map(|xyz| sums.lab_from_xyz(xyz));
            let expected = crate::ciede2000(one, two);
            assert!((norm / expected - 1.0).abs() < CURVATURE, "{color:?} {norm} {expected}");
        }
    }

    #[test]
    fn nobody_is_adapted_to_an_ultraviolet_lamp() {
        let contract = Contract::default();
        let matrix = random(axis(300.0, 780.0, 10.0), axis(380.0, 780.0, 10.0));
        let day = MatrixSums::new(&matrix, &contract.illuminant, &contract.observer).unwrap();
        let lamp = Illuminant::line("lamp", 365.0, 12.0).unwrap();
        let seen = matrix.seen_under(&contract, &lamp).unwrap();
        let power = |sums: &MatrixSums| sums.arriving().iter().sum::<f64>();
        assert!(!seen.is_adapted() && seen.white() == day.white());
        assert!((power(&seen) / power(&day) - 1.0).abs() < 1e-12 && seen.diffuser().0[1] < 0.01);
        let lamp = Illuminant::named("FL2").unwrap();
        assert!(matrix.seen_under(&contract, &lamp).unwrap().is_adapted());
    }

    #[test]
    fn a_light_that_does_not_reach_the_matrix_is_refused() {
        let matrix = random(axis(500.0, 700.0, 10.0), axis(400.0, 700.0, 10.0));
        let power = Grid::FINE.wavelengths_nm().map(|nm| if nm > 705.0 { 1.0 } else { 0.0 });
        let power = crate::Spectrum::new(Grid::FINE, power.collect()).unwrap();
        let red = Illuminant::from_spectrum("red", &power).unwrap();
        let refused = matrix.color(&red, &Observer::default()).unwrap_err().to_string();
        assert!(
            refused.starts_with("the observer CIE 1931 2° sees nothing of the light red"),
            "{refused}"
        );
    }
}
