//! The laws of `verify` for small cubes of every preset, model, accounting and quantum yield.
#![expect(clippy::unwrap_used, reason = "a test that cannot start has failed")]

use upglow::{
    Accounting, AnalyticModel, DyeModel, DyeOptions, DyeSet, FilmModel, Mixing, Model, QuantumYield,
};
use upglow_color::{Choice, Contract};
use upglow_fit::{FitOptions, Preset, Unwatched, VerifyOptions, build_cube, verify};

/// Nodes along each axis: enough for every kind of material.
const RESOLUTION: usize = 5;

/// Every preset, then every other model and rule with the limits of the default preset, named.
fn cases() -> Vec<(String, Model, FitOptions)> {
    let presets =
        Preset::ALL.iter().map(|preset| (preset.to_string(), preset.model(), preset.options()));
    let mut cases: Vec<_> = presets.collect();
    let options = Preset::Natural.options();
    let yields = [QuantumYield::Fixed(1.0), QuantumYield::Measured];
    for &accounting in Accounting::ALL {
        let analytic = AnalyticModel::new(50.0, 45.0, accounting, 1.0).unwrap();
        cases.push((format!("analytic, {accounting}"), Model::Analytic(analytic), options));
        for quantum_yield in yields {
            let rules = format!("{accounting}, {quantum_yield:?}");
            let film = FilmModel::new(set(), accounting, quantum_yield).unwrap();
            cases.push((format!("film, {rules}"), Model::Film(film), options));
            for (&mixing, optical_density) in Mixing::ALL.iter().zip([None, Some(2.0)]) {
                let rule = DyeOptions { mixing, accounting, quantum_yield, optical_density };
                let dyes = DyeModel::new(set(), rule).unwrap();
                let name = format!("dyes, {mixing}, {rules}, density {optical_density:?}");
                cases.push((name, Model::Dyes(dyes), options));
            }
        }
    }
    // The film of one accounting is that of the default preset.
    let is_new = |case: &(String, Model, FitOptions)| {
        let preset = Preset::of(&case.1, &case.2);
        preset.is_none_or(|preset| preset.to_string() == case.0)
    };
    cases.retain(is_new);
    cases
}

fn set() -> DyeSet {
    DyeSet::named("wide8").unwrap()
}

/// Verifies every case at this many colors between the nodes.
fn assert_laws_hold(points: usize) {
    for (name, model, options) in cases() {
        let cube =
            build_cube(&Contract::default(), &model, options, RESOLUTION, &Unwatched).unwrap();
        let report =
            verify(&cube, &VerifyOptions { points, ..VerifyOptions::default() }, &Unwatched);
        let report = report.unwrap();
        let broken: Vec<_> = report.broken().collect();
        assert!(broken.is_empty(), "{name}: {broken:#?}");
        for law in ["energy", "bounds", "slope"] {
            let checked = report.check(law).unwrap().checked;
            assert!(checked >= points, "{name}: {law} was checked {checked} times");
        }
        println!("{name}: {points} colors, no law broken");
    }
}

#[test]
fn no_law_is_broken_in_any_model() {
    assert_laws_hold(1000);
}

#[test]
#[ignore = "slow"]
fn slow_no_law_is_broken_in_any_model_at_ten_million_colors_each() {
    assert_laws_hold(10_000_000);
}
