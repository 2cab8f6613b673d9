//! The compact bispectral form: one reflectance per band, one map per dye, and the curves as attributes.
//!
//! `docs/spectral-exr.md` specifies it for other programs.

mod dye;

use upglow::{Accounting, Bispectral, DyeModel, DyeSet, FilmModel, Fluorescence, Mixing, Mixture};
use upglow_color::rounding::to_single;
use upglow_color::{Grid, choices};

use self::dye::{CompactDye, curve};
use super::channel::SpectralChannel;
use super::error::FormError;
use super::stated::{choice, stated};
use crate::exr::attribute::Attributes;

/// The meaning of the maps beside the reflectances.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CompactForm {
    /// One map per dye: its amount, in a film its optical density. Exact for single materials, and for
    /// mixtures of separate dyes; the maps of separate dyes may also be filtered.
    PerDye,
    /// Four pairs of maps: the position of a material on the ring of dyes, and its strength.
    /// Exact for every mixture of a look-up; needs float samples and must not be filtered.
    PerLobe,
}

choices!(CompactForm, "compact form", PerDye = "dyes", PerLobe = "lobes");

/// How the dyes of a texel act together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CompactMixing {
    /// As [`Mixing::Pooled`].
    Pooled,
    /// As [`Mixing::Separate`].
    Separate,
    /// As in a [`FilmModel`].
    Film,
}

choices!(CompactMixing, "mixing", Pooled = "pooled", Separate = "separate", Film = "film");

impl From<Mixing> for CompactMixing {
    fn from(mixing: Mixing) -> Self {
        match mixing {
            Mixing::Pooled => Self::Pooled,
            Mixing::Separate => Self::Separate,
        }
    }
}

/// Most channels beside the reflectances.
pub(crate) const MOST_EXTRA_CHANNELS: usize = 12;
/// Materials in a mixture.
const LOBES: usize = 4;

/// The bands, dyes and rules of a file in compact form.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CompactLayout {
    wavelengths_nm: Vec<f64>,
    dyes: Vec<CompactDye>,
    accounting: Accounting,
    mixing: CompactMixing,
    form: CompactForm,
}

/// Dyes that act together: the strength of the lobe, and the share of each dye in it.
struct Lobe {
    strength: f64,
    shares: Vec<(usize, f64)>,
}

impl Lobe {
    /// The mean of a property of the dyes.
    fn mean(&self, dyes: &[CompactDye], of: impl Fn(&CompactDye) -> f64) -> f64 {
        self.shares.iter().map(|&(dye, share)| share * of(&dyes[dye])).sum()
    }
}

const VERSION: &str = "upglow.compact";
const VERSION_VALUE: &str = "1";
const FORM: &str = "upglow.compact.form";
const MIXING: &str = "upglow.compact.mixing";
const ACCOUNTING: &str = "upglow.compact.accounting";
const DYES: &str = "upglow.compact.dyes";

impl CompactLayout {
    /// The layout for materials of `model` on the bands around the wavelengths of `grid`.
    ///
    /// # Errors
    ///
    /// [`FormError`] if the ring has more dyes than the form has maps, or two dyes have the same name.
    pub(crate) fn new(model: &DyeModel, grid: Grid, form: CompactForm) -> Result<Self, FormError> {
        Self::of_dyes(model, model.options().mixing.into(), grid, form)
    }

    /// The layout for single materials of a film.
    ///
    /// # Errors
    ///
    /// [`FormError`] if the film has more dyes than the form has maps, or two dyes have the same name.
    pub(crate) fn in_film(model: &FilmModel, grid: Grid) -> Result<Self, FormError> {
        Self::of_dyes(model.dyes(), CompactMixing::Film, grid, CompactForm::PerDye)
    }

    fn of_dyes(
        model: &DyeModel,
        mixing: CompactMixing,
        grid: Grid,
        form: CompactForm,
    ) -> Result<Self, FormError> {
        let half = f64::from(grid.step_nm()) / 2.0;
        let wavelengths_nm: Vec<f64> = grid.wavelengths_nm().collect();
        let named = model.set().dyes().iter().zip(model.curves());
        let dyes = named
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
        let accounting = model.options().accounting;
        let layout = Self { wavelengths_nm, dyes, accounting, mixing, form };
        layout.check()?;
        Ok(layout)
    }

    /// The meaning of the maps.
    pub(crate) fn form(&self) -> CompactForm {
        self.form
    }

    /// The channels of a texel, in the order of its values: the reflectances, then the maps.
    pub(crate) fn channel_names(&self) -> Vec<String> {
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

    /// The attributes of the form, without those of the spectral layout.
    pub(crate) fn attributes(&self) -> Attributes {
        let names: Vec<&str> = self.dyes.iter().map(|d| d.name.as_str()).collect();
        let mut attributes = Attributes::from([
            (VERSION.into(), VERSION_VALUE.into()),
            (FORM.into(), self.form.to_string().into()),
            (MIXING.into(), self.mixing.to_string().into()),
            (ACCOUNTING.into(), self.accounting.to_string().into()),
            (DYES.into(), names.join(";").into()),
        ]);
        attributes.extend(self.dyes.iter().flat_map(|dye| dye.attributes(&self.wavelengths_nm)));
        attributes
    }

    /// Whether a file with these attributes is in compact form.
    pub(crate) fn is_stated(attributes: &Attributes) -> bool {
        attributes.contains_key(VERSION)
    }

    /// Reads the layout of a file.
    ///
    /// # Errors
    ///
    /// [`FormError::Attribute`] names an attribute that is absent or invalid.
    pub(crate) fn from_attributes(attributes: &Attributes) -> Result<Self, FormError> {
        let is_version = |text: &str| (text == VERSION_VALUE).then_some(());
        stated(attributes, VERSION, VERSION_VALUE, is_version)?;
        let (form, mixing) = (choice(attributes, FORM)?, choice(attributes, MIXING)?);
        let accounting = choice(attributes, ACCOUNTING)?;
        let split = |text: &str| {
            let names: Vec<String> =
                text.split(';').take(DyeSet::MOST + 1).map(str::to_owned).collect();
            (names.len() <= DyeSet::MOST).then_some(names)
        };
        let expected = format!("1 to {} names separated by semicolons", DyeSet::MOST);
        let names = stated(attributes, DYES, &expected, split)?;
        let (wavelengths_nm, _) = curve(attributes, &names[0], "absorption", None)?;
        let dyes = names.iter().map(|name| CompactDye::stated(attributes, name, &wavelengths_nm));
        let dyes = dyes.collect::<Result<_, _>>()?;
        let layout = Self { wavelengths_nm, dyes, accounting, mixing, form };
        layout.check()?;
        Ok(layout)
    }

    /// Checks that each dye has a map and a unique name, and that a film has the form for it.
    fn check(&self) -> Result<(), FormError> {
        let count = self.dyes.len();
        if self.form == CompactForm::PerDye && count > MOST_EXTRA_CHANNELS {
            let found = format!("{count} dyes");
            let other = match self.mixing {
                CompactMixing::Film => "the spectral form that is not compact",
                CompactMixing::Pooled | CompactMixing::Separate => "the form of lobes",
            };
            let expected = format!("1 to {MOST_EXTRA_CHANNELS} with a map each, or {other}");
            return Err(FormError::Dyes { found, expected });
        }
        if self.form == CompactForm::PerLobe && self.mixing == CompactMixing::Film {
            let (name, found) = (MIXING.into(), format!("{:?}", self.mixing.to_string()));
            let expected = "pooled or separate in the form of lobes".into();
            return Err(FormError::Attribute { name, found, expected });
        }
        let mut names = self.dyes.iter().map(|dye| &dye.name).enumerate();
        let twin = names.find(|(i, name)| self.dyes[..*i].iter().any(|dye| dye.name == **name));
        twin.map_or(Ok(()), |(_, name)| {
            let found = format!("two dyes are named {name:?} in channels");
            Err(FormError::Dyes { found, expected: "different names".into() })
        })
    }

    /// The values of a texel with this mixture, in the order of [`CompactLayout::channel_names`].
    ///
    /// The reflectance of a band is the diagonal of the re-radiation matrix: the reflected light, and
    /// the light that is re-emitted within the band. `None` if the form cannot hold the mixture exactly:
    /// maps of dyes cannot hold materials of different pooled dyes, or more than one film, and lobes hold
    /// at most four materials.
    pub(crate) fn encode(&self, mixture: &Mixture<'_>) -> Option<Vec<f32>> {
        let mut values = vec![0.0; self.wavelengths_nm.len()];
        mixture.reflectances(&self.wavelengths_nm, &mut values);
        if !mixture.is_fluorescent() {
            values.resize(values.len() + self.map_count(), 0.0);
            return Some(values.into_iter().map(to_single).collect());
        }
        let maps = match self.form {
            CompactForm::PerDye => self.dye_maps(mixture)?,
            CompactForm::PerLobe => lobe_maps(mixture)?,
        };
        let maps: Vec<f32> = maps.into_iter().map(to_single).collect();
        let lobes = self.lobes(&maps);
        values.iter_mut().enumerate().for_each(|(i, value)| *value += self.moved(&lobes, i, i));
        Some(values.into_iter().map(to_single).chain(maps).collect())
    }

    /// Number of maps beside the reflectances.
    fn map_count(&self) -> usize {
        match self.form {
            CompactForm::PerDye => self.dyes.len(),
            CompactForm::PerLobe => 2 * LOBES,
        }
    }

    /// The re-radiation matrix of a texel, `[outgoing][incident]`, with the reflectance on the diagonal.
    /// `None` unless there is one value per channel.
    pub(crate) fn expand(&self, texel: &[f32]) -> Option<Vec<Vec<f32>>> {
        let bands = self.wavelengths_nm.len();
        if texel.len() != bands + self.map_count() {
            return None;
        }
        let (reflectances, maps) = texel.split_at(bands);
        let lobes = self.lobes(maps);
        let share = |outgoing: usize, incident: usize| match incident == outgoing {
            true => reflectances[incident],
            false => to_single(self.moved(&lobes, incident, outgoing)),
        };
        Some((0..bands).map(|o| (0..bands).map(|i| share(o, i)).collect()).collect())
    }

    /// Centers of the bands, ascending, nm.
    pub(crate) fn wavelengths_nm(&self) -> &[f64] {
        &self.wavelengths_nm
    }

    /// Share of the power in the incident band that is re-emitted in the outgoing band.
    fn moved(&self, lobes: &[Lobe], incident: usize, outgoing: usize) -> f64 {
        let density =
            |lobe: &Lobe| lobe.strength * lobe.mean(&self.dyes, |dye| dye.absorption[incident]);
        let absorbed_per_density = match self.mixing {
            CompactMixing::Pooled | CompactMixing::Separate => 1.0,
            CompactMixing::Film => FilmModel::absorbed_per_density(lobes.iter().map(density).sum()),
        };
        lobes.iter().fold(0.0, |sum, lobe| {
            let mean = |of: &dyn Fn(&CompactDye) -> f64| lobe.mean(&self.dyes, of);
            let absorbed = density(lobe) * absorbed_per_density;
            let mean_emission_nm = mean(&|dye| dye.mean_emission_nm);
            let returned = self.accounting.share(self.wavelengths_nm[incident], mean_emission_nm);
            let quantum_yield = mean(&|dye| dye.quantum_yield);
            sum + absorbed * quantum_yield * returned * mean(&|dye| dye.emission[outgoing])
        })
    }

    /// The lobes of a texel with these maps.
    fn lobes(&self, maps: &[f32]) -> Vec<Lobe> {
        let count = self.dyes.len();
        let of_position = |&[position, strength]: &[f32; 2]| {
            let position = f64::from(position).rem_euclid(count as f64);
            let first = (0..count).rev().find(|&dye| dye as f64 <= position).unwrap_or(0);
            let weight = position - first as f64;
            let shares = vec![(first, 1.0 - weight), ((first + 1) % count, weight)];
            Lobe { strength: f64::from(strength), shares }
        };
        let mut lobes: Vec<Lobe> = match self.form {
            CompactForm::PerLobe => maps.as_chunks().0.iter().map(of_position).collect(),
            CompactForm::PerDye => {
                let amounts = maps.iter().map(|&k| f64::from(k)).enumerate();
                let present: Vec<(usize, f64)> = amounts.filter(|(_, k)| *k > 0.0).collect();
                let strength = present.iter().map(|(_, k)| k).sum::<f64>();
                let shares = present.into_iter().map(|(dye, k)| (dye, k / strength)).collect();
                vec![Lobe { strength, shares }]
            }
        };
        lobes.retain(|lobe| lobe.strength > 0.0 && lobe.strength.is_finite());
        if self.mixing == CompactMixing::Pooled {
            return lobes;
        }
        let dyes =
            lobes.iter().flat_map(|lobe| lobe.shares.iter().map(|dye| (lobe.strength, *dye)));
        let alone = |(strength, (dye, share))| Lobe {
            strength: strength * share,
            shares: vec![(dye, 1.0)],
        };
        dyes.map(alone).collect()
    }

    /// The amount of each dye.
    fn dye_maps(&self, mixture: &Mixture<'_>) -> Option<Vec<f64>> {
        if self.mixing == CompactMixing::Film {
            return self.density_maps(mixture);
        }
        let parts = fluorescent_parts(mixture);
        let pooled = self.mixing == CompactMixing::Pooled;
        if pooled && parts.iter().any(|part| part.0 != parts[0].0) {
            return None;
        }
        let mut amounts = vec![0.0; self.dyes.len()];
        for (first, weight, strength) in parts {
            amounts[first] += strength * (1.0 - weight);
            amounts[(first + 1) % self.dyes.len()] += strength * weight;
        }
        Some(amounts)
    }

    /// The optical density of each dye, if all of the mixture is one film or nothing fluoresces.
    fn density_maps(&self, mixture: &Mixture<'_>) -> Option<Vec<f64>> {
        let mut amounts = vec![0.0; self.dyes.len()];
        let count = mixture.parts().count();
        for (_, material) in mixture.parts() {
            if let Fluorescence::Film { dyes, densities } = material.fluorescence {
                if count > 1 {
                    return None;
                }
                dyes.into_iter().zip(densities).for_each(|(dye, density)| amounts[dye] += density);
            }
        }
        Some(amounts)
    }
}

/// Position and strength of each material.
fn lobe_maps(mixture: &Mixture<'_>) -> Option<Vec<f64>> {
    let parts = fluorescent_parts(mixture);
    let pairs = parts.iter().map(|(first, weight, strength)| [*first as f64 + weight, *strength]);
    let mut maps: Vec<f64> = pairs.flatten().collect();
    (parts.len() <= LOBES).then(|| {
        maps.resize(2 * LOBES, 0.0);
        maps
    })
}

/// The fluorescent materials of a mixture: the first dye, the share of its neighbor, and the
/// concentration times the material's share of the mixture.
fn fluorescent_parts(mixture: &Mixture<'_>) -> Vec<(usize, f64, f64)> {
    let parts = mixture.parts();
    let fluorescent = parts.filter_map(|(part, material)| match material.fluorescence {
        Fluorescence::Dyes { first, weight, concentration } if part * concentration > 0.0 => {
            Some((first, weight, part * concentration))
        }
        _ => None,
    });
    fluorescent.collect()
}

/// The name of a dye in channel names: characters other than letters, digits, `-` and `_` become `_`.
fn channel_word(name: &str) -> String {
    /// Leaves room for `dye.` and keeps attribute names within the format's 255 bytes.
    const LONGEST: usize = 200;
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_');
    name.chars().take(LONGEST).map(|c| if plain(c) { c } else { '_' }).collect()
}

#[cfg(test)]
mod tests {
    use super::dye::dye_attribute;
    use super::*;
    use crate::exr::attribute::Attribute;
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
                models.push(DyeModel::new(DyeSet::named("konig8").unwrap(), options).unwrap());
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
                let found = f64::from(expanded[o][i]);
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

    fn films() -> Vec<FilmModel> {
        let kinds = [
            (Accounting::Energy, QuantumYield::Fixed(1.0)),
            (Accounting::Photon, QuantumYield::Measured),
        ];
        let set = || DyeSet::named("open8").unwrap();
        kinds.map(|(accounting, q)| FilmModel::new(set(), accounting, q).unwrap()).into()
    }

    #[test]
    fn a_film_expands_exactly_and_a_mixture_of_films_is_refused() {
        for film in films() {
            let layout = CompactLayout::in_film(&film, bands()).unwrap();
            let back = CompactLayout::from_attributes(&layout.attributes()).unwrap();
            assert_eq!(back, layout);
            let model = Model::Film(film);
            let reflectance = Sigmoid::flat(0.7);
            let none = Fluorescence::None;
            for (fluorescence, dyes) in [
                (none, 0),
                (Fluorescence::film((3, 1.7), (3, 0.0)), 1),
                (Fluorescence::film((6, 0.4), (1, 5.9)), 2),
                (Fluorescence::film((2, 1e-5), (3, 1e-6)), 2),
            ] {
                let mixture = Mixture::of(&model, Material { reflectance, fluorescence });
                check(&layout, &mixture);
                let maps = layout.encode(&mixture).unwrap().split_off(bands().len());
                assert_eq!(maps.iter().filter(|v| **v > 0.0).count(), dyes);
            }
        }
        let film = films().remove(0);
        let layout = CompactLayout::in_film(&film, bands()).unwrap();
        let edge = Sigmoid::flat(0.5).to_edge(550.0);
        let node = Node::new(edge, Fluorescence::film((3, 1.7), (5, 0.2)), 0.0);
        let (contract, fit) = (Contract::default(), FitRecord::default());
        let cube = Cube::new(contract, Model::Film(film), fit, 2, vec![node; 8]).unwrap();
        let mixture = cube.lookup(LinearRgb([0.3, 0.62, 0.41]), Interpolation::Blend).unwrap();
        assert_eq!(layout.encode(&mixture), None);
    }

    #[test]
    fn films_of_many_dyes_and_lobes_of_films_are_refused() {
        let set = DyeSet::named("wide14").unwrap();
        let film = FilmModel::new(set, Accounting::Photon, QuantumYield::Measured).unwrap();
        assert_eq!(
            CompactLayout::in_film(&film, bands()).unwrap_err().to_string(),
            "14 dyes, expected 1 to 12 with a map each, or the spectral form that is not compact"
        );
        let layout = CompactLayout::in_film(&films()[0], bands()).unwrap();
        let mut attributes = layout.attributes();
        attributes.insert(FORM.into(), "lobes".into());
        assert_eq!(
            CompactLayout::from_attributes(&attributes).unwrap_err().to_string(),
            "attribute upglow.compact.mixing is \"film\", expected pooled or separate in the form of \
             lobes"
        );
    }

    /// A cube whose nodes differ, so that a look-up blends four of them.
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
                dyes: [first.try_into().unwrap(), 0],
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
                assert_eq!(layouts[0].encode(&mixture), None);
            }
        }
    }

    #[test]
    fn the_layout_is_read_back_from_its_attributes_and_has_at_most_twelve_maps() {
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
    fn invalid_attributes_are_refused_by_name() {
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
        let mut attributes = layout.attributes();
        attributes.insert(FORM.into(), Attribute::new("st\u{1b}[2Jng", Vec::new()));
        assert_eq!(
            CompactLayout::from_attributes(&attributes).unwrap_err().to_string(),
            "attribute upglow.compact.form is a st\\u{1b}[2Jng, expected dyes or lobes"
        );
        let dye = layout.dyes[0].name.clone();
        let absorption = dye_attribute(&dye, "absorption");
        for broken in ["", "400nm", "400nm:2", "410nm:0;400nm:0", "400,0nm:0.5", "400nm:NaN"] {
            assert!(with(&absorption, broken).contains("expected numbers from 0 to 1"), "{broken}");
        }
        assert!(with(&absorption, "400nm:0.5;").contains("the same in all curves"));
        assert!(with(DYES, "").contains("absorption is absent"));
        assert!(with(&dye_attribute(&dye, "quantumYield"), "1.5").contains("from 0 to 1"));
        assert_eq!(layout.expand(&[0.0]), None);
    }
}
