//! Figure 8: where interpolated features distort the layer B = 0.7.

use rayon::prelude::*;
use upglow::{Cube, Interpolation};
use upglow_color::{LinearRgb, ciede2000};

use super::paths::lab;
use super::{Claim, Fields, Number, Verdict, share};
use crate::field::Field;
use crate::spread::Spread;

const BLUE: f64 = 0.7;

/// Points along red and along green for each node of the cube, as in the figure.
const POINTS_PER_NODE: usize = 8;

/// A point is distorted if its color differs by this ΔE00, just visible, from the mixture of the materials
/// around it: the mixture has neither steps nor bends but those of the nodes.
const DISTORTED: f64 = 1.0;

/// A point of the layer.
#[derive(Clone, Copy, Debug)]
struct Point {
    is_distorted: bool,
    /// Whether the slopes of the nodes around it have both signs.
    has_both_signs: bool,
    /// Whether the colors of two of the nodes around it differ visibly more, or less, than they should.
    has_jump: bool,
}

pub(super) fn claims(fields: &Fields) -> Vec<Claim> {
    let points = points(&fields.features);
    vec![caption(&fields.features, &points), at_discontinuities(&points)]
}

/// Points along each axis of the layer.
fn side(cube: &Cube) -> usize {
    POINTS_PER_NODE * cube.resolution()
}

fn colors(cube: &Cube) -> impl ParallelIterator<Item = LinearRgb> {
    let side = side(cube);
    let at = move |i: usize| i as f64 / (side - 1) as f64;
    (0..side * side).into_par_iter().map(move |i| LinearRgb([at(i % side), at(i / side), BLUE]))
}

fn points(field: &Field) -> Vec<Point> {
    let (cube, sums) = (field.cube(), field.sums());
    let color = |rgb, interpolation| {
        let material = cube.lookup(rgb, interpolation).expect("layers lie in the cube");
        lab(sums, material.color(sums))
    };
    let point = |rgb: LinearRgb| {
        let corners = cube.corners(rgb).expect("layers lie in the cube");
        let around: Vec<usize> =
            corners.into_iter().filter(|(_, weight)| *weight > 0.0).map(|(node, _)| node).collect();
        let c0 = |&node: &usize| cube.node_material(node).reflectance.c0;
        let [distorted, mixed] =
            [Interpolation::Features, Interpolation::Blend].map(|mode| color(rgb, mode));
        Point {
            is_distorted: ciede2000(mixed, distorted) >= DISTORTED,
            has_both_signs: around.iter().any(|node| c0(node) > 0.0)
                && around.iter().any(|node| c0(node) < 0.0),
            has_jump: around.iter().any(|&a| around.iter().any(|&b| field.jumps(a, b))),
        }
    };
    colors(cube).map(point).collect()
}

/// Mean ΔE00 of the layer from the colors asked for.
fn mean_error(field: &Field, interpolation: Interpolation) -> f64 {
    let (cube, sums) = (field.cube(), field.sums());
    let error = |rgb: LinearRgb| {
        let material = cube.lookup(rgb, interpolation).expect("layers lie in the cube");
        let target = lab(sums, sums.colorimetry().xyz_from_rgb(rgb));
        ciede2000(target, lab(sums, material.color(sums)))
    };
    let errors: Vec<f64> = colors(cube).map(error).collect();
    Spread::of(errors).mean
}

fn count(points: &[Point], is_meant: impl Fn(&Point) -> bool) -> usize {
    points.iter().filter(|point| is_meant(point)).count()
}

fn caption(field: &Field, points: &[Point]) -> Claim {
    let both = count(points, |p| p.has_both_signs);
    let distorted = count(points, |p| p.is_distorted);
    let distorted_of_both = count(points, |p| p.is_distorted && p.has_both_signs);
    let of_distorted = share(distorted_of_both, distorted);
    let of_both = share(distorted_of_both, both);
    Claim {
        id: "layer-distorted-at-sign-flips",
        section: "figure 8, caption",
        statement: "In the layer B = 0.7, interpolating slopes of different signs distorts the colors",
        measure: "share of the layer's points that are distorted: 1 ΔE00 or more between the color of \
                  interpolated features and that of the mixed materials; the same for points between \
                  nodes of both signs; mean ΔE00 of the layer for the four interpolations of the figure",
        numbers: vec![
            Number::percent("distorted", share(distorted, points.len())),
            Number::percent("of these between both signs", of_distorted),
            Number::percent("between both signs", share(both, points.len())),
            Number::percent("of these distorted", of_both),
            Number::new("none", mean_error(field, Interpolation::None), "ΔE00", 2),
            Number::new("features", mean_error(field, Interpolation::Features), "ΔE00", 2),
            Number::new("hybrid", mean_error(field, Interpolation::Hybrid), "ΔE00", 2),
            Number::new("coefficients", mean_error(field, Interpolation::Coefficients), "ΔE00", 2),
        ],
        verdict: Verdict::holds_if(of_distorted > 0.5 && of_both > 0.5),
        why: "Holds if most of the points between both signs are distorted, and most of the distorted \
              points lie there.",
    }
}

fn at_discontinuities(points: &[Point]) -> Claim {
    let distorted = count(points, |p| p.is_distorted);
    let at_jumps = share(count(points, |p| p.is_distorted && p.has_jump), distorted);
    Claim {
        id: "distortions-at-discontinuities",
        section: "5.3, figure 8",
        statement: "The distortions lie where the layer without interpolation has discontinuities",
        measure: "share of the points of that layer, and of the distorted ones, between nodes with a \
                  discontinuity: two whose misses differ by 1 ΔE00 or more",
        numbers: vec![
            Number::percent(
                "at discontinuities",
                share(count(points, |p| p.has_jump), points.len()),
            ),
            Number::percent("of the distorted points", at_jumps),
        ],
        verdict: Verdict::holds_if(at_jumps > 0.5),
        why: "Holds if most of the distorted points lie at discontinuities. Nodes that match their \
              colors have none, whatever the signs of their slopes.",
    }
}
