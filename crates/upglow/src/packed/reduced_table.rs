//! 4×4 matrices of looked-up colors.

use upglow_color::rounding::to_single;
use upglow_color::{EngineSpace, ReducedBasis, ReducedMatrix};

use crate::cube::{Cube, LookupError};
use crate::material::reduced_model::ReducedModel;
use crate::packed::lookup_table::{Corners, axis};

/// The 4×4 matrix of every node of a [`Cube`], in single precision.
///
/// The matrix of a mixture is the mixture of its materials' matrices, so that what is interpolated between the
/// nodes is exactly [`crate::Mixture::reduced_matrix`] with [`crate::Interpolation::Blend`], without any spectrum.
///
/// # Examples
///
/// ```
/// use upglow::{Cube, Edge, FitRecord, Fluorescence, Model, Node};
/// use upglow_color::{Contract, Grid, ReducedBasis};
///
/// let gray = Edge { edge_nm: 550.0, level: 0.0, slope_per_nm: 0.0 };
/// let nodes = vec![Node::new(gray, Fluorescence::None, 0.0); 8];
/// let cube = Cube::new(Contract::default(), Model::Reflectance, FitRecord::default(), 2, nodes)?;
/// let table = cube.reduced_table(&ReducedBasis::try_new(cube.contract(), Grid::FIT)?);
/// let matrix = table.matrix([0.2, 0.5, 0.1])?;
/// assert!((matrix[1][1] - 0.5).abs() < 1e-6 && matrix[1][3].abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Clone, Debug)]
pub struct ReducedTable {
    resolution: u32,
    nodes: Vec<NodeMatrix>,
}

/// A matrix in a cache line of its own, `[outgoing][incident]`.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct NodeMatrix([f32; 16]);

impl Cube {
    /// The matrices of the nodes, in the order of [`Cube::nodes`], for the lights of `basis`.
    pub fn reduced_table(&self, basis: &ReducedBasis) -> ReducedTable {
        let model = ReducedModel::new(self.model(), basis);
        let matrix = |index| {
            let rows = model.matrix(self.node_material(index)).0;
            let mut numbers = [0.0; 16];
            numbers.iter_mut().zip(rows.as_flattened()).for_each(|(to, v)| *to = to_single(*v));
            NodeMatrix(numbers)
        };
        let nodes = (0..self.nodes().len()).map(matrix).collect();
        ReducedTable { resolution: axis(self), nodes }
    }
}

impl ReducedTable {
    /// The same matrices for an engine that keeps light as linear red, green and blue, and U.
    pub fn in_engine(mut self, engine: &EngineSpace) -> Self {
        for NodeMatrix(numbers) in &mut self.nodes {
            let (rows, _) = numbers.as_chunks_mut::<4>();
            let matrix = [0, 1, 2, 3].map(|row| rows[row].map(f64::from));
            let found = engine.matrix(ReducedMatrix(matrix)).0;
            rows.iter_mut().zip(found).for_each(|(row, found)| *row = found.map(to_single));
        }
        self
    }

    /// The matrix of a color, `[outgoing][incident]`, each X, Y, Z, U (or R, G, B, U after
    /// [`ReducedTable::in_engine`]); nothing is allocated.
    ///
    /// # Errors
    ///
    /// [`LookupError::Outside`] if a component is not a number in 0..=1. Clamp first for the nearest color of the
    /// cube.
    #[inline]
    pub fn matrix(&self, rgb: [f32; 3]) -> Result<[[f32; 4]; 4], LookupError> {
        let corners = Corners::around(self.resolution, rgb)
            .ok_or_else(|| LookupError::outside(rgb.map(f64::from)))?;
        let mut sum = [0.0; 16];
        for (node, weight) in corners.nodes.into_iter().zip(corners.weights) {
            let numbers = &self.nodes[node as usize].0;
            (0..16).for_each(|i| sum[i] += weight * numbers[i]);
        }
        let (rows, _) = sum.as_chunks::<4>();
        Ok([rows[0], rows[1], rows[2], rows[3]])
    }

    /// The matrices of the nodes, 16 numbers each, `[blue][green][red][outgoing][incident]`, as devices read them.
    pub fn nodes(&self) -> impl ExactSizeIterator<Item = [f32; 16]> + '_ {
        self.nodes.iter().map(|node| node.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cube::FitRecord;
    use crate::cube::interpolation::Interpolation;
    use crate::random::{Random, models};
    use upglow_color::{Contract, Grid, LinearRgb};

    #[test]
    fn a_looked_up_matrix_is_that_of_the_mixture() {
        // Single precision of numbers up to a few units, and of positions up to 4.
        const SINGLE: f64 = 1e-5;
        let contract = Contract::default();
        let basis = ReducedBasis::try_new(&contract, Grid::FIT).unwrap();
        for (seed, model) in (0..).zip(models()) {
            let mut random = Random::new(seed);
            let nodes = (0..125).map(|_| random.node(&model)).collect();
            let cube = Cube::new(contract.clone(), model, FitRecord::default(), 5, nodes).unwrap();
            let reduced = ReducedModel::new(cube.model(), &basis);
            let table = cube.reduced_table(&basis);
            for _ in 0..100 {
                let rgb = [(); 3].map(|()| to_single(random.unit()));
                let found = table.matrix(rgb).unwrap();
                let color = LinearRgb(rgb.map(f64::from));
                let mixture = cube.lookup(color, Interpolation::Blend).unwrap();
                let expected = mixture.reduced_matrix(&reduced).0;
                for (found, expected) in found.as_flattened().iter().zip(expected.as_flattened()) {
                    assert!((f64::from(*found) - expected).abs() < SINGLE, "{rgb:?}");
                }
            }
            let refused = table.matrix([0.5, -1.0, 0.5]).unwrap_err().to_string();
            assert_eq!(refused, "green is -1, expected 0 to 1, the range of the cube");
        }
    }
}
