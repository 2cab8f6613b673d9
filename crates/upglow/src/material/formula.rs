//! The formula of fluorescence, in double precision and in vectors of single precision.
//!
//! The fluorescence of a material has one or two lobes. At λ, a lobe absorbs the share c·a(λ) of the
//! light, returns Q·g(λ) of that, and emits it with the density ê. A model of dyes has two dyes in
//! each material: [`Mixing`] says which lobes they make, [`Accounting`] what g is.

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
    /// Color emitted at concentration 1.
    pub color: [f64; 3],
    /// Its derivatives by the model's parameters.
    pub derivatives: [[f64; 3]; N],
}

/// One dye under a light and observer.
#[derive(Clone, Debug)]
pub(crate) struct Emitter {
    /// Absorptance at concentration 1, `[wavelength]`.
    pub(crate) absorption: Vec<f64>,
    /// Energy of the light that it absorbs.
    pub(crate) absorbed: f64,
    /// Color of one unit of emitted energy.
    pub(crate) stimulus: [f64; 3],
    pub(crate) quantum_yield: f64,
    pub(crate) mean_emission_nm: f64,
}
