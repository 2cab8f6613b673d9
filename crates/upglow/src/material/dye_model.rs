//! Measured dyes under the rules of a model.

use std::fmt;
use std::str::FromStr;

use upglow_color::{Grid, Spectrum, UnknownChoice};

use crate::material::distribution::Distribution;
use crate::material::dye_set::DyeSet;
use crate::material::formula::{Accounting, Mixing};
use crate::material::model_error::{ModelError, check_yield};

/// The share of absorbed light that a dye re-emits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum QuantumYield {
    /// The same for every dye, 0..=1.
    Fixed(f64),
    /// The yield measured for each dye, and 1 where none was published.
    Measured,
}

impl Default for QuantumYield {
    fn default() -> Self {
        Self::Fixed(1.0)
    }
}

/// The choices in a [`DyeModel`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct DyeOptions {
    /// Pooled (default) or separate.
    pub mixing: Mixing,
    /// Energy (default) or photons.
    pub accounting: Accounting,
    /// 1 (default), another number, or measured.
    pub quantum_yield: QuantumYield,
    /// Optical density A of the pigment at its peak, above 0 and at most [`DyeModel::MOST_DENSE`]: the absorptance is 1 − 10^(−A·a), broader
    /// and steeper than the curve a of a thin solution. `None` (default) is a itself.
    pub optical_density: Option<f64>,
}

/// A ring of dyes, ready to be mixed two by two.
///
/// Absorption per incident light: c·a(λ) with a = (1 − w)·aᵢ + w·aⱼ for dye i and its neighbor j.
#[derive(Clone, Debug, PartialEq)]
pub struct DyeModel {
    set: DyeSet,
    options: DyeOptions,
    curves: Vec<DyeCurves>,
}

/// One dye under the options of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct DyeCurves {
    /// Absorptance at concentration 1, 0..=1, on [`Grid::FINE`].
    pub absorption: Spectrum,
    /// Emission of unit area, 1/nm, on [`Grid::FINE`].
    pub emission: Spectrum,
    /// Share of absorbed light that is re-emitted, 0..=1.
    pub quantum_yield: f64,
    /// Mean wavelength of the emission, nm.
    pub mean_emission_nm: f64,
    /// The absorption, to draw wavelengths from.
    pub(crate) absorbing: Distribution,
    /// The emission, to draw wavelengths from.
    pub(crate) emitting: Distribution,
}

impl DyeModel {
    /// The greatest optical density. A pigment of 6 is opaque at its peak. From a thousand on, its absorption has edges
    /// that sums over 5 nm do not resolve, so that `upglow-fit`'s `verify` finds other colors at every nanometer.
    pub const MOST_DENSE: f64 = 100.0;

    /// The dyes of `set` under `options`.
    ///
    /// # Errors
    ///
    /// [`ModelError`] if the quantum yield is not in 0..=1 or the optical density out of range.
    pub fn new(set: DyeSet, options: DyeOptions) -> Result<Self, ModelError> {
        if let QuantumYield::Fixed(q) = options.quantum_yield {
            check_yield(q)?;
        }
        if let Some(found) = options.optical_density
            && !(found > 0.0 && found <= Self::MOST_DENSE)
        {
            return Err(ModelError::OpticalDensity { found });
        }
        let curves = set.dyes().iter().map(|dye| {
            let quantum_yield = match options.quantum_yield {
                QuantumYield::Fixed(q) => q,
                QuantumYield::Measured => dye.quantum_yield.unwrap_or(1.0),
            };
            DyeCurves::new(&dye.absorption, &dye.emission, quantum_yield, options.optical_density)
        });
        Ok(Self { curves: curves.collect(), set, options })
    }

    /// The ring of dyes.
    pub fn set(&self) -> &DyeSet {
        &self.set
    }

    /// The options it was made with.
    pub fn options(&self) -> DyeOptions {
        self.options
    }

    /// The dyes' curves in ring order.
    pub fn curves(&self) -> &[DyeCurves] {
        &self.curves
    }

    /// The neighbor that dye `first` is mixed with.
    pub fn partner(&self, first: usize) -> usize {
        (first + 1) % self.curves.len()
    }

    /// How many different pairs of neighbors there are.
    pub fn pairs(&self) -> usize {
        match self.curves.len() {
            2 => 1,
            n => n,
        }
    }

    /// Names of the dyes without a published quantum yield, in ring order.
    pub fn without_published_yield(&self) -> Vec<&str> {
        let unknown = self.set.dyes().iter().filter(|dye| dye.quantum_yield.is_none());
        unknown.map(|dye| dye.name.as_str()).collect()
    }
}

impl DyeCurves {
    /// ∫ returned dλ of the dye by itself at concentration 1, nm.
    pub fn returned_nm(&self, accounting: Accounting) -> f64 {
        self.quantum_yield * self.absorbing.shared_total(accounting, self.mean_emission_nm)
    }

    fn new(
        absorption: &Spectrum,
        emission: &Spectrum,
        quantum_yield: f64,
        optical_density: Option<f64>,
    ) -> Self {
        let load = |a: f64| optical_density.map_or(a, |density| 1.0 - 10f64.powf(-density * a));
        let loaded = absorption.resampled(Grid::FINE).values().iter().map(|&a| load(a)).collect();
        let emission = emission.resampled(Grid::FINE);
        let area = emission.integral();
        let emission = emission.scaled(area.recip());
        let moment: f64 =
            emission.values().iter().zip(Grid::FINE.wavelengths_nm()).map(|(e, nm)| e * nm).sum();
        let absorption = Spectrum::new(Grid::FINE, loaded).expect("a function of finite samples");
        Self {
            absorbing: Distribution::new(&absorption),
            emitting: Distribution::new(&emission),
            absorption,
            emission,
            quantum_yield,
            mean_emission_nm: moment * f64::from(Grid::FINE.step_nm()),
        }
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for QuantumYield {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl fmt::Display for QuantumYield {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fixed(q) => write!(f, "{q}"),
            Self::Measured => f.write_str("measured"),
        }
    }
}

impl FromStr for QuantumYield {
    type Err = UnknownChoice;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let unknown = || UnknownChoice {
            what: "quantum yield",
            found: text.into(),
            expected: "measured or a number from 0 to 1".into(),
        };
        match text {
            "measured" => Ok(Self::Measured),
            _ => text.parse().map(Self::Fixed).map_err(|_| unknown()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::analytic_model::AnalyticModel;
    use crate::material::formula::Accounting;

    fn konig8(options: DyeOptions) -> DyeModel {
        DyeModel::new(DyeSet::named("konig8").unwrap(), options).unwrap()
    }

    #[test]
    fn emissions_have_unit_area_and_their_mean_inside_the_range() {
        for curves in konig8(DyeOptions::default()).curves() {
            assert!((curves.emission.integral() - 1.0).abs() < 1e-12);
            assert!((400.0..700.0).contains(&curves.mean_emission_nm));
        }
    }

    #[test]
    fn optical_density_widens_the_absorption_and_keeps_it_a_fraction() {
        let thin = konig8(DyeOptions::default());
        let dense = konig8(DyeOptions { optical_density: Some(4.0), ..DyeOptions::default() });
        for (thin, dense) in thin.curves().iter().zip(dense.curves()) {
            assert!(dense.absorption.integral() > 1.5 * thin.absorption.integral());
            assert!(dense.absorption.values().iter().all(|a| (0.0..=1.0).contains(a)));
        }
    }

    #[test]
    fn photon_accounting_loses_the_stokes_shift_and_never_gains() {
        assert_eq!(Accounting::Photon.share(400.0, 500.0), 0.8);
        assert_eq!(Accounting::Photon.share(600.0, 500.0), 1.0);
        assert_eq!(Accounting::Energy.share(400.0, 500.0), 1.0);
    }

    #[test]
    fn rules_out_of_range_are_refused() {
        let set = || DyeSet::named("konig8").unwrap();
        let with = |options| DyeModel::new(set(), options).unwrap_err().to_string();
        let density = DyeOptions { optical_density: Some(-1.0), ..DyeOptions::default() };
        assert_eq!(with(density), "optical density -1, expected > 0 and at most 100");
        let quantum_yield = QuantumYield::Fixed(1.5);
        let bright = DyeOptions { quantum_yield, ..DyeOptions::default() };
        assert_eq!(with(bright), "quantum yield 1.5, expected 0 to 1");
        assert!(AnalyticModel::new(5.0, 45.0, Accounting::Energy, 1.0).is_err());
    }
}
