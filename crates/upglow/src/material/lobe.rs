//! The lobes of a material in double precision: what each absorbs, returns, emits and draws.

use crate::material::Fluorescence;
use crate::material::bell::Bell;
use crate::material::distribution::Distribution;
use crate::material::dye_model::{DyeCurves, DyeModel, DyeOptions};
use crate::material::film_model::{FilmModel, LEVELS, level_shares};
use crate::material::formula::{Accounting, Film, Mixing};
use crate::material::model::Model;
use crate::material::sampling::ratio;

/// One absorption and one emission, with the rules that connect them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lobe<'m> {
    accounting: Accounting,
    quantum_yield: f64,
    mean_emission_nm: f64,
    concentration: f64,
    spectra: Spectra<'m>,
}

#[derive(Clone, Copy, Debug)]
enum Spectra<'m> {
    /// Lobe number `lobe` of two dyes.
    Dyes {
        dyes: [&'m DyeCurves; 2],
        weight: f64,
        mixing: Mixing,
        lobe: usize,
    },
    /// The dye that is number `lobe` of a film's two.
    Film {
        model: &'m FilmModel,
        dyes: [usize; 2],
        film: Film<f64>,
        lobe: usize,
    },
    Bells {
        absorption: Bell,
        emission: Bell,
    },
}

impl Fluorescence {
    /// The lobes of this fluorescence under `model`: none, one or two.
    pub(crate) fn lobes(self, model: &Model) -> impl Iterator<Item = Lobe<'_>> + use<'_> {
        let [first, second] = match (self, model) {
            (Self::Dyes { first, weight, concentration }, Model::Dyes(model)) => {
                dye_lobes(model, first, weight, concentration)
            }
            (Self::Film { dyes, densities }, Model::Film(model)) => {
                film_lobes(model, dyes, densities)
            }
            (
                Self::Analytic { emission_peak_nm, stokes_shift_nm, concentration },
                Model::Analytic(model),
            ) => {
                let emission = model.emission_bell(emission_peak_nm);
                let absorption = model.absorption_bell(emission_peak_nm - stokes_shift_nm);
                let bells = Lobe {
                    accounting: model.accounting(),
                    quantum_yield: model.quantum_yield(),
                    mean_emission_nm: emission_peak_nm,
                    concentration,
                    spectra: Spectra::Bells { absorption, emission },
                };
                [Some(bells), None]
            }
            _ => [None, None],
        };
        first.into_iter().chain(second)
    }
}

fn dye_lobes(
    model: &DyeModel,
    first: usize,
    weight: f64,
    concentration: f64,
) -> [Option<Lobe<'_>>; 2] {
    let DyeOptions { accounting, mixing, .. } = model.options();
    let dyes = [first, model.partner(first)].map(|dye| &model.curves()[dye]);
    let quantum_yields = mixing.per_lobe(dyes.map(|dye| dye.quantum_yield), weight);
    let means_nm = mixing.per_lobe(dyes.map(|dye| dye.mean_emission_nm), weight);
    [0, 1].map(|lobe| {
        (lobe < mixing.lobes()).then(|| Lobe {
            accounting,
            quantum_yield: quantum_yields[lobe],
            mean_emission_nm: means_nm[lobe],
            concentration,
            spectra: Spectra::Dyes { dyes, weight, mixing, lobe },
        })
    })
}

fn film_lobes(model: &FilmModel, dyes: [usize; 2], densities: [f64; 2]) -> [Option<Lobe<'_>>; 2] {
    [0, 1].map(|lobe| {
        let DyeCurves { quantum_yield, mean_emission_nm, .. } = model.dyes().curves()[dyes[lobe]];
        let spectra = Spectra::Film { model, dyes, film: Film { densities }, lobe };
        let (accounting, concentration) = (model.accounting(), 1.0);
        Some(Lobe { accounting, quantum_yield, mean_emission_nm, concentration, spectra })
    })
}

impl Lobe<'_> {
    /// Share of incident light at `lambda_nm` that the lobe absorbs.
    pub(crate) fn absorbed(&self, lambda_nm: f64) -> f64 {
        match self.spectra {
            Spectra::Dyes { dyes, weight, mixing, lobe } => {
                let absorptions = dyes.map(|dye| dye.absorption.at(lambda_nm));
                mixing.absorbed(absorptions, self.concentration, weight)[lobe]
            }
            Spectra::Film { model, dyes, film, lobe } => {
                let curves = model.dyes().curves();
                film.absorbed(dyes.map(|dye| curves[dye].absorption.at(lambda_nm)))[lobe]
            }
            Spectra::Bells { absorption, .. } => {
                self.concentration * absorption.peak_one(lambda_nm).0
            }
        }
    }

    /// Share of the incident energy at `lambda_nm` that is re-emitted at any wavelength.
    pub(crate) fn returned(&self, lambda_nm: f64) -> f64 {
        let absorbed = self.absorbed(lambda_nm);
        self.accounting.returned(absorbed, self.quantum_yield, lambda_nm, self.mean_emission_nm)
    }

    /// The emission as a density of unit area, 1/nm.
    pub(crate) fn emission(&self, lambda_nm: f64) -> f64 {
        match self.spectra {
            Spectra::Dyes { .. } | Spectra::Film { .. } => {
                self.of_dyes(|dye| dye.emission.at(lambda_nm))
            }
            Spectra::Bells { emission, .. } => emission.area_one(lambda_nm).0,
        }
    }

    /// The area of the emission between two wavelengths, 0..=1.
    pub(crate) fn emission_between(&self, from_nm: f64, to_nm: f64) -> f64 {
        match self.spectra {
            Spectra::Dyes { .. } | Spectra::Film { .. } => {
                self.of_dyes(|dye| dye.emission.area(from_nm, to_nm))
            }
            Spectra::Bells { emission, .. } => emission.area_between(from_nm, to_nm),
        }
    }

    /// ∫ ê dλ: below 1 where a measured emission does not fall to zero within its table.
    pub(crate) fn emitted_total(&self) -> f64 {
        match self.spectra {
            Spectra::Dyes { .. } | Spectra::Film { .. } => self.of_dyes(|dye| dye.emitting.total()),
            Spectra::Bells { .. } => 1.0,
        }
    }

    /// The curve, over incident wavelengths, that [`Lobe::sample_incident`] draws from. It is what the
    /// lobe returns; in a film, what its dye would return without the other one, from a table.
    pub(crate) fn proposed(&self, in_nm: f64) -> f64 {
        match self.spectra {
            Spectra::Film { .. } => {
                self.quantum_yield * self.of_levels(|level| level.at(in_nm)).iter().sum::<f64>()
            }
            Spectra::Dyes { .. } | Spectra::Bells { .. } => self.returned(in_nm),
        }
    }

    /// ∫ proposed dλ over incident wavelengths, nm.
    pub(crate) fn proposed_total_nm(&self) -> f64 {
        let (concentration, area) = match self.spectra {
            Spectra::Film { .. } => (1.0, self.of_levels(Distribution::total).iter().sum()),
            Spectra::Dyes { weight, mixing, lobe, .. } => {
                let concentrations = mixing.concentrations(self.concentration, weight);
                let [one, two] = self.areas(|dye| self.shared_total(dye));
                (concentrations[lobe], one + two)
            }
            Spectra::Bells { absorption, .. } => {
                let share = match self.accounting {
                    Accounting::Energy => 1.0,
                    Accounting::Photon => {
                        absorption.shared_area_below(self.mean_emission_nm, f64::INFINITY)
                    }
                };
                // The area for a peak of 1, nm.
                (self.concentration, 1.5 * absorption.step_nm * share)
            }
        };
        concentration * self.quantum_yield * area
    }

    /// An incident wavelength with the density of [`Lobe::proposed`], from `u` in 0..1.
    pub(crate) fn sample_incident(&self, u: f64) -> f64 {
        match self.spectra {
            Spectra::Film { model, dyes, lobe, .. } => {
                let (level, u) = pick(self.of_levels(Distribution::total), u);
                model.proposals(dyes[lobe])[level].sample(u)
            }
            Spectra::Dyes { dyes, .. } => {
                let (dye, u) = pick(self.areas(|dye| self.shared_total(dye)), u);
                dyes[dye].absorbing.sample_shared(self.accounting, self.mean_emission_nm, u)
            }
            Spectra::Bells { absorption, .. } => match self.accounting {
                Accounting::Energy => absorption.quantile(u),
                Accounting::Photon => absorption.shared_quantile(self.mean_emission_nm, u),
            },
        }
    }

    /// An outgoing wavelength with the density of the emission, from `u` in 0..1.
    pub(crate) fn sample_emitted(&self, u: f64) -> f64 {
        match self.spectra {
            Spectra::Dyes { dyes, .. } => {
                let (dye, u) = pick(self.areas(|dye| dye.emitting.total()), u);
                dyes[dye].emitting.sample(u)
            }
            Spectra::Film { model, dyes, lobe, .. } => {
                model.dyes().curves()[dyes[lobe]].emitting.sample(u)
            }
            Spectra::Bells { emission, .. } => emission.quantile(u),
        }
    }

    /// ∫ a·share dλ of one dye, nm.
    fn shared_total(&self, dye: &DyeCurves) -> f64 {
        dye.absorbing.shared_total(self.accounting, self.mean_emission_nm)
    }

    /// A number of the lobe from those of its dyes; 0 for bells.
    fn of_dyes(&self, number: impl Fn(&DyeCurves) -> f64) -> f64 {
        match self.spectra {
            Spectra::Dyes { dyes, weight, mixing, lobe } => {
                mixing.per_lobe(dyes.map(number), weight)[lobe]
            }
            Spectra::Film { model, dyes, lobe, .. } => number(&model.dyes().curves()[dyes[lobe]]),
            Spectra::Bells { .. } => 0.0,
        }
    }

    /// The parts that two mixed dyes have in the area of one of the lobe's curves; zeros for others.
    fn areas(&self, area: impl Fn(&DyeCurves) -> f64) -> [f64; 2] {
        match self.spectra {
            Spectra::Dyes { dyes, weight, mixing, lobe } => {
                let [one, two] = mixing.shares_of_dyes(lobe, weight);
                [one * area(dyes[0]), two * area(dyes[1])]
            }
            Spectra::Film { .. } | Spectra::Bells { .. } => [0.0; 2],
        }
    }

    /// A number of each level of a film's dye, times the level's share; zeros for other lobes.
    fn of_levels(&self, number: impl Fn(&Distribution) -> f64) -> [f64; LEVELS.len()] {
        let Spectra::Film { model, dyes, film, lobe } = self.spectra else {
            return [0.0; LEVELS.len()];
        };
        let mut numbers = level_shares(film.densities[lobe]);
        let levels = model.proposals(dyes[lobe]);
        numbers.iter_mut().zip(levels).for_each(|(share, level)| *share *= number(level));
        numbers
    }
}

/// The index of one of `areas` in proportion to them, and what is left of `u` to draw from it.
fn pick<const N: usize>(areas: [f64; N], u: f64) -> (usize, f64) {
    let mut rest = u * areas.iter().sum::<f64>();
    let last = areas.iter().rposition(|area| *area > 0.0).unwrap_or(0);
    for (index, area) in areas.into_iter().enumerate().take(last) {
        if rest < area {
            return (index, rest / area);
        }
        rest -= area;
    }
    (last, ratio(rest, areas[last]))
}
