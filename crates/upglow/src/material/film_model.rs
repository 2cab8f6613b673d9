//! Measured dyes in a film, each at an optical density of its own.

use upglow_color::{Grid, Spectrum};

use crate::material::distribution::Distribution;
use crate::material::dye_model::{DyeCurves, DyeModel, DyeOptions, QuantumYield};
use crate::material::dye_set::DyeSet;
use crate::material::formula::{Accounting, Film, Mixing, Number};
use crate::material::model_error::ModelError;

/// Any two dyes of a set in one film over a reflectance, under the law of Beer and Lambert.
///
/// With the optical densities A of the two dyes and D = Σ A·a(λ), the film lets T = 10^(−D) of the
/// light pass, to the reflectance and back; each dye absorbs its share A·a / D of 1 − T and re-emits
/// the quantum yield of that.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmModel {
    dyes: DyeModel,
    /// What each dye returns by itself at each of [`LEVELS`], to draw incident wavelengths from.
    proposals: Vec<[Distribution; LEVELS.len()]>,
}

/// [`FilmModel::LEVELS`] for the modules of the library.
pub(crate) const LEVELS: [f64; 4] = FilmModel::LEVELS;

impl FilmModel {
    /// Smallest and greatest optical density of a dye. At the greatest, light at the absorption's peak
    /// passes by a millionth.
    pub const DENSITIES: [f64; 2] = [0.0, 6.0];

    /// Optical densities at which a dye's absorptance is tabulated for drawing wavelengths. Between
    /// them it is mixed, below the first it is scaled.
    pub const LEVELS: [f64; 4] = [0.5, 1.5, 3.0, 6.0];

    /// The dyes of `set`, with what is conserved when they re-emit light.
    ///
    /// # Errors
    ///
    /// [`ModelError`] if the quantum yield is not in 0..=1.
    pub fn new(
        set: DyeSet,
        accounting: Accounting,
        quantum_yield: QuantumYield,
    ) -> Result<Self, ModelError> {
        let mixing = Mixing::Separate;
        let options = DyeOptions { mixing, accounting, quantum_yield, optical_density: None };
        let dyes = DyeModel::new(set, options)?;
        let proposals = dyes.curves().iter().map(|dye| proposals(dye, accounting)).collect();
        Ok(Self { dyes, proposals })
    }

    /// The dyes with their curves, at concentration 1 and as measured in a thin solution.
    pub fn dyes(&self) -> &DyeModel {
        &self.dyes
    }

    /// What is conserved when absorbed light is re-emitted.
    pub fn accounting(&self) -> Accounting {
        self.dyes.options().accounting
    }

    /// The share of absorbed light that is re-emitted.
    pub fn quantum_yield(&self) -> QuantumYield {
        self.dyes.options().quantum_yield
    }

    /// The curves that incident wavelengths are drawn from: what dye number `dye` returns by itself at
    /// each of [`FilmModel::LEVELS`] and a quantum yield of 1, 0..=1, at 300, 301 … 830 nm.
    pub fn proposed(&self, dye: usize) -> [&[f64]; Self::LEVELS.len()] {
        self.proposals[dye].each_ref().map(Distribution::densities)
    }

    /// What a dye in a film absorbs per optical density of its own, (1 − 10^(−D)) / D, where the dyes have
    /// the optical density D together; ln 10 at D = 0.
    pub fn absorbed_per_density(density: f64) -> f64 {
        density.absorbed_per_density()
    }

    /// Where two dyes of these optical densities have these absorptions: the share of light that passes, what
    /// each dye absorbs, and the derivatives of that by each density, `[dye][density]`.
    pub fn absorbed_by_two(
        densities: [f64; 2],
        absorptions: [f64; 2],
    ) -> (f64, [f64; 2], [[f64; 2]; 2]) {
        Film { densities }.with_derivatives(absorptions)
    }

    /// [`FilmModel::proposed`], to draw from.
    pub(crate) fn proposals(&self, dye: usize) -> &[Distribution; LEVELS.len()] {
        &self.proposals[dye]
    }
}

/// The share of each of [`LEVELS`] in the absorptance at an optical density: it is mixed from two
/// neighbors, and below the first the share is less than 1.
pub(crate) fn level_shares(density: f64) -> [f64; LEVELS.len()] {
    let reached = |k: usize| {
        let below = if k == 0 { 0.0 } else { LEVELS[k - 1] };
        LEVELS.get(k).map_or(0.0, |level| ((density - below) / (level - below)).clamp(0.0, 1.0))
    };
    std::array::from_fn(|k| reached(k) - reached(k + 1))
}

fn proposals(dye: &DyeCurves, accounting: Accounting) -> [Distribution; LEVELS.len()] {
    LEVELS.map(|level| {
        let film = Film { densities: [level, 0.0] };
        let samples = dye.absorption.values().iter().zip(Grid::FINE.wavelengths_nm());
        let returned = samples.map(|(&a, nm)| {
            let [absorbed, _] = film.absorbed([a, 0.0]);
            accounting.returned(absorbed, 1.0, nm, dye.mean_emission_nm)
        });
        let curve = Spectrum::new(Grid::FINE, returned.collect());
        Distribution::new(&curve.expect("a function of finite samples"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_mix_to_the_density() {
        for i in 0..=60 {
            let density = 0.1 * f64::from(i);
            let mixed: f64 = level_shares(density).iter().zip(LEVELS).map(|(s, l)| s * l).sum();
            assert!((mixed - density).abs() < 1e-12, "{density} {mixed}");
        }
        assert_eq!(level_shares(7.0), [0.0, 0.0, 0.0, 1.0]);
        assert_eq!(level_shares(-1.0), [0.0; 4]);
    }
}
