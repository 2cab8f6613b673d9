//! A material as curves, for the charts of the page.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use upglow::{Bispectral, Fluorescence, Material, Mixture, Model, Sigmoid};
use upglow_color::rounding::to_single;
use upglow_color::{Grid, Observer};

/// What charts show of a material: arrays over [`Grid::FINE`], but for `moved`. `page/js/cube.js` makes the
/// same for materials of a cube, by the functions that are exported for shaders.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Sampled {
    pub(crate) label: String,
    /// Share of light reflected without a change of wavelength, 0..=1.
    pub(crate) reflectance: Vec<f32>,
    /// That of the material without its dyes.
    pub(crate) base: Vec<f32>,
    /// Share of light that the dyes let through.
    pub(crate) passed: Vec<f32>,
    pub(crate) dyes: Vec<SampledDye>,
    /// Re-radiation, 1/nm, over [`Grid::FIT`] twice, `[incident][outgoing]`, as base64 of little-endian
    /// floats; `None` without fluorescence.
    pub(crate) moved: Option<String>,
    /// XYZ that an observer sees of what is moved from each wavelength, nm⁻¹; `None` without fluorescence.
    pub(crate) response: Option<Vec<f32>>,
    pub(crate) fluoresces: bool,
}

/// What one dye does in a material.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct SampledDye {
    pub(crate) name: String,
    pub(crate) dose: f32,
    /// The dose with its meaning.
    #[serde(rename = "doseText")]
    pub(crate) dose_text: String,
    /// Share of light that the dye would absorb alone.
    pub(crate) absorbed: Vec<f32>,
    /// Emission of unit area, 1/nm.
    pub(crate) emission: Vec<f32>,
}

impl Sampled {
    pub(crate) fn of(mixture: &Mixture<'_>, observer: &Observer, label: &str) -> Self {
        let model = mixture.model();
        let moved = mixture
            .is_fluorescent()
            .then_some(|in_nm, out_nm| mixture.reradiation_per_nm(in_nm, out_nm));
        let sampled = Self::of_curves(|nm| mixture.reflectance(nm), moved, observer, label);
        let parts: Vec<(f64, Material)> = mixture.parts().collect();
        let mean = |of: &dyn Fn(Material) -> Material| {
            let with = |(w, part): &(f64, Material)| (*w, Mixture::of(model, of(*part)));
            let parts: Vec<_> = parts.iter().map(with).collect();
            fine(|nm| parts.iter().map(|(w, part)| w * part.reflectance(nm)).sum())
        };
        Self {
            base: mean(&|part| Material::passive(part.reflectance)),
            passed: mean(&|part| white_with(part.fluorescence)),
            dyes: dyes(&parts, model),
            ..sampled
        }
    }

    /// A material whose dyes are not known: reflectance by wavelength, and re-radiation per nm by incident
    /// and outgoing wavelength.
    pub(crate) fn of_curves(
        reflectance: impl Fn(f64) -> f64,
        reradiation_per_nm: Option<impl Fn(f64, f64) -> f64>,
        observer: &Observer,
        label: &str,
    ) -> Self {
        let reflectance = fine(reflectance);
        let moved = reradiation_per_nm.as_ref();
        Self {
            label: label.into(),
            base: reflectance.clone(),
            passed: vec![1.0; reflectance.len()],
            reflectance,
            dyes: Vec::new(),
            response: moved.map(|moved| response(observer, moved)),
            fluoresces: moved.is_some(),
            moved: moved.map(matrix_in_base64),
        }
    }
}

fn fine(value: impl Fn(f64) -> f64) -> Vec<f32> {
    Grid::FINE.wavelengths_nm().map(value).map(to_single).collect()
}

/// Re-radiation over [`Grid::FIT`] twice, `[incident][outgoing]`, as base64 of little-endian floats.
fn matrix_in_base64(reradiation_per_nm: impl Fn(f64, f64) -> f64) -> String {
    let mut bytes = Vec::with_capacity(Grid::FIT.len().pow(2) * size_of::<f32>());
    for in_nm in Grid::FIT.wavelengths_nm() {
        for out_nm in Grid::FIT.wavelengths_nm() {
            bytes.extend(to_single(reradiation_per_nm(in_nm, out_nm)).to_le_bytes());
        }
    }
    STANDARD.encode(bytes)
}

fn white_with(fluorescence: Fluorescence) -> Material {
    Material { reflectance: Sigmoid::flat(1.0), fluorescence }
}

/// XYZ of what is moved from each wavelength of [`Grid::FINE`], by sums over [`Grid::FIT`].
fn response(observer: &Observer, reradiation_per_nm: impl Fn(f64, f64) -> f64) -> Vec<f32> {
    let step_nm = f64::from(Grid::FIT.step_nm());
    let matching = observer.on(Grid::FIT);
    let seen = |in_nm: f64| {
        let mut xyz = [0.0; 3];
        for (out_nm, matching) in Grid::FIT.wavelengths_nm().zip(&matching) {
            let moved = step_nm * reradiation_per_nm(in_nm, out_nm);
            xyz.iter_mut().zip(matching).for_each(|(sum, m)| *sum += moved * m);
        }
        xyz.map(to_single)
    };
    Grid::FINE.wavelengths_nm().flat_map(seen).collect()
}

/// The dyes of all parts, each once, in the order of the set.
fn dyes(parts: &[(f64, Material)], model: &Model) -> Vec<SampledDye> {
    let Some(set) = model.dyes() else {
        return parts.iter().filter_map(|(w, part)| bell(*w, *part, model)).collect();
    };
    let named = set.set().dyes().iter().zip(set.curves()).enumerate();
    named
        .filter_map(|(number, (dye, curves))| {
            let doses: Vec<(f64, f64)> = parts
                .iter()
                .flat_map(|(w, part)| part.fluorescence.dyes(set).map(|found| (*w, found)))
                .filter(|(_, (found, dose))| *found == number && *dose > 0.0)
                .map(|(w, (_, dose))| (w, dose))
                .collect();
            let alone = |dose| match model {
                Model::Film(_) => Fluorescence::film((number, dose), (number, 0.0)),
                _ => Fluorescence::Dyes { first: number, weight: 0.0, concentration: dose },
            };
            let word = if matches!(model, Model::Film(_)) { "density" } else { "concentration" };
            let emission = curves.emission.values().iter().copied().map(to_single).collect();
            let parts = doses.iter().map(|(w, dose)| (*w, alone(*dose))).collect();
            let dose = doses.iter().map(|(w, dose)| w * dose).sum();
            (!doses.is_empty())
                .then(|| sampled_dye(&dye.name, (dose, word), emission, parts, model))
        })
        .collect()
}

/// The absorption and emission by formula of one part.
fn bell(weight: f64, part: Material, model: &Model) -> Option<SampledDye> {
    let (Fluorescence::Analytic { emission_peak_nm, concentration, .. }, Model::Analytic(bells)) =
        (part.fluorescence, model)
    else {
        return None;
    };
    let emission = fine(|nm| bells.emission(emission_peak_nm, nm).0);
    let dose = (weight * concentration, "concentration");
    let parts = vec![(weight, part.fluorescence)];
    Some(sampled_dye(
        &format!("emission at {emission_peak_nm:.0} nm"),
        dose,
        emission,
        parts,
        model,
    ))
}

fn sampled_dye(
    name: &str,
    (dose, word): (f64, &str),
    emission: Vec<f32>,
    parts: Vec<(f64, Fluorescence)>,
    model: &Model,
) -> SampledDye {
    let absorbed = |nm: f64| -> f64 {
        let of = |part| 1.0 - Mixture::of(model, white_with(part)).reflectance(nm);
        parts.iter().map(|(w, part)| w * of(*part)).sum()
    };
    SampledDye {
        name: name.into(),
        dose: to_single(dose),
        dose_text: format!("{word} {dose:.3}"),
        absorbed: fine(absorbed),
        emission,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow::{FilmModel, ModelOnGrid};
    use upglow_color::{Contract, LinearRgb, Metric};
    use upglow_fit::{Fitter, Preset};

    /// Single precision of 531 numbers, and sums over light at every nm in place of every 5 nm.
    const DE2000: f64 = 0.05;

    fn fitted(preset: Preset, rgb: [f64; 3]) -> (Model, Material) {
        let fitter = Fitter::new(&Contract::default(), &preset.model(), preset.options()).unwrap();
        (preset.model(), fitter.fit(LinearRgb(rgb)).unwrap().material())
    }

    #[test]
    fn curves_give_the_color_of_the_material() {
        let contract = Contract::default();
        let colorimetry = contract.on(Grid::FINE);
        for preset in [Preset::Natural, Preset::Konig2020, Preset::Jung2019, Preset::Jakob2019] {
            let (model, material) = fitted(preset, [0.9, 0.1, 0.8]);
            let mixture = Mixture::of(&model, material);
            let sampled = Sampled::of(&mixture, &contract.observer, "magenta");
            let mut xyz = [0.0; 3];
            let response = sampled.response.as_deref();
            for (i, w) in colorimetry.weights().iter().enumerate() {
                for k in 0..3 {
                    let moved = response.map_or(0.0, |r| f64::from(r[3 * i + k]));
                    xyz[k] += w[k] * f64::from(sampled.reflectance[i])
                        + colorimetry.irradiance()[i] * moved;
                }
            }
            let own = mixture.color(&ModelOnGrid::new(&model, &contract.on(Grid::FIT)));
            let off = Metric::De2000.distance(&colorimetry, upglow_color::Xyz(xyz), own);
            assert!(off < DE2000, "{preset}: {off}");
            assert_eq!(sampled.fluoresces, preset != Preset::Jakob2019);
            assert_eq!(sampled.dyes.is_empty(), preset == Preset::Jakob2019);
        }
    }

    #[test]
    fn reflectance_is_what_the_dyes_let_through_of_the_base() {
        /// Single precision.
        const ROUNDING: f32 = 1e-6;
        let (model, material) = fitted(Preset::Natural, [0.9, 0.0, 0.9]);
        assert!(
            matches!(model, Model::Film(FilmModel { .. })) && material.fluorescence.dose() > 0.0
        );
        let sampled = Sampled::of(&Mixture::of(&model, material), &Observer::cie_1931_2deg(), "");
        for i in 0..Grid::FINE.len() {
            let product = sampled.base[i] * sampled.passed[i];
            assert!((sampled.reflectance[i] - product).abs() < ROUNDING, "{i}");
        }
        let dose: f32 = sampled.dyes.iter().map(|dye| dye.dose).sum();
        assert!((f64::from(dose) - material.fluorescence.dose()).abs() < 1e-6);
    }
}
