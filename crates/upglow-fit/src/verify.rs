//! Verifies what a cube promises, from its stored numbers alone.

mod finding;
mod inspector;
mod laws;
mod report;
mod spectra;
mod subjects;

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use upglow::{Cube, DyeCurves, Interpolation, Model};

pub use report::{Check, Offender, Stopped, Verdict, VerifyReport};
pub use subjects::random_rgb;

use crate::cube::Spread;
use crate::fitter::Fitter;
use crate::kind::{KindCounts, MaterialKind};
use crate::options::FitOptions;
use crate::progress::{Progress, Watch};
use crate::seams::seams;
use inspector::{Figure, Findings, Inspector};
use laws::{Law, verdict};
use spectra::Spectra;

/// How a cube is verified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VerifyOptions {
    /// Number of random colors; default 1,000,000. Each takes 40 bytes, and 15 µs on one core.
    pub points: usize,
    /// How colors between nodes are interpolated; default blend.
    pub interpolation: Interpolation,
    /// Seed of the random colors; default 0.
    pub seed: u64,
}

impl Default for VerifyOptions {
    fn default() -> Self {
        Self { points: 1_000_000, interpolation: Interpolation::default(), seed: 0 }
    }
}

/// Greatest mean CIEDE2000 between sums over 5 nm and over 1 nm, of materials that match their colors. A
/// larger one means that renderers get other colors than the fit; sums over 5 nm cannot do better.
///
/// Materials that miss have no such limit. For colors out of reach the best is nearly a step, with the
/// greatest slope of any fit, 0.2/nm, which rises within two samples of 5 nm. By how much it misses is then
/// uncertain by tenths of a ΔE00; it is reported apart, as nobody is promised that color.
const GRID_LIMIT: f64 = 0.05;

/// Checks every node, 1001 grays and `options.points` random colors against the laws, on all
/// threads of the current rayon pool.
///
/// Spectra are sampled at every nanometer from 300 to 830 nm. The report does not depend on the number
/// of threads. The laws of spectra apply to every interpolation, but those that interpolate parameters
/// instead of materials, which are all but blend and none, may break them.
///
/// # Errors
///
/// [`Stopped`] if `watch` stopped the work.
pub fn verify(
    cube: &Cube,
    options: &VerifyOptions,
    watch: &dyn Watch,
) -> Result<VerifyReport, Stopped> {
    let inspector = Inspector::new(cube, options);
    let subjects = &inspector.subjects;
    let done = AtomicUsize::new(0);
    let pieces: Vec<Findings> = (0..subjects.pieces())
        .into_par_iter()
        .map_init(Spectra::new, |spectra, piece| {
            if watch.stopped() {
                return Err(Stopped);
            }
            let findings = inspector.inspect(piece, spectra);
            let count = subjects.piece(piece).len();
            let done = done.fetch_add(count, Ordering::Relaxed) + count;
            watch.progress(Progress { stage: "verifying", done, total: subjects.len() });
            Ok(findings)
        })
        .collect::<Result<_, _>>()?;
    let mut findings = Findings::default();
    pieces.into_iter().for_each(|piece| findings.add(piece));
    let checks = checks(cube, &inspector, findings);
    Ok(VerifyReport { nodes: cube.nodes().len(), points: options.points, checks })
}

fn checks(cube: &Cube, inspector: &Inspector<'_>, findings: Findings) -> Vec<Check> {
    let between_exact = between_exact(inspector, &findings);
    let laws = inspector.rules.iter().zip(findings.laws);
    let mut checks: Vec<Check> = laws.map(|(rule, outcome)| rule.check(outcome, cube)).collect();
    checks.push(dye_curves(cube.model()));
    checks.extend(grid_checks(GRID_NODES, findings.grid_nodes, Some(GRID_LIMIT), cube));
    checks.extend(grid_checks(GRID_POINTS, findings.grid_points, Some(GRID_LIMIT), cube));
    checks.extend(grid_checks(GRID_MISSED, findings.grid_missed, None, cube));
    checks.extend(point_figures(findings.points, cube));
    checks.push(between_exact);
    checks.extend(kinds(cube));
    checks.extend(dose_over_least(cube));
    checks.extend(seam_figures(cube));
    checks
}

/// Nodes for which a smaller dose is looked for.
const DOSES_COMPARED: usize = 64;

/// The greatest dose of a node over that of a fit of its color by itself, of nodes spread over the cube
/// that have dyes and match; nothing if the options of the fit are not known.
fn dose_over_least(cube: &Cube) -> Option<Check> {
    let options = FitOptions::try_from(cube.fit()).ok()?;
    let fitter = Fitter::new(cube.contract(), cube.model(), options).ok()?;
    let nodes = cube.nodes();
    let is_dyed = |&i: &usize| MaterialKind::of_node(&nodes[i], cube) == MaterialKind::Dyed;
    let dyed: Vec<usize> = (0..nodes.len()).filter(is_dyed).collect();
    let step = dyed.len().div_ceil(DOSES_COMPARED).max(1);
    let ratios: Vec<f64> = dyed
        .iter()
        .step_by(step)
        .filter_map(|&index| {
            let fit = fitter.fit(cube.node_rgb(index)).ok()?;
            let dose = cube.node_material(index).fluorescence.dose();
            let is_dyed = MaterialKind::of_fit(&fit, cube.fit()) == MaterialKind::Dyed;
            is_dyed.then(|| dose / fit.fluorescence.dose())
        })
        .collect();
    let about =
        "greatest dose of a node over that of its color fitted by itself, on a sample of nodes";
    let most = ratios.iter().copied().fold(0.0, f64::max);
    Some(figure(["dose-over-least", about, ""], most, ratios.len()))
}

/// The seams of gradients under other lights: the number that one in ten exceeds, and the greatest.
fn seam_figures(cube: &Cube) -> Vec<Check> {
    const NAMES: [[&str; 2]; 3] = [
        ["seams-a-p90", "seams-a-worst"],
        ["seams-led-b3-p90", "seams-led-b3-worst"],
        ["seams-uv-lamp-p90", "seams-uv-lamp-worst"],
    ];
    const ABOUT: [&str; 2] = [
        "greatest step of a gradient under this light over that under the cube's: one in ten has more",
        "the same of the gradient with the strongest seam",
    ];
    let found = seams(cube).into_iter().zip(NAMES);
    found
        .flat_map(|(seam, names)| {
            [(names[0], ABOUT[0], seam.p90), (names[1], ABOUT[1], seam.worst)]
                .map(|(name, about, value)| figure([name, about, ""], value, seam.gradients))
        })
        .collect()
}

/// The share of nodes of each kind of material.
fn kinds(cube: &Cube) -> [Check; 4] {
    let nodes = cube.nodes().len();
    let kinds: KindCounts =
        cube.nodes().iter().map(|node| MaterialKind::of_node(node, cube)).collect();
    let share = |count: u64| count as f64 / nodes as f64;
    [
        ("nodes-reflectance", "share of nodes matched by reflectance alone", kinds.reflectance),
        ("nodes-dyed", "share of nodes matched with dyes within the slope limit", kinds.dyed),
        ("nodes-steep", "share of nodes matched by steeper reflectances", kinds.steep),
        ("nodes-missed", "share of nodes that miss their colors", kinds.missed),
    ]
    .map(|(name, about, count)| figure([name, about, ""], share(count), nodes))
}

/// The share of random colors for which blend promises to be exact.
fn between_exact(inspector: &Inspector<'_>, findings: &Findings) -> Check {
    let law = Law::Exact as usize;
    let points = if inspector.rules[law].applies { findings.points.values.len() } else { 0 };
    let share = findings.laws[law].checked as f64 / points.max(1) as f64;
    let texts = ["points-between-exact", "share of random colors whose nodes are all exact", ""];
    figure(texts, share, points)
}

/// A number that is only reported; `texts` are name, description and unit.
fn figure([name, about, unit]: [&'static str; 3], value: f64, checked: usize) -> Check {
    let verdict = verdict(None, checked, 0);
    Check { name, about, verdict, value, limit: None, unit, checked, violations: 0, worst: None }
}

/// Texts of a mean and of a greatest value.
type MeanAndMax = [[&'static str; 3]; 2];

const GRID_NODES: MeanAndMax = [
    ["grid-nodes-mean", "exact nodes, sums over 1 nm against 5 nm, mean", "CIEDE2000"],
    ["grid-nodes-max", "exact nodes, sums over 1 nm against 5 nm, greatest", "CIEDE2000"],
];
const GRID_POINTS: MeanAndMax = [
    ["grid-points-mean", "colors between exact nodes, 1 nm against 5 nm, mean", "CIEDE2000"],
    ["grid-points-max", "colors between exact nodes, 1 nm against 5 nm, greatest", "CIEDE2000"],
];
const GRID_MISSED: MeanAndMax = [
    ["grid-missed-mean", "other nodes and colors, 1 nm against 5 nm, mean", "CIEDE2000"],
    ["grid-missed-max", "other nodes and colors, 1 nm against 5 nm, greatest", "CIEDE2000"],
];
const POINTS: [[&str; 3]; 3] = [
    ["points-mean", "random colors against their targets, mean", "CIEDE2000"],
    ["points-p95", "random colors against their targets, 95 in 100 are within", "CIEDE2000"],
    ["points-max", "random colors against their targets, greatest", "CIEDE2000"],
];

fn grid_checks(
    [mean, max]: MeanAndMax,
    found: Figure,
    limit: Option<f64>,
    cube: &Cube,
) -> [Check; 2] {
    let worst = found.outcome.worst.map(|worst| worst.offender(cube));
    let spread = Spread::of(found.values);
    let checked = found.outcome.checked;
    let is_broken = |limit| spread.mean.is_nan() || spread.mean > limit;
    let violations = usize::from(limit.is_some_and(is_broken));
    let mean = Check {
        verdict: verdict(limit, checked, violations),
        limit,
        violations,
        ..figure(mean, spread.mean, checked)
    };
    [mean, Check { worst, ..figure(max, spread.max, checked) }]
}

fn point_figures(found: Figure, cube: &Cube) -> [Check; 3] {
    let worst = found.outcome.worst.map(|worst| worst.offender(cube));
    let spread = Spread::of(found.values);
    let [mean, p95, max] = POINTS;
    let of = |texts, value| figure(texts, value, found.outcome.checked);
    [of(mean, spread.mean), of(p95, spread.p95), Check { worst, ..of(max, spread.max) }]
}

/// The curves that all materials share: absorption in 0 to 1, emission of 0 or more and unit area.
fn dye_curves(model: &Model) -> Check {
    /// Rounding of a sum of 531 numbers.
    const LIMIT: f64 = 1e-9;
    let about = "how far absorption lies outside 0 to 1, emission below 0, its area from 1";
    let dyes: Vec<_> = model
        .dyes()
        .into_iter()
        .flat_map(|dyes| dyes.curves().iter().zip(dyes.set().dyes()))
        .collect();
    let faults: Vec<f64> = dyes.iter().map(|(curves, _)| curve_fault(curves)).collect();
    let violations = faults.iter().filter(|&&fault| fault > LIMIT).count();
    let (found, at) = finding::greatest(faults.iter().copied());
    let worst = dyes.get(at).map(|(_, dye)| {
        let dye = Some(dye.name.clone());
        Offender { found, wavelength_nm: None, node: None, rgb: None, dye }
    });
    Check {
        verdict: verdict(Some(LIMIT), dyes.len(), violations),
        limit: Some(LIMIT),
        violations,
        worst,
        ..figure(["dye-curves", about, ""], found.max(0.0), dyes.len())
    }
}

/// The greatest amount by which the curves of a dye violate that.
fn curve_fault(curves: &DyeCurves) -> f64 {
    let absorption = curves.absorption.values().iter().map(|&a| (a - 1.0).max(-a));
    let emission = curves.emission.values().iter().map(|e| -e);
    let area = (curves.emission.integral() - 1.0).abs();
    absorption.chain(emission).fold(area, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cube::build_cube;
    use crate::preset::Preset;
    use crate::progress::Unwatched;
    use upglow::{
        Accounting, AnalyticModel, DyeModel, DyeOptions, DyeSet, Edge, FilmModel, FitRecord,
        Fluorescence, Mixing, ModelOnGrid, Node, QuantumYield, Sigmoid,
    };
    use upglow_color::{
        Adaptation, Contract, Grid, Illuminant, LinearRgb, Metric, Observer, Spectrum,
    };

    const RESOLUTION: usize = 4;
    const OPTIONS: VerifyOptions =
        VerifyOptions { points: 3000, interpolation: Interpolation::Blend, seed: 5 };
    /// Indices of the node `[1][0][2]`, which is not gray, of the gray `[1][1][1]`, and of white.
    const COLORED: usize = 18;
    const GRAY: usize = 21;
    const WHITE: usize = 63;

    fn dyes() -> Model {
        let options = DyeOptions {
            accounting: Accounting::Photon,
            mixing: Mixing::Separate,
            quantum_yield: QuantumYield::Measured,
            optical_density: Some(2.0),
        };
        Model::Dyes(DyeModel::new(DyeSet::named("konig8").unwrap(), options).unwrap())
    }

    fn film(accounting: Accounting) -> Model {
        let set = DyeSet::named("konig8").unwrap();
        Model::Film(FilmModel::new(set, accounting, QuantumYield::Measured).unwrap())
    }

    /// A flat reflectance for grays; an edge, with some fluorescence, for other colors.
    fn material(LinearRgb([r, g, b]): LinearRgb, model: &Model) -> (Edge, Fluorescence) {
        let flat = Sigmoid::flat((r + g + b) / 3.0).to_edge(550.0);
        if r == g && g == b {
            return (flat, Fluorescence::None);
        }
        let level = flat.level.clamp(-2.0, 2.0);
        let edge = Edge { edge_nm: 450.0 + 200.0 * r, level, slope_per_nm: 0.0099 * (r - b) };
        let fluorescence = match model {
            Model::Reflectance => Fluorescence::None,
            Model::Film(_) => {
                Fluorescence::film((if r < 0.5 { 2 } else { 7 }, 1.5 * b), (5, 0.5 * g))
            }
            Model::Dyes(_) => Fluorescence::Dyes {
                first: if r < 0.5 { 2 } else { 7 },
                weight: g,
                concentration: b,
            },
            Model::Analytic(_) => Fluorescence::Analytic {
                emission_peak_nm: 450.0 + 200.0 * g,
                stokes_shift_nm: 60.0,
                concentration: r,
            },
        };
        (edge, fluorescence)
    }

    /// A cube of such materials, each changed by `change`.
    fn cube(contract: Contract, model: Model, change: impl Fn(usize, &mut Node)) -> Cube {
        let colorimetry = contract.on(Grid::FIT);
        let sums = ModelOnGrid::new(&model, &colorimetry);
        let fit = FitRecord { slope_max_per_nm: Some(0.01), ..FitRecord::default() };
        let empty = vec![Node::default(); RESOLUTION.pow(3)];
        let frame = Cube::new(contract.clone(), model.clone(), fit.clone(), RESOLUTION, empty);
        let frame = frame.unwrap();
        let node = |index: usize| {
            let rgb = frame.node_rgb(index);
            let (edge, fluorescence) = material(rgb, &model);
            let mut node = Node::new(edge, fluorescence, 0.0);
            change(index, &mut node);
            let (target, color) =
                (colorimetry.xyz_from_rgb(rgb), sums.color(node.material(&model)));
            let de2000 = Metric::De2000.distance(&colorimetry, target, color);
            // The change may make it NaN, which is not stored.
            node.de2000 += Node::new(edge, fluorescence, de2000.max(0.0)).de2000;
            node
        };
        let nodes = (0..RESOLUTION.pow(3)).map(node).collect();
        Cube::new(contract, model, fit, RESOLUTION, nodes).unwrap()
    }

    fn report(cube: &Cube) -> VerifyReport {
        verify(cube, &OPTIONS, &Unwatched).unwrap()
    }

    /// The laws that are broken in a cube with one changed node, and their worst values.
    fn broken(index: usize, change: impl Fn(&mut Node)) -> Vec<(&'static str, Offender)> {
        let cube = cube(Contract::default(), dyes(), |i, node| {
            if i == index {
                change(node);
            }
        });
        let report = report(&cube);
        assert!(!report.holds());
        // Means have no worst value.
        report.broken().filter_map(|check| Some((check.name, check.worst.clone()?))).collect()
    }

    #[test]
    fn valid_cubes_of_all_models_keep_every_law() {
        let analytic = Model::Analytic(AnalyticModel::default());
        let films = [Accounting::Energy, Accounting::Photon].map(film);
        for model in [Model::Reflectance, analytic, dyes()].into_iter().chain(films) {
            let cube = cube(Contract::default(), model, |_, _| {});
            let report = report(&cube);
            assert!(report.holds(), "{:#?}", report.broken().collect::<Vec<_>>());
            let energy = report.check("energy").unwrap();
            assert_eq!((energy.checked, energy.verdict), (64 + 1001 + 3000, Verdict::Holds));
            assert_eq!(report.check("white-black").unwrap().checked, 2);
        }
    }

    #[test]
    fn sums_over_5_nm_are_close_to_those_over_1_nm_under_a_lamp_with_lines() {
        let line = |nm: f64, peak_nm: f64| (-((nm - peak_nm) / 0.9).powi(2)).exp();
        let mercury = [365.0, 404.7, 435.8, 546.1, 577.0, 579.1];
        let power = Grid::FINE
            .wavelengths_nm()
            .map(|nm| 0.01 + mercury.iter().map(|&peak_nm| line(nm, peak_nm)).sum::<f64>());
        let power = Spectrum::new(Grid::FINE, power.collect()).unwrap();
        let illuminant = Illuminant::from_spectrum("mercury", &power).unwrap();
        let contract = Contract { illuminant, ..Contract::default() };
        for model in [Model::Reflectance, Model::Analytic(AnalyticModel::default()), dyes()] {
            let report = report(&cube(contract.clone(), model, |_, _| {}));
            assert!(report.holds(), "{:#?}", report.broken().collect::<Vec<_>>());
            // Few of these materials match; all have slopes that fits without relaxed limits may have.
            for name in ["grid-nodes-mean", "grid-points-mean", "grid-missed-mean"] {
                let mean = report.check(name).unwrap().value;
                assert!(mean <= GRID_LIMIT, "{name} {mean}");
            }
        }
    }

    #[test]
    fn a_cube_keeps_every_law_although_most_of_its_colors_are_out_of_reach() {
        let bell = |peak_nm: f64| {
            let seen = |nm: f64| if (380.0..=780.0).contains(&nm) { 1.0 } else { 0.0 };
            let value = |nm: f64| seen(nm) * (-((nm - peak_nm) / 45.0).powi(2)).exp();
            let values = Grid::FINE.wavelengths_nm().map(value).collect();
            Spectrum::new(Grid::FINE, values).unwrap()
        };
        let bells = Observer::from_spectra("bells", [600.0, 555.0, 450.0].map(bell)).unwrap();
        let contract = Contract { observer: bells, ..Contract::default() };
        let options = Preset::Natural.options();
        let cube =
            build_cube(&contract, &Model::Reflectance, options, RESOLUTION, &Unwatched).unwrap();
        let report = report(&cube);
        assert!(report.holds(), "{:#?}", report.broken().collect::<Vec<_>>());
        let of_misses = report.check("grid-missed-mean").unwrap();
        assert_eq!(of_misses.verdict, Verdict::Reported);
        assert!(of_misses.value > GRID_LIMIT, "{}", of_misses.value);
    }

    #[test]
    fn materials_that_match_only_by_sums_over_5_nm_are_caught() {
        // A step near one of two samples of 5 nm, for which it is in the middle. The nodes claim to match.
        let step = Node { reflectance: [554.5, 0.0, 50.0], ..Node::default() };
        let (contract, fit) = (Contract::default(), FitRecord::default());
        let nodes = vec![step; RESOLUTION.pow(3)];
        let cube = Cube::new(contract, Model::Reflectance, fit, RESOLUTION, nodes).unwrap();
        let report = report(&cube);
        for name in ["grid-nodes-mean", "grid-points-mean"] {
            assert_eq!(report.check(name).unwrap().verdict, Verdict::Broken, "{name}");
        }
    }

    #[test]
    fn a_slope_above_the_limit_is_caught_and_named() {
        let found = broken(COLORED, |node| node.reflectance[2] = 0.010_001);
        let rgb = LinearRgb([2.0 / 3.0, 0.0, 1.0 / 3.0]);
        let [("slope", worst)] = &found[..] else { panic!("{found:?}") };
        assert_eq!((worst.node, worst.rgb), (Some([1, 0, 2]), Some(rgb)));
    }

    /// The valid cube with other limits.
    fn limited(slope_max_per_nm: f64, under_dyes_per_nm: f64, relaxed: bool) -> Cube {
        let honest = cube(Contract::default(), dyes(), |_, _| {});
        let fit = FitRecord {
            slope_max_per_nm: Some(slope_max_per_nm),
            slope_under_dyes_per_nm: Some(under_dyes_per_nm),
            relaxed,
            ..FitRecord::default()
        };
        let nodes = honest.nodes().to_vec();
        Cube::new(honest.contract().clone(), dyes(), fit, RESOLUTION, nodes).unwrap()
    }

    #[test]
    fn a_slope_above_the_limit_under_dyes_is_caught_unless_the_limits_are_relaxed() {
        let found = report(&limited(0.02, 0.009, false));
        let broken: Vec<_> = found.broken().map(|check| check.name).collect();
        assert_eq!(broken, ["slope-under-dyes"]);
        assert!(report(&limited(0.02, 0.01, false)).holds());
        let relaxed = report(&limited(0.005, 0.004, true));
        assert!(relaxed.holds());
        assert_eq!(relaxed.check("slope").unwrap().limit, Some(0.2));
        let under_dyes = relaxed.check("slope-under-dyes").unwrap();
        assert_eq!(under_dyes.verdict, Verdict::NotApplicable);
    }

    #[test]
    fn kinds_of_nodes_add_up() {
        let found = report(&limited(0.02, 0.009, true));
        let share = |name| found.check(name).unwrap().value;
        let kinds = ["nodes-reflectance", "nodes-dyed", "nodes-steep", "nodes-missed"].map(share);
        // Rounding only.
        assert!((kinds.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{kinds:?}");
        // The four grays match; the made-up materials of other colors do not.
        assert_eq!(kinds[0], 4.0 / 64.0);
    }

    #[test]
    fn a_tinted_gray_is_caught() {
        let found = broken(GRAY, |node| node.reflectance[2] = 1e-5);
        assert_eq!(found.iter().map(|f| f.0).collect::<Vec<_>>(), ["gray-flat", "gray-value"]);
    }

    #[test]
    fn a_fluorescent_gray_is_caught() {
        let found = broken(GRAY, |node| node.fluorescence = [0.5, 0.1, 0.0]);
        assert_eq!(found[0].0, "gray-passive");
    }

    #[test]
    fn a_white_that_is_not_quite_white_is_caught() {
        let found = broken(WHITE, |node| node.reflectance[1] = 1000.0);
        let white = LinearRgb([1.0; 3]);
        let [("white-black", worst)] = &found[..] else { panic!("{found:?}") };
        assert_eq!((worst.node, worst.rgb), (Some([3; 3]), Some(white)));
    }

    #[test]
    fn a_wrong_stored_difference_is_caught() {
        let found = broken(COLORED, |node| node.de2000 = 0.01);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].0, "stored-difference");
    }

    #[test]
    fn nodes_with_a_false_difference_of_0_are_caught_and_so_are_colors_between_them() {
        let honest = cube(Contract::default(), dyes(), |_, _| {});
        let nodes = honest.nodes().iter().map(|node| Node { de2000: 0.0, ..*node }).collect();
        let (contract, fit) = (honest.contract().clone(), honest.fit().clone());
        let liar = Cube::new(contract, dyes(), fit, RESOLUTION, nodes).unwrap();
        let report = report(&liar);
        assert_eq!(report.check("exact").unwrap().verdict, Verdict::Broken);
        assert_eq!(report.check("points-between-exact").unwrap().value, 1.0);
    }

    #[test]
    fn the_greatest_numbers_break_no_law_of_light_and_cause_no_panic() {
        let found = broken(COLORED, |node| node.reflectance = [1e18, 1e10, 1e3]);
        assert_eq!(found[0].0, "slope");
        for [edge_nm, level, slope_per_nm] in [[1e19, 0.0, 0.0], [0.0, 1e11, 0.0], [0.0, 0.0, 1e4]]
        {
            let reflectance = [edge_nm, level, slope_per_nm];
            let nodes = vec![Node { reflectance, ..Node::default() }; 8];
            let fit = FitRecord::default();
            assert!(Cube::new(Contract::default(), dyes(), fit, 2, nodes).is_err());
        }
    }

    #[test]
    fn without_adaptation_the_laws_of_grays_do_not_apply() {
        let contract = Contract { adaptation: Adaptation::None, ..Contract::default() };
        let report = report(&cube(contract, dyes(), |_, _| {}));
        for name in ["gray-flat", "gray-passive", "gray-value", "white-black"] {
            assert_eq!(report.check(name).unwrap().verdict, Verdict::NotApplicable);
        }
    }

    #[test]
    fn the_report_does_not_depend_on_the_number_of_threads() {
        let cube = cube(Contract::default(), dyes(), |_, _| {});
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| report(&cube))
        };
        assert_eq!(with(1), with(3));
    }

    #[test]
    fn a_watcher_stops_the_work() {
        struct Impatient;
        impl Watch for Impatient {
            fn progress(&self, _: Progress) {}
            fn stopped(&self) -> bool {
                true
            }
        }
        let cube = cube(Contract::default(), Model::Reflectance, |_, _| {});
        assert_eq!(verify(&cube, &OPTIONS, &Impatient), Err(Stopped));
    }
}
