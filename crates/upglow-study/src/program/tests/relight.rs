//! What the default makes of the colors of real surfaces, so that a change of it is noticed.

use std::path::Path;

use upglow_color::Contract;
use upglow_fit::Preset;

use crate::bispectral::Measured;
use crate::relight::{Relit, Way, sets};
use crate::samples::SampleSet;
use crate::spread::Spread;

/// What half a unit of the last of two printed decimals adds to the figures of docs/relighting.md.
const PRINTED: f64 = 0.005;

fn relit(preset: Preset, measured: &[Measured], set: usize) -> Relit {
    let (set, lights) = &sets(measured)[set];
    Relit::of(set, &Way::preset(preset, Contract::default()), lights)
}

#[test]
fn the_default_relights_measured_surfaces_as_well_as_the_documents_say_and_gives_them_no_dye() {
    for (set, mean) in [(0, 1.47), (1, 0.92)] {
        let found = relit(Preset::Natural, &[], set);
        assert_eq!(found.dyed, 0);
        assert!(Spread::of(found.home.iter().copied()).max < 0.02, "{:?}", found.home);
        let found = Spread::of(found.means()).mean;
        assert!(found <= mean + PRINTED, "{found}");
    }
}

#[test]
fn the_default_relights_object_colors_better_than_one_hard_limit_of_slopes() {
    let [natural, konig2020] =
        [Preset::Natural, Preset::Konig2020].map(|preset| relit(preset, &[], 0).means());
    let gains = Spread::of(konig2020.iter().zip(natural).map(|(before, now)| before - now));
    // Three standard errors: chance alone would do this once in 700 times.
    assert!(gains.mean > 3.0 * gains.standard_error, "{gains:?}");
}

#[test]
fn every_measured_surface_has_a_color_of_the_default_space() {
    for (set, _) in sets(&[]) {
        let colorimetry = Contract::default().on(set.grid);
        for sample in &set.samples {
            let rgb = colorimetry.rgb_from_xyz(sample.color(&colorimetry)).0;
            assert!(rgb.iter().all(|v| (0.0..=1.0).contains(v)), "{rgb:?}");
        }
    }
}

#[test]
fn the_default_relights_fluorescent_materials_as_well_as_the_documents_say() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/bispectral");
    if !folder.is_dir() {
        eprintln!(
            "skipped: the_default_relights_fluorescent_materials_as_well_as_the_documents_say \
             (no ../shared/data/bispectral)"
        );
        return;
    }
    let measured = Measured::read_folder(&folder).unwrap();
    let fluorescent = sets(&[]).len();
    let found = Spread::of(relit(Preset::Natural, &measured, fluorescent).means()).mean;
    assert!(found <= 3.57 + PRINTED, "{found}");
    assert_eq!(SampleSet::fluorescent(&measured).samples.len(), 4);
}
