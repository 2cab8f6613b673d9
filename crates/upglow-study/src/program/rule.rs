//! Which colors get a dye by the rule of choosing, and how much more of it than the least.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use serde::Serialize;
use upglow::{Cube, Fluorescence, Interpolation, Material};
use upglow_color::{
    Adaptation, Contract, Grid, LinearRgb, RgbSpace, Xyz, lab_from_xyz, srgb_decoded,
};
use upglow_fit::{
    BuildError, FitOptions, Fitter, MaterialKind, Method, Preset, Progress, Watch, build_cube,
    random_rgb,
};

use crate::samples::{Sample, SampleSet, pointers_border};
use crate::spread::Spread;
use crate::ways::OneColor;

/// Seed of the random colors and nodes.
const SEED: u64 = 0;

/// How many of some colors have a dye.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Dyed {
    pub(crate) colors: &'static str,
    pub(crate) count: usize,
    pub(crate) dyed: usize,
    /// The lightness L* of the lightest color with a dye; 0 if there is none.
    pub(crate) lightest: f64,
}

impl Dyed {
    /// From each color, under D65, and whether its material has a dye.
    fn new(colors: &'static str, found: &[(Xyz, bool)]) -> Self {
        let white = Contract::default().on(Grid::FIT).white();
        let glowing = found.iter().filter(|(_, glows)| *glows);
        let lightness = glowing.map(|(color, _)| lab_from_xyz(*color, white).l);
        let (dyed, lightest) =
            lightness.fold((0, 0.0), |(dyed, most), l| (dyed + 1, f64::max(most, l)));
        Self { colors, count: found.len(), dyed, lightest }
    }
}

/// A contract that differs from the default in the RGB space.
fn contract_of(space: &str) -> Contract {
    let space = RgbSpace::named(space).expect("the space is built in");
    Contract { space, ..Contract::default() }
}

/// A contract in which every color has an RGB: some colors of surfaces lie outside of ACEScg.
pub(crate) fn contract_of_every_color() -> Contract {
    Contract { adaptation: Adaptation::None, ..contract_of("xyz") }
}

/// A cube of a preset for an RGB space.
///
/// # Errors
///
/// [`BuildError`] if the resolution is out of range or `watch` stopped the work.
pub(crate) fn cube(
    preset: Preset,
    space: &str,
    resolution: usize,
    watch: &dyn Watch,
) -> Result<Cube, BuildError> {
    build_cube(&contract_of(space), &preset.model(), preset.options(), resolution, watch)
}

/// The colors of surfaces, and random ones of sRGB, under D65, by name.
pub(crate) fn colors(random: usize) -> [(&'static str, Vec<Xyz>); 4] {
    let d65 = Contract::default();
    let white = d65.on(Grid::FIT).white();
    let [objects, paints] = [SampleSet::object_colors(), SampleSet::paints()].map(|set| {
        let color = |sample: &Sample| sample.color(&d65.illuminant, white);
        (set.name, set.samples.iter().map(color).collect())
    });
    let srgb = contract_of("srgb").on(Grid::FIT);
    let random = random_srgb(random).map(|rgb| srgb.xyz_from_rgb(rgb)).collect();
    [
        objects,
        paints,
        ("border of Pointer's gamut", pointers_border(&d65)),
        ("random 8-bit sRGB", random),
    ]
}

/// Which of some colors get a dye, each fitted by itself.
pub(crate) fn dyed_alone((name, colors): &(&'static str, Vec<Xyz>), way: &OneColor) -> Dyed {
    let glows = |color: &Xyz| way.fit(*color).fluorescence != Fluorescence::None;
    let found: Vec<_> = colors.par_iter().map(|color| (*color, glows(color))).collect();
    Dyed::new(name, &found)
}

/// Random 8-bit colors of sRGB.
fn random_srgb(count: usize) -> impl Iterator<Item = LinearRgb> {
    const CODES: f64 = 256.0;
    let decoded = |v: f64| srgb_decoded((v * CODES).floor() / (CODES - 1.0));
    (0..count).map(move |index| LinearRgb(random_rgb(SEED, index).0.map(decoded)))
}

/// The nodes of a cube for sRGB.
pub(crate) fn dyed_nodes(srgb: &Cube) -> Dyed {
    let space = srgb.contract().on(Grid::FIT);
    let found = (0..srgb.nodes().len()).map(|index| {
        let glows = srgb.node_material(index).fluorescence != Fluorescence::None;
        (space.xyz_from_rgb(srgb.node_rgb(index)), glows)
    });
    Dyed::new("nodes of the sRGB cube", &found.collect::<Vec<_>>())
}

/// Random colors of sRGB looked up in a cube for a wider space: a mixture has a dye if one of its
/// materials has.
pub(crate) fn dyed_by_look_up(wide: &Cube, count: usize) -> Dyed {
    let [srgb, space] =
        [&contract_of("srgb"), wide.contract()].map(|contract| contract.on(Grid::FIT));
    let found = random_srgb(count).map(|rgb| {
        let color = srgb.xyz_from_rgb(rgb);
        let rgb = space.rgb_from_xyz(color).0.map(|v| v.clamp(0.0, 1.0));
        let mixture = wide.lookup(LinearRgb(rgb), Interpolation::Blend).expect("it is in range");
        let is_dyed =
            |(weight, part): (f64, Material)| weight > 0.0 && part.fluorescence.dose() > 0.0;
        (color, mixture.parts().any(is_dyed))
    });
    Dyed::new("random 8-bit sRGB in the ACEScg cube", &found.collect::<Vec<_>>())
}

/// Doses of materials over the least that is known.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Doses {
    /// Of nodes fitted by themselves.
    pub(crate) alone: Spread,
    /// Of the nodes of the cube.
    pub(crate) in_cube: Spread,
    /// How many nodes a fit by itself does not match within the limit under dyes, as the cube does.
    pub(crate) missed_alone: usize,
    /// The same of the exhaustive search.
    pub(crate) missed_exhaustively: usize,
}

/// The doses of the nodes of a cube of a preset and of their fits by themselves, over the least of these and
/// of an exhaustive search over all pairs of dyes, signs of slopes, and many starts. The nodes are drawn
/// from those that match with a dye within the limit.
///
/// # Errors
///
/// [`BuildError::Stopped`] if `watch` stopped the work.
pub(crate) fn doses(
    cube: &Cube,
    preset: Preset,
    count: usize,
    watch: &dyn Watch,
) -> Result<Doses, BuildError> {
    let options = preset.options();
    let fitter = |method| {
        let options = FitOptions { method, ..options };
        Fitter::new(cube.contract(), cube.model(), options).expect("a preset is in range")
    };
    let [alone, exhaustive] = [options.method, Method::Exhaustive].map(fitter);
    let dose = |fitter: &Fitter, index: usize| {
        let fit = fitter.fit(cube.node_rgb(index)).expect("nodes are in range");
        let is_dyed = MaterialKind::of_fit(&fit, cube.fit()) == MaterialKind::Dyed;
        is_dyed.then(|| fit.fluorescence.dose())
    };
    let nodes = drawn_nodes(cube, count);
    let done = AtomicUsize::new(0);
    let found: Vec<[Option<f64>; 3]> = nodes
        .par_iter()
        .map(|&index| {
            if watch.stopped() {
                return Err(BuildError::Stopped);
            }
            let stored = cube.node_material(index).fluorescence.dose();
            let doses = [Some(stored), dose(&alone, index), dose(&exhaustive, index)];
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            watch.progress(Progress { stage: "searching", done, total: nodes.len() });
            Ok(doses)
        })
        .collect::<Result<_, _>>()?;
    let over_least = |which: usize| {
        Spread::of(found.iter().filter_map(|doses| {
            let least = doses.iter().flatten().copied().fold(f64::INFINITY, f64::min);
            doses[which].map(|dose| dose / least)
        }))
    };
    let missed = |which: usize| found.iter().filter(|doses| doses[which].is_none()).count();
    Ok(Doses {
        alone: over_least(1),
        in_cube: over_least(0),
        missed_alone: missed(1),
        missed_exhaustively: missed(2),
    })
}

/// As many random nodes that match with a dye within the limit, or all of them if there are fewer.
fn drawn_nodes(cube: &Cube, count: usize) -> Vec<usize> {
    let is_dyed = |&i: &usize| MaterialKind::of_node(&cube.nodes()[i], cube) == MaterialKind::Dyed;
    let mut dyed: Vec<usize> = (0..cube.nodes().len()).filter(is_dyed).collect();
    let key = |index: usize| random_rgb(SEED, index).0[0];
    dyed.sort_by(|&a, &b| key(a).total_cmp(&key(b)));
    dyed.truncate(count);
    dyed
}
