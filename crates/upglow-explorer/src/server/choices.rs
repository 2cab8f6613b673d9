//! What a cube can be built from.

use std::collections::BTreeMap;

use serde_json::{Value, json};
use upglow::{DyeSet, Model};
use upglow_color::{BispectralUnit, Choice as _, Illuminant, MeasuredDye, Observer, RgbSpace};
use upglow_fit::{FitOptions, Preset};
use upglow_image::{DeclaredAlpha, Encoding};

/// Encodings that pictures have without saying so.
const ENCODINGS: [Encoding; 3] = [Encoding::Linear, Encoding::Srgb, Encoding::Bt709];

/// The built-in presets, spaces, lights, observers and dyes.
pub(super) fn built_in() -> Value {
    let presets = Preset::ALL.iter().map(|preset| {
        json!({ "name": preset.name(), "options": options_of(&preset.model(), &preset.options()) })
    });
    let dye_sets = MeasuredDye::set_names().filter_map(|name| {
        let set = DyeSet::named(name).ok()?;
        let dyes: Vec<&str> = set.dyes().iter().map(|dye| dye.name.as_str()).collect();
        Some(json!({ "name": name, "dyes": dyes }))
    });
    json!({
        "presets": presets.collect::<Vec<_>>(),
        "spaces": RgbSpace::names(),
        "lights": Illuminant::names(),
        "observers": Observer::NAMES,
        "dye_sets": dye_sets.collect::<Vec<_>>(),
        "encodings": ENCODINGS.map(|encoding| encoding.to_string()),
        "alphas": DeclaredAlpha::ALL.iter().map(|alpha| alpha.name()).collect::<Vec<_>>(),
        "bispectral_units": BispectralUnit::ALL.iter().map(|unit| unit.name()).collect::<Vec<_>>(),
    })
}

/// The name that a set is called by; files keep a former one.
fn name_of(set: &DyeSet) -> &str {
    let is_same =
        |name: &&str| MeasuredDye::set(name).is_some_and(|(stored, _)| stored == set.name());
    MeasuredDye::set_names().find(is_same).unwrap_or(set.name())
}

/// A model and options of a fit by the options of the command line that give them.
pub(super) fn options_of(model: &Model, fit: &FitOptions) -> BTreeMap<&'static str, String> {
    let limit = |limit: Option<f64>| limit.map_or("none".into(), |limit| limit.to_string());
    let mut options = BTreeMap::from([
        ("--model", model.name().to_owned()),
        ("--metric", fit.metric.to_string()),
        ("--slope-max-per-nm", limit(fit.slope_max_per_nm)),
        ("--slope-limits", if fit.relaxed { "relaxed" } else { "hard" }.into()),
        ("--method", fit.method.to_string()),
        ("--sweeps", fit.sweeps.to_string()),
    ]);
    if *model != Model::Reflectance {
        options.insert("--slope-under-dyes-per-nm", limit(fit.slope_under_dyes_per_nm));
    }
    let accounting = model.accounting().map(|accounting| accounting.to_string());
    options.extend(accounting.map(|accounting| ("--accounting", accounting)));
    let quantum_yield = model.quantum_yield().map(|quantum_yield| quantum_yield.to_string());
    options.extend(quantum_yield.map(|quantum_yield| ("--quantum-yield", quantum_yield)));
    if let Some(dyes) = model.dyes() {
        options.insert("--dyes", name_of(dyes.set()).into());
    }
    match model {
        Model::Dyes(dyes) => {
            options.insert("--mixing", dyes.options().mixing.to_string());
            let density = dyes.options().optical_density;
            options.extend(density.map(|density| ("--optical-density", density.to_string())));
        }
        Model::Analytic(bells) => {
            options.insert("--absorption-fwhm-nm", bells.absorption_fwhm_nm().to_string());
            options.insert("--emission-fwhm-nm", bells.emission_fwhm_nm().to_string());
        }
        Model::Film(_) | Model::Reflectance => {}
    }
    options
}
