//! Fits of single colors: what must hold for all of them, and for some in particular.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

use proptest::prelude::*;
use upglow::{
    Accounting, AnalyticModel, Bispectral, DyeModel, DyeOptions, DyeSet, Fluorescence, Mixing,
    Mixture, Model,
};
use upglow_color::{Choice, Contract, Grid, LinearRgb, Metric};
use upglow_fit::{ColorError, Fit, FitOptions, Fitter, Preset};

/// The limit of the preset `konig2020`, 1/nm.
const SLOPE_LIMIT: f64 = 0.01;

fn konig8(options: DyeOptions) -> Model {
    Model::Dyes(DyeModel::new(DyeSet::named("konig8").unwrap(), options).unwrap())
}

fn fitter(model: &Model, options: FitOptions) -> Fitter {
    Fitter::new(&Contract::default(), model, options).unwrap()
}

fn fit(model: &Model, rgb: [f64; 3]) -> Fit {
    fitter(model, Preset::Konig2020.options()).fit(LinearRgb(rgb)).unwrap()
}

fn assert_valid(model: &Model, fit: &Fit) {
    let slope = fit.material().reflectance.steepest_slope_per_nm();
    assert!(slope <= SLOPE_LIMIT, "{fit:?}");
    let mixture = Mixture::of(model, fit.material());
    for nm in Grid::FIT.wavelengths_nm() {
        // Rounding only.
        assert!((0.0..=1.0 + 1e-12).contains(&mixture.albedo(nm)), "{nm} {fit:?}");
    }
}

#[test]
fn white_is_the_perfect_diffuser_and_black_reflects_nothing() {
    let model = konig8(DyeOptions::default());
    for value in [1.0, 0.0] {
        let fit = fit(&model, [value; 3]);
        let mixture = Mixture::of(&model, fit.material());
        assert!(Grid::FINE.wavelengths_nm().all(|nm| mixture.reflectance(nm) == value));
        assert!(fit.de2000 < 1e-9 && fit.fluorescence == Fluorescence::None);
    }
}

#[test]
fn grays_are_flat_and_do_not_fluoresce() {
    let model = konig8(DyeOptions::default());
    for i in 0..=31 {
        let value = f64::from(i) / 31.0;
        let fit = fit(&model, [value; 3]);
        assert_eq!((fit.reflectance.slope_per_nm, fit.fluorescence), (0.0, Fluorescence::None));
        assert!((fit.reflectance.at(550.0) - value).abs() < 1e-12);
    }
}

#[test]
fn a_magenta_that_no_reflectance_reaches_needs_dyes() {
    let model = konig8(DyeOptions::default());
    let magenta = fit(&model, [0.9, 0.0, 0.9]);
    let passive = fit(&Model::Reflectance, [0.9, 0.0, 0.9]);
    assert!(magenta.fluorescence.dose() > 0.0);
    assert!(magenta.de2000 < 0.6 * passive.de2000, "{magenta:?} {passive:?}");
    assert_valid(&model, &magenta);
}

#[test]
fn a_measured_fluorescent_orange_brighter_than_white_is_matched_by_dense_dyes() {
    let model = konig8(DyeOptions { optical_density: Some(4.0), ..DyeOptions::default() });
    let orange = fit(&model, [1.58, 0.34, 0.05]);
    assert!(orange.de2000 <= 0.1, "{orange:?}");
    assert_valid(&model, &orange);
}

#[test]
fn unreachable_pure_green_gets_a_near_material() {
    let model = konig8(DyeOptions::default());
    let green = fit(&model, [0.0, 1.0, 0.0]);
    assert!(green.de2000 > 1.0 && green.de2000 < 30.0, "{green:?}");
    assert_valid(&model, &green);
}

#[test]
fn errors_name_the_channel_that_is_out_of_range() {
    let fitter = fitter(&Model::Reflectance, Preset::Konig2020.options());
    for (rgb, channel) in
        [([f64::NAN, 0.0, 0.0], "red"), ([0.0, -0.1, 0.0], "green"), ([0.0, 0.0, 11.0], "blue")]
    {
        let Err(ColorError::Outside { channel: found, .. }) = fitter.fit(LinearRgb(rgb)) else {
            panic!("{rgb:?} was accepted");
        };
        assert_eq!(found, channel);
    }
}

#[test]
fn a_color_that_needs_little_fluorescence_gets_little() {
    // From a color that a reflectance matches to one that none does, the concentration rises from 0
    // without a jump.
    let model = konig8(DyeOptions::default());
    let fitter = fitter(&model, Preset::Konig2020.options());
    let at = |t: f64| fitter.fit(LinearRgb([0.5, 0.5 - 0.45 * t, 0.5])).unwrap();
    let fits: Vec<Fit> = (0..=40).map(|i| at(f64::from(i) / 40.0)).collect();
    let first = fits.iter().find(|f| f.fluorescence.dose() > 0.0).unwrap();
    assert!(first.de2000 <= 0.01, "{first:?}");
    assert!(first.fluorescence.dose() < 0.25, "{first:?}");
}

#[test]
fn every_metric_matches_a_reachable_color() {
    let model = konig8(DyeOptions::default());
    for &metric in Metric::ALL {
        let options = FitOptions { metric, ..Preset::Konig2020.options() };
        let fit = fitter(&model, options).fit(LinearRgb([0.2, 0.7, 0.4])).unwrap();
        assert!(fit.de2000 <= 0.01, "{metric} {fit:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_color_gets_a_valid_material_from_any_model(rgb in prop::array::uniform3(0.0..1.5)) {
        let mut models = vec![Model::Reflectance, Model::Analytic(AnalyticModel::default())];
        for accounting in [Accounting::Energy, Accounting::Photon] {
            for mixing in [Mixing::Pooled, Mixing::Separate] {
                models.push(konig8(DyeOptions { accounting, mixing, ..DyeOptions::default() }));
            }
        }
        for model in models {
            let fit = fit(&model, rgb);
            prop_assert!(fit.de2000.is_finite());
            assert_valid(&model, &fit);
        }
    }
}
