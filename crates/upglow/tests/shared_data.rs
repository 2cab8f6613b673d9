//! Algorithm 1 against computed vectors, and measured dyes, where the folder that holds them is at hand.

use std::path::PathBuf;

use upglow::{DyeSet, Features};
use upglow_color::MeasuredDye;

/// The vectors are printed with six digits for the features they start from, so that is how well
/// they determine what follows; coefficients near z² times the curvature lose more.
const PRINTED_DIGITS: f64 = 1e-4;

#[test]
fn algorithm_1_gives_the_reference_coefficients_and_spectra() {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../../shared/data/reference/algorithm1_vectors.csv"
    );
    let Ok(text) = std::fs::read_to_string(PathBuf::from(file)) else {
        eprintln!(
            "skipped: algorithm_1_gives_the_reference_coefficients_and_spectra \
             (no ../shared/data/reference/algorithm1_vectors.csv)"
        );
        return;
    };
    let mut rows = 0;
    for line in text.lines().skip(1) {
        let v: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let features = Features { shift_nm: v[0], width_nm: v[1], slope_per_nm: v[2] };
        let vertex = features.to_vertex().unwrap();
        let sigmoid = vertex.to_sigmoid();
        let found = [sigmoid.c0, sigmoid.c1, sigmoid.c2, vertex.peak];
        for (found, expected) in found.iter().zip(&v[3..7]) {
            assert!((found - expected).abs() <= PRINTED_DIGITS * expected.abs(), "{line}: {found}");
        }
        for (nm, expected) in [380.0, 460.0, 550.0, 640.0, 780.0].into_iter().zip(&v[7..12]) {
            assert!((vertex.at(nm) - expected).abs() <= PRINTED_DIGITS, "{line}: {nm} nm");
        }
        rows += 1;
    }
    assert!(rows >= 100, "{rows}");
}

#[test]
fn every_measured_dye_is_accepted_and_none_takes_a_built_in_name_with_other_numbers() {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/dyes"));
    if !folder.exists() {
        eprintln!(
            "skipped: every_measured_dye_is_accepted_and_none_takes_a_built_in_name_with_other_numbers \
             (no ../shared/data/dyes)"
        );
        return;
    }
    let set = DyeSet::from_folder(&folder).unwrap();
    assert!(set.dyes().len() >= 28, "{}", set.dyes().len());
    for dye in set.dyes() {
        assert_eq!(dye.check_name(), Ok(()));
        // The built-in tables are coarser, so their dyes are others.
        let stem = dye.provenance.strip_suffix(".csv").unwrap();
        let is_built_in = MeasuredDye::named(stem).is_some();
        assert_eq!(dye.name, if is_built_in { &dye.provenance } else { stem });
    }
    // Curves there are divided by their peaks, up to the rounding of three digits.
    let normalized = DyeSet::from_folder_normalized(&folder).unwrap();
    assert!(normalized.dyes().iter().all(|dye| dye.absorption.peak() == 1.0));
}
