//! Our tables against the published files, if the folder with these is available.

use std::path::PathBuf;

use upglow_color::{Grid, Illuminant, MeasuredDye, Observer};

/// A file of the optional data folder, or the name of the test that is skipped without it.
fn shared(test: &str, file: &str) -> Option<String> {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"));
    let text = std::fs::read_to_string(folder.join(file)).ok();
    if text.is_none() {
        eprintln!("skipped: {test} (no ../shared/data/{file})");
    }
    text
}

fn rows(text: &str) -> impl Iterator<Item = Vec<f64>> {
    let number = |cell: &str| cell.trim().parse().unwrap_or(0.0);
    text.lines().skip(1).map(move |line| line.split(',').map(number).collect())
}

#[test]
fn computed_d65_is_the_published_table() {
    let Some(text) = shared("computed_d65_is_the_published_table", "cie/CIE_std_illum_D65.csv")
    else {
        return;
    };
    let d65 = Illuminant::default();
    for row in rows(&text) {
        // Six printed digits, rounded at every 10 nm and again after interpolation: twice half a
        // unit of 0.001 where the power is above 100.
        assert!((d65.power().at(row[0]) - row[1]).abs() <= 1.05e-3, "{row:?}");
    }
}

#[test]
fn the_observer_is_the_published_table() {
    let Some(text) = shared("the_observer_is_the_published_table", "cie/CIE_xyz_1931_2deg.csv")
    else {
        return;
    };
    let ours = Observer::default().on(Grid::FINE);
    for (row, ours) in rows(&text).zip(&ours[60..]) {
        assert_eq!(row[1..], *ours, "{} nm", row[0]);
    }
}

#[test]
fn the_dyes_are_the_published_curves_at_every_fifth_nanometer() {
    for dye in MeasuredDye::all() {
        let test = "the_dyes_are_the_published_curves_at_every_fifth_nanometer";
        let Some(text) = shared(test, &format!("dyes/{}.csv", dye.name)) else {
            return;
        };
        for row in rows(&text).step_by(5) {
            // Half a unit of the last digit that the tables keep, and rounding of its ties.
            assert!((dye.absorption.at(row[0]) - row[1]).abs() < 0.501e-4, "{} {row:?}", dye.name);
            assert!((dye.emission.at(row[0]) - row[2]).abs() < 0.501e-4, "{} {row:?}", dye.name);
        }
    }
}
