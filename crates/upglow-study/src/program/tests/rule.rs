//! What the rule of choosing promises.

use upglow::Fluorescence;
use upglow_color::{Contract, Grid, lab_from_xyz};
use upglow_fit::{CubeSummary, Preset, Unwatched};

use crate::rule::{colors, contract_of_every_color, cube, doses, dyed_by_look_up, dyed_nodes};
use crate::ways::OneColor;

/// Greatest |dr/dλ| of the default's reflectances without a dye, 1/nm.
fn limit_per_nm() -> f64 {
    Preset::Natural.options().slope_max_per_nm.unwrap()
}

#[test]
fn known_surfaces_and_srgb_colors_are_matched_without_a_dye() {
    // Darker colors of sRGB with a channel at zero need steeper slopes, and some of them get a dye.
    const NEARLY_BLACK: f64 = 5.0;
    let way = OneColor::preset(Preset::Natural, &contract_of_every_color());
    let white = Contract::default().on(Grid::FIT).white();
    for (name, colors) in colors(2000) {
        let is_srgb = name.contains("sRGB");
        for color in colors {
            if is_srgb && lab_from_xyz(color, white).l <= NEARLY_BLACK {
                continue;
            }
            let fit = way.fit(color);
            assert_eq!(fit.fluorescence, Fluorescence::None, "{name} {color:?}");
            assert!(fit.de2000 <= CubeSummary::EXACT_DE2000, "{name} {color:?} {fit:?}");
            assert!(fit.reflectance.slope_per_nm.abs() <= limit_per_nm(), "{name} {color:?}");
        }
    }
}

#[test]
fn no_node_of_a_small_cube_for_srgb_has_a_dye() {
    let cube = cube(Preset::Natural, "srgb", 9, &Unwatched).unwrap();
    assert_eq!(dyed_nodes(&cube).dyed, 0);
}

#[test]
fn half_of_the_nodes_have_nearly_the_least_dose() {
    // Matches within 0.01 ΔE00 of the color differ in dose by a percent or two.
    const NEARLY: f64 = 1.05;
    let cube = cube(Preset::Natural, "acescg", 9, &Unwatched).unwrap();
    let found = doses(&cube, Preset::Natural, 24, &Unwatched).unwrap();
    assert_eq!((found.alone.count + found.missed_alone, found.in_cube.count), (24, 24));
    assert!(found.alone.median < NEARLY && found.in_cube.median < NEARLY, "{found:?}");
}

#[test]
#[ignore = "slow"]
fn slow_the_default_cube_gives_few_srgb_colors_a_dye_and_no_more_of_it_than_the_documents_say() {
    // Half a unit of the last printed decimal.
    const PRINTED: f64 = 0.005;
    let cube = cube(Preset::Natural, "acescg", 32, &Unwatched).unwrap();
    // A blend in a cube for a wider space has the dyes of its corners.
    let found = dyed_by_look_up(&cube, 20_000);
    assert!(100 * found.dyed <= 7 * found.count, "{found:?}");
    let found = doses(&cube, Preset::Natural, 500, &Unwatched).unwrap();
    for (spread, [p95, worst]) in [(found.alone, [1.06, 1.79]), (found.in_cube, [1.30, 2.17])] {
        assert!(spread.p95 <= p95 + PRINTED && spread.max <= worst + PRINTED, "{spread:?}");
    }
}
