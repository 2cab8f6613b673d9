//! Reflectances in half precision.

use half::f16;
use upglow::Edge;
use upglow_color::rounding::to_single;

/// Wavelengths are stored relative to this: half precision resolves an eighth of a nanometer within
/// 256 nm of zero, and only half a nanometer at 600.
pub(super) const ORIGIN_NM: f32 = 550.0;

/// Distance of an edge from [`ORIGIN_NM`], nm, up to which it is stored as it is: half precision then
/// resolves a quarter of a nanometer. Beyond it, slopes below 6e-5 per nm lose so many digits that their
/// effect over the distance would be visible.
const NEAR_NM: f32 = 512.0;

/// Distances of the extremum from the edge, nm, at which the extremum is kept, and with it the other edge.
/// In a narrower curve that would move more of the curve than it keeps; in a wider one only one of the
/// three is visible.
const KEPT_NM: std::ops::Range<f64> = 8.0..NEAR_NM as f64;

/// Where the reflectances of far edges are compared, nm. They have no features narrower than 100 nm.
const COMPARED_NM: [f64; 7] = [400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0];

/// The half-precision numbers of the reflectance that looks most like this one: the distance of its edge
/// from [`ORIGIN_NM`], its level and its slope. It is never steeper, and flat ones stay flat.
///
/// An edge far from visible light has more distance than half precision can hold, or so little slope
/// that few of its digits are left. Only what is visible of the reflectance counts, so it may be stored
/// with another edge: the tangent at the origin, whose edge is the origin.
pub(super) fn in_half(edge: Edge) -> [f32; 3] {
    let plain = rounded(edge);
    let [distance, _, slope_per_nm] = plain;
    if distance.abs() <= NEAR_NM || edge.slope_per_nm == 0.0 {
        return if distance.is_finite() {
            with_extremum(edge, plain)
        } else {
            [0.0, plain[1], slope_per_nm]
        };
    }
    let tangent = rounded(edge.tangent(ORIGIN_NM.into()));
    let same_at_origin = rounded(with_level_at_origin(edge, plain));
    let loss = |stored: [f32; 3]| {
        let stored = restored(stored);
        let losses = COMPARED_NM.map(|nm| (stored.at(nm) - edge.at(nm)).abs());
        losses.into_iter().fold(0.0, f64::max)
    };
    if distance.is_finite() && loss(same_at_origin) < loss(tangent) {
        same_at_origin
    } else {
        tangent
    }
}

/// The edge that numbers of [`in_half`] stand for.
fn restored([distance, level, slope_per_nm]: [f32; 3]) -> Edge {
    let edge_nm = f64::from(distance) + f64::from(ORIGIN_NM);
    Edge { edge_nm, level: level.into(), slope_per_nm: slope_per_nm.into() }
}

/// Each number by itself: the nearest one, and towards zero for the slope. A distance may become
/// infinite, a level does not: beyond ±65504 a reflectance is white or black in any case.
fn rounded(edge: Edge) -> [f32; 3] {
    let Edge { edge_nm, level, slope_per_nm } = edge;
    let most = f64::from(f16::MAX);
    let nearest = |v: f64| f16::from_f32(to_single(v)).to_f32();
    [
        nearest(edge_nm - f64::from(ORIGIN_NM)),
        nearest(level.clamp(-most, most)),
        towards_zero(to_single(slope_per_nm)),
    ]
}

/// The rounded edge and slope, with the level that leaves the extremum where it is. That is at the
/// distance 1 / (6·s·P·√(1 + P²)) from the edge, to which the slope's rounding would add up to a
/// thousandth.
fn with_extremum(edge: Edge, plain: [f32; 3]) -> [f32; 3] {
    let Edge { level: p, slope_per_nm: s, edge_nm } = edge;
    let to_extremum = -1.0 / (6.0 * s * p * (1.0 + p * p).sqrt());
    if !KEPT_NM.contains(&to_extremum.abs()) {
        return plain;
    }
    let stored = restored(plain);
    let q = -1.0 / (6.0 * stored.slope_per_nm * (edge_nm + to_extremum - stored.edge_nm));
    let level = q * (2.0 / (1.0 + (1.0 + 4.0 * q * q).sqrt())).sqrt();
    if level.is_finite() { rounded(Edge { level, ..stored }) } else { plain }
}

/// The rounded edge and slope, with the level that gives the exact reflectance at [`ORIGIN_NM`].
fn with_level_at_origin(edge: Edge, rounded: [f32; 3]) -> Edge {
    let origin_nm = f64::from(ORIGIN_NM);
    let target = edge.tangent(origin_nm).level;
    let mut found = Edge { level: edge.level, ..restored(rounded) };
    let (s, d) = (found.slope_per_nm, origin_nm - found.edge_nm);
    // Two steps of Newton's method: the change is a thousandth.
    for _ in 0..2 {
        let p = found.level;
        let flatness = 1.0 + p * p;
        let u = s * d;
        let by_level =
            1.0 + 6.0 * p * flatness.sqrt() * u + 6.0 * flatness * (flatness + 4.0 * p * p) * u * u;
        let step = (target - found.tangent(origin_nm).level) / by_level;
        found.level += if step.is_finite() { step } else { 0.0 };
    }
    found
}

/// The nearest half-precision number of no greater magnitude: rounding must not raise a slope above
/// its limit.
fn towards_zero(value: f32) -> f32 {
    let nearest = f16::from_f32(value);
    let size = nearest.to_f32().abs();
    if size <= value.abs() {
        return nearest.to_f32();
    }
    // The bits of half-precision numbers are ordered by magnitude.
    f16::from_bits(nearest.to_bits() - 1).to_f32()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_slope_is_never_rounded_up() {
        for slope in [0.01, -0.01, 0.0099, 1e-7, -0.2, 0.0] {
            let stored = towards_zero(slope);
            assert!(stored.abs() <= slope.abs(), "{stored} {slope}");
            // A half has eleven digits, or steps of 6e-8.
            assert!((stored - slope).abs() <= slope.abs() / 1024.0 + 6e-8, "{stored} {slope}");
        }
    }

    #[test]
    fn flat_reflectances_stay_flat_wherever_their_edges_are() {
        for edge_nm in [550.0, -4e4, 1e7, -1e18] {
            for level in [0.0, -0.7, 1e9, -1e9] {
                let [distance, stored, slope] = in_half(Edge { edge_nm, level, slope_per_nm: 0.0 });
                let exact = Edge { edge_nm, level, slope_per_nm: 0.0 }.at(550.0);
                let found = restored([distance, stored, slope]).at(400.0);
                assert!(slope == 0.0 && distance.is_finite() && (found - exact).abs() < 1e-4);
            }
        }
    }

    proptest! {
        /// Cause of the bound: a half has eleven digits, and edges within 512 nm steps of up to half a
        /// nanometer, which a slope of 0.01 per nm turns into a quarter of this; a far edge adds as much
        /// by the slope's digits.
        #[test]
        fn no_reflectance_changes_visibly_and_none_becomes_steeper(
            magnitude in -1.0..7.0_f64,
            sign in prop::sample::select(vec![-1.0, 1.0]),
            level in -3.0..3.0_f64,
            rise in -1.0..1.0_f64,
        ) {
            let distance = sign * 10_f64.powf(magnitude);
            // The slope at which the edge still has an effect near visible light.
            let slope = rise * 0.01_f64.min(2.0 / distance.abs());
            // Materials are stored in single precision.
            let slope_per_nm = f64::from(to_single(slope));
            let edge = Edge { edge_nm: 550.0 + distance, level, slope_per_nm };
            let stored = restored(in_half(edge));
            prop_assert!(stored.slope_per_nm.abs() <= slope_per_nm.abs());
            for nm in (300..=830).step_by(10) {
                let loss = stored.at(nm.into()) - edge.at(nm.into());
                prop_assert!(loss.abs() < 2e-3, "{loss} at {nm}: {edge:?} {stored:?}");
            }
        }
    }
}
