//! Polished textures: what one material per texel must fulfill.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

use upglow::{
    Accounting, AnalyticModel, Cube, DyeModel, DyeOptions, DyeSet, FilmModel, Fluorescence,
    Interpolation, Mixing, Model, ModelOnGrid, Node, QuantumYield,
};
use upglow_color::{Colorimetry, Contract, Grid, LinearRgb, Metric};
use upglow_fit::{FitOptions, Polisher, Preset, Unwatched, build_cube};

/// What counts as a match, ΔE00: a hundredth of a visible difference.
const EXACT: f64 = 0.01;

fn dyes(options: DyeOptions) -> Model {
    Model::Dyes(DyeModel::new(DyeSet::named("konig8").unwrap(), options).unwrap())
}

fn film(accounting: Accounting, quantum_yield: QuantumYield) -> Model {
    let set = DyeSet::named("konig8").unwrap();
    Model::Film(FilmModel::new(set, accounting, quantum_yield).unwrap())
}

fn models() -> [Model; 6] {
    let pigments = DyeOptions {
        accounting: Accounting::Photon,
        mixing: Mixing::Separate,
        optical_density: Some(4.0),
        ..DyeOptions::default()
    };
    [
        Model::Reflectance,
        dyes(DyeOptions::default()),
        dyes(pigments),
        Model::Analytic(AnalyticModel::default()),
        film(Accounting::Energy, QuantumYield::Fixed(1.0)),
        film(Accounting::Photon, QuantumYield::Measured),
    ]
}

fn cube(model: &Model, resolution: usize) -> Cube {
    let options = Preset::Konig2020.options();
    build_cube(&Contract::default(), model, options, resolution, &Unwatched).unwrap()
}

/// Steele's `SplitMix64`, 0..1.
fn random(count: usize) -> Vec<[f32; 3]> {
    let mut state = 1_u64;
    let mut unit = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1_u32 << 24) as f32
    };
    (0..count).map(|_| [unit(), unit(), unit()]).collect()
}

fn polished(polisher: &Polisher<'_>, rgb: &[[f32; 3]]) -> Vec<Node> {
    let mut out = vec![Node::default(); rgb.len()];
    assert_eq!(polisher.polish(rgb, &mut out), Ok(0));
    out
}

/// Measures the materials of texels.
struct Meter<'c> {
    cube: &'c Cube,
    colorimetry: Colorimetry,
    sums: ModelOnGrid,
}

impl<'c> Meter<'c> {
    fn new(cube: &'c Cube) -> Self {
        let colorimetry = cube.contract().on(Grid::FIT);
        Self { cube, sums: ModelOnGrid::new(cube.model(), &colorimetry), colorimetry }
    }

    fn de2000(&self, rgb: [f32; 3], node: &Node) -> f64 {
        let target = self.colorimetry.xyz_from_rgb(LinearRgb(rgb.map(f64::from)));
        let color = self.sums.color(node.material(self.cube.model()));
        Metric::De2000.distance(&self.colorimetry, target, color)
    }

    fn blend_de2000(&self, rgb: [f32; 3]) -> f64 {
        let rgb = LinearRgb(rgb.map(f64::from));
        let blend = self.cube.lookup(rgb, Interpolation::Blend).unwrap().color(&self.sums);
        let target = self.colorimetry.xyz_from_rgb(rgb);
        Metric::De2000.distance(&self.colorimetry, target, blend)
    }

    fn corners(&self, rgb: [f32; 3], holds: impl Fn(usize) -> bool) -> bool {
        let corners = self.cube.corners(LinearRgb(rgb.map(f64::from))).unwrap();
        corners.iter().all(|&(index, weight)| weight == 0.0 || holds(index))
    }

    fn corners_match(&self, rgb: [f32; 3]) -> bool {
        self.corners(rgb, |index| f64::from(self.cube.nodes()[index].de2000) <= EXACT)
    }
}

/// How well the materials of texels match.
#[derive(Debug, Default)]
struct Quality {
    exact: usize,
    corners_exact: usize,
    lost: usize,
    far: usize,
    mean: f64,
    blend_mean: f64,
    greatest: f64,
}

fn quality(meter: &Meter<'_>, rgb: &[[f32; 3]], nodes: &[Node]) -> Quality {
    let mut quality = Quality::default();
    for (&rgb, node) in rgb.iter().zip(nodes) {
        let (de2000, blend) = (meter.de2000(rgb, node), meter.blend_de2000(rgb));
        let corners_exact = meter.corners_match(rgb);
        quality.exact += usize::from(de2000 <= EXACT);
        quality.corners_exact += usize::from(corners_exact);
        quality.lost += usize::from(corners_exact && de2000 > EXACT);
        quality.far += usize::from(de2000 > blend + 0.5);
        quality.mean += de2000 / nodes.len() as f64;
        quality.blend_mean += blend / nodes.len() as f64;
        quality.greatest = quality.greatest.max(de2000 - blend);
    }
    quality
}

#[test]
fn where_the_corners_match_the_material_matches() {
    for model in models() {
        let cube = cube(&model, 10);
        let meter = Meter::new(&cube);
        let rgb = random(3000);
        let nodes = polished(&Polisher::new(&cube).unwrap(), &rgb);
        let quality = quality(&meter, &rgb, &nodes);
        println!("{}: {quality:?}", model.name());
        assert!(quality.corners_exact > 400);
        assert_eq!(quality.lost, 0, "{}", model.name());
    }
}

#[test]
fn a_miss_is_rarely_much_greater_than_that_of_the_blend() {
    for model in models() {
        let cube = cube(&model, 10);
        let rgb = random(3000);
        let nodes = polished(&Polisher::new(&cube).unwrap(), &rgb);
        let quality = quality(&Meter::new(&cube), &rgb, &nodes);
        assert!(quality.mean < quality.blend_mean, "{quality:?}");
        // A mixture of four reflectances reaches saturated colors that no single one does.
        let most = if model == Model::Reflectance { 120 } else { 40 };
        assert!(quality.far < most, "{quality:?}");
        assert!(quality.exact > quality.corners_exact, "{quality:?}");
    }
}

#[test]
fn every_material_keeps_the_limit_and_is_valid_for_the_model() {
    for model in models() {
        let cube = cube(&model, 6);
        let polisher = Polisher::new(&cube).unwrap();
        let meter = Meter::new(&cube);
        let limit = cube.fit().slope_max_per_nm.unwrap();
        let rgb = random(512);
        let mut fast = vec![Node::default(); rgb.len()];
        assert_eq!(polisher.interpolate(&rgb, &mut fast), Ok(0));
        for nodes in [polished(&polisher, &rgb), fast] {
            for (&rgb, node) in rgb.iter().zip(&nodes) {
                assert!(node.edge().to_sigmoid().steepest_slope_per_nm() <= limit, "{node:?}");
                let is_passive = node.material(&model).fluorescence == Fluorescence::None;
                let corner_glows = |i| cube.node_material(i).fluorescence != Fluorescence::None;
                assert!(is_passive || !meter.corners(rgb, |i| !corner_glows(i)), "{rgb:?}");
            }
            let measured = |node: &Node| Node { de2000: 0.0, ..*node };
            let nodes = nodes.iter().map(measured).collect();
            let (contract, fit) = (cube.contract().clone(), cube.fit().clone());
            assert!(Cube::new(contract, model.clone(), fit, 8, nodes).is_ok());
        }
    }
}

#[test]
fn a_texel_is_no_steeper_than_its_kind_may_be_or_its_steepest_corner_is() {
    let options = FitOptions { relaxed: false, ..Preset::Natural.options() };
    let limits = [options.slope_max_per_nm, options.slope_under_dyes_per_nm].map(Option::unwrap);
    let (contract, model) = (Contract::default(), Preset::Natural.model());
    let cube = build_cube(&contract, &model, options, 10, &Unwatched).unwrap();
    let (polisher, rgb) = (Polisher::new(&cube).unwrap(), random(3000));
    let nodes = polished(&polisher, &rgb);
    let mut fast = vec![Node::default(); rgb.len()];
    assert_eq!(polisher.interpolate(&rgb, &mut fast), Ok(0));
    let slope = |node: &Node| f64::from(node.reflectance[2].abs());
    let mut beyond = 0;
    for (&rgb, node) in rgb.iter().chain(&rgb).zip(nodes.iter().chain(&fast)) {
        let glows = node.material(&model).fluorescence != Fluorescence::None;
        let limit = limits[usize::from(glows)];
        let corners = cube.corners(LinearRgb(rgb.map(f64::from))).unwrap();
        let used = corners.iter().filter(|(_, weight)| *weight > 0.0);
        let steepest = used.map(|&(index, _)| slope(&cube.nodes()[index])).fold(limit, f64::max);
        assert!(slope(node) <= steepest, "{rgb:?} {node:?}");
        beyond += usize::from(slope(node) > limit);
    }
    // Between nodes with dyes and nodes of steep reflectance alone.
    assert!(beyond > 10, "{beyond}");
    let quality = quality(&Meter::new(&cube), &rgb, &nodes);
    println!("{quality:?}");
    assert_eq!(quality.lost, 0);
}

#[test]
fn the_stored_difference_is_that_of_the_material_or_a_bound() {
    // Single precision of colors, times the slope of Lab in the dark, and of what is stored.
    const SINGLE: f64 = 2e-3;
    for model in models() {
        let cube = cube(&model, 8);
        let meter = Meter::new(&cube);
        let rgb = random(2000);
        for (&rgb, node) in rgb.iter().zip(polished(&Polisher::new(&cube).unwrap(), &rgb)) {
            let (stored, found) = (f64::from(node.de2000), meter.de2000(rgb, &node));
            assert!(found <= stored + SINGLE, "{rgb:?} {found} {node:?}");
            assert!(stored <= EXACT || stored <= found + SINGLE, "{rgb:?} {found} {node:?}");
        }
    }
}

#[test]
fn grays_are_flat_and_do_not_fluoresce() {
    let cube = cube(&dyes(DyeOptions::default()), 7);
    let polisher = Polisher::new(&cube).unwrap();
    let grays: Vec<[f32; 3]> = (0..=100_u8).map(|i| [f32::from(i) / 100.0; 3]).collect();
    let mut fast = vec![Node::default(); grays.len()];
    assert_eq!(polisher.interpolate(&grays, &mut fast), Ok(0));
    for nodes in [polished(&polisher, &grays), fast] {
        for ([value, ..], node) in grays.iter().zip(nodes) {
            let material = node.material(cube.model());
            assert_eq!(material.fluorescence, Fluorescence::None);
            assert_eq!(node.edge().slope_per_nm, 0.0);
            // Single precision of the level, which is near 1e4 in the dark.
            assert!((material.reflectance.at(550.0) - f64::from(*value)).abs() < 1e-6);
        }
    }
}

/// The share of the light at the absorption's peak that is absorbed, the peaks of two dyes in a film taken
/// as one.
fn absorbed(fluorescence: &Fluorescence) -> f64 {
    match fluorescence {
        Fluorescence::Film { .. } => 1.0 - 10_f64.powf(-fluorescence.dose()),
        _ => fluorescence.dose(),
    }
}

#[test]
fn similar_colors_get_similar_materials() {
    // With yields below 1, no film matches the end of the line.
    let films = [Accounting::Energy, Accounting::Photon].map(|a| film(a, QuantumYield::Fixed(1.0)));
    for model in [dyes(DyeOptions::default())].into_iter().chain(films) {
        let cube = cube(&model, 10);
        let polisher = Polisher::new(&cube).unwrap();
        // From a soft green to a saturated magenta, which fluoresces.
        let at = |share: f32| [0.1 + 0.75 * share, 0.4 - 0.35 * share, 0.1 + 0.75 * share];
        let rgb: Vec<[f32; 3]> = (0..=4000_u16).map(|i| at(f32::from(i) / 4000.0)).collect();
        let nodes = polished(&polisher, &rgb);
        let leaps = nodes.windows(2).filter(|pair| {
            let [a, b] = [&pair[0], &pair[1]].map(|node| node.material(cube.model()));
            let change = |nm: f64| (a.reflectance.at(nm) - b.reflectance.at(nm)).abs();
            let glow = absorbed(&a.fluorescence) - absorbed(&b.fluorescence);
            // A step of the line is 2e-4 in RGB; a leap is a hundred times that.
            [450.0, 500.0, 550.0, 600.0, 650.0].into_iter().any(|nm| change(nm) > 0.02)
                || glow.abs() > 0.02
        });
        let leaps = leaps.count();
        println!("{}: {leaps} leaps", model.name());
        // The line crosses some twenty cells, and dyes change a few times.
        assert!(leaps <= 10, "{leaps}");
    }
}

#[test]
fn results_do_not_depend_on_batches() {
    for model in models() {
        let cube = cube(&model, 6);
        let polisher = Polisher::new(&cube).unwrap();
        // Each color twice, so that one of them is a repeat.
        let rgb = [random(300), random(300)].concat();
        let whole = polished(&polisher, &rgb);
        for size in [1, 7, 64] {
            let parts: Vec<Node> =
                rgb.chunks(size).flat_map(|part| polished(&polisher, part)).collect();
            assert_eq!(parts, whole);
        }
    }
}

#[test]
fn colors_outside_have_no_material_and_are_counted() {
    let cube = cube(&Model::Reflectance, 3);
    let polisher = Polisher::new(&cube).unwrap();
    let rgb = [
        [0.5, 0.4, 0.3],
        [f32::NAN, 0.5, 0.5],
        [-1e-9, 0.5, 0.5],
        [0.5, 1.0 + f32::EPSILON, 0.5],
        [0.5, 0.5, f32::INFINITY],
        [1.0, 1.0, 0.0],
    ];
    let is_nowhere = |node: &Node| node.reflectance.iter().all(|v| v.is_nan());
    let mut out = [Node::default(); 6];
    let mut fast = out;
    assert_eq!(polisher.polish(&rgb, &mut out), Ok(4));
    assert_eq!(polisher.interpolate(&rgb, &mut fast), Ok(4));
    for nodes in [out, fast] {
        assert_eq!(nodes.map(|node| is_nowhere(&node)), [false, true, true, true, true, false]);
    }
    assert!(out[0].de2000 < 1.0 && out[1].de2000.is_nan());
    assert_eq!(
        polisher.polish(&rgb, &mut out[1..]).unwrap_err().to_string(),
        "room for 5 colors, expected 6, one for each RGB"
    );
}

#[test]
fn a_cube_without_a_limit_is_polished_too() {
    let options = Preset::Konig2020.options().with_slope_max_per_nm(None);
    let (contract, model) = (Contract::default(), dyes(DyeOptions::default()));
    let cube = build_cube(&contract, &model, options, 8, &Unwatched).unwrap();
    let rgb = random(2000);
    let nodes = polished(&Polisher::new(&cube).unwrap(), &rgb);
    let quality = quality(&Meter::new(&cube), &rgb, &nodes);
    println!("{quality:?}");
    assert!(quality.lost <= 20 && quality.mean < quality.blend_mean, "{quality:?}");
}

/// Shares of matches as found with 20,000 random colors, with a margin for other sequences.
#[test]
#[ignore = "slow"]
fn slow_the_default_cube_is_polished_as_well_as_it_is_fitted() {
    for (model, exact) in models().into_iter().zip([0.36, 0.77, 0.86, 0.80, 0.94, 0.94]) {
        let cube = cube(&model, 32);
        let rgb = random(20_000);
        let nodes = polished(&Polisher::new(&cube).unwrap(), &rgb);
        let quality = quality(&Meter::new(&cube), &rgb, &nodes);
        println!("{}: {quality:?}", model.name());
        assert_eq!(quality.lost, 0, "{}", model.name());
        assert!(quality.exact as f64 > exact * 20_000.0 && quality.mean < quality.blend_mean);
    }
}
