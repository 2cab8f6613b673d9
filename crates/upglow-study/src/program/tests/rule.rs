//! What the rule of choosing promises.

use upglow::Fluorescence;
use upglow_color::{Contract, Grid, lab_from_xyz};
use upglow_fit::{CubeSummary, Preset, Unwatched};

use crate::relight::Way;
use crate::rule::{colors, contract_of_every_color, cube, doses, dyed_by_look_up, dyed_nodes};

/// Greatest |dr/dλ| of the default's reflectances without a dye, 1/nm.
fn limit_per_nm() -> f64 {
    Preset::Natural.options().slope_max_per_nm.unwrap()
}

#[test]
fn known_surfaces_and_srgb_colors_are_matched_without_a_dye() {
    // Darker colors of sRGB with a channel at zero need steeper slopes, and some of them get a dye.
    const NEARLY_BLACK: f64 = 5.0;
    let way = Way::preset(Preset::Natural, contract_of_every_color());
    let white = Contract::default().on(Grid::FIT).white();
    for (name, colors) in colors() {
        let is_srgb = name.contains("sRGB");
        // A tenth of the random colors are enough where time counts.
        let step = if is_srgb { 10 } else { 1 };
        for color in colors.into_iter().step_by(step) {
            if is_srgb && lab_from_xyz(color, white).l <= NEARLY_BLACK {
                continue;
            }
            let fit = way.material(color);
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
fn the_dose_of_a_node_is_near_the_least() {
    // Of the nodes of a small cube half have the least dose that is known, and three in four are within the
    // factor of two that nearness to the neighbors may cost.
    let cube = cube(Preset::Natural, "acescg", 9, &Unwatched).unwrap();
    let found = doses(&cube, Preset::Natural, 24, &Unwatched).unwrap();
    assert!(found.alone.count + found.missed_alone == 24 && found.in_cube.count == 24);
    assert!(found.alone.median < 1.05 && found.in_cube.median < 1.05, "{found:?}");
    println!("{found:?}");
}

/// A blend in a cube for a wider space has the dyes of its corners.
#[test]
#[ignore = "slow"]
fn slow_few_srgb_colors_have_a_dye_by_look_up_in_the_default_cube() {
    const MOST_IN_100: usize = 7;
    let found = dyed_by_look_up(&cube(Preset::Natural, "acescg", 32, &Unwatched).unwrap());
    assert!(100 * found.dyed <= MOST_IN_100 * found.count, "{found:?}");
}
