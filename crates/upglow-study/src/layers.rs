//! Layers of a cube, at one blue, as the colors that its materials really have.

use rayon::prelude::*;
use upglow::{Cube, Interpolation, LookupError, Mixture, ModelOnGrid};
use upglow_color::{Grid, LinearRgb, Metric};
use upglow_fit::CubeSummary;

/// Colors over red and green at one blue: of the nodes, or of a denser grid between them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layer {
    /// Blue, 0..=1.
    pub(crate) blue: f64,
    /// Points along red and green; point i stands for i / (side − 1).
    pub(crate) side: usize,
    /// What is shown, `[green][red]`; any finite numbers.
    pub(crate) colors: Vec<LinearRgb>,
    /// CIEDE2000 from what is asked for, `[green][red]`.
    pub(crate) de2000: Vec<f64>,
    /// Whether all nodes that take part match their colors within 0.01 CIEDE2000, `[green][red]`.
    pub(crate) has_exact_nodes: Vec<bool>,
}

/// The node of an axis nearest to a value, 0..=1.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the value is in 0..=1, and rounding is what it is for"
)]
pub(crate) fn nearest_node(resolution: usize, value: f64) -> usize {
    (value * (resolution - 1) as f64).round() as usize
}

impl Layer {
    /// The nodes of layer `blue_index`.
    pub(crate) fn of_nodes(cube: &Cube, blue_index: usize) -> Self {
        let side = cube.resolution();
        let blue = blue_index as f64 / (side - 1) as f64;
        Self::sampled(cube, blue, side, |_, index| {
            let node = blue_index * side * side + index;
            Ok(Mixture::of(cube.model(), cube.node_material(node)))
        })
    }

    /// A grid of `side`² colors at `blue`, 0..=1, whatever nodes there are.
    pub(crate) fn between_nodes(
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

    /// Greatest CIEDE2000 where all nodes that take part are exact; 0 where none are.
    pub(crate) fn worst_between_exact(&self) -> f64 {
        let pairs = self.de2000.iter().zip(&self.has_exact_nodes);
        pairs.filter(|(_, exact)| **exact).map(|(d, _)| *d).fold(0.0, f64::max)
    }

    /// The part with red and green of at least `low` and at most `high`, by whole points.
    pub(crate) fn cut(&self, red: [f64; 2], green: [f64; 2]) -> Cut<'_> {
        let index = |value| nearest_node(self.side, value);
        let [red, green] = [red, green].map(|[low, high]| [index(low), index(high)]);
        Cut { layer: self, red, green }
    }

    /// All of it.
    pub(crate) fn whole(&self) -> Cut<'_> {
        self.cut([0.0, 1.0], [0.0, 1.0])
    }
}

fn has_exact_nodes(cube: &Cube, rgb: LinearRgb) -> bool {
    let corners = cube.corners(rgb).expect("layers lie in the cube");
    corners
        .into_iter()
        .filter(|&(_, weight)| weight > 0.0)
        .all(|(index, _)| f64::from(cube.nodes()[index].de2000) <= CubeSummary::EXACT_DE2000)
}

/// A rectangle of the points of a layer, both ends included.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cut<'l> {
    pub(crate) layer: &'l Layer,
    /// First and last point along red.
    pub(crate) red: [usize; 2],
    /// First and last point along green.
    pub(crate) green: [usize; 2],
}

impl Cut<'_> {
    /// Points along red.
    pub(crate) fn columns(&self) -> usize {
        self.red[1] - self.red[0] + 1
    }

    /// Points along green.
    pub(crate) fn rows(&self) -> usize {
        self.green[1] - self.green[0] + 1
    }

    /// The points' numbers in the layer as a picture has them: greatest green first.
    pub(crate) fn picture(&self) -> impl Iterator<Item = usize> + '_ {
        let [first, last] = self.green;
        let row = move |green: usize| {
            (self.red[0]..=self.red[1]).map(move |red| green * self.layer.side + red)
        };
        (first..=last).rev().flat_map(row)
    }

    /// Mean CIEDE2000, and the share within 1, of the points.
    pub(crate) fn errors(&self) -> (f64, f64) {
        let found: Vec<f64> = self.picture().map(|i| self.layer.de2000[i]).collect();
        let count = found.len() as f64;
        let within = found.iter().filter(|&&d| d <= 1.0).count() as f64;
        (found.iter().sum::<f64>() / count, within / count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cubes, StudyCube};
    use upglow_fit::Unwatched;

    /// Single precision of what the cube stores.
    const STORED_TOL: f64 = 1e-4;

    #[test]
    fn a_layer_of_nodes_repeats_the_differences_that_the_cube_stores() {
        let cube = Cubes::new(4).get(StudyCube::Reference, &Unwatched).unwrap();
        let layer = Layer::of_nodes(&cube, 2);
        for (i, found) in layer.de2000.iter().enumerate() {
            let stored = f64::from(cube.nodes()[2 * 16 + i].de2000);
            assert!((found - stored).abs() < STORED_TOL, "{i}: {found} against {stored}");
        }
    }

    #[test]
    fn a_grid_of_the_nodes_alone_is_the_layer_of_nodes() {
        let cube = Cubes::new(4).get(StudyCube::Reference, &Unwatched).unwrap();
        let nodes = Layer::of_nodes(&cube, 0);
        let dense = Layer::between_nodes(&cube, 0.0, 7, Interpolation::Blend);
        assert_eq!(dense.colors[14], nodes.colors[4]);
    }

    #[test]
    fn pictures_start_with_the_greatest_green() {
        let cube = Cubes::new(4).get(StudyCube::Reference, &Unwatched).unwrap();
        let layer = Layer::of_nodes(&cube, 0);
        let cut = layer.cut([1.0 / 3.0, 1.0], [0.0, 1.0 / 3.0]);
        assert_eq!((cut.columns(), cut.rows()), (3, 2));
        assert_eq!(cut.picture().collect::<Vec<_>>(), [5, 6, 7, 1, 2, 3]);
    }
}
