//! Metamers of measured fluorescent materials.

use std::path::Path;

use upglow::ModelOnGrid;
use upglow_color::{DonaldsonMatrix, Grid, LinearRgb, Metric};

use super::*;
use crate::fit_matrix::goal::MatrixDifference;

const MEASURED: [&str; 4] = ["CIBA12", "HERPIORA", "POLGREE", "TEXTYELL"];

/// The measured materials; `None` where they are absent.
fn measured(test: &str) -> Option<Vec<DonaldsonMatrix>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/bispectral");
    if !folder.is_dir() {
        eprintln!("skipped: {test} (no ../shared/data/bispectral)");
        return None;
    }
    let read = |name: &str| {
        let text = std::fs::read_to_string(folder.join(format!("{name}.BFC"))).unwrap();
        DonaldsonMatrix::from_bfc(&text).unwrap()
    };
    Some(MEASURED.map(read).to_vec())
}

fn named(name: &str) -> Illuminant {
    Illuminant::named(name).unwrap()
}

/// Six lights that materials are compared under.
fn six_lights() -> Vec<Illuminant> {
    let named = ["A", "E", "FL2", "HP5", "D65-cut400"].map(named);
    named.into_iter().chain([ultraviolet_lamp()]).collect()
}

/// The mean ΔE00 of single materials and of blends from the measured ones, which they are made of by their colors
/// under D65 and `others`; over those of the six lights that are not given.
fn errors(measured: &[DonaldsonMatrix], others: &[Illuminant]) -> [f64; 2] {
    let contract = Contract::default();
    let search = MetamerSearch::new(&contract, others, PaintKind::Fluorescent).unwrap();
    let lights: Vec<Illuminant> =
        six_lights().into_iter().filter(|light| !others.contains(light)).collect();
    let mut sums = [0.0; 2];
    for matrix in measured {
        let lit = std::iter::once(&contract.illuminant).chain(others);
        let color = |light| matrix.color(light, &contract.observer).unwrap();
        let metamers = search.of(&lit.map(color).collect::<Vec<_>>()).unwrap();
        let answers = [metamers.single().unwrap(), metamers.mixture().unwrap()];
        for (sum, answer) in sums.iter_mut().zip(&answers) {
            let fitted = answer.mixture().matrix_like(matrix);
            for light in &lights {
                *sum += MatrixDifference::of(matrix, &fitted, light).unwrap().de2000;
            }
        }
    }
    sums.map(|sum| sum / (lights.len() * measured.len()) as f64)
}

#[test]
fn fluorescent_materials_are_known_by_one_color_and_better_by_more() {
    // Mean ΔE00 of a single material and of a blend.
    const BY_ONE: [f64; 2] = [3.0, 2.5];
    const BY_A_PHOTO_WITHOUT_ULTRAVIOLET: [f64; 2] = [2.0, 1.6];
    const BY_A_LAMP_AND_A: [f64; 2] = [1.1, 1.0];
    let test = "fluorescent_materials_are_known_by_one_color_and_better_by_more";
    let Some(measured) = measured(test) else { return };
    for (others, goal) in [
        (vec![], BY_ONE),
        (vec![named("D65-cut400")], BY_A_PHOTO_WITHOUT_ULTRAVIOLET),
        (vec![ultraviolet_lamp(), named("A")], BY_A_LAMP_AND_A),
    ] {
        let found = errors(&measured, &others);
        println!("{} other colors: {found:.2?}", others.len());
        assert!(found[0] <= goal[0] && found[1] <= goal[1], "{found:?}, expected {goal:?}");
    }
}

fn xyz(rgb: [f64; 3]) -> Xyz {
    Contract::default().on(Grid::FIT).xyz_from_rgb(LinearRgb(rgb))
}

/// Gray, dark, brown, orange, and a green and a magenta that no reflectance shows.
const COLORS: [[f64; 3]; 6] = [
    [0.5, 0.5, 0.5],
    [0.01, 0.02, 0.01],
    [0.2, 0.1, 0.05],
    [0.4, 0.2, 0.05],
    [0.1, 0.9, 0.2],
    [0.9, 0.1, 0.8],
];

#[test]
fn answers_have_the_color_exactly_and_are_the_same_for_any_number_of_threads() {
    let contract = Contract::default();
    let colorimetry = contract.on(Grid::FIT);
    let search = MetamerSearch::new(&contract, &[], PaintKind::Any).unwrap();
    let answers = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let of = |rgb| {
            let metamers = search.of(&[xyz(rgb)]).unwrap();
            [metamers.single().unwrap(), metamers.mixture().unwrap()]
        };
        pool.install(|| COLORS.map(of))
    };
    let found = answers(1);
    for (rgb, answers) in COLORS.into_iter().zip(&found) {
        for answer in answers {
            let sums = ModelOnGrid::new(answer.model(), &colorimetry);
            let color = answer.mixture().color(&sums);
            let de2000 = Metric::De2000.distance(&colorimetry, xyz(rgb), color);
            assert!(de2000 <= crate::fit::EXACT, "{rgb:?} {de2000}");
        }
    }
    assert_eq!(found, answers(3));
}

#[test]
fn what_a_reflectance_shows_is_taken_for_ordinary_and_what_none_shows_fluoresces() {
    let contract = Contract::default();
    let search = MetamerSearch::new(&contract, &[], PaintKind::Any).unwrap();
    let probability = |rgb| search.of(&[xyz(rgb)]).unwrap().fluorescent_probability();
    for rgb in &COLORS[..4] {
        assert!(probability(*rgb) < 0.05, "{rgb:?}");
    }
    for rgb in &COLORS[4..] {
        assert!(probability(*rgb) > 0.99, "{rgb:?}");
    }
}

#[test]
fn a_band_holds_the_share_of_the_materials_that_was_asked_for() {
    let contract = Contract::default();
    let search = MetamerSearch::new(&contract, &[], PaintKind::Fluorescent).unwrap();
    let metamers = search.of(&[xyz(COLORS[3])]).unwrap();
    let light = search.light(&named("A"));
    let answer = metamers.mean(&light);
    let white = light.white();
    let far = |xyz| ciede2000(lab_from_xyz(answer, white), lab_from_xyz(xyz, white));
    for share in [0.5, 0.9] {
        let band = metamers.band(&light, answer, share);
        let colors = metamers.colors(&light);
        let within = |limit: &dyn Fn(f64) -> bool| -> f64 {
            colors.iter().filter(|(_, xyz)| limit(far(*xyz))).map(|(weight, _)| weight).sum()
        };
        assert!(within(&|de2000| de2000 <= band) >= share);
        assert!(within(&|de2000| de2000 < band) < share);
    }
}

#[test]
fn the_wrong_number_of_colors_and_what_is_no_color_are_refused() {
    let contract = Contract::default();
    let lights = ["A", "E", "FL2"].map(named);
    let refused = MetamerSearch::new(&contract, &lights, PaintKind::Any).unwrap_err();
    assert_eq!(refused.to_string(), "colors under 4 lights, expected at most 3");
    let search = MetamerSearch::new(&contract, &lights[..1], PaintKind::Any).unwrap();
    let refused = |colors: &[Xyz]| search.of(colors).unwrap_err().to_string();
    let gray = xyz(COLORS[0]);
    assert_eq!(refused(&[gray]), "1 colors, expected 2, one for each light");
    let wrong = refused(&[gray, Xyz([f64::NAN; 3])]);
    assert_eq!(wrong, "the color under A is [NaN, NaN, NaN] (XYZ), expected numbers up to 1000");
}

#[test]
fn a_cube_blends_the_parts_of_a_mixture_and_the_kind_does_not_change_the_probability() {
    // Weights go through sums of each other.
    const ROUNDING: f64 = 1e-12;
    let contract = Contract::default();
    let orange = LinearRgb(COLORS[3]);
    let of_kind =
        |kind| MetamerSearch::new(&contract, &[], kind).unwrap().of_rgb(&[orange]).unwrap();
    let [any, fluorescent] = [PaintKind::Any, PaintKind::Fluorescent].map(of_kind);
    assert_eq!(any.fluorescent_probability(), fluorescent.fluorescent_probability());
    let colorimetry = contract.on(Grid::FIT);
    let mixture = fluorescent.mixture().unwrap();
    assert!(mixture.parts().len() > 1);
    let (cube, rgb) = mixture.to_blending_cube(&contract, MetamerSearch::METHOD).unwrap();
    let blend = cube.lookup(rgb, upglow::Interpolation::Blend).unwrap();
    let own = mixture.mixture().color(&ModelOnGrid::new(mixture.model(), &colorimetry));
    let found = blend.color(&ModelOnGrid::new(cube.model(), &colorimetry));
    assert!((0..3).all(|k| (own.0[k] - found.0[k]).abs() < ROUNDING), "{own:?} {found:?}");
    let weights = |parts: &mut dyn Iterator<Item = f64>| {
        let mut weights: Vec<f64> = parts.filter(|weight| *weight > 0.0).collect();
        weights.sort_by(f64::total_cmp);
        weights
    };
    let ours = weights(&mut mixture.parts().iter().map(|part| part.0));
    let theirs = weights(&mut blend.parts().map(|part| part.0));
    assert_eq!(ours.len(), theirs.len());
    assert!(ours.iter().zip(&theirs).all(|(one, two)| (one - two).abs() < ROUNDING));
}
