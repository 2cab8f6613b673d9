//! The compact bispectral form: one reflectance a band, one map a dye, and the curves once.
//!
//! `docs/spectral-exr.md` describes it for readers in other languages.

use upglow::{Accounting, Bispectral, DyeModel, Fluorescence, Mixing, Mixture};
use upglow_color::Grid;

use crate::exr::attribute::{Attribute, Attributes};
use crate::rounding::to_single;
use crate::spectral::attribute_spectrum::{parse_spectrum, print_spectrum};
use crate::spectral::channel::SpectralChannel;

/// What the maps beside the reflectances hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompactForm {
    /// One map for each dye of the ring: how much of it is there. Exact for a single material,
    /// whose dyes are pooled or not, and for every mixture where each dye acts for itself; there maps
    /// may also be filtered.
    PerDye,
    /// Four pairs of maps: where on the ring of dyes a material stands, and how strong it is.
    /// Exact for every mixture of a look-up, of any ring; needs float samples and no filter.
    PerLobe,
}

impl CompactForm {
    fn name(self) -> &'static str {
        match self {
            Self::PerDye => "dyes",
            Self::PerLobe => "lobes",
        }
    }
}

/// The most channels beside the reflectances.
pub const MOST_EXTRA_CHANNELS: usize = 12;
/// Materials in a mixture.
const LOBES: usize = 4;

/// One dye on the bands of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct CompactDye {
    /// Its name, as in the channel `dye.NAME`.
    pub name: String,
    /// Share of incident light that it absorbs at concentration 1, in each band, 0..=1.
    pub absorption: Vec<f64>,
    /// Share of what it gives back that leaves in each band; adds up to 1 at most.
    pub emission: Vec<f64>,
    /// Share of absorbed light that comes out, 0..=1.
    pub quantum_yield: f64,
    /// Mean wavelength of the emission, nm.
    pub mean_emission_nm: f64,
}

/// Why there is no compact form.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompactError {
    /// More dyes than maps.
    #[error(
        "{found} dyes, expected 1 to {MOST_EXTRA_CHANNELS} with a map each; the form of lobes takes any number"
    )]
    Dyes {
        /// Dyes of the ring.
        found: usize,
    },
    /// Two dyes have one name once it is spelled as a channel.
    #[error("two dyes are named {name:?} in channels, expected different names")]
    Twice {
        /// The name.
        name: String,
    },
    /// Materials with different pooled dyes in one texel.
    #[error("materials of different pooled dyes in one texel, expected one, or the form of lobes")]
    Mixture,
    /// More materials in a texel than there are maps.
    #[error("{found} fluorescent materials in one texel, expected at most {LOBES}")]
    Lobes {
        /// Materials found.
        found: usize,
    },
    /// An attribute is absent or is not what it should be.
    #[error("attribute {name} is {found}, expected {expected}")]
    Attribute {
        /// The attribute.
        name: String,
        /// Its value, or "absent".
        found: String,
        /// What it should be.
        expected: String,
    },
    /// A channel is absent.
    #[error("no channel {name:?}, expected the channels of the compact form")]
    Channel {
        /// The channel.
        name: String,
    },
    /// A texel of another size.
    #[error("{found} values in a texel, expected {expected}")]
    Texel {
        /// Values given.
        found: usize,
        /// One for each channel.
        expected: usize,
    },
}

/// The bands, dyes and rules of a file in compact form.
#[derive(Clone, Debug, PartialEq)]
pub struct CompactLayout {
    wavelengths_nm: Vec<f64>,
    dyes: Vec<CompactDye>,
    accounting: Accounting,
    mixing: Mixing,
    form: CompactForm,
}

/// A re-radiation matrix over the bands of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Donaldson {
    /// Centers of the bands, ascending, nm.
    pub wavelengths_nm: Vec<f64>,
    /// `[incident][outgoing]`: share of the power that comes in at the incident wavelength and
    /// leaves within the outgoing band. On the diagonal also what is reflected.
    pub shares: Vec<Vec<f32>>,
}

impl Donaldson {
    /// The entries that the spectral layout has channels for: incident, outgoing, share, where the
    /// outgoing wavelength is the longer one.
    pub fn pairs(&self) -> impl Iterator<Item = (f64, f64, f32)> + '_ {
        let nm = &self.wavelengths_nm;
        let rows = self.shares.iter().enumerate();
        rows.flat_map(move |(i, row)| (i + 1..nm.len()).map(move |o| (nm[i], nm[o], row[o])))
    }
}

/// Dyes that act together: the share of each in the lobe, and the strength of the lobe.
struct Lobe<'s> {
    strength: f64,
    shares: &'s [(usize, f64)],
}

const VERSION: &str = "upglow.compact";
const VERSION_VALUE: &str = "1";
const FORM: &str = "upglow.compact.form";
const MIXING: &str = "upglow.compact.mixing";
const ACCOUNTING: &str = "upglow.compact.accounting";
const DYES: &str = "upglow.compact.dyes";

impl CompactLayout {
    /// The form for materials of `model` on the bands around `grid`'s wavelengths.
    ///
    /// # Errors
    ///
    /// [`CompactError`] if the ring has more dyes than the form has maps, or two of one name.
    pub fn new(model: &DyeModel, grid: Grid, form: CompactForm) -> Result<Self, CompactError> {
        let found = model.curves().len();
        if form == CompactForm::PerDye && found > MOST_EXTRA_CHANNELS {
            return Err(CompactError::Dyes { found });
        }
        let half = f64::from(grid.step_nm()) / 2.0;
        let wavelengths_nm: Vec<f64> = grid.wavelengths_nm().collect();
        let named = model.set().dyes().iter().zip(model.curves());
        let dyes: Vec<CompactDye> = named
            .map(|(dye, curves)| {
                let absorption = wavelengths_nm.iter().map(|&nm| curves.absorption.at(nm));
                let emission =
                    wavelengths_nm.iter().map(|&nm| curves.emission.area(nm - half, nm + half));
                CompactDye {
                    name: channel_word(&dye.name),
                    absorption: absorption.collect(),
                    emission: emission.collect(),
                    quantum_yield: curves.quantum_yield,
                    mean_emission_nm: curves.mean_emission_nm,
                }
            })
            .collect();
        check_names(&dyes)?;
        let options = model.options();
        let (accounting, mixing) = (options.accounting, options.mixing);
        Ok(Self { wavelengths_nm, dyes, accounting, mixing, form })
    }

    /// Centers of the bands, ascending, nm.
    pub fn wavelengths_nm(&self) -> &[f64] {
        &self.wavelengths_nm
    }

    /// The dyes in ring order.
    pub fn dyes(&self) -> &[CompactDye] {
        &self.dyes
    }

    /// What the maps hold.
    pub fn form(&self) -> CompactForm {
        self.form
    }

    /// The channels of a texel, in the order of its values: the reflectances, then the maps.
    pub fn channel_names(&self) -> Vec<String> {
        let bands = self.wavelengths_nm.iter();
        let bands = bands.map(|&nm| SpectralChannel::Reflectance { nm }.to_string());
        bands.chain(self.map_names()).collect()
    }

    fn map_names(&self) -> Vec<String> {
        match self.form {
            CompactForm::PerDye => self.dyes.iter().map(|d| format!("dye.{}", d.name)).collect(),
            CompactForm::PerLobe => (1..=LOBES)
                .flat_map(|n| [format!("lobe.{n}.position"), format!("lobe.{n}.strength")])
                .collect(),
        }
    }

    /// What a file in this form states, besides what the spectral layout asks for.
    pub fn attributes(&self) -> Attributes {
        let names: Vec<&str> = self.dyes.iter().map(|d| d.name.as_str()).collect();
        let mut attributes = Attributes::from([
            (VERSION.into(), VERSION_VALUE.into()),
            (FORM.into(), self.form.name().into()),
            (MIXING.into(), self.mixing.to_string().into()),
            (ACCOUNTING.into(), self.accounting.to_string().into()),
            (DYES.into(), names.join(";").into()),
        ]);
        for dye in &self.dyes {
            let curve = |values: &[f64]| print_spectrum(&self.wavelengths_nm, values).into();
            attributes.extend([
                (dye_attribute(&dye.name, "absorption"), curve(&dye.absorption)),
                (dye_attribute(&dye.name, "emission"), curve(&dye.emission)),
                (dye_attribute(&dye.name, "quantumYield"), dye.quantum_yield.to_string().into()),
                (dye_attribute(&dye.name, "meanEmission"), dye.mean_emission_nm.to_string().into()),
            ]);
        }
        attributes
    }

    /// Whether a file with these attributes is in compact form.
    pub fn is_stated(attributes: &Attributes) -> bool {
        attributes.contains_key(VERSION)
    }

    /// The form that a file states.
    ///
    /// # Errors
    ///
    /// [`CompactError::Attribute`] names what is absent or wrong.
    pub fn from_attributes(attributes: &Attributes) -> Result<Self, CompactError> {
        let stated = Stated(attributes);
        stated.word(VERSION, &[VERSION_VALUE])?;
        let form = match stated.word(FORM, &["dyes", "lobes"])? {
            "dyes" => CompactForm::PerDye,
            _ => CompactForm::PerLobe,
        };
        let mixing = match stated.word(MIXING, &["pooled", "separate"])? {
            "pooled" => Mixing::Pooled,
            _ => Mixing::Separate,
        };
        let accounting = match stated.word(ACCOUNTING, &["energy", "photon"])? {
            "energy" => Accounting::Energy,
            _ => Accounting::Photon,
        };
        let names = stated.text(DYES, "names separated by semicolons")?;
        let dyes = names.split(';').map(|name| stated.dye(name));
        let dyes = dyes.collect::<Result<Vec<_>, _>>()?;
        let found = dyes.len();
        if form == CompactForm::PerDye && found > MOST_EXTRA_CHANNELS {
            return Err(CompactError::Dyes { found });
        }
        let (wavelengths_nm, _) = &dyes[0];
        let wavelengths_nm = wavelengths_nm.clone();
        if let Some((_, dye)) = dyes.iter().find(|(nm, _)| *nm != wavelengths_nm) {
            let name = dye_attribute(&dye.name, "absorption");
            let expected = "the wavelengths of the first dye".into();
            return Err(CompactError::Attribute { name, found: "on others".into(), expected });
        }
        let dyes: Vec<CompactDye> = dyes.into_iter().map(|(_, dye)| dye).collect();
        check_names(&dyes)?;
        Ok(Self { wavelengths_nm, dyes, accounting, mixing, form })
    }

    /// The values of a texel with this mixture, in the order of [`CompactLayout::channel_names`].
    ///
    /// The reflectance of a band is the diagonal of the re-radiation matrix: what is reflected, and what
    /// fluorescence returns within the band.
    ///
    /// # Errors
    ///
    /// [`CompactError::Mixture`] if the form cannot hold the mixture exactly.
    pub fn encode(&self, mixture: &Mixture<'_>) -> Result<Vec<f32>, CompactError> {
        let maps = match self.form {
            CompactForm::PerDye => self.dye_maps(mixture)?,
            CompactForm::PerLobe => self.lobe_maps(mixture)?,
        };
        let maps: Vec<f32> = maps.into_iter().map(to_single).collect();
        let mut texel: Vec<f32> = Vec::with_capacity(self.wavelengths_nm.len() + maps.len());
        for (i, &nm) in self.wavelengths_nm.iter().enumerate() {
            texel.push(to_single(mixture.reflectance(nm) + self.moved(&maps, i, i)));
        }
        texel.extend(maps);
        Ok(texel)
    }

    /// The re-radiation matrix of a texel: all that the compact form leaves out.
    ///
    /// # Errors
    ///
    /// [`CompactError::Texel`] if there is not one value for each channel.
    pub fn expand(&self, texel: &[f32]) -> Result<Donaldson, CompactError> {
        let bands = self.wavelengths_nm.len();
        let (found, expected) = (texel.len(), bands + self.map_names().len());
        if found != expected {
            return Err(CompactError::Texel { found, expected });
        }
        let (reflectances, maps) = texel.split_at(bands);
        let row = |i: usize| {
            let share =
                |o| if i == o { reflectances[i] } else { to_single(self.moved(maps, i, o)) };
            (0..bands).map(share).collect()
        };
        let shares = (0..bands).map(row).collect();
        Ok(Donaldson { wavelengths_nm: self.wavelengths_nm.clone(), shares })
    }

    /// Share of the power in one band that fluorescence moves to another or leaves there.
    fn moved(&self, maps: &[f32], incident: usize, outgoing: usize) -> f64 {
        let mut sum = 0.0;
        self.for_each_lobe(maps, |lobe| {
            let mean = |of: &dyn Fn(&CompactDye) -> f64| -> f64 {
                lobe.shares.iter().map(|&(dye, share)| share * of(&self.dyes[dye])).sum()
            };
            let absorbed = lobe.strength * mean(&|dye| dye.absorption[incident]);
            let returned = match self.accounting {
                Accounting::Energy => 1.0,
                Accounting::Photon => {
                    let mean_nm = mean(&|dye| dye.mean_emission_nm);
                    (self.wavelengths_nm[incident] / mean_nm).min(1.0)
                }
            };
            let quantum_yield = mean(&|dye| dye.quantum_yield);
            sum += absorbed * quantum_yield * returned * mean(&|dye| dye.emission[outgoing]);
        });
        sum
    }

    /// The lobes that the maps of a texel stand for.
    fn for_each_lobe(&self, maps: &[f32], mut act: impl FnMut(&Lobe<'_>)) {
        let count = self.dyes.len();
        let mut together = |strength: f64, shares: &[(usize, f64)]| match self.mixing {
            _ if strength <= 0.0 || !strength.is_finite() => {}
            Mixing::Pooled => act(&Lobe { strength, shares }),
            Mixing::Separate => {
                for &(dye, share) in shares {
                    act(&Lobe { strength: strength * share, shares: &[(dye, 1.0)] });
                }
            }
        };
        match self.form {
            CompactForm::PerDye => {
                let amounts = maps.iter().map(|&k| f64::from(k)).enumerate();
                let present: Vec<(usize, f64)> = amounts.filter(|(_, k)| *k > 0.0).collect();
                let total = present.iter().map(|(_, k)| k).sum::<f64>();
                let shares: Vec<_> = present.iter().map(|&(dye, k)| (dye, k / total)).collect();
                together(total, &shares);
            }
            CompactForm::PerLobe => {
                for &[position, strength] in maps.as_chunks().0 {
                    let position = f64::from(position).rem_euclid(count as f64);
                    let first = (0..count).rev().find(|&dye| dye as f64 <= position).unwrap_or(0);
                    let weight = position - first as f64;
                    let shares = [(first, 1.0 - weight), ((first + 1) % count, weight)];
                    together(f64::from(strength), &shares);
                }
            }
        }
    }

    /// How much of each dye there is.
    fn dye_maps(&self, mixture: &Mixture<'_>) -> Result<Vec<f64>, CompactError> {
        let places = self.places(mixture);
        let pooled = self.mixing == Mixing::Pooled;
        if pooled && places.iter().any(|place| place.0 != places[0].0) {
            return Err(CompactError::Mixture);
        }
        let mut amounts = vec![0.0; self.dyes.len()];
        for ((first, weight), strength) in places {
            amounts[first] += strength * (1.0 - weight);
            amounts[(first + 1) % self.dyes.len()] += strength * weight;
        }
        Ok(amounts)
    }

    /// Position and strength of each material.
    fn lobe_maps(&self, mixture: &Mixture<'_>) -> Result<Vec<f64>, CompactError> {
        let places = self.places(mixture);
        if places.len() > LOBES {
            return Err(CompactError::Lobes { found: places.len() });
        }
        let pairs = places.iter().map(|&((first, weight), k)| [first as f64 + weight, k]);
        let mut maps: Vec<f64> = pairs.flatten().collect();
        maps.resize(2 * LOBES, 0.0);
        Ok(maps)
    }

    /// Dye, share of its neighbor, and strength of each fluorescent material.
    fn places(&self, mixture: &Mixture<'_>) -> Vec<((usize, f64), f64)> {
        let parts = mixture.parts();
        let fluorescent = parts.filter_map(|(part, material)| match material.fluorescence {
            Fluorescence::Dyes { first, weight, concentration } if part * concentration > 0.0 => {
                Some(((first, weight), part * concentration))
            }
            _ => None,
        });
        fluorescent.collect()
    }
}

/// A dye's name as a channel can have it: letters, digits, `-`, `_`, and `_` for all else.
fn channel_word(name: &str) -> String {
    /// Leaves room for `dye.` and keeps attribute names within the format's 255 bytes.
    const LONGEST: usize = 200;
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_');
    name.chars().take(LONGEST).map(|c| if plain(c) { c } else { '_' }).collect()
}

fn check_names(dyes: &[CompactDye]) -> Result<(), CompactError> {
    let twice = |i: usize| dyes[..i].iter().any(|dye| dye.name == dyes[i].name);
    match (0..dyes.len()).find(|&i| twice(i)) {
        Some(i) => Err(CompactError::Twice { name: dyes[i].name.clone() }),
        None => Ok(()),
    }
}

fn dye_attribute(dye: &str, what: &str) -> String {
    format!("upglow.dye.{dye}.{what}")
}

/// Attributes of a file that claims to be in compact form.
struct Stated<'a>(&'a Attributes);

impl<'a> Stated<'a> {
    fn text(&self, name: &str, expected: &str) -> Result<&'a str, CompactError> {
        let found = self.0.get(name);
        found.and_then(Attribute::as_text).ok_or_else(|| CompactError::Attribute {
            name: name.into(),
            found: found.map_or("absent".into(), |value| format!("a {}", value.kind())),
            expected: expected.into(),
        })
    }

    fn word(&self, name: &str, known: &[&str]) -> Result<&'a str, CompactError> {
        let expected = known.join(" or ");
        let word = self.text(name, &expected)?;
        if known.contains(&word) {
            return Ok(word);
        }
        Err(CompactError::Attribute { name: name.into(), found: format!("{word:?}"), expected })
    }

    fn number(&self, name: &str, most: f64) -> Result<f64, CompactError> {
        let expected = format!("a number from 0 to {most}");
        let text = self.text(name, &expected)?;
        let number = text.parse().ok().filter(|v: &f64| (0.0..=most).contains(v));
        number.ok_or_else(|| CompactError::Attribute {
            name: name.into(),
            found: format!("{text:?}"),
            expected,
        })
    }

    /// A dye, and the wavelengths of its curves.
    fn dye(&self, name: &str) -> Result<(Vec<f64>, CompactDye), CompactError> {
        /// Longer than any wavelength of light that a picture holds, nm.
        const LONGEST_NM: f64 = 1e6;
        let (nm, absorption) = self.curve(&dye_attribute(name, "absorption"))?;
        let emission_name = dye_attribute(name, "emission");
        let (other, emission) = self.curve(&emission_name)?;
        if nm != other {
            let (found, expected) = ("on others".into(), "the absorption's wavelengths".into());
            return Err(CompactError::Attribute { name: emission_name, found, expected });
        }
        let dye = CompactDye {
            name: name.into(),
            absorption,
            emission,
            quantum_yield: self.number(&dye_attribute(name, "quantumYield"), 1.0)?,
            mean_emission_nm: self.number(&dye_attribute(name, "meanEmission"), LONGEST_NM)?,
        };
        Ok((nm, dye))
    }

    fn curve(&self, name: &str) -> Result<(Vec<f64>, Vec<f64>), CompactError> {
        const EXPECTED: &str = "numbers from 0 to 1 as 400nm:0.5;410nm:0.6, wavelengths ascending";
        let text = self.text(name, EXPECTED)?;
        let curve = parse_spectrum(text);
        let curve = curve.filter(|(nm, values)| {
            nm.is_sorted_by(|a, b| a < b) && values.iter().all(|v| (0.0..=1.0).contains(v))
        });
        curve.ok_or_else(|| {
            /// A line that a person reads.
            const SHOWN: usize = 40;
            let found = format!("{:?}", text.chars().take(SHOWN).collect::<String>());
            CompactError::Attribute { name: name.into(), found, expected: EXPECTED.into() }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use upglow::{
        Cube, DyeOptions, DyeSet, FitRecord, Interpolation, Material, Model, Node, QuantumYield,
        Sigmoid,
    };
    use upglow_color::{Contract, LinearRgb};

    fn bands() -> Grid {
        Grid::try_new(380, 780, 10).unwrap()
    }

    fn models() -> Vec<DyeModel> {
        let mut models = Vec::new();
        for accounting in [Accounting::Energy, Accounting::Photon] {
            for mixing in [Mixing::Pooled, Mixing::Separate] {
                let quantum_yield = QuantumYield::Fixed(0.75);
                let options =
                    DyeOptions { accounting, mixing, quantum_yield, ..DyeOptions::default() };
                models.push(DyeModel::new(DyeSet::named("seed8").unwrap(), options).unwrap());
                let quantum_yield = QuantumYield::Measured;
                let options = DyeOptions { quantum_yield, ..options };
                models.push(DyeModel::new(DyeSet::named("open8").unwrap(), options).unwrap());
            }
        }
        models
    }

    fn material(u: [f64; 4]) -> Material {
        Material {
            reflectance: Sigmoid::flat(u[0]),
            fluorescence: Fluorescence::Dyes {
                first: (0..8).rev().find(|&i| i as f64 <= 8.0 * u[1]).unwrap_or(0),
                weight: u[2],
                concentration: u[3],
            },
        }
    }

    /// Single precision keeps seven digits; a share is at most 1, and two are multiplied and
    /// divided by a third.
    const SINGLE: f64 = 5e-7;

    fn check(layout: &CompactLayout, mixture: &Mixture<'_>) {
        let texel = layout.encode(mixture).unwrap();
        let expanded = layout.expand(&texel).unwrap();
        let direct = mixture.reradiation_matrix(bands());
        for (o, row) in direct.iter().enumerate() {
            for (i, share) in row.iter().enumerate() {
                let found = f64::from(expanded.shares[i][o]);
                assert!((found - share).abs() < SINGLE, "{i} {o}: {found} {share}");
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(8))]

        #[test]
        fn one_material_expands_exactly_in_both_forms(u in prop::array::uniform4(0.0..1.0)) {
            for dyes in models() {
                let layouts = [CompactForm::PerDye, CompactForm::PerLobe]
                    .map(|form| CompactLayout::new(&dyes, bands(), form).unwrap());
                let model = Model::Dyes(dyes);
                for layout in layouts {
                    check(&layout, &Mixture::of(&model, material(u)));
                }
            }
        }
    }

    /// A cube whose nodes differ, so that a look-up mixes four of them.
    fn cube(dyes: DyeModel) -> Cube {
        let node = |i: u16| {
            let u = f64::from(i) / 27.0;
            let Material { reflectance, fluorescence } = material([u, u, 1.0 - u, 0.5 + 0.5 * u]);
            let Fluorescence::Dyes { first, weight, concentration } = fluorescence else {
                panic!()
            };
            let Sigmoid { c0, c1, c2 } = reflectance;
            let _ = (c0, c1);
            Node {
                reflectance: [500.0, to_single(c2), 0.0],
                dye: first.try_into().unwrap(),
                fluorescence: [to_single(weight), to_single(concentration), 0.0],
                de2000: 0.0,
            }
        };
        let nodes = (0..27).map(node).collect();
        Cube::new(Contract::default(), Model::Dyes(dyes), FitRecord::default(), 3, nodes).unwrap()
    }

    #[test]
    fn mixtures_expand_exactly_as_lobes_and_where_dyes_are_separate() {
        for dyes in models() {
            let separate = dyes.options().mixing == Mixing::Separate;
            let layouts = [CompactForm::PerDye, CompactForm::PerLobe]
                .map(|form| CompactLayout::new(&dyes, bands(), form).unwrap());
            let cube = cube(dyes);
            let rgb = LinearRgb([0.3, 0.62, 0.41]);
            let mixture = cube.lookup(rgb, Interpolation::Blend).unwrap();
            assert_eq!(mixture.parts().count(), 4);
            check(&layouts[1], &mixture);
            if separate {
                check(&layouts[0], &mixture);
            } else {
                assert_eq!(layouts[0].encode(&mixture), Err(CompactError::Mixture));
            }
        }
    }

    #[test]
    fn the_form_survives_its_attributes_and_has_at_most_twelve_maps() {
        for dyes in models() {
            for form in [CompactForm::PerDye, CompactForm::PerLobe] {
                let layout = CompactLayout::new(&dyes, bands(), form).unwrap();
                let back = CompactLayout::from_attributes(&layout.attributes()).unwrap();
                assert_eq!(back, layout);
                assert!(layout.channel_names().len() <= 41 + MOST_EXTRA_CHANNELS);
            }
        }
    }

    #[test]
    fn attributes_that_lie_are_refused_by_name() {
        let layout = CompactLayout::new(&models()[0], bands(), CompactForm::PerDye).unwrap();
        let with = |name: &str, value: &str| {
            let mut attributes = layout.attributes();
            attributes.insert(name.into(), value.into());
            CompactLayout::from_attributes(&attributes).unwrap_err().to_string()
        };
        assert_eq!(
            with(FORM, "x"),
            "attribute upglow.compact.form is \"x\", expected dyes or lobes"
        );
        let dye = layout.dyes()[0].name.clone();
        let absorption = dye_attribute(&dye, "absorption");
        for broken in ["", "400nm", "400nm:2", "410nm:0;400nm:0", "400,0nm:0.5", "400nm:NaN"] {
            assert!(with(&absorption, broken).contains("expected numbers from 0 to 1"), "{broken}");
        }
        assert!(with(&absorption, "400nm:0.5;").contains("expected the absorption's wavelengths"));
        assert!(with(DYES, "").contains("absorption is absent"));
        assert!(with(&dye_attribute(&dye, "quantumYield"), "1.5").contains("from 0 to 1"));
        assert!(layout.expand(&[0.0]).is_err());
    }
}
