//! The colors on the path from one reflectance to another.

use upglow::{Features, Material, ModelOnGrid, Sigmoid};
use upglow_color::{Lab, Xyz, ciede2000};
use upglow_study::Mixing;

use crate::field::Field;
use crate::spread::Spread;

/// How even and how direct the paths between pairs of reflectances are.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathSpreads {
    /// Greatest ΔE00 from the mixture of the two spectra at the weights ¼, ½ and ¾.
    pub(super) from_spectrum: Spread,
    /// Longest of 16 steps divided by the mean step, in ΔE00; 1 is an even pace.
    pub(super) pace: Spread,
    /// Greatest deviation of the hue angle from an even turn between the ends, degrees.
    pub(super) hue_deg: Spread,
    /// Length of the path divided by the distance of its ends, in CIELAB; 1 is straight.
    pub(super) detour: Spread,
}

/// How many pairs are drawn.
const PAIRS: usize = 2000;

/// Seed of the random pairs.
const SEED: u64 = 20;

/// Chroma C*ab from which a color is called saturated, and lightness L* from which it is bright.
const SATURATED: (f64, f64) = (30.0, 50.0);

/// Steps of a path.
const STEPS: usize = 16;

/// Two reflectances.
pub(super) type Ends = [Sigmoid; 2];

/// Random pairs of bright and saturated reflectances of a cube whose slopes have the same sign, and whose
/// features both pass a test.
pub(super) fn random_pairs(field: &Field, is_meant: impl Fn(&Features) -> bool) -> Vec<Ends> {
    let cube = field.cube();
    let usable: Vec<Sigmoid> = (0..cube.nodes().len())
        .map(|node| cube.node_material(node).reflectance)
        .filter(|&reflectance| {
            is_vivid(lab(field.sums(), color(field.sums(), reflectance)))
                && features(reflectance).is_some_and(|found| is_meant(&found))
        })
        .collect();
    if usable.is_empty() {
        return Vec::new();
    }
    let mut state = SEED;
    let mut draw = || usable[below(usable.len(), &mut state)];
    let pairs = std::iter::repeat_with(|| [draw(), draw()]);
    pairs.take(PAIRS).filter(|[p, q]| p != q && p.c0 * q.c0 > 0.0).collect()
}

/// Whether a color is bright and saturated.
pub(super) fn is_vivid(color: Lab) -> bool {
    let (chroma, lightness) = SATURATED;
    color.l >= lightness && color.a.hypot(color.b) >= chroma
}

/// The next number of the `SplitMix64` sequence, modulo `count`.
#[expect(clippy::cast_possible_truncation, reason = "the remainder is below a usize")]
fn below(count: usize, state: &mut u64) -> usize {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) % count as u64) as usize
}

/// Measures the paths between pairs of reflectances under one kind of interpolation.
pub(super) fn path_spreads(sums: &ModelOnGrid, pairs: &[Ends], mixing: Mixing) -> PathSpreads {
    let paths: Vec<[Vec<Lab>; 2]> = pairs
        .iter()
        .map(|&ends| [mixing, Mixing::Spectra].map(|mixing| path(sums, ends, mixing)))
        .collect();
    PathSpreads {
        from_spectrum: Spread::of(paths.iter().map(|[path, truth]| {
            let quarters = [STEPS / 4, STEPS / 2, 3 * STEPS / 4];
            quarters.map(|i| ciede2000(truth[i], path[i])).into_iter().fold(0.0, f64::max)
        })),
        pace: Spread::of(paths.iter().map(|[path, _]| pace(path))),
        hue_deg: Spread::of(paths.iter().map(|[path, _]| hue_deviation_deg(path))),
        detour: Spread::of(paths.iter().map(|[path, _]| {
            let length: f64 = path.windows(2).map(|step| step[0].de76(step[1])).sum();
            length / path[0].de76(path[STEPS])
        })),
    }
}

fn pace(path: &[Lab]) -> f64 {
    let steps = Spread::of(path.windows(2).map(|step| ciede2000(step[0], step[1])));
    steps.max / steps.mean
}

/// The even turn goes around in the direction of the path, even if that is the longer one.
fn hue_deviation_deg(path: &[Lab]) -> f64 {
    let mut hues: Vec<f64> = path.iter().map(|color| color.b.atan2(color.a).to_degrees()).collect();
    for i in 1..hues.len() {
        let step = hues[i] - hues[i - 1];
        hues[i] -= 360.0 * (step / 360.0).round();
    }
    let (first, last) = (hues[0], hues[STEPS]);
    let even = |i: usize| first + (last - first) * i as f64 / STEPS as f64;
    hues.iter().enumerate().map(|(i, hue)| (hue - even(i)).abs()).fold(0.0, f64::max)
}

fn path(sums: &ModelOnGrid, [from, to]: Ends, mixing: Mixing) -> Vec<Lab> {
    let ends = [from, to].map(|reflectance| color(sums, reflectance).0);
    let at = |step: usize| {
        let t = step as f64 / STEPS as f64;
        let mix = |p: f64, q: f64| (1.0 - t) * p + t * q;
        let mixed = |p: Sigmoid, q: Sigmoid| Sigmoid {
            c0: mix(p.c0, q.c0),
            c1: mix(p.c1, q.c1),
            c2: mix(p.c2, q.c2),
        };
        match mixing {
            Mixing::Spectra => Xyz([0, 1, 2].map(|k| mix(ends[0][k], ends[1][k]))),
            Mixing::Coefficients => color(sums, mixed(from, to)),
            Mixing::Features => color(sums, between_features(from, to, mix)),
        }
    };
    (0..=STEPS).map(|step| lab(sums, at(step))).collect()
}

fn between_features(from: Sigmoid, to: Sigmoid, mix: impl Fn(f64, f64) -> f64) -> Sigmoid {
    let [p, q] = [from, to].map(|end| features(end).expect("pairs have features"));
    let mixed = Features {
        shift_nm: mix(p.shift_nm, q.shift_nm),
        width_nm: mix(p.width_nm, q.width_nm),
        slope_per_nm: mix(p.slope_per_nm, q.slope_per_nm),
    };
    mixed.to_sigmoid().expect("slopes of the same sign do not cancel")
}

fn features(reflectance: Sigmoid) -> Option<Features> {
    reflectance.to_vertex()?.to_features()
}

pub(super) fn color(sums: &ModelOnGrid, reflectance: Sigmoid) -> Xyz {
    sums.color(Material::passive(reflectance))
}

pub(super) fn lab(sums: &ModelOnGrid, xyz: Xyz) -> Lab {
    sums.colorimetry().lab_from_xyz(xyz)
}
