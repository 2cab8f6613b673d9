//! The nodes of a cube, prepared for polishing.

use std::sync::OnceLock;

use upglow::{Cube, Edge, Fluorescence, ModelOnGrid};
use upglow_color::rounding::to_single;

use crate::problem::parabola::{UNIT_NM, edge_of, scaled};
use crate::problem::single_sums::CHART_NM;

/// A node that is prepared when a texel first needs it, because small pictures need few. One cache line.
#[derive(Debug, Default)]
#[repr(align(64))]
pub(super) struct Slot(OnceLock<Corner>);

impl Slot {
    #[inline(always)]
    pub(super) fn get(&self, cube: &Cube, index: usize, model: &ModelOnGrid) -> &Corner {
        self.0.get_or_init(|| Corner::new(cube, index, model))
    }
}

const _: () = assert!(size_of::<Slot>() == 64);

/// A node, prepared for polishing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// The reflectance at the chart wavelengths.
    pub(super) values: [f32; 3],
    /// Edge (t), level, slope (1/nm).
    pub(super) edge: [f32; 3],
    /// Dyes: the position in the ring, first + weight. Film: the optical densities. Bells: emission peak,
    /// Stokes shift, 100 nm.
    pub(super) hue: [f32; 2],
    /// The dose: 0 if nothing fluoresces.
    pub(super) dose: f32,
    /// The dyes of a film.
    pub(super) dyes: [u8; 2],
    pub(super) xyz: [f32; 3],
    pub(super) de2000: f32,
}

/// The four corners of a texel's tetrahedron, with their weights.
pub(super) type Corners<'a> = [(f64, &'a Corner); 4];

impl Corner {
    fn new(cube: &Cube, index: usize, model: &ModelOnGrid) -> Self {
        let node = &cube.nodes()[index];
        let material = cube.node_material(index);
        let edge = node.edge();
        let hue = match material.fluorescence {
            Fluorescence::None => [0.0; 2],
            Fluorescence::Dyes { first, weight, .. } => [first as f64 + weight, 0.0],
            Fluorescence::Film { densities, .. } => densities,
            Fluorescence::Analytic { emission_peak_nm, stokes_shift_nm, .. } => {
                [emission_peak_nm, stokes_shift_nm].map(|nm| nm / UNIT_NM)
            }
        };
        Self {
            values: CHART_NM.map(|nm| to_single(edge.at(nm))),
            edge: [scaled(edge.edge_nm), edge.level, edge.slope_per_nm].map(to_single),
            hue: hue.map(to_single),
            dose: to_single(material.fluorescence.dose()),
            dyes: node.dyes,
            xyz: model.color(material).0.map(to_single),
            de2000: node.de2000,
        }
    }

    /// The greatest |dr/dλ|, 1/nm.
    pub(super) fn steepest_slope_per_nm(&self) -> f64 {
        f64::from(self.edge[2].abs())
    }

    pub(super) fn edge(&self) -> Edge {
        let [e, level, slope_per_nm] = self.edge.map(f64::from);
        edge_of([e, level, slope_per_nm], 1.0)
    }
}

/// Whether all corners with a weight above 0 have a property.
#[inline(always)]
pub(super) fn all(corners: &Corners<'_>, holds: impl Fn(&Corner) -> bool) -> bool {
    // Without an early exit, as branches are hard to predict here.
    let mut all = true;
    for (weight, corner) in corners {
        all &= (*weight == 0.0) | holds(corner);
    }
    all
}

/// The weighted mean of one number of the corners.
#[inline(always)]
pub(super) fn mean(corners: &Corners<'_>, of: impl Fn(&Corner) -> f32) -> f64 {
    corners.iter().map(|(weight, corner)| weight * f64::from(of(corner))).sum()
}
