//! A cube as a field of colors and spectra: how smooth it is, and which nodes are artifacts.

use std::sync::Arc;

use rayon::prelude::*;
use upglow::{Bispectral, Cube, Mixture, ModelOnGrid};
use upglow_color::{Grid, Lab, Xyz, ciede2000};

use crate::spread::Spread;

/// The colors of a cube's nodes, `[blue][green][red]`.
#[derive(Debug)]
pub(crate) struct Field {
    cube: Arc<Cube>,
    sums: ModelOnGrid,
    /// The color of each node's material.
    pub(crate) shown: Vec<Xyz>,
    /// The same in CIELAB.
    lab: Vec<Lab>,
    /// The color that each node should have.
    target: Vec<Lab>,
}

/// A node is an artifact if its color differs by at least this (ΔE00) from the color expected from
/// its neighbors: a difference that is just visible. Half of it would count the bends at the border
/// of what materials can match; twice of it only the worst artifacts of the paper's figures.
const ARTIFACT: f64 = 1.0;

/// A radiance factor at 400, 410 … 700 nm: the light that leaves at a wavelength divided by the light
/// that arrives at it.
pub(crate) type RadianceFactor = [f64; 31];

impl Field {
    pub(crate) fn of(cube: Arc<Cube>) -> Self {
        let sums = ModelOnGrid::new(cube.model(), &cube.contract().on(Grid::FIT));
        let colorimetry = sums.colorimetry();
        let nodes = 0..cube.nodes().len();
        let shown: Vec<Xyz> =
            nodes.clone().into_par_iter().map(|i| sums.color(cube.node_material(i))).collect();
        let lab = shown.iter().map(|&xyz| colorimetry.lab_from_xyz(xyz)).collect();
        let target = nodes
            .map(|i| colorimetry.lab_from_xyz(colorimetry.xyz_from_rgb(cube.node_rgb(i))))
            .collect();
        Self { cube, sums, shown, lab, target }
    }

    pub(crate) fn cube(&self) -> &Cube {
        &self.cube
    }

    pub(crate) fn sums(&self) -> &ModelOnGrid {
        &self.sums
    }

    /// The nodes of the layer of one blue index that are artifacts.
    ///
    /// The neighbors of a node are those around it in the layer, in opposite pairs: eight, two at
    /// an edge, none in a corner. Each misses its own color by a vector in CIELAB. The expected color
    /// of the node is its own color plus the component-wise median of those vectors; the node is an
    /// artifact if it differs from that by 1 ΔE00 or more.
    ///
    /// Comparing misses instead of colors ignores the change from color to color, opposite pairs
    /// ignore a steady change of the misses, and medians ignore a few bad neighbors.
    pub(crate) fn artifacts_in_layer(&self, blue: usize) -> Vec<usize> {
        let n = self.cube.resolution();
        (blue * n * n..(blue + 1) * n * n).filter(|&node| self.is_artifact(node)).collect()
    }

    /// How many nodes are artifacts of their layer.
    pub(crate) fn artifacts(&self) -> usize {
        (0..self.cube.resolution()).map(|blue| self.artifacts_in_layer(blue).len()).sum()
    }

    fn is_artifact(&self, node: usize) -> bool {
        let misses: Vec<[f64; 3]> =
            self.neighbors_in_layer(node).into_iter().map(|i| self.miss(i)).collect();
        if misses.is_empty() {
            return false;
        }
        let expected = [0, 1, 2].map(|k| median(misses.iter().map(|m| m[k]).collect()));
        self.surprise(node, expected) >= ARTIFACT
    }

    /// ΔE00 between the color of a node's material and the node's own color plus `miss`.
    fn surprise(&self, node: usize, miss: [f64; 3]) -> f64 {
        let Lab { l, a, b } = self.target[node];
        let [dl, da, db] = miss;
        ciede2000(Lab { l: l + dl, a: a + da, b: b + db }, self.lab[node])
    }

    /// The color of a node's material minus the color it should have, L*, a*, b*.
    fn miss(&self, node: usize) -> [f64; 3] {
        let (shown, target) = (self.lab[node], self.target[node]);
        [shown.l - target.l, shown.a - target.a, shown.b - target.b]
    }

    /// ΔE00 and ΔE76 between the color of a node's material and the color it should have.
    pub(crate) fn differences(&self, node: usize) -> [f64; 2] {
        let (shown, target) = (self.lab[node], self.target[node]);
        [ciede2000(target, shown), target.de76(shown)]
    }

    /// Whether the colors of two neighbors differ visibly more, or less, than the colors that they should
    /// have: 1 ΔE00 between the miss of one and that of the other.
    pub(crate) fn jumps(&self, node: usize, neighbor: usize) -> bool {
        self.surprise(node, self.miss(neighbor)) >= ARTIFACT
    }

    fn neighbors_in_layer(&self, node: usize) -> Vec<usize> {
        let n = self.cube.resolution();
        let [_, green, red] = self.cube.coordinates(node);
        let inside = |i: usize| i > 0 && i + 1 < n;
        // Row, column and both diagonals: the stride, and whether there are nodes on both sides.
        [
            (1, inside(red)),
            (n, inside(green)),
            (n + 1, inside(red) && inside(green)),
            (n - 1, inside(red) && inside(green)),
        ]
        .into_iter()
        .filter(|(_, both)| *both)
        .flat_map(|(stride, _)| [node - stride, node + stride])
        .collect()
    }

    /// The radiance factor of each node's material under the light of the contract.
    pub(crate) fn radiance_factors(&self) -> Vec<RadianceFactor> {
        let nodes = 0..self.cube.nodes().len();
        nodes.into_par_iter().map(|node| self.radiance_factor(node)).collect()
    }

    fn radiance_factor(&self, node: usize) -> RadianceFactor {
        let material = Mixture::of(self.cube.model(), self.cube.node_material(node));
        let colorimetry = self.sums.colorimetry();
        let (step_nm, wavelengths) = (f64::from(Grid::FIT.step_nm()), self.sums.wavelengths_nm());
        let returned = |nm: f64| material.albedo(nm) - material.reflectance(nm);
        let light = || wavelengths.iter().copied().zip(colorimetry.irradiance().iter().copied());
        let emitted: f64 = light().map(|(nm, power)| power * returned(nm)).sum();
        // A node's material has one lobe at most, whose emission has the same shape for any source.
        let strongest = light().max_by(|a, b| returned(a.0).total_cmp(&returned(b.0)));
        let (source_nm, _) = strongest.expect("the grid has wavelengths");
        let per_source = returned(source_nm);
        std::array::from_fn(|i| {
            let nm = 400.0 + 10.0 * i as f64;
            let reflected = material.reflectance(nm);
            if per_source <= 0.0 {
                return reflected;
            }
            let shape_per_nm = material.reradiation_per_nm(source_nm, nm) / per_source;
            let arriving = colorimetry.irradiance()[20 + 2 * i];
            reflected + emitted * shape_per_nm * step_nm / arriving
        })
    }

    /// ΔE00 between nodes and their own color plus the mean miss of their two neighbors along an
    /// axis, over all nodes and axes.
    pub(crate) fn color_roughness(&self) -> Spread {
        Spread::of(self.triples().map(|triple| self.color_bend(triple)))
    }

    /// The same within the layer of one blue index.
    pub(crate) fn color_roughness_in_layer(&self, blue: usize) -> Spread {
        let layer = self.cube.resolution().pow(2);
        let inside = |triple: &[usize; 3]| triple.iter().all(|node| node / layer == blue);
        Spread::of(self.triples().filter(inside).map(|triple| self.color_bend(triple)))
    }

    fn color_bend(&self, [below, node, above]: [usize; 3]) -> f64 {
        let (p, q) = (self.miss(below), self.miss(above));
        self.surprise(node, [0, 1, 2].map(|k| (p[k] + q[k]) / 2.0))
    }

    /// Distance of radiance factors from the mean of their two neighbors' along an axis: mean over
    /// wavelengths, over all nodes and axes.
    pub(crate) fn spectral_roughness(&self) -> Spread {
        let factors = self.radiance_factors();
        Spread::of(self.triples().map(|[below, node, above]| {
            let off =
                |k: usize| ((factors[below][k] + factors[above][k]) / 2.0 - factors[node][k]).abs();
            (0..31).map(off).sum::<f64>() / 31.0
        }))
    }

    fn triples(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        let n = self.cube.resolution();
        (0..self.cube.nodes().len()).flat_map(move |node| {
            [1, n, n * n].into_iter().filter_map(move |stride| {
                let index = node / stride % n;
                (index > 0 && index + 1 < n).then(|| [node - stride, node, node + stride])
            })
        })
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let count = values.len();
    (values[(count - 1) / 2] + values[count / 2]) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow::{Edge, Fluorescence, Node};
    use upglow_fit::Unwatched;

    use crate::cubes::{Cubes, StudyCube};

    /// A node that matches its color, inside the cube of six and inside its layer.
    const INSIDE: usize = (3 * 6 + 3) * 6 + 3;

    fn with_one_other(reflectance: f64) -> Field {
        let cube = Cubes::new(6).get(StudyCube::REFERENCE, &Unwatched).unwrap();
        let mut nodes = cube.nodes().to_vec();
        let level = upglow::Sigmoid::flat(reflectance).c2;
        let flat = Edge { edge_nm: 565.0, level, slope_per_nm: 0.0 };
        nodes[INSIDE] = Node::new(flat, Fluorescence::None, 0.0);
        let (contract, model) = (cube.contract().clone(), cube.model().clone());
        Field::of(Arc::new(Cube::new(contract, model, cube.fit().clone(), 6, nodes).unwrap()))
    }

    #[test]
    fn an_outlier_is_an_artifact_and_makes_the_cube_rougher() {
        let (smooth, rough) = (with_one_other(0.6), with_one_other(0.2));
        assert!(!smooth.artifacts_in_layer(3).contains(&INSIDE));
        assert!(rough.artifacts_in_layer(3).contains(&INSIDE));
        assert!(rough.color_roughness().mean > smooth.color_roughness().mean);
        assert!(rough.spectral_roughness().mean > smooth.spectral_roughness().mean);
    }

    #[test]
    fn the_radiance_factor_has_the_color_of_the_node() {
        // Samples over 10 nm from 400 to 700 nm in place of 5 nm from 300 to 830.
        const TOLERANCE: f64 = 0.02;
        let field = Field::of(Cubes::new(4).get(StudyCube::REFERENCE, &Unwatched).unwrap());
        let weights = field.sums.colorimetry().weights();
        for (factor, shown) in field.radiance_factors().iter().zip(&field.shown) {
            let luminance: f64 =
                factor.iter().enumerate().map(|(i, r)| 2.0 * r * weights[20 + 2 * i][1]).sum();
            assert!((luminance - shown.0[1]).abs() < TOLERANCE, "{luminance} {shown:?}");
        }
    }
}
