//! How well interpolated materials match the colors between the nodes of a cube.

use rayon::prelude::*;
use upglow::{Cube, Interpolation, Sigmoid};
use upglow_color::{LinearRgb, ciede2000};

use super::paths::{is_vivid, lab};
use crate::field::Field;
use crate::spread::Spread;

/// A node is matched within this ΔE00.
pub(super) const MATCHED: f32 = 0.01;

/// A color up to this chroma C*ab is nearly gray. A larger limit includes colors that clearly have a
/// hue; a smaller one leaves too few nodes to measure.
const GRAY_CHROMA: f64 = 10.0;

/// The center of a tetrahedron of the look-up, all of whose corners match their colors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Center {
    rgb: LinearRgb,
    pub(super) kind: Kind,
    /// Whether all corners are bright and saturated.
    pub(super) is_vivid: bool,
}

/// What the materials at the corners are like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Slopes of both signs.
    Flip,
    /// Slopes of one sign, and a corner that is nearly gray.
    Gray,
    /// Slopes of one sign, and no corner nearly gray.
    Colored,
    /// A corner without features: features cannot be interpolated there.
    Flat,
}

/// All centers, in the order of the nodes.
pub(super) fn centers(field: &Field) -> Vec<Center> {
    let cube = field.cube();
    let last = cube.resolution() - 1;
    (0..cube.nodes().len())
        .filter(|&node| cube.coordinates(node).iter().all(|&i| i < last))
        .flat_map(|node| cell_centers(cube, node))
        .filter_map(|rgb| {
            let corners = cube.corners(rgb).expect("centers are in the cube").map(|(node, _)| node);
            let matched = corners.iter().all(|&node| cube.nodes()[node].de2000 <= MATCHED);
            matched.then(|| Center {
                rgb,
                kind: kind(field, corners),
                is_vivid: corners
                    .iter()
                    .all(|&node| is_vivid(lab(field.sums(), field.shown[node]))),
            })
        })
        .collect()
}

/// The centers of the six tetrahedra of the cell whose lowest corner is this node.
fn cell_centers(cube: &Cube, node: usize) -> [LinearRgb; 6] {
    const ORDERS: [[f64; 3]; 6] = [
        [0.75, 0.5, 0.25],
        [0.75, 0.25, 0.5],
        [0.5, 0.75, 0.25],
        [0.5, 0.25, 0.75],
        [0.25, 0.75, 0.5],
        [0.25, 0.5, 0.75],
    ];
    let last = (cube.resolution() - 1) as f64;
    let [blue, green, red] = cube.coordinates(node).map(|i| i as f64);
    ORDERS.map(|[r, g, b]| LinearRgb([red + r, green + g, blue + b].map(|v| v / last)))
}

fn kind(field: &Field, corners: [usize; 4]) -> Kind {
    let shapes: [Sigmoid; 4] = corners.map(|node| field.cube().node_material(node).reflectance);
    let any = |test: fn(&Sigmoid) -> bool| shapes.iter().any(test);
    let is_gray = |&node: &usize| {
        let color = lab(field.sums(), field.shown[node]);
        color.a.hypot(color.b) <= GRAY_CHROMA
    };
    if any(|shape| shape.to_vertex().and_then(|vertex| vertex.to_features()).is_none()) {
        Kind::Flat
    } else if any(|shape| shape.c0 > 0.0) && any(|shape| shape.c0 < 0.0) {
        Kind::Flip
    } else if corners.iter().any(is_gray) {
        Kind::Gray
    } else {
        Kind::Colored
    }
}

/// ΔE00 between the interpolated material and the requested color, at the centers of one kind.
pub(super) fn misses(
    field: &Field,
    centers: &[Center],
    is_meant: impl Fn(&Center) -> bool,
    interpolation: Interpolation,
) -> Spread {
    let meant: Vec<LinearRgb> =
        centers.iter().filter(|center| is_meant(center)).map(|center| center.rgb).collect();
    let (cube, sums) = (field.cube(), field.sums());
    let miss = |&rgb: &LinearRgb| {
        let material = cube.lookup(rgb, interpolation).expect("centers are in the cube");
        let target = sums.colorimetry().xyz_from_rgb(rgb);
        ciede2000(lab(sums, target), lab(sums, material.color(sums)))
    };
    let misses: Vec<f64> = meant.par_iter().map(miss).collect();
    Spread::of(misses)
}
