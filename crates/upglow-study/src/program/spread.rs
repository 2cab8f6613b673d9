//! Statistics of a set of numbers.

/// Count, mean, median and tail of a set of numbers; all zero for an empty set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Spread {
    pub(crate) count: usize,
    pub(crate) mean: f64,
    pub(crate) median: f64,
    /// The 95th percentile.
    pub(crate) p95: f64,
    pub(crate) max: f64,
}

impl Spread {
    pub(crate) fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_by(f64::total_cmp);
        let count = values.len();
        if count == 0 {
            return Self::default();
        }
        Self {
            count,
            mean: values.iter().sum::<f64>() / count as f64,
            median: values[(count - 1) / 2],
            p95: values[(count - 1) * 95 / 100],
            max: values[count - 1],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_is_that_of_the_ordered_numbers() {
        let spread = Spread::of((0..=100).rev().map(f64::from));
        let expected = Spread { count: 101, mean: 50.0, median: 50.0, p95: 95.0, max: 100.0 };
        assert_eq!(spread, expected);
        assert_eq!(Spread::of([]), Spread::default());
    }
}
