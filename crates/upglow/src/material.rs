//! Materials: a reflectance and what fluoresces in it.

use crate::{Model, Sigmoid};

/// One material in six numbers at most. What they mean is said by the [`Model`] it was made for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Material {
    /// What the material reflects where nothing is absorbed by fluorescence.
    pub reflectance: Sigmoid,
    /// What it absorbs and gives back at other wavelengths.
    pub fluorescence: Fluorescence,
}

/// The fluorescent part of a [`Material`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Fluorescence {
    /// Nothing fluoresces.
    #[default]
    None,
    /// A dye of the model's ring mixed with its neighbor.
    Dyes {
        /// Number of the first dye in the ring.
        first: usize,
        /// Share of the neighbor, 0..=1.
        weight: f64,
        /// How much of the light at the absorption's peak is absorbed, 0..=1.
        concentration: f64,
    },
    /// Bells by formula.
    Analytic {
        /// Wavelength of the emission's peak, nm.
        emission_peak_nm: f64,
        /// Distance from the absorption's peak to the emission's, nm.
        stokes_shift_nm: f64,
        /// How much of the light at the absorption's peak is absorbed, 0..=1.
        concentration: f64,
    },
}

impl Fluorescence {
    /// The concentration, 0..=1; 0 where nothing fluoresces.
    pub fn concentration(self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Dyes { concentration, .. } | Self::Analytic { concentration, .. } => {
                concentration
            }
        }
    }
}

impl Material {
    /// A material that only reflects.
    pub fn passive(reflectance: Sigmoid) -> Self {
        Self { reflectance, fluorescence: Fluorescence::None }
    }
}

/// Light that one absorber takes and one emitter gives back.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lobe<'m> {
    pub(crate) strength: f64,
    pub(crate) quantum_yield: f64,
    pub(crate) mean_emission_nm: f64,
    pub(crate) curves: Curves<'m>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Curves<'m> {
    Dyes { model: &'m crate::DyeModel, first: usize, second: usize, weight: f64 },
    Bells { model: &'m crate::AnalyticModel, absorption_nm: f64, emission_nm: f64 },
}

impl Lobe<'_> {
    /// Share of incident light at `lambda_nm` that the lobe absorbs.
    pub(crate) fn absorbed(&self, lambda_nm: f64) -> f64 {
        self.strength
            * match self.curves {
                Curves::Dyes { model, first, second, weight } => {
                    let at = |dye: usize| model.curves()[dye].absorption.at(lambda_nm);
                    (1.0 - weight) * at(first) + weight * at(second)
                }
                Curves::Bells { model, absorption_nm, .. } => {
                    model.absorption(absorption_nm, lambda_nm).0
                }
            }
    }

    pub(crate) fn accounting(&self) -> crate::Accounting {
        match self.curves {
            Curves::Dyes { model, .. } => model.options().accounting,
            Curves::Bells { model, .. } => model.accounting(),
        }
    }

    /// Share of incident energy at `lambda_nm` that comes out somewhere.
    pub(crate) fn returned(&self, lambda_nm: f64) -> f64 {
        let share = self.accounting().share(lambda_nm, self.mean_emission_nm);
        self.absorbed(lambda_nm) * self.quantum_yield * share
    }

    /// Where it comes out: a density of unit area, 1/nm.
    pub(crate) fn emission(&self, lambda_nm: f64) -> f64 {
        match self.curves {
            Curves::Dyes { model, first, second, weight } => {
                let at = |dye: usize| model.curves()[dye].emission.at(lambda_nm);
                (1.0 - weight) * at(first) + weight * at(second)
            }
            Curves::Bells { model, emission_nm, .. } => model.emission(emission_nm, lambda_nm).0,
        }
    }

    /// The area of the emission between two wavelengths, 0..=1.
    pub(crate) fn emission_between(&self, from_nm: f64, to_nm: f64) -> f64 {
        match self.curves {
            Curves::Dyes { model, first, second, weight } => {
                let area = |dye: usize| model.curves()[dye].emission.area(from_nm, to_nm);
                (1.0 - weight) * area(first) + weight * area(second)
            }
            Curves::Bells { model, emission_nm, .. } => {
                model.emission_area(emission_nm, from_nm, to_nm)
            }
        }
    }
}

impl Fluorescence {
    /// The one or two lobes of this fluorescence under `model`; none where nothing fluoresces.
    pub(crate) fn lobes(self, model: &Model) -> impl Iterator<Item = Lobe<'_>> + use<'_> {
        let [first, second] = match (self, model) {
            (Self::Dyes { first, weight, concentration }, Model::Dyes(model)) => {
                dye_lobes(model, first, weight, concentration)
            }
            (
                Self::Analytic { emission_peak_nm, stokes_shift_nm, concentration },
                Model::Analytic(model),
            ) => [
                Some(Lobe {
                    strength: concentration,
                    quantum_yield: model.quantum_yield(),
                    mean_emission_nm: emission_peak_nm,
                    curves: Curves::Bells {
                        model,
                        absorption_nm: emission_peak_nm - stokes_shift_nm,
                        emission_nm: emission_peak_nm,
                    },
                }),
                None,
            ],
            _ => [None, None],
        };
        first.into_iter().chain(second)
    }
}

fn dye_lobes(
    model: &crate::DyeModel,
    first: usize,
    weight: f64,
    concentration: f64,
) -> [Option<Lobe<'_>>; 2] {
    let second = model.partner(first);
    let (a, b) = (&model.curves()[first], &model.curves()[second]);
    let mix = |x: f64, y: f64| (1.0 - weight) * x + weight * y;
    match model.options().mixing {
        crate::Mixing::Pooled => [
            Some(Lobe {
                strength: concentration,
                quantum_yield: mix(a.quantum_yield, b.quantum_yield),
                mean_emission_nm: mix(a.mean_emission_nm, b.mean_emission_nm),
                curves: Curves::Dyes { model, first, second, weight },
            }),
            None,
        ],
        crate::Mixing::Separate => [(first, 1.0 - weight), (second, weight)].map(|(dye, share)| {
            let curves = &model.curves()[dye];
            Some(Lobe {
                strength: concentration * share,
                quantum_yield: curves.quantum_yield,
                mean_emission_nm: curves.mean_emission_nm,
                curves: Curves::Dyes { model, first: dye, second: dye, weight: 0.0 },
            })
        }),
    }
}
