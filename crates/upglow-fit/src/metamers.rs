//! The materials that may have a color: all that match it, and how probable each is.

use std::sync::Arc;

use rayon::prelude::*;
use upglow::{Accounting, DyeSet, FilmModel, Model, QuantumYield};
use upglow_color::{
    Contract, ContractError, Illuminant, LinearRgb, MeasuredDye, MissingUltraviolet, Observer, Xyz,
    ciede2000, difference_by_xyz, lab_from_xyz,
};

mod blend;
mod lit;
mod posterior;
mod prior;

use crate::own_material::{FilmPart, OwnMaterial, OwnMaterialError, fitted_dye};
use crate::problem::parabola::edge_of;
use crate::seams::ultraviolet_lamp;
use blend::weights;
pub use lit::MetamerLight;
use posterior::{Found, Known, Posterior};
pub use prior::PaintKind;
use prior::{Dyes, SLOPE_MAX_PER_NM, densities};

/// Finds the materials that may have a color, of which one is known under the light of a contract and up to two
/// more under other lights.
///
/// A material is a film of two of the dyes over a smooth reflectance, whose shape, optical densities and quantum yields
/// are free; in an ordinary paint the dyes absorb only. How probable each is follows from how well it has the known
/// colors, and from what is usual for paint.
///
/// # Examples
///
/// ```
/// use upglow_color::{Contract, Illuminant, LinearRgb};
/// use upglow_fit::{MetamerSearch, PaintKind};
///
/// let search = MetamerSearch::new(&Contract::default(), &[], PaintKind::Fluorescent)?;
/// let metamers = search.of_rgb(&[LinearRgb([0.9, 0.3, 0.02])])?;
/// let a = metamers.light(&Illuminant::named("A")?);
/// println!("within {:.1} ΔE00 of {:?} under A", metamers.band(&a, metamers.mean(&a), 0.9), metamers.mean(&a));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct MetamerSearch {
    kind: PaintKind,
    among: Arc<Among>,
}

/// What is searched: films of dyes, under lights.
#[derive(Debug)]
struct Among {
    dyes: Vec<MeasuredDye>,
    contract: Contract,
    model: Model,
    /// The light of the contract, then those of the other known colors.
    known: Vec<MetamerLight>,
    /// Lights under which a material should be right, though nothing is known there.
    expected: Vec<MetamerLight>,
}

/// Most known colors.
pub(crate) const MOST_COLORS: usize = 3;

/// Why there is nothing to search.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MetamerError {
    /// Too few or too many colors.
    #[error("{found} colors, expected {expected}, one for each light")]
    Count {
        /// Colors given.
        found: usize,
        /// Lights of the search.
        expected: usize,
    },
    /// Too many lights.
    #[error("colors under {found} lights, expected at most {MOST_COLORS}")]
    Lights {
        /// Lights given, with that of the contract.
        found: usize,
    },
    /// A color is not a number, or too bright.
    #[error("the color under {light} is {xyz:?} (XYZ), expected numbers up to {BRIGHTEST}")]
    Color {
        /// The light.
        light: String,
        /// The color.
        xyz: [f64; 3],
    },
    /// The observer does not see a light.
    #[error(transparent)]
    Contract(#[from] ContractError),
    /// The dyes make no material.
    #[error(transparent)]
    Material(#[from] OwnMaterialError),
}

/// Far brighter than any material, of which none is ten times as bright as white.
const BRIGHTEST: f64 = 1000.0;

/// How many of the most probable materials are kept, and how many of them may be the answer.
const MOST_KEPT: usize = 256;
const MOST_ANSWERS: usize = 64;

impl MetamerSearch {
    /// How many colors programs search one after another: each takes half a second.
    pub const MOST_IN_TURN: usize = 1000;

    /// What the record of a cube calls the way in which its material was found.
    pub const METHOD: &str = "metamers";

    /// A search for colors under the light of the contract, then under `others`, of paints of a kind, among all
    /// built-in dyes.
    ///
    /// # Errors
    ///
    /// [`MetamerError`] if there are more than two other lights, or if the observer does not see one.
    pub fn new(
        contract: &Contract,
        others: &[Illuminant],
        kind: PaintKind,
    ) -> Result<Self, MetamerError> {
        Self::among(contract, others, kind, MeasuredDye::all().collect())
    }

    /// The same among these dyes.
    ///
    /// # Errors
    ///
    /// [`MetamerError`] if there are more than two other lights, if the observer does not see one, or if the dyes
    /// make no set.
    pub fn among(
        contract: &Contract,
        others: &[Illuminant],
        kind: PaintKind,
        dyes: Vec<MeasuredDye>,
    ) -> Result<Self, MetamerError> {
        let found = others.len() + 1;
        if found > MOST_COLORS {
            return Err(MetamerError::Lights { found });
        }
        contract.check()?;
        let set = DyeSet::new("candidates", dyes.clone()).map_err(OwnMaterialError::from)?;
        let film = FilmModel::new(set, Accounting::Photon, QuantumYield::Fixed(1.0));
        let model = Model::Film(film.map_err(OwnMaterialError::from)?);
        let light = |light: &Illuminant| MetamerLight::new(&model, contract, light);
        let known = std::iter::once(&contract.illuminant).chain(others).map(light).collect();
        let expected = expected_lights().iter().map(light).collect();
        let contract = contract.clone();
        let among = Arc::new(Among { dyes, contract, known, expected, model });
        Ok(Self { kind, among })
    }

    /// A light to see metamers under.
    pub fn light(&self, light: &Illuminant) -> MetamerLight {
        MetamerLight::new(&self.among.model, &self.among.contract, light)
    }

    /// What is to say about a light: ultraviolet that is not known, where dyes that may emit absorb it.
    pub fn missing_ultraviolet(&self, light: &Illuminant) -> Option<MissingUltraviolet> {
        let may_emit = self.kind != PaintKind::Ordinary;
        self.among.model.missing_ultraviolet(light).filter(|_| may_emit)
    }

    /// The materials that may have these linear colors, one for each light of the search, as they look under it:
    /// [`Contract::seen_under`]. Otherwise as [`Self::of`].
    ///
    /// # Errors
    ///
    /// [`MetamerError`] if there is not one color for each light, or one is no color of a material.
    pub fn of_rgb(&self, colors: &[LinearRgb]) -> Result<Metamers, MetamerError> {
        self.check_count(colors.len())?;
        let colors = self.among.known.iter().zip(colors);
        self.of(&colors.map(|(light, &rgb)| light.xyz_from_rgb(rgb)).collect::<Vec<_>>())
    }

    fn check_count(&self, found: usize) -> Result<(), MetamerError> {
        let expected = self.among.known.len();
        if found == expected { Ok(()) } else { Err(MetamerError::Count { found, expected }) }
    }

    /// The materials that may have these colors, one for each light of the search: relative to white as
    /// [`Contract::seen_under`] has it. By sums over 5 nm on all threads of the current rayon pool; results do not
    /// depend on their number.
    ///
    /// # Errors
    ///
    /// [`MetamerError`] if there is not one color for each light, or one is no color of a material.
    pub fn of(&self, colors: &[Xyz]) -> Result<Metamers, MetamerError> {
        self.check_count(colors.len())?;
        for (light, color) in self.among.known.iter().zip(colors) {
            if !color.0.iter().all(|v| v.is_finite() && v.abs() <= BRIGHTEST) {
                return Err(MetamerError::Color { light: light.name().into(), xyz: color.0 });
            }
        }
        Ok(self.found(colors))
    }

    /// The materials that have colors which were checked.
    fn found(&self, colors: &[Xyz]) -> Metamers {
        let Among { dyes, known: lights, .. } = &*self.among;
        let lights = lights.iter().zip(colors).enumerate();
        let known: Vec<Known<'_>> =
            lights.map(|(k, (light, &color))| Known::new(light, color, k == 0)).collect();
        let mut found = Vec::new();
        for (does, probability) in self.kind.hypotheses() {
            let posterior = Posterior { known: &known, dyes: dyes.len(), does };
            let modes = posterior.modes().into_iter();
            found
                .extend(modes.map(|mode| Found { weight: mode.weight + probability.ln(), ..mode }));
        }
        found.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        found.truncate(MOST_KEPT);
        let most = found.first().map_or(0.0, |found| found.weight);
        found.iter_mut().for_each(|found| found.weight = (found.weight - most).exp());
        let total: f64 = found.iter().map(|found| found.weight).sum();
        found.iter_mut().for_each(|found| found.weight /= total);
        Metamers { search: self.clone(), colors: colors.to_vec(), found }
    }
}

/// Lights that people have, at which a material is likely to be looked at.
fn expected_lights() -> Vec<Illuminant> {
    let named = ["A", "E", "D65-cut400", "FL2", "FL11", "HP1", "LED-B3"];
    let named = named.map(|name| Illuminant::named(name).expect("it is built in"));
    named.into_iter().chain([ultraviolet_lamp()]).collect()
}

/// The materials that may have a color, with their probabilities.
#[derive(Clone, Debug)]
pub struct Metamers {
    search: MetamerSearch,
    /// One for each light of the search.
    colors: Vec<Xyz>,
    /// The most probable first; their weights add up to 1.
    found: Vec<Found>,
}

impl Metamers {
    /// The share that a band usually holds: nine of ten.
    pub const USUAL_SHARE: f64 = 0.9;

    /// The probability that the paint fluoresces, as its colors tell. Where the kind of the paint was given, they
    /// are searched again as if it were not.
    pub fn fluorescent_probability(&self) -> f64 {
        if self.search.kind != PaintKind::Any {
            let any = MetamerSearch { kind: PaintKind::Any, ..self.search.clone() };
            return any.found(&self.colors).fluorescent_probability();
        }
        let emitting = self.found.iter().filter(|found| found.does == Dyes::Emit);
        // The sum of nothing would be -0.
        emitting.fold(0.0, |sum, found| sum + found.weight)
    }

    /// A light to see them under: [`MetamerSearch::light`].
    pub fn light(&self, light: &Illuminant) -> MetamerLight {
        self.search.light(light)
    }

    /// The same for another observer.
    pub(crate) fn light_for(&self, observer: &Observer, light: &Illuminant) -> MetamerLight {
        let Among { model, contract, .. } = &*self.search.among;
        let contract = Contract { observer: observer.clone(), ..contract.clone() };
        MetamerLight::new(model, &contract, light)
    }

    /// [`MetamerSearch::missing_ultraviolet`].
    pub fn missing_ultraviolet(&self, light: &Illuminant) -> Option<MissingUltraviolet> {
        self.search.missing_ultraviolet(light)
    }

    /// The probability and the color of each material under a light.
    pub fn colors(&self, light: &MetamerLight) -> Vec<(f64, Xyz)> {
        let color = |found: &Found| (found.weight, light.color(found.dyes, &found.numbers));
        self.found.par_iter().map(color).collect()
    }

    /// The mean color under a light.
    pub fn mean(&self, light: &MetamerLight) -> Xyz {
        mean(&self.colors(light))
    }

    /// How far an answer may be off: the ΔE00 under a light within which the share `share` of the materials, by
    /// their probabilities, is from `answer`.
    ///
    /// For nine of ten of the 99 object colors of CIE 224:2017, of which only the color under D65 is known, the
    /// truth is within the band of 0.9.
    pub fn band(&self, light: &MetamerLight, answer: Xyz, share: f64) -> f64 {
        band(&self.colors(light), answer, light.white(), share)
    }

    /// The material from which the ΔE00 to all, by their probabilities and over lights that people have, is least:
    /// the best answer if one material is asked for.
    ///
    /// # Errors
    ///
    /// [`MetamerError`] if the dyes make no material.
    pub fn single(&self) -> Result<OwnMaterial, MetamerError> {
        let answers = self.found.len().min(MOST_ANSWERS);
        let mut errors = vec![0.0; answers];
        for light in &self.search.among.expected {
            let labs = self.colors(light).into_iter();
            let labs: Vec<_> = labs.map(|(w, xyz)| (w, lab_from_xyz(xyz, light.white()))).collect();
            let error = |answer: usize| -> f64 {
                labs.iter().map(|(w, lab)| w * ciede2000(labs[answer].1, *lab)).sum()
            };
            let of_light: Vec<f64> = (0..answers).into_par_iter().map(error).collect();
            errors.iter_mut().zip(of_light).for_each(|(sum, error)| *sum += error);
        }
        let best = (0..answers).min_by(|&a, &b| errors[a].total_cmp(&errors[b])).unwrap_or(0);
        self.material(&[(best, 1.0)])
    }

    /// The blend of up to four of the materials whose colors are nearest to the mean colors of all: the best
    /// answer if a blend may be given.
    ///
    /// # Errors
    ///
    /// [`MetamerError`] if the dyes make no material.
    pub fn mixture(&self) -> Result<OwnMaterial, MetamerError> {
        let Among { known, expected, .. } = &*self.search.among;
        let lights = known.iter().chain(expected);
        let answers = self.found.len().min(MOST_ANSWERS);
        let rows = lights.map(|light| {
            let colors = self.colors(light);
            let mean = mean(&colors);
            let by_xyz = difference_by_xyz(mean, light.white());
            let row = |&(_, xyz): &(f64, Xyz)| by_xyz * (xyz - mean).0;
            colors[..answers].iter().map(row).collect::<Vec<_>>()
        });
        self.material(&weights(&rows.collect::<Vec<_>>()))
    }

    /// A blend of materials by number.
    fn material(&self, parts: &[(usize, f64)]) -> Result<OwnMaterial, MetamerError> {
        let Among { dyes: all, known, .. } = &*self.search.among;
        let part = |(place, &(number, weight)): (usize, &(usize, f64))| {
            let home = Known::new(&known[0], self.colors[0], true);
            let Found { dyes, numbers, .. } = self.found[number].exact(&home);
            let [edge, level, slope, .., first_yield, second_yield] = numbers;
            let [a, b] = densities(&numbers);
            let name = (parts.len() > 1).then_some(place + 1);
            let dye = |k: usize, quantum_yield| fitted_dye(&all[k], quantum_yield, name);
            let both = [(dye(dyes[0], first_yield), a), (dye(dyes[1], second_yield), b)];
            let dyes = if dyes[0] == dyes[1] { both[..1].to_vec() } else { both.to_vec() };
            FilmPart { weight, reflectance: edge_of([edge, level, slope], SLOPE_MAX_PER_NM), dyes }
        };
        Ok(OwnMaterial::new(parts.iter().enumerate().map(part).collect())?)
    }
}

fn mean(colors: &[(f64, Xyz)]) -> Xyz {
    colors.iter().map(|&(weight, color)| weight * color).sum()
}

/// The ΔE00 from `center` within which a share of the colors is.
fn band(colors: &[(f64, Xyz)], center: Xyz, white: Xyz, share: f64) -> f64 {
    let center = lab_from_xyz(center, white);
    let mut far: Vec<(f64, f64)> = colors
        .iter()
        .map(|&(weight, xyz)| (ciede2000(center, lab_from_xyz(xyz, white)), weight))
        .collect();
    far.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut reached = 0.0;
    for (de2000, weight) in &far {
        reached += weight;
        if reached >= share {
            return *de2000;
        }
    }
    far.last().map_or(0.0, |(de2000, _)| *de2000)
}

#[cfg(test)]
mod tests;
