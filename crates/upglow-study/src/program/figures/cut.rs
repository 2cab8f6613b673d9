//! The part of a layer that is drawn in a panel.

use upglow_study::Layer;

/// A rectangular part of a layer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cut<'l> {
    pub(crate) layer: &'l Layer,
    /// First and last point along red.
    pub(crate) red: [usize; 2],
    /// First and last point along green.
    pub(crate) green: [usize; 2],
}

impl<'l> Cut<'l> {
    /// The part between the points nearest to these limits, each from low to high.
    pub(crate) fn of(layer: &'l Layer, red: [f64; 2], green: [f64; 2]) -> Self {
        let index = |value| Layer::nearest_node(layer.side, value);
        let [red, green] = [red, green].map(|[low, high]| [index(low), index(high)]);
        Self { layer, red, green }
    }

    /// The whole layer.
    pub(crate) fn whole(layer: &'l Layer) -> Self {
        Self::of(layer, [0.0, 1.0], [0.0, 1.0])
    }

    /// Points along red.
    pub(crate) fn columns(&self) -> usize {
        self.red[1] - self.red[0] + 1
    }

    /// Points along green.
    pub(crate) fn rows(&self) -> usize {
        self.green[1] - self.green[0] + 1
    }

    /// Indices of the points in the order of a picture's pixels: greatest green first.
    pub(crate) fn picture(&self) -> impl Iterator<Item = usize> + '_ {
        let [first, last] = self.green;
        let row = move |green: usize| {
            (self.red[0]..=self.red[1]).map(move |red| green * self.layer.side + red)
        };
        (first..=last).rev().flat_map(row)
    }

    /// Mean CIEDE2000 of the points, and the share of points within 1.
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
    use crate::cubes::{Cubes, StudyCube};
    use upglow_fit::Unwatched;

    #[test]
    fn pictures_start_with_the_greatest_green() {
        let cube = Cubes::new(4).get(StudyCube::REFERENCE, &Unwatched).unwrap();
        let layer = Layer::of_nodes(&cube, 0);
        let cut = Cut::of(&layer, [1.0 / 3.0, 1.0], [0.0, 1.0 / 3.0]);
        assert_eq!((cut.columns(), cut.rows()), (3, 2));
        assert_eq!(cut.picture().collect::<Vec<_>>(), [5, 6, 7, 1, 2, 3]);
    }
}
