//! Ways to make a material of what is known of a sample.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use upglow::{
    Accounting, DyeModel, DyeOptions, DyeSet, FilmModel, Fluorescence, Material, Mixing, Mixture,
    Model, QuantumYield,
};
use upglow_color::{Choice, Contract, DonaldsonMatrix, Illuminant, Xyz};
use upglow_fit::{
    Fit, FitOptions, FitOptionsError, Fitter, GivenOptions, MatrixFit, MatrixFitError,
    MatrixFitOptions, MetamerError, MetamerSearch, Metamers, Method, OwnMaterial, PaintKind,
    Preset, fit_matrix,
};

use crate::lights::named;
use crate::samples::{Sample, SampleSet};

/// A way to make a material of what is known of a sample.
pub(crate) trait Way: Sync {
    /// What reports call it.
    fn name(&self) -> &str;

    /// The lights under which it knows the color of a sample. Under these it predicts nothing.
    fn told(&self) -> Vec<Illuminant> {
        vec![Illuminant::default()]
    }

    /// Whether it knows what it takes of the samples of a set; by default their colors, which all have.
    fn is_for(&self, _: &SampleSet) -> bool {
        true
    }

    /// The material of a sample.
    fn material(&self, sample: &Sample) -> Made<'_>;
}

/// A weighted mean of materials of one model.
#[derive(Clone, Debug)]
pub(crate) struct Made<'w> {
    model: Cow<'w, Model>,
    /// Weights, which add up to 1, and materials.
    parts: Vec<(f64, Material)>,
    /// What it was chosen from.
    metamers: Option<Metamers>,
}

impl<'w> Made<'w> {
    fn of(model: &'w Model, material: Material) -> Self {
        Self { model: Cow::Borrowed(model), parts: vec![(1.0, material)], metamers: None }
    }

    /// The ΔE00 from `color` under a light within which nine of ten materials are that it was chosen from.
    pub(crate) fn band(&self, light: &Illuminant, color: Xyz) -> Option<f64> {
        let metamers = self.metamers.as_ref()?;
        Some(metamers.band(&metamers.light(light), color, Metamers::USUAL_SHARE))
    }

    /// The mean as a matrix on the axes of `measured`.
    pub(crate) fn matrix_like(&self, measured: &DonaldsonMatrix) -> DonaldsonMatrix {
        let mixture = Mixture::of_parts(&self.model, &self.parts);
        mixture.expect("one to four materials").matrix_like(measured)
    }

    /// Whether a dye is in it.
    pub(crate) fn is_dyed(&self) -> bool {
        self.parts.iter().any(|(_, material)| material.fluorescence != Fluorescence::None)
    }
}

/// A fit of the color under D65, each by itself.
#[derive(Debug)]
pub(crate) struct OneColor {
    name: String,
    fitter: Fitter,
}

impl OneColor {
    /// Fits under a contract whose light is D65.
    ///
    /// # Errors
    ///
    /// [`FitOptionsError`] if an option is out of range.
    pub(crate) fn try_new(
        name: impl Into<String>,
        contract: &Contract,
        model: &Model,
        options: FitOptions,
    ) -> Result<Self, FitOptionsError> {
        Ok(Self { name: name.into(), fitter: Fitter::new(contract, model, options)? })
    }

    /// The fit of a preset.
    pub(crate) fn preset(preset: Preset, contract: &Contract) -> Self {
        Self::try_new(preset.to_string(), contract, &preset.model(), preset.options())
            .expect("a preset is in range")
    }

    /// The fit of a color under the contract's light: of the nearest RGB that can be asked for.
    pub(crate) fn fit(&self, color: Xyz) -> Fit {
        let mut rgb = self.fitter.model().colorimetry().rgb_from_xyz(color);
        rgb.0 = rgb.0.map(|value| value.clamp(0.0, Fitter::BRIGHTEST));
        self.fitter.fit(rgb).expect("the color is in range")
    }
}

impl Way for OneColor {
    fn name(&self) -> &str {
        &self.name
    }

    fn material(&self, sample: &Sample) -> Made<'_> {
        let model = self.fitter.model();
        let color = sample.color(&Illuminant::default(), model.colorimetry().white());
        Made::of(model.model(), self.fit(color).material())
    }
}

/// Slope limits beside those of the preset `natural`: of a reflectance alone and under dyes, 1/nm.
const OTHER_LIMITS_PER_NM: [[f64; 2]; 5] =
    [[0.065, 0.01], [0.065, 0.03], [0.05, 0.02], [0.02, 0.02], [0.01, 0.01]];

/// Every preset, then `natural` with other limits.
pub(crate) fn presets_and_limits(contract: &Contract) -> Vec<OneColor> {
    let presets = Preset::ALL.iter().map(|preset| OneColor::preset(*preset, contract));
    let limited = |[alone, under_dyes]: [f64; 2]| {
        let given = GivenOptions {
            slope_max_per_nm: Some(Some(alone)),
            slope_under_dyes_per_nm: Some(Some(under_dyes)),
            ..GivenOptions::default()
        };
        let (model, options) = (Preset::Natural.model(), Preset::Natural.options().with(given));
        let name = format!("{}, {alone} and {under_dyes}/nm", Preset::Natural);
        OneColor::try_new(name, contract, &model, options).expect("the limits are in range")
    };
    presets.chain(OTHER_LIMITS_PER_NM.map(limited)).collect()
}

/// Every way that is told colors.
pub(crate) fn ways() -> Vec<Box<dyn Way>> {
    fits().into_iter().chain(among_metamers()).collect()
}

/// Fits of the color under D65.
pub(crate) fn fits() -> Vec<Box<dyn Way>> {
    let fits = presets_and_limits(&Contract::default()).into_iter().chain(options());
    fits.map(|way| Box::new(way) as Box<dyn Way>).collect()
}

/// Two presets with other dyes and rules of fluorescence, and by the method of the paper.
fn options() -> Vec<OneColor> {
    let contract = Contract::default();
    let mut ways = Vec::new();
    let mut add = |preset: Preset, with: &str, model: Model, options: FitOptions| {
        let way = OneColor::try_new(format!("{preset}, {with}"), &contract, &model, options);
        ways.push(way.expect("the options are in range"));
    };
    let set = |name| DyeSet::named(name).expect("the set is built in");
    let (photon, energy) = (Accounting::Photon, Accounting::Energy);
    let (all, half) = (QuantumYield::Fixed(1.0), QuantumYield::Fixed(0.5));
    for (with, dyes, accounting, quantum_yield) in [
        ("konig8", "konig8", photon, all),
        ("wide14", "wide14", photon, all),
        ("energy", "wide8", energy, all),
        ("yield 0.5", "wide8", photon, half),
        ("measured yields", "wide8", photon, QuantumYield::Measured),
    ] {
        let film = FilmModel::new(set(dyes), accounting, quantum_yield);
        let model = Model::Film(film.expect("the yield is in range"));
        add(Preset::Natural, with, model, Preset::Natural.options());
    }
    let usual = DyeOptions::default();
    for (with, options) in [
        ("photon", DyeOptions { accounting: photon, ..usual }),
        ("separate", DyeOptions { mixing: Mixing::Separate, ..usual }),
        ("measured yields", DyeOptions { quantum_yield: QuantumYield::Measured, ..usual }),
        ("optical density 2", DyeOptions { optical_density: Some(2.0), ..usual }),
    ] {
        let dyes = DyeModel::new(set("konig8"), options).expect("the density is in range");
        add(Preset::Konig2020, with, Model::Dyes(dyes), Preset::Konig2020.options());
    }
    let method = FitOptions { method: Method::Konig2020, ..Preset::Konig2020.options() };
    add(Preset::Konig2020, "method of the paper", Preset::Konig2020.model(), method);
    ways
}

/// An answer among all materials that may have the known colors.
#[derive(Debug)]
pub(crate) struct AmongMetamers {
    name: String,
    search: MetamerSearch,
    /// What was found for samples, by their names: both answers are chosen from it.
    found: Arc<Mutex<HashMap<String, Metamers>>>,
    /// Lights under which colors are known, and the whites that they are relative to.
    told: Vec<(Illuminant, Xyz)>,
    answer: Answer,
}

/// A single material or a mixture.
type Answer = fn(&Metamers) -> Result<OwnMaterial, MetamerError>;

/// Paints of every kind by their colors under D65, and fluorescent paints by colors under other lights too: a photo
/// without ultraviolet, or an ultraviolet lamp and incandescent light.
fn among_metamers() -> Vec<Box<dyn Way>> {
    const IN_RANGE: &str = "the lights are visible, and there are at most two";
    let contract = Contract::default();
    let [cut, a] = ["D65-cut400", "A"].map(named);
    let others = [vec![cut], vec![Illuminant::mineral_lamp(), a]];
    let others = others.map(|others| (PaintKind::Fluorescent, others));
    let alone = PaintKind::ALL.iter().map(|kind| (*kind, Vec::new()));
    let search = |(kind, others): (PaintKind, Vec<Illuminant>)| {
        let search = MetamerSearch::new(&contract, &others, kind).expect(IN_RANGE);
        let found: Arc<Mutex<HashMap<_, _>>> = Arc::default();
        let also: String = others.iter().map(|light| format!(" + {}", light.name())).collect();
        let white = |light: &Illuminant| search.light(light).white();
        let lights = std::iter::once(&contract.illuminant).chain(&others);
        let told: Vec<_> = lights.map(|light| (light.clone(), white(light))).collect();
        let way = |(word, answer): (&str, Answer)| {
            let name = format!("{kind}, {word}{also}");
            let (search, found, told) = (search.clone(), found.clone(), told.clone());
            Box::new(AmongMetamers { name, search, found, told, answer }) as Box<dyn Way>
        };
        let answers: [(&str, Answer); 2] =
            [("single", |found| found.single()), ("mixture", |found| found.mixture())];
        answers.map(way)
    };
    alone.chain(others).flat_map(search).collect()
}

impl Way for AmongMetamers {
    fn name(&self) -> &str {
        &self.name
    }

    fn told(&self) -> Vec<Illuminant> {
        self.told.iter().map(|(light, _)| light.clone()).collect()
    }

    fn material(&self, sample: &Sample) -> Made<'_> {
        let possible = |v: f64| v.clamp(-Fitter::BRIGHTEST, Fitter::BRIGHTEST);
        let color =
            |(light, white): &(Illuminant, Xyz)| Xyz(sample.color(light, *white).0.map(possible));
        let colors: Vec<Xyz> = self.told.iter().map(color).collect();
        let all = || self.found.lock().expect("nothing panics while it is locked");
        let known = all().get(&sample.name).cloned();
        let metamers = known.unwrap_or_else(|| {
            let found = self.search.of(&colors).expect("a color in range for each light");
            all().insert(sample.name.clone(), found.clone());
            found
        });
        let answer = (self.answer)(&metamers).expect("built-in dyes make a set");
        Made {
            model: Cow::Owned(answer.model().clone()),
            parts: answer.parts().to_vec(),
            metamers: Some(metamers),
        }
    }
}

/// What comes nearest to samples whose matrices are known as a whole.
#[derive(Clone, Debug)]
pub(crate) struct WholeMatrix(Vec<(String, MatrixFit)>);

impl WholeMatrix {
    /// The fits of these samples; later asked for by their names.
    ///
    /// # Errors
    ///
    /// The name of the sample that has no material, and why.
    pub(crate) fn of(samples: &[Sample]) -> Result<Self, (String, MatrixFitError)> {
        let fit = |sample: &Sample| {
            let name = || sample.name.clone();
            let fit = fit_matrix(sample.matrix(), &MatrixFitOptions::default());
            fit.map(|fit| (name(), fit)).map_err(|error| (name(), error))
        };
        samples.iter().map(fit).collect::<Result<_, _>>().map(Self)
    }
}

impl Way for WholeMatrix {
    fn name(&self) -> &'static str {
        "told the whole matrix"
    }

    fn is_for(&self, set: &SampleSet) -> bool {
        set.samples.iter().all(|sample| self.0.iter().any(|(name, _)| *name == sample.name))
    }

    fn material(&self, sample: &Sample) -> Made<'_> {
        let found = self.0.iter().find(|(name, _)| *name == sample.name);
        let (_, fit) = found.expect("it was made for this sample");
        Made::of(fit.model(), fit.material())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::relight::{LitSet, Relit};
    use upglow::Sigmoid;

    /// Half of a dark and half of a light gray, whatever the sample; told its colors under two lights.
    struct TwoGrays;

    impl Way for TwoGrays {
        fn name(&self) -> &'static str {
            "two grays"
        }

        fn told(&self) -> Vec<Illuminant> {
            ["D65", "A"].map(|name| Illuminant::named(name).unwrap()).to_vec()
        }

        fn material(&self, _: &Sample) -> Made<'_> {
            let half = |share| (0.5, Material::passive(Sigmoid::flat(share)));
            let (model, parts) = (Cow::Owned(Model::Reflectance), vec![half(0.2), half(0.6)]);
            Made { model, parts, metamers: None }
        }
    }

    #[test]
    fn a_mean_of_grays_is_a_gray_and_a_light_that_was_told_is_in_no_mean() {
        let mut set = SampleSet::paints();
        // Rounding of sums, in ΔE00.
        const ROUNDING: f64 = 1e-9;
        let lights = ["A", "E", "FL2"].map(|name| Illuminant::named(name).unwrap());
        let of = |set: &SampleSet| Relit::of(&LitSet::new(set, &lights), &TwoGrays);
        let found = of(&set);
        assert_eq!((&found.told[..], found.dyed), (&[true, false, false][..], 0));
        let [e, fl2] = [1, 2].map(|light| found.under(light));
        for (sample, mean) in found.means(0..3).into_iter().enumerate() {
            assert!((mean - (e[sample] + fl2[sample]) / 2.0).abs() < ROUNDING);
        }
        let gray = set.samples[0].matrix().with_factors(|o, i| if i == o + 16 { 0.4 } else { 0.0 });
        set.samples = vec![Sample::try_new("gray".into(), gray).unwrap()];
        assert!(of(&set).under(2)[0] < ROUNDING);
    }
}
