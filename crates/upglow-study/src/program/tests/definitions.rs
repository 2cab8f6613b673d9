//! What the paper says and what follows from the model itself: the report lists it, but counts it as no
//! claim, because no fit can refute it.

use upglow::{Features, Fluorescence, Interpolation, Material, Mixing, Model, ModelOnGrid};
use upglow_color::{ColorSolid, Grid, Lab, LinearRgb, ciede2000};
use upglow_fit::Unwatched;
use upglow_study::{Layer, konig2020};

use super::reradiation::backward_shares;
use crate::cubes::{Cubes, StudyCube};

/// The color of a reflectance of these features, and its luminance.
fn shown(features: Features) -> (Lab, f64) {
    let colorimetry = konig2020::contract().on(Grid::FIT);
    let model = Model::Dyes(konig2020::dyes(Mixing::Pooled));
    let reflectance = features.to_sigmoid().unwrap();
    let xyz = ModelOnGrid::new(&model, &colorimetry).color(Material::passive(reflectance));
    (colorimetry.lab_from_xyz(xyz), xyz.0[1])
}

#[test]
fn some_colors_lie_beyond_every_reflectance() {
    let colorimetry = konig2020::contract().on(Grid::FIT);
    let green = colorimetry.xyz_from_rgb(LinearRgb([0.0, 1.0, 0.0]));
    assert!(!ColorSolid::reflectance(&colorimetry).contains(green));
}

#[test]
fn neighboring_nodes_can_have_different_dyes() {
    let cube = Cubes::new(4).get(StudyCube::PAPER, &Unwatched).unwrap();
    let first = |node: usize| match cube.node_material(node).fluorescence {
        Fluorescence::Dyes { first, .. } => Some(first),
        _ => None,
    };
    let differ = |node: usize| {
        let (a, b) = (first(node), first(node + 1));
        a.is_some() && b.is_some() && a != b && cube.coordinates(node)[2] + 1 < 4
    };
    assert!((0..cube.nodes().len() - 1).any(differ));
}

/// Nodes match within 0.01 ΔE00, and are stored in single precision.
const MATCHED_AND_STORED: f64 = 0.02;

#[test]
fn mixed_materials_are_exact_between_exact_nodes() {
    for which in [StudyCube::REFERENCE, StudyCube::PaperFeatures] {
        let cube = Cubes::new(6).get(which, &Unwatched).unwrap();
        let layer = Layer::between_nodes(&cube, 0.7, 31, Interpolation::Blend);
        let exact = layer.de2000.iter().zip(&layer.has_exact_nodes).filter(|(_, exact)| **exact);
        let errors: Vec<f64> = exact.map(|(error, _)| *error).collect();
        assert!(errors.len() > 100 && errors.iter().all(|error| *error <= MATCHED_AND_STORED));
    }
}

#[test]
fn dyes_kept_apart_send_less_light_to_shorter_wavelengths() {
    let shares = backward_shares();
    let worst = shares.iter().max_by(|a, b| a.pooled.total_cmp(&b.pooled)).unwrap();
    assert_eq!(worst.first, "Alexa_Fluor_635", "where the ring closes, red absorbs for violet");
    assert!(worst.separate < worst.pooled / 2.0, "{worst:?}");
}

/// Just visible, ΔE00.
const VISIBLE: f64 = 1.0;

#[test]
fn one_gray_has_many_features() {
    // Width times slope is constant, so these are the same gray.
    let gray = |shift_nm: f64, width_nm: f64| {
        shown(Features { shift_nm, width_nm, slope_per_nm: 0.1 / width_nm }).0
    };
    let known = gray(550.0, 4000.0);
    assert!(known.a.hypot(known.b) < VISIBLE);
    for other in [gray(550.0, 8000.0), gray(450.0, 4000.0)] {
        assert!(ciede2000(known, other) < VISIBLE);
    }
}

#[test]
fn small_slopes_are_bright_or_dark_by_their_sign() {
    let luminance =
        |slope_per_nm| shown(Features { shift_nm: 550.0, width_nm: 80.0, slope_per_nm }).1;
    assert!(luminance(0.0005) > 0.9 && luminance(-0.0005) < 0.1);
    // The sigmoid is symmetric: one is the complement of the other.
    assert!((luminance(0.0005) + luminance(-0.0005) - 1.0).abs() < 1e-9);
}
