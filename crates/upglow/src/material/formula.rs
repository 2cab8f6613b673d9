//! The formula of fluorescence, in double precision and in vectors of single precision.
//!
//! The fluorescence of a material has one or two lobes. At λ, a lobe absorbs a share of the light,
//! returns Q·g(λ) of that, and emits it with the density ê; [`Accounting`] says what g is. A lobe of
//! the analytic model absorbs c·a(λ). A model of dyes has two dyes in each material: [`Mixing`] says
//! which lobes they make. In a film each of two dyes is a lobe: [`Film`].

use std::f64::consts::LN_10;
use std::ops::{Add, Mul};

use upglow_color::choices;

/// What is conserved when absorbed light is re-emitted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Accounting {
    /// The absorbed energy times the quantum yield is re-emitted (König et al. 2020).
    #[default]
    Energy,
    /// Each absorbed photon yields `quantum yield` photons: light of λi is re-emitted with the share
    /// λi / λ̄e of its energy, with λ̄e the mean emission wavelength. The share is at most 1: light
    /// absorbed beyond λ̄e gains no energy.
    Photon,
}

/// How two dyes share the light in one material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Mixing {
    /// One absorption and one emission: light absorbed by either dye leaves with the mixed emission.
    #[default]
    Pooled,
    /// Each dye re-emits what it absorbed itself.
    Separate,
}

choices!(Accounting, "accounting", Energy = "energy", Photon = "photon");
choices!(Mixing, "mixing", Pooled = "pooled", Separate = "separate");

/// A number of one material, or of each of several in a vector.
pub(crate) trait Number: Copy + Add<Output = Self> + Mul<Output = Self> {
    fn zero(self) -> Self;

    /// (1 − `weight`)·one + `weight`·two.
    fn mixed(pair: [Self; 2], weight: Self) -> Self;

    /// (1 − `weight`)·self and `weight`·self.
    fn divided(self, weight: Self) -> [Self; 2];

    /// min(1, self / `mean_nm`), self being a wavelength, nm.
    fn photon_share(self, mean_nm: Self) -> Self;

    /// 10^(−self), self being an optical density.
    fn transmittance(self) -> Self;

    /// (1 − 10^(−self)) / self, self being an optical density; ln 10 at 0.
    fn absorbed_per_density(self) -> Self;
}

impl Number for f64 {
    fn zero(self) -> Self {
        0.0
    }

    fn mixed([one, two]: [Self; 2], weight: Self) -> Self {
        (1.0 - weight) * one + weight * two
    }

    fn divided(self, weight: Self) -> [Self; 2] {
        [self * (1.0 - weight), self * weight]
    }

    fn photon_share(self, mean_nm: Self) -> Self {
        (self / mean_nm).min(1.0)
    }

    #[inline(always)]
    fn transmittance(self) -> Self {
        // 2^x as 2^(whole part) · e^(rest · ln 2): without a branch, so that loops become vectors.
        let x = (-std::f64::consts::LOG2_10 * self).max(-LEAST_EXPONENT);
        let shifted = x + ROUNDING_SHIFT;
        let rest = (x - (shifted - ROUNDING_SHIFT)) * std::f64::consts::LN_2;
        let power = EXPONENTIAL.iter().rev().fold(0.0, |sum, c| sum * rest + c);
        // The low bits of `shifted` hold the whole part.
        let exponent = shifted.to_bits().wrapping_add(1023) << 52;
        power * Self::from_bits(exponent)
    }

    #[inline(always)]
    fn absorbed_per_density(self) -> Self {
        let z = LN_10 * self;
        let series = LN_10 * (1.0 - z * (0.5 - z * (1.0 / 6.0 - z / 24.0)));
        let closed = (1.0 - self.transmittance()) / self.max(THIN);
        if self < THIN { series } else { closed }
    }
}

/// The slope of [`Number::absorbed_per_density`].
pub(crate) trait AbsorbedSlope: Number {
    fn absorbed_slope(self) -> Self;
}

impl AbsorbedSlope for f64 {
    #[inline(always)]
    fn absorbed_slope(self) -> Self {
        let z = LN_10 * self;
        let series = -LN_10 * LN_10 * (0.5 - z * (1.0 / 3.0 - z * (0.125 - z / 30.0)));
        let closed = (LN_10 * self.transmittance() - self.absorbed_per_density()) / self.max(THIN);
        if self < THIN { series } else { closed }
    }
}

/// Below this density the closed forms cancel more digits than the series leave out, 1e-11.
const THIN: f64 = 1e-3;
/// Light of a density of 300 is none; beyond it, the exponent would not be a normal number.
const LEAST_EXPONENT: f64 = 1000.0;
/// Adding it to a number below 2⁵¹ rounds that to a whole one.
const ROUNDING_SHIFT: f64 = 6_755_399_441_055_744.0;
/// Coefficients of the exponential's series: the first that is left out adds 6e-15 at ½·ln 2.
const EXPONENTIAL: [f64; 12] = {
    let mut coefficients = [1.0; 12];
    let mut k = 1;
    while k < 12 {
        coefficients[k] = coefficients[k - 1] / k as f64;
        k += 1;
    }
    coefficients
};

/// Two dyes in one film, each with an optical density of its own, under the law of Beer and Lambert:
/// with D = Σ A·a the film lets 10^(−D) of the light pass, and each dye absorbs its share A·a / D of
/// the rest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Film<T> {
    /// A of each dye: the density where its absorption is 1.
    pub(crate) densities: [T; 2],
}

impl<T: Number> Film<T> {
    fn own(self, [a, b]: [T; 2]) -> [T; 2] {
        let [first, second] = self.densities;
        [first * a, second * b]
    }

    /// The share of the light that passes where the dyes have these absorptions.
    #[inline(always)]
    pub(crate) fn passed(self, absorptions: [T; 2]) -> T {
        let [first, second] = self.own(absorptions);
        (first + second).transmittance()
    }

    /// What each dye absorbs where they have these absorptions.
    #[inline(always)]
    pub(crate) fn absorbed(self, absorptions: [T; 2]) -> PerLobe<T> {
        let [first, second] = self.own(absorptions);
        let per_density = (first + second).absorbed_per_density();
        [first * per_density, second * per_density]
    }
}

impl<T: AbsorbedSlope> Film<T> {
    /// [`Film::passed`], [`Film::absorbed`], and the derivatives of what each dye absorbs by each
    /// density, `[dye][density]`.
    #[inline(always)]
    pub(crate) fn with_derivatives(self, [a, b]: [T; 2]) -> (T, [T; 2], [[T; 2]; 2]) {
        let [first, second] = self.own([a, b]);
        let density = first + second;
        let passed = density.transmittance();
        let per_density = density.absorbed_per_density();
        let slope = density.absorbed_slope();
        let by = [
            [a * (per_density + first * slope), b * first * slope],
            [a * second * slope, b * (per_density + second * slope)],
        ];
        (passed, [first * per_density, second * per_density], by)
    }
}

impl Film<f64> {
    /// What happens when a little of a third dye comes into the film: what that dye absorbs per density
    /// and absorption, and how much what each of the two absorbs changes.
    #[inline(always)]
    pub(crate) fn opened(self, absorptions: [f64; 2]) -> (f64, [f64; 2]) {
        let [first, second] = self.own(absorptions);
        let density = first + second;
        let slope = density.absorbed_slope();
        (density.absorbed_per_density(), [first * slope, second * slope])
    }
}

/// A number of each lobe; zero for the second where there is only one.
pub(crate) type PerLobe<T> = [T; 2];

impl Accounting {
    /// The share of the energy absorbed at `lambda_nm` that can be emitted around
    /// `mean_emission_nm`, 0..=1.
    pub fn share(self, lambda_nm: f64, mean_emission_nm: f64) -> f64 {
        match self {
            Self::Energy => 1.0,
            Self::Photon => lambda_nm.photon_share(mean_emission_nm),
        }
    }

    /// What a lobe returns of what it absorbed at the wavelength `nm`.
    #[inline(always)]
    pub(crate) fn returned<T: Number>(self, absorbed: T, yielded: T, nm: T, mean_nm: T) -> T {
        match self {
            Self::Energy => absorbed * yielded,
            Self::Photon => absorbed * yielded * nm.photon_share(mean_nm),
        }
    }
}

impl Mixing {
    /// How many lobes two dyes make.
    #[inline(always)]
    pub(crate) fn lobes(self) -> usize {
        match self {
            Self::Pooled => 1,
            Self::Separate => 2,
        }
    }

    /// A number of each lobe from that of each dye, the second dye having the share `weight`.
    #[inline(always)]
    pub(crate) fn per_lobe<T: Number>(self, dyes: [T; 2], weight: T) -> PerLobe<T> {
        match self {
            Self::Pooled => [T::mixed(dyes, weight), weight.zero()],
            Self::Separate => dyes,
        }
    }

    /// The concentration of each lobe.
    #[inline(always)]
    pub(crate) fn concentrations<T: Number>(self, concentration: T, weight: T) -> PerLobe<T> {
        match self {
            Self::Pooled => [concentration, weight.zero()],
            Self::Separate => concentration.divided(weight),
        }
    }

    /// What each lobe absorbs where the dyes have these absorptions.
    #[inline(always)]
    pub(crate) fn absorbed<T: Number>(
        self,
        absorptions: [T; 2],
        concentration: T,
        weight: T,
    ) -> PerLobe<T> {
        let [one, two] = self.concentrations(concentration, weight);
        let [a, b] = self.per_lobe(absorptions, weight);
        [one * a, two * b]
    }

    /// The share of each dye in lobe number `lobe`.
    pub(crate) fn shares_of_dyes(self, lobe: usize, weight: f64) -> [f64; 2] {
        match (self, lobe) {
            (Self::Pooled, _) => [1.0 - weight, weight],
            (Self::Separate, 0) => [1.0, 0.0],
            (Self::Separate, _) => [0.0, 1.0],
        }
    }

    /// What all lobes absorb together where the dyes have these absorptions.
    #[inline(always)]
    pub(crate) fn absorbed_in_all<T: Number>(
        self,
        absorptions: [T; 2],
        concentration: T,
        weight: T,
    ) -> T {
        // Pooled or separate, the sum is the same.
        concentration * T::mixed(absorptions, weight)
    }

    /// The color that two dyes emit at concentration 1, and its derivative by the second's share,
    /// `weight`. `absorbed` is the energy that one of them absorbs and may re-emit around a mean
    /// wavelength (nm), and its derivative by that wavelength, 1/nm.
    pub(crate) fn emitted(
        self,
        [a, b]: [&Emitter; 2],
        weight: f64,
        absorbed: impl Fn(&Emitter, f64) -> (f64, f64),
    ) -> Emitted<1> {
        match self {
            Self::Pooled => {
                let mix = |x: f64, y: f64| f64::mixed([x, y], weight);
                let mean_nm = mix(a.mean_emission_nm, b.mean_emission_nm);
                let (of_a, of_b) = (absorbed(a, mean_nm), absorbed(b, mean_nm));
                let by_mean_nm = mix(of_a.1, of_b.1);
                let absorbed_by_weight =
                    of_b.0 - of_a.0 + by_mean_nm * (b.mean_emission_nm - a.mean_emission_nm);
                let absorbed = mix(of_a.0, of_b.0);
                let quantum_yield = mix(a.quantum_yield, b.quantum_yield);
                let energy = quantum_yield * absorbed;
                let energy_by_weight = (b.quantum_yield - a.quantum_yield) * absorbed
                    + quantum_yield * absorbed_by_weight;
                let stimulus = [0, 1, 2].map(|k| mix(a.stimulus[k], b.stimulus[k]));
                Emitted {
                    color: stimulus.map(|s| energy * s),
                    derivatives: [[0, 1, 2].map(|k| {
                        energy_by_weight * stimulus[k] + energy * (b.stimulus[k] - a.stimulus[k])
                    })],
                }
            }
            Self::Separate => {
                let [of_a, of_b] = [a, b].map(|dye| {
                    let energy = dye.quantum_yield * absorbed(dye, dye.mean_emission_nm).0;
                    dye.stimulus.map(|s| energy * s)
                });
                Emitted {
                    color: [0, 1, 2].map(|k| f64::mixed([of_a[k], of_b[k]], weight)),
                    derivatives: [[0, 1, 2].map(|k| of_b[k] - of_a[k])],
                }
            }
        }
    }
}

/// A color and its derivatives by `N` parameters, `[parameter][X Y Z]`.
#[derive(Clone, Copy, Debug)]
pub struct Emitted<const N: usize> {
    /// Color emitted, at concentration 1 where the model has a concentration.
    pub color: [f64; 3],
    /// Its derivatives by the model's parameters.
    pub derivatives: [[f64; 3]; N],
}

impl<const N: usize> Emitted<N> {
    /// No light.
    pub(crate) const DARK: Self = Self { color: [0.0; 3], derivatives: [[0.0; 3]; N] };
}

/// One dye under a light and observer.
#[derive(Clone, Debug)]
pub(crate) struct Emitter {
    /// Absorptance at concentration 1, `[wavelength]`.
    pub(crate) absorption: Vec<f64>,
    /// Energy of the light that it absorbs.
    pub(crate) absorbed: f64,
    /// Energy of the light that it may re-emit where it absorbs all, `[wavelength]`.
    pub(crate) usable: Vec<f64>,
    /// Color of one unit of emitted energy.
    pub(crate) stimulus: [f64; 3],
    pub(crate) quantum_yield: f64,
    pub(crate) mean_emission_nm: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transmittance_is_a_power_of_ten() {
        for i in 0..=14_000 {
            let density = f64::from(i) * 1e-3;
            let expected = 10_f64.powf(-density);
            assert!((density.transmittance() / expected - 1.0).abs() < 1e-13, "{density}");
        }
        assert_eq!(0.0_f64.transmittance(), 1.0);
        for odd in [f64::INFINITY, 1e300] {
            assert!(odd.transmittance() < 1e-299);
        }
    }

    #[test]
    fn a_film_absorbs_what_does_not_pass() {
        for [a, b] in [[0.0_f64, 0.0], [1e-9, 0.0], [3e-4, 1e-4], [0.2, 0.7], [1.0, 1.0]] {
            for densities in [[0.0, 0.0], [1e-3, 2.0], [1.0, 1e-6], [6.0, 6.0]] {
                let film = Film { densities };
                let [first, second] = film.absorbed([a, b]);
                // The series' error for a density just below that of the closed form.
                assert!((first + second + film.passed([a, b]) - 1.0).abs() < 1e-12);
                assert!(first >= 0.0 && second >= 0.0);
            }
        }
    }

    #[test]
    fn derivatives_by_the_densities_match_differences() {
        // A central difference of this step errs by its square and by rounding over it.
        const STEP: f64 = 1e-5;
        for [a, b] in [[0.0_f64, 0.3], [1e-4, 2e-4], [0.2, 0.7], [1.0, 1.0]] {
            for densities in [[1e-3, 2.0], [1.0, 0.5], [5.0, 3.0]] {
                let (_, absorbed, by) = Film { densities }.with_derivatives([a, b]);
                let expected = Film { densities }.absorbed([a, b]);
                assert_eq!(absorbed, expected);
                for k in 0..2 {
                    let at = |step: f64| {
                        let mut moved = densities;
                        moved[k] += step;
                        Film { densities: moved }.absorbed([a, b])
                    };
                    let (low, high) = (at(-STEP), at(STEP));
                    for dye in 0..2 {
                        let quotient = (high[dye] - low[dye]) / (2.0 * STEP);
                        assert!((by[dye][k] - quotient).abs() < 1e-8, "{densities:?}");
                    }
                }
            }
        }
    }
}
