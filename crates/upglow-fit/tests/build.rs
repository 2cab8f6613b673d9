//! Whole cubes: their quality, and that they do not depend on the number of threads.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

use std::sync::atomic::{AtomicBool, Ordering};

use upglow::{AnalyticModel, Cube, DyeModel, DyeOptions, DyeSet, Interpolation, Mixture, Model};
use upglow::{Fluorescence, ModelOnGrid};
use upglow_color::{Contract, Grid, LinearRgb, Metric};
use upglow_fit::{
    BuildError, CubeSummary, FitOptions, Fitter, Method, Preset, Progress, Unwatched, Watch,
    build_cube,
};

fn dyes(set: &str, optical_density: Option<f64>) -> Model {
    let options = DyeOptions { optical_density, ..DyeOptions::default() };
    Model::Dyes(DyeModel::new(DyeSet::named(set).unwrap(), options).unwrap())
}

fn build(model: &Model, options: FitOptions, resolution: usize) -> Cube {
    build_cube(&Contract::default(), model, options, resolution, &Unwatched).unwrap()
}

/// Share of nodes within 1 ΔE00, percent, and mean ΔE00.
fn quality(model: &Model, slope_max_per_nm: Option<f64>) -> (f64, f64) {
    let options = Preset::Konig2020.options().with_slope_max_per_nm(slope_max_per_nm);
    let summary = CubeSummary::of(&build(model, options, 32));
    println!("{slope_max_per_nm:?}: {summary:?}");
    (100.0 * summary.within_1 as f64 / summary.nodes as f64, summary.mean_de2000)
}

/// The bounds are the results of an exhaustive search with the same model, less 0.4 points and 0.015.
#[test]
fn acescg_is_matched_as_well_as_by_an_exhaustive_search() {
    let (within_1, mean) = quality(&dyes("konig8", None), Some(0.01));
    assert!(within_1 >= 78.5 && mean <= 0.83, "{within_1} {mean}");
    let (within_1, mean) = quality(&dyes("konig8", Some(4.0)), Some(0.01));
    assert!(within_1 >= 90.2 && mean <= 0.283, "{within_1} {mean}");
    let (within_1, mean) = quality(&dyes("konig8", None), None);
    assert!(within_1 >= 97.0 && mean <= 0.079, "{within_1} {mean}");
}

/// How much worse than the exhaustive search a node of the default build may be, ΔE00: a fiftieth of a
/// visible difference.
const WORSE_THAN_EXHAUSTIVE: f64 = 0.02;

#[test]
fn no_random_node_is_worse_than_with_an_exhaustive_search() {
    let model = dyes("konig8", None);
    let cube = build(&model, Preset::Konig2020.options(), 32);
    let options = FitOptions { method: Method::Exhaustive, ..Preset::Konig2020.options() };
    let fitter = Fitter::new(&Contract::default(), &model, options).unwrap();
    let mut worst: f64 = 0.0;
    // A step that is coprime to the number of nodes visits the whole cube.
    for index in (0..500).map(|i| i * 12_289 % 32_768) {
        let best = fitter.fit(cube.node_rgb(index)).unwrap().de2000;
        worst = worst.max(f64::from(cube.nodes()[index].de2000) - best.max(0.01));
    }
    println!("worst of 500: {worst:.4} ΔE00 above the exhaustive search");
    assert!(worst <= WORSE_THAN_EXHAUSTIVE, "{worst}");
}

#[test]
fn cubes_do_not_depend_on_the_number_of_threads() {
    for model in [dyes("open8", None), Model::Analytic(AnalyticModel::default())] {
        let bytes = [1, 2, 5].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| build(&model, Preset::Konig2020.options(), 7)).to_bytes()
        });
        assert!(bytes[0] == bytes[1] && bytes[0] == bytes[2]);
    }
}

#[test]
fn the_stored_difference_is_that_of_the_stored_material() {
    let cube = build(&dyes("konig8", None), Preset::Konig2020.options(), 6);
    let colorimetry = cube.contract().on(Grid::FIT);
    let sums = ModelOnGrid::new(cube.model(), &colorimetry);
    for (index, node) in cube.nodes().iter().enumerate() {
        let target = colorimetry.xyz_from_rgb(cube.node_rgb(index));
        let color = sums.color(cube.node_material(index));
        let de2000 = Metric::De2000.distance(&colorimetry, target, color);
        // Single precision of the stored number.
        assert!((de2000 - f64::from(node.de2000)).abs() <= 1e-6 * de2000.max(1e-3));
    }
}

#[test]
fn colors_between_exact_corners_are_exact() {
    let cube = build(&dyes("konig8", None), Preset::Konig2020.options(), 9);
    let colorimetry = cube.contract().on(Grid::FIT);
    let sums = ModelOnGrid::new(cube.model(), &colorimetry);
    let mut checked = 0;
    for i in 0..4000_u32 {
        let rgb = [i % 23, i / 23 % 19, i % 29].map(|v| f64::from(v) / 29.0);
        let corners = cube.corners(LinearRgb(rgb)).unwrap();
        if corners.iter().any(|&(n, w)| w > 0.0 && cube.nodes()[n].de2000 > 0.01) {
            continue;
        }
        let mixture: Mixture<'_> = cube.lookup(LinearRgb(rgb), Interpolation::Blend).unwrap();
        let target = colorimetry.xyz_from_rgb(LinearRgb(rgb));
        let de2000 = Metric::De2000.distance(&colorimetry, target, mixture.color(&sums));
        assert!(de2000 <= 0.01, "{rgb:?} {de2000}");
        checked += 1;
    }
    assert!(checked > 1000, "{checked}");
}

#[test]
fn a_reflectance_cube_does_not_fluoresce() {
    let cube = build(&Model::Reflectance, Preset::Konig2020.options(), 5);
    assert_eq!(CubeSummary::of(&cube).fluorescent, 0);
    assert!((0..125).all(|i| cube.node_material(i).fluorescence == Fluorescence::None));
}

#[derive(Default)]
struct StopAtOnce {
    seen: AtomicBool,
}

impl Watch for StopAtOnce {
    fn progress(&self, _: Progress) {
        self.seen.store(true, Ordering::Relaxed);
    }

    fn stopped(&self) -> bool {
        self.seen.load(Ordering::Relaxed)
    }
}

#[test]
fn a_stopped_build_returns_an_error() {
    let model = dyes("konig8", None);
    let watch = StopAtOnce::default();
    let stopped = build_cube(&Contract::default(), &model, Preset::Konig2020.options(), 16, &watch);
    assert_eq!(stopped, Err(BuildError::Stopped));
}

#[test]
fn options_out_of_range_are_refused() {
    let model = Model::Reflectance;
    let build = |options, resolution| {
        let built = build_cube(&Contract::default(), &model, options, resolution, &Unwatched);
        built.unwrap_err().to_string()
    };
    let steep = FitOptions { slope_max_per_nm: Some(-1.0), ..Preset::Konig2020.options() };
    assert_eq!(build(steep, 4), "slope limit -1/nm, expected 0.0001 to 0.2/nm");
    assert_eq!(build(Preset::Konig2020.options(), 1), "resolution 1, expected 2 to 256");
}
