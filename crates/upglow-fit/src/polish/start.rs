//! The start of a texel's material: a mean of its corners' materials.

use upglow::{Edge, Features, Model};

use crate::polish::corner::{Corner, Corners, all, mean};
use crate::problem::LEVEL_BOUND;
use crate::problem::parabola::{MIDDLE_NM, UNIT_NM, edge_of, feature_chart, scaled, sigmoid_of};

/// What kind of fluorescence a material has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Family {
    /// None.
    Passive,
    /// This dye and its neighbor; the unknown is the weight.
    Pair(usize),
    /// A film of these dyes; the unknowns are their optical densities.
    Film([usize; 2]),
    /// Bells; the unknowns are emission peak and Stokes shift, 100 nm.
    Bells,
}

/// A fluorescence as unknowns: concentration, and those of its family; in a film both densities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Glow {
    pub(super) family: Family,
    pub(super) numbers: [f64; 3],
}

/// Reflectances with wider features, nm, are nearly flat or straight, and their features have no useful
/// mean.
const WIDEST_NM: f64 = 3000.0;
/// Corners count in the mean if they are this near in the ring to the heaviest corner: the dyes between
/// more distant corners are those of neither.
const RING_REACH: f64 = 1.0;
/// The same for emission peaks and Stokes shifts, 100 nm. With larger values the mean falls between two
/// bells; smaller ones make unnecessary steps.
const BELL_REACH: [f64; 2] = [0.3, 0.4];

/// The mean reflectance of the corners: of edges if all rise or all fall, of features if all are peaks
/// or all valleys, else of parabolas.
pub(super) fn edge(corners: &Corners<'_>) -> Edge {
    if all(corners, |c| c.edge[2] > 0.0) || all(corners, |c| c.edge[2] < 0.0) {
        let [e, level, slope_per_nm] = [0, 1, 2].map(|i| mean(corners, |c| c.edge[i]));
        return edge_of([e, level, slope_per_nm], 1.0);
    }
    let alike = all(corners, |c| c.edge[1] > 0.0) || all(corners, |c| c.edge[1] < 0.0);
    alike.then(|| features(corners)).flatten().unwrap_or_else(|| parabolas(corners))
}

fn features(corners: &Corners<'_>) -> Option<Edge> {
    let mut sum = [0.0; 3];
    for (weight, corner) in corners.iter().filter(|(weight, _)| *weight > 0.0) {
        let Features { shift_nm, width_nm, slope_per_nm } =
            corner.edge().to_sigmoid().to_vertex()?.to_features()?;
        if width_nm > WIDEST_NM {
            return None;
        }
        let numbers = [scaled(shift_nm), width_nm / UNIT_NM, slope_per_nm];
        (0..3).for_each(|i| sum[i] += weight * numbers[i]);
    }
    Some(sigmoid_of(feature_chart(sum, 1.0).0).to_edge(MIDDLE_NM))
}

fn parabolas(corners: &Corners<'_>) -> Edge {
    let mut sum = [0.0; 3];
    for (weight, corner) in corners.iter().filter(|(weight, _)| *weight > 0.0) {
        let mut edge = corner.edge();
        // Black and white have huge levels, which would dominate the mean.
        edge.level = edge.level.clamp(-LEVEL_BOUND, LEVEL_BOUND);
        let [p, b, k] = edge.parabola();
        let (b, k, e) = (b * UNIT_NM, k * UNIT_NM * UNIT_NM, f64::from(corner.edge[0]));
        let numbers = [p - b * e + k * e * e, b - 2.0 * k * e, k];
        (0..3).for_each(|i| sum[i] += weight * numbers[i]);
    }
    sigmoid_of(sum).to_edge(MIDDLE_NM)
}

/// The mean fluorescence of the corners; passive only if all of them are.
#[inline(always)]
pub(super) fn glow(corners: &Corners<'_>, model: &Model) -> Glow {
    if all(corners, |c| c.dose == 0.0) {
        return PASSIVE;
    }
    if let Model::Film(_) = model {
        return film(corners);
    }
    let (mut heaviest, mut most) = (corners[0].1, 0.0);
    for (weight, corner) in corners {
        let share = weight * f64::from(corner.dose);
        if share > most {
            (heaviest, most) = (corner, share);
        }
    }
    glow_around(heaviest, mean(corners, |c| c.dose), corners, model)
}

const PASSIVE: Glow = Glow { family: Family::Passive, numbers: [0.0; 3] };

/// The two dyes of which the corners hold most, at their mean densities.
fn film(corners: &Corners<'_>) -> Glow {
    let of_corners = || {
        corners.iter().flat_map(|(weight, corner)| {
            [0, 1].map(|k| (corner.dyes[k], weight * f64::from(corner.hue[k])))
        })
    };
    let mean = |dye: u8| of_corners().fold(0.0, |sum, (d, a)| if d == dye { sum + a } else { sum });
    let densest = |except: Option<u8>| {
        let others = of_corners().filter(|(dye, a)| Some(*dye) != except && *a > 0.0);
        others.fold(None, |most: Option<(u8, f64)>, (dye, _)| {
            let density = mean(dye);
            if most.is_some_and(|(_, known)| known >= density) {
                most
            } else {
                Some((dye, density))
            }
        })
    };
    let Some((first, density)) = densest(None) else { return PASSIVE };
    let (second, second_density) = densest(Some(first)).unwrap_or((first, 0.0));
    let dyes = [first, second].map(usize::from);
    Glow { family: Family::Film(dyes), numbers: [density, second_density, 0.0] }
}

/// The fluorescence of one corner.
pub(super) fn glow_of(corner: &Corner, model: &Model) -> Glow {
    let alone = [(1.0, corner), (0.0, corner), (0.0, corner), (0.0, corner)];
    glow(&alone, model)
}

/// The mean of the fluorescences that are near that of `heaviest`.
fn glow_around(
    heaviest: &Corner,
    concentration: f64,
    corners: &Corners<'_>,
    model: &Model,
) -> Glow {
    let (reach, ring) = match model {
        Model::Reflectance | Model::Film(_) => return PASSIVE,
        Model::Analytic(_) => (BELL_REACH, f64::INFINITY),
        Model::Dyes(dyes) if dyes.pairs() < 3 => ([RING_REACH, 0.0], f64::INFINITY),
        Model::Dyes(dyes) => ([RING_REACH, 0.0], dyes.pairs() as f64),
    };
    let center = [f64::from(heaviest.hue[0]), f64::from(heaviest.hue[1])];
    let (mut total, mut sum) = (0.0, [0.0; 2]);
    for (weight, corner) in corners {
        let share = weight * f64::from(corner.dose);
        let mut off = f64::from(corner.hue[0]) - center[0];
        let other = f64::from(corner.hue[1]) - center[1];
        if off.abs() > 0.5 * ring {
            off -= ring.copysign(off);
        }
        if off.abs() <= reach[0] && other.abs() <= reach[1] {
            total += share;
            sum[0] += share * off;
            sum[1] += share * other;
        }
    }
    let (u, v) = (center[0] + sum[0] / total, center[1] + sum[1] / total);
    match model {
        Model::Dyes(_) => {
            let (first, weight) = pair_at(u, ring);
            Glow { family: Family::Pair(first), numbers: [concentration, weight, 0.0] }
        }
        _ => Glow { family: Family::Bells, numbers: [concentration, u, v] },
    }
}

/// The pair of dyes and the weight at a position in a ring of this length; a ring of infinite length has
/// a single pair.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the position is in the ring and its fraction is the weight"
)]
fn pair_at(place: f64, ring: f64) -> (usize, f64) {
    if ring.is_infinite() {
        return (0, place.clamp(0.0, 1.0));
    }
    let place = if place < 0.0 { place + ring } else { place };
    let place = if place >= ring { place - ring } else { place };
    let first = place as usize;
    (first, place - first as f64)
}
