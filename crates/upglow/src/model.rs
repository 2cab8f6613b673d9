//! What fluorescence is made of: measured dyes, or bells by formula.

use std::fmt;
use std::str::FromStr;

use upglow_color::{Grid, Spectrum, UnknownChoice, choices};

use crate::DyeSet;
use crate::bspline::Bell;
use crate::distribution::Distribution;

/// How the fluorescence of a material is described, and by what rules it gives light back.
#[derive(Clone, Debug, PartialEq)]
pub enum Model {
    /// No fluorescence.
    Reflectance,
    /// Two neighbors of a ring of measured dyes.
    Dyes(DyeModel),
    /// Absorption and emission by formula.
    Analytic(AnalyticModel),
}

impl Model {
    /// The name that files and options use: `reflectance`, `dyes` or `analytic`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Reflectance => "reflectance",
            Self::Dyes(_) => "dyes",
            Self::Analytic(_) => "analytic",
        }
    }
}

/// What is conserved when absorbed light is given back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Accounting {
    /// All absorbed energy times the quantum yield comes out, as the seed paper has it.
    #[default]
    Energy,
    /// Each absorbed photon comes out as `quantum yield` photons: light of λi comes out with the
    /// share λi / λ̄e of its energy, with λ̄e the mean emission wavelength. Never above 1: what is
    /// absorbed beyond λ̄e keeps its energy, so that none is made.
    Photon,
}

impl Accounting {
    /// The share of absorbed energy at `lambda_nm` that can come out around `mean_emission_nm`.
    pub(crate) fn share(self, lambda_nm: f64, mean_emission_nm: f64) -> f64 {
        match self {
            Self::Energy => 1.0,
            Self::Photon => (lambda_nm / mean_emission_nm).min(1.0),
        }
    }
}

/// What two dyes in one material do with each other's light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Mixing {
    /// One absorption, one emission: what either absorbs comes out as the mixed emission.
    #[default]
    Pooled,
    /// Each dye gives back what it absorbed itself.
    Separate,
}

/// How much of what a dye absorbs comes out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum QuantumYield {
    /// The same for every dye, 0..=1.
    Fixed(f64),
    /// The yield that was measured for each dye, and 1 where none was published.
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
    /// Optical density A > 0 of the pigment at its peak: the absorptance is 1 − 10^(−A·a), broader
    /// and steeper than the curve a of a thin solution. `None` (default) is a itself.
    pub optical_density: Option<f64>,
}

/// Why a model cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The quantum yield is not a fraction.
    #[error("quantum yield {found}, expected 0 to 1")]
    QuantumYield {
        /// The number given.
        found: f64,
    },
    /// The optical density is not a positive number.
    #[error("optical density {found}, expected > 0")]
    OpticalDensity {
        /// The number given.
        found: f64,
    },
    /// A width of the analytic model is out of range.
    #[error("width {found_nm} nm, expected {MIN_FWHM_NM} to {MAX_FWHM_NM} nm")]
    Width {
        /// The width given, nm.
        found_nm: f64,
    },
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
    /// Share of absorbed light that comes out, 0..=1.
    pub quantum_yield: f64,
    /// Mean wavelength of the emission, nm.
    pub mean_emission_nm: f64,
    /// The absorption, to draw wavelengths from.
    pub(crate) absorbing: Distribution,
    /// The emission, to draw wavelengths from.
    pub(crate) emitting: Distribution,
}

impl DyeModel {
    /// The dyes of `set` under `options`.
    ///
    /// # Errors
    ///
    /// [`ModelError`] if the quantum yield is not in 0..=1 or the optical density not above 0.
    pub fn new(set: DyeSet, options: DyeOptions) -> Result<Self, ModelError> {
        if let QuantumYield::Fixed(q) = options.quantum_yield {
            check_yield(q)?;
        }
        if let Some(found) = options.optical_density
            && !(found > 0.0 && found.is_finite())
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

    /// The rules it was made with.
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

    /// Dyes whose quantum yield nobody published, in ring order.
    pub fn without_published_yield(&self) -> Vec<&str> {
        let unknown = self.set.dyes().iter().filter(|dye| dye.quantum_yield.is_none());
        unknown.map(|dye| dye.name.as_str()).collect()
    }
}

impl DyeCurves {
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

/// Absorption and emission as cubic B-splines, placed by the emission's peak and the Stokes shift.
///
/// # Source
///
/// `jung`; its widths are not published, so they are options here.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct AnalyticModel {
    absorption_fwhm_nm: f64,
    emission_fwhm_nm: f64,
    accounting: Accounting,
    quantum_yield: f64,
}

/// Below this a bell falls between the samples of a 5 nm sum.
const MIN_FWHM_NM: f64 = 15.0;
/// Above this an emission at [`AnalyticModel::EMISSION_PEAKS_NM`] leaves the range of the tables.
const MAX_FWHM_NM: f64 = 80.0;

impl Default for AnalyticModel {
    fn default() -> Self {
        Self {
            absorption_fwhm_nm: 50.0,
            emission_fwhm_nm: 45.0,
            accounting: Accounting::Energy,
            quantum_yield: 1.0,
        }
    }
}

impl AnalyticModel {
    /// Smallest and greatest wavelength of the emission's peak, nm.
    pub const EMISSION_PEAKS_NM: [f64; 2] = [400.0, 710.0];
    /// Smallest and greatest distance from the absorption's peak to the emission's, nm.
    pub const STOKES_SHIFTS_NM: [f64; 2] = [10.0, 120.0];

    /// The model with these full widths at half maximum, nm, and rules.
    ///
    /// # Errors
    ///
    /// [`ModelError`] if a width is outside 15 to 80 nm or the quantum yield outside 0 to 1.
    pub fn new(
        absorption_fwhm_nm: f64,
        emission_fwhm_nm: f64,
        accounting: Accounting,
        quantum_yield: f64,
    ) -> Result<Self, ModelError> {
        for found_nm in [absorption_fwhm_nm, emission_fwhm_nm] {
            if !(MIN_FWHM_NM..=MAX_FWHM_NM).contains(&found_nm) {
                return Err(ModelError::Width { found_nm });
            }
        }
        check_yield(quantum_yield)?;
        Ok(Self { absorption_fwhm_nm, emission_fwhm_nm, accounting, quantum_yield })
    }

    /// Full width at half maximum of the absorption, nm.
    pub fn absorption_fwhm_nm(&self) -> f64 {
        self.absorption_fwhm_nm
    }

    /// Full width at half maximum of the emission, nm.
    pub fn emission_fwhm_nm(&self) -> f64 {
        self.emission_fwhm_nm
    }

    /// Energy or photons.
    pub fn accounting(&self) -> Accounting {
        self.accounting
    }

    /// Share of absorbed light that comes out, 0..=1.
    pub fn quantum_yield(&self) -> f64 {
        self.quantum_yield
    }

    /// Absorption around `center_nm` at `lambda_nm`, 0..=1, and its derivative by the center.
    pub fn absorption(&self, center_nm: f64, lambda_nm: f64) -> (f64, f64) {
        Bell::new(center_nm, self.absorption_fwhm_nm).peak_one(lambda_nm)
    }

    /// Emission of unit area around `center_nm` at `lambda_nm`, 1/nm, and its derivative by the
    /// center.
    pub fn emission(&self, center_nm: f64, lambda_nm: f64) -> (f64, f64) {
        Bell::new(center_nm, self.emission_fwhm_nm).area_one(lambda_nm)
    }

    /// The absorption around `center_nm`; its peak is 1, that of the bell's area is not.
    pub(crate) fn absorption_bell(&self, center_nm: f64) -> Bell {
        Bell::new(center_nm, self.absorption_fwhm_nm)
    }

    /// The emission around `center_nm`.
    pub(crate) fn emission_bell(&self, center_nm: f64) -> Bell {
        Bell::new(center_nm, self.emission_fwhm_nm)
    }

    /// The area of the emission around `center_nm` between two wavelengths, 0..=1.
    pub(crate) fn emission_area(&self, center_nm: f64, from_nm: f64, to_nm: f64) -> f64 {
        Bell::new(center_nm, self.emission_fwhm_nm).area_between(from_nm, to_nm)
    }
}

fn check_yield(found: f64) -> Result<(), ModelError> {
    if (0.0..=1.0).contains(&found) { Ok(()) } else { Err(ModelError::QuantumYield { found }) }
}

choices!(Accounting, "accounting", Energy = "energy", Photon = "photon");
choices!(Mixing, "mixing", Pooled = "pooled", Separate = "separate");

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

    fn seed8(options: DyeOptions) -> DyeModel {
        DyeModel::new(DyeSet::named("seed8").unwrap(), options).unwrap()
    }

    #[test]
    fn emissions_have_unit_area_and_their_mean_inside_the_range() {
        for curves in seed8(DyeOptions::default()).curves() {
            assert!((curves.emission.integral() - 1.0).abs() < 1e-12);
            assert!((400.0..700.0).contains(&curves.mean_emission_nm));
        }
    }

    #[test]
    fn optical_density_widens_the_absorption_and_keeps_it_a_fraction() {
        let thin = seed8(DyeOptions::default());
        let dense = seed8(DyeOptions { optical_density: Some(4.0), ..DyeOptions::default() });
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
        let set = || DyeSet::named("seed8").unwrap();
        let with = |options| DyeModel::new(set(), options).unwrap_err().to_string();
        let density = DyeOptions { optical_density: Some(-1.0), ..DyeOptions::default() };
        assert_eq!(with(density), "optical density -1, expected > 0");
        let quantum_yield = QuantumYield::Fixed(1.5);
        let bright = DyeOptions { quantum_yield, ..DyeOptions::default() };
        assert_eq!(with(bright), "quantum yield 1.5, expected 0 to 1");
        assert!(AnalyticModel::new(5.0, 45.0, Accounting::Energy, 1.0).is_err());
    }
}
