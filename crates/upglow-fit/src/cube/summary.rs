//! How well the nodes of a cube match their colors.

use upglow::Cube;

use crate::kind::{KindCounts, MaterialKind};

/// Statistics of the stored differences of a cube's nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[must_use]
pub struct CubeSummary {
    /// Nodes of the cube.
    pub nodes: usize,
    /// Nodes within [`CubeSummary::EXACT_DE2000`] of their color.
    pub exact: usize,
    /// Nodes within 1 CIEDE2000 of their color.
    pub within_1: usize,
    /// Nodes within 2 CIEDE2000 of their color.
    pub within_2: usize,
    /// Mean CIEDE2000 over the nodes.
    pub mean_de2000: f64,
    /// The smallest CIEDE2000 that at least 95 % of the nodes do not exceed.
    pub p95_de2000: f64,
    /// Greatest CIEDE2000 of a node.
    pub max_de2000: f64,
    /// Nodes whose material fluoresces.
    pub fluorescent: usize,
    /// Nodes of each kind of material, under the limits that the cube records.
    pub kinds: KindCounts,
}

impl CubeSummary {
    /// A material within this difference matches its color. Smaller would count rounding to single
    /// precision as a miss; larger would count misses as matches that can be seen in a gradient.
    pub const EXACT_DE2000: f64 = 0.01;

    /// Reads the differences that the cube stores; nothing is recomputed.
    pub fn of(cube: &Cube) -> Self {
        let found: Vec<f64> = cube.nodes().iter().map(|node| node.de2000.into()).collect();
        let within = |limit: f64| found.iter().filter(|&&d| d <= limit).count();
        let glows = |&index: &usize| cube.node_material(index).fluorescence.dose() > 0.0;
        let spread = Spread::of(found.clone());
        Self {
            nodes: found.len(),
            exact: within(Self::EXACT_DE2000),
            within_1: within(1.0),
            within_2: within(2.0),
            mean_de2000: spread.mean,
            p95_de2000: spread.p95,
            max_de2000: spread.max,
            fluorescent: (0..found.len()).filter(glows).count(),
            kinds: cube.nodes().iter().map(|node| MaterialKind::of_node(node, cube)).collect(),
        }
    }
}

/// Mean, 95th percentile and greatest of some numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Spread {
    /// The mean.
    pub mean: f64,
    /// By nearest rank: the smallest number that at least 95 % do not exceed.
    pub p95: f64,
    /// The greatest.
    pub max: f64,
}

impl Spread {
    /// Zeros if there are no numbers. The mean is summed in the order given.
    pub(crate) fn of(mut numbers: Vec<f64>) -> Self {
        let count = numbers.len();
        if count == 0 {
            return Self { mean: 0.0, p95: 0.0, max: 0.0 };
        }
        let mean = numbers.iter().sum::<f64>() / count as f64;
        let rank = (count * 95).div_ceil(100);
        let (_, &mut p95, _) = numbers.select_nth_unstable_by(rank - 1, f64::total_cmp);
        let max = numbers.iter().copied().max_by(f64::total_cmp).unwrap_or(0.0);
        Self { mean, p95, max }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow::{FitRecord, Model, Node};
    use upglow_color::Contract;

    #[test]
    fn percentiles_are_nearest_ranks() {
        let upto = |n: u32| Spread::of((1..=n).rev().map(f64::from).collect());
        assert_eq!(upto(100), Spread { mean: 50.5, p95: 95.0, max: 100.0 });
        assert_eq!(upto(10).p95, 10.0);
        assert_eq!(upto(20).p95, 19.0);
        assert_eq!(upto(1), Spread { mean: 1.0, p95: 1.0, max: 1.0 });
        assert_eq!(Spread::of(Vec::new()).max, 0.0);
    }

    #[test]
    fn nodes_are_counted_by_their_stored_difference() {
        let differences = [0.0, 0.009, 0.01, 0.5, 1.0, 1.5, 2.0, 7.0];
        let node = |de2000| Node { de2000, ..Node::default() };
        let fit = FitRecord { slope_max_per_nm: None, ..FitRecord::default() };
        let nodes = differences.map(node).to_vec();
        let cube = Cube::new(Contract::default(), Model::Reflectance, fit, 2, nodes).unwrap();
        let summary = CubeSummary::of(&cube);
        assert_eq!((summary.nodes, summary.exact), (8, 3));
        assert_eq!((summary.within_1, summary.within_2), (5, 7));
        assert_eq!((summary.kinds.reflectance, summary.kinds.missed), (3, 5));
        assert_eq!((summary.p95_de2000, summary.max_de2000, summary.fluorescent), (7.0, 7.0, 0));
    }
}
