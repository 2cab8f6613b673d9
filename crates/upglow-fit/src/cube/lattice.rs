//! The nodes of a cube, their neighbors, and the order in which they are fitted.

use upglow::{Cube, CubeError};
use upglow_color::LinearRgb;

/// The nodes of a cube, `[blue][green][red]`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lattice {
    resolution: usize,
}

/// Every so many nodes along an axis are fitted alone: 8³ of 32³. With 2, a cube of reflectances takes
/// nearly twice the evaluations and is no better; with 8, two hundred of its nodes end more than
/// 0.02 ΔE00 worse than if fitted alone.
const COARSEST: usize = 4;

/// The nodes that one step of refinement adds to a lattice.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Refinement {
    lattice: Lattice,
    /// Distance between nodes after this step; half of that before.
    stride: usize,
}

impl Lattice {
    /// # Errors
    ///
    /// [`CubeError`] if the resolution is out of range.
    pub(crate) fn try_new(resolution: usize) -> Result<Self, CubeError> {
        let [least, most] = Cube::RESOLUTIONS;
        if (least..=most).contains(&resolution) {
            Ok(Self { resolution })
        } else {
            Err(CubeError::Resolution { found: resolution })
        }
    }

    pub(crate) fn len(self) -> usize {
        self.resolution.pow(3)
    }

    pub(crate) fn rgb(self, index: usize) -> LinearRgb {
        let last = (self.resolution - 1) as f64;
        LinearRgb(self.places(index).map(|place| place as f64 / last))
    }

    /// 0 and 1 like the fields of a chessboard: neighbors differ.
    pub(crate) fn parity(self, index: usize) -> usize {
        self.places(index).iter().sum::<usize>() % 2
    }

    /// The up to six nodes next to one.
    pub(crate) fn neighbors(self, index: usize) -> impl Iterator<Item = usize> {
        let n = self.resolution;
        [1, n, n * n].into_iter().flat_map(move |stride| {
            let place = index / stride % n;
            let below = (place > 0).then(|| index - stride);
            let above = (place + 1 < n).then(|| index + stride);
            below.into_iter().chain(above)
        })
    }

    /// The coarsest nodes and each step that refines them; together they hold every node once.
    pub(crate) fn refinements(self) -> impl Iterator<Item = Refinement> {
        let halved = |&stride: &usize| (stride > 1).then_some(stride / 2);
        std::iter::successors(Some(COARSEST), halved)
            .map(move |stride| Refinement { lattice: self, stride })
    }

    /// Indices of a node along red, green, blue.
    fn places(self, index: usize) -> [usize; 3] {
        let n = self.resolution;
        [index % n, index / n % n, index / (n * n)]
    }

    fn index(self, [red, green, blue]: [usize; 3]) -> usize {
        red + self.resolution * (green + self.resolution * blue)
    }

    fn is_on(self, index: usize, stride: usize) -> bool {
        self.places(index).iter().all(|place| place % stride == 0)
    }
}

impl Refinement {
    /// The nodes of this step in their order.
    pub(crate) fn nodes(self) -> Vec<usize> {
        let Self { lattice, stride } = self;
        let is_new = |&i: &usize| self.is_coarsest() || !lattice.is_on(i, 2 * stride);
        (0..lattice.len()).filter(|&i| lattice.is_on(i, stride)).filter(is_new).collect()
    }

    /// The nodes of earlier steps at the corners of the cell that holds a node, up to eight;
    /// none for the coarsest.
    pub(crate) fn around(self, index: usize) -> impl Iterator<Item = usize> {
        let Self { lattice, stride } = self;
        let places = lattice.places(index);
        let corners = if self.is_coarsest() { 0 } else { 8 };
        (0..corners).filter_map(move |corner| {
            let mut at = [0; 3];
            for (k, place) in places.into_iter().enumerate() {
                let offset = place % (2 * stride);
                let is_above = corner >> k & 1 == 1;
                // Without an offset along this axis both corners are the same: take one.
                if is_above && offset == 0 {
                    return None;
                }
                at[k] = place - offset + if is_above { 2 * stride } else { 0 };
            }
            at.iter().all(|&place| place < lattice.resolution).then(|| lattice.index(at))
        })
    }

    fn is_coarsest(self) -> bool {
        self.stride == COARSEST
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_steps_hold_every_node_once_and_build_on_earlier_ones() {
        for resolution in [2, 5, 8, 9] {
            let lattice = Lattice::try_new(resolution).expect("it is in range");
            let mut is_known = vec![false; lattice.len()];
            for step in lattice.refinements() {
                let nodes = step.nodes();
                for &node in &nodes {
                    assert!(step.around(node).all(|corner| is_known[corner]), "{node}");
                    assert_eq!(step.around(node).next().is_none(), step.is_coarsest(), "{node}");
                }
                for node in nodes {
                    assert!(!std::mem::replace(&mut is_known[node], true), "{node}");
                }
            }
            assert!(!is_known.contains(&false));
        }
    }

    #[test]
    fn a_node_in_the_middle_of_a_cell_is_surrounded_by_eight_corners() {
        let lattice = Lattice::try_new(9).expect("it is in range");
        let finest = lattice.refinements().last().expect("there are steps");
        let around: Vec<[usize; 3]> =
            finest.around(lattice.index([1, 3, 5])).map(|i| lattice.places(i)).collect();
        assert_eq!(around.len(), 8);
        assert!(around.contains(&[0, 2, 4]) && around.contains(&[2, 4, 6]));
        let on_edge = finest.around(lattice.index([2, 3, 4]));
        assert_eq!(on_edge.map(|i| lattice.places(i)[1]).collect::<Vec<_>>(), [2, 4]);
    }
}
