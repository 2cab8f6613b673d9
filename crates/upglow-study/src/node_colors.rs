//! The colors of a cube's nodes.

use rayon::prelude::*;
use upglow::{Cube, ModelOnGrid};
use upglow_color::{Colorimetry, Xyz};

/// The color of each node's material under `colorimetry`, `[blue][green][red]`.
pub fn node_colors(cube: &Cube, colorimetry: &Colorimetry) -> Vec<Xyz> {
    let sums = ModelOnGrid::new(cube.model(), colorimetry);
    (0..cube.nodes().len())
        .into_par_iter()
        .map(|node| sums.color(cube.node_material(node)))
        .collect()
}
