//! Layers of a cube at one blue: the colors of its materials and their errors.

use rayon::prelude::*;
use upglow::{Cube, Interpolation, LookupError, Mixture, ModelOnGrid};
use upglow_color::{Grid, LinearRgb, Metric};
use upglow_fit::CubeSummary;

/// Colors of materials over red and green at one blue: those of the nodes, or of a denser grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Blue, 0..=1.
    pub blue: f64,
    /// Number of points along red and along green; point i is at i / (side − 1).
    pub side: usize,
    /// Linear RGB of the materials, `[green][red]`; may lie outside 0..=1.
    pub colors: Vec<LinearRgb>,
    /// CIEDE2000 between each material and the color it should have, `[green][red]`.
    pub de2000: Vec<f64>,
    /// Whether all nodes around the point match their colors within 0.01 CIEDE2000, `[green][red]`.
    pub has_exact_nodes: Vec<bool>,
}

impl Layer {
    /// The index of the node nearest to a value in 0..=1, along an axis.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the value is in 0..=1 and rounded"
    )]
    pub fn nearest_node(resolution: usize, value: f64) -> usize {
        (value * (resolution - 1) as f64).round() as usize
    }

    /// The layer of nodes with this index along blue.
    ///
    /// # Panics
    ///
    /// If there is no such layer.
    pub fn of_nodes(cube: &Cube, blue_index: usize) -> Self {
        let side = cube.resolution();
        let blue = blue_index as f64 / (side - 1) as f64;
        Self::sampled(cube, blue, side, |_, index| {
            let node = blue_index * side * side + index;
            Ok(Mixture::of(cube.model(), cube.node_material(node)))
        })
    }

    /// A grid of `side`² interpolated materials at `blue`, 0..=1.
    ///
    /// # Panics
    ///
    /// If `blue` is outside 0..=1, or `side` is below 2.
    pub fn between_nodes(
        cube: &Cube,
        blue: f64,
        side: usize,
        interpolation: Interpolation,
    ) -> Self {
        Self::sampled(cube, blue, side, |rgb, _| cube.lookup(rgb, interpolation))
    }

    fn sampled<'c>(
        cube: &'c Cube,
        blue: f64,
        side: usize,
        material: impl Fn(LinearRgb, usize) -> Result<Mixture<'c>, LookupError> + Sync,
    ) -> Self {
        let colorimetry = cube.contract().on(Grid::FIT);
        let sums = ModelOnGrid::new(cube.model(), &colorimetry);
        let last = (side - 1) as f64;
        let points: Vec<(LinearRgb, f64, bool)> = (0..side * side)
            .into_par_iter()
            .map(|index| {
                let [red, green] = [index % side, index / side].map(|i| i as f64 / last);
                let rgb = LinearRgb([red, green, blue]);
                let mixture = material(rgb, index).expect("layers lie in the cube");
                let (target, color) = (colorimetry.xyz_from_rgb(rgb), mixture.color(&sums));
                let de2000 = Metric::De2000.distance(&colorimetry, target, color);
                (colorimetry.rgb_from_xyz(color), de2000, has_exact_nodes(cube, rgb))
            })
            .collect();
        Self {
            blue,
            side,
            colors: points.iter().map(|(color, ..)| *color).collect(),
            de2000: points.iter().map(|(_, de2000, _)| *de2000).collect(),
            has_exact_nodes: points.iter().map(|(.., exact)| *exact).collect(),
        }
    }
}

fn has_exact_nodes(cube: &Cube, rgb: LinearRgb) -> bool {
    let corners = cube.corners(rgb).expect("layers lie in the cube");
    corners
        .into_iter()
        .filter(|&(_, weight)| weight > 0.0)
        .all(|(index, _)| f64::from(cube.nodes()[index].de2000) <= CubeSummary::EXACT_DE2000)
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow::{Mixing, Model};
    use upglow_fit::{Unwatched, build_cube};

    use crate::konig2020;

    fn cube() -> Cube {
        let model = Model::Dyes(konig2020::dyes(Mixing::Pooled));
        let options = konig2020::options(Metric::De2000, 1);
        build_cube(&konig2020::contract(), &model, options, 4, &Unwatched).unwrap()
    }

    /// The cube stores single precision.
    const STORED_TOL: f64 = 1e-4;

    #[test]
    fn a_layer_of_nodes_has_the_differences_that_the_cube_stores() {
        let cube = cube();
        let layer = Layer::of_nodes(&cube, 2);
        for (i, found) in layer.de2000.iter().enumerate() {
            let stored = f64::from(cube.nodes()[2 * 16 + i].de2000);
            assert!((found - stored).abs() < STORED_TOL, "{i}: {found} against {stored}");
        }
    }

    #[test]
    fn a_grid_that_meets_a_node_has_its_color() {
        let cube = cube();
        let nodes = Layer::of_nodes(&cube, 0);
        let dense = Layer::between_nodes(&cube, 0.0, 7, Interpolation::Blend);
        assert_eq!(dense.colors[14], nodes.colors[4]);
    }
}
