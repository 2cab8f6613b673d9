//! Statistics of a set of numbers.

/// Count, mean, median and tail of a set of numbers; all zero for an empty set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Spread {
    pub(crate) count: usize,
    pub(crate) mean: f64,
    pub(crate) median: f64,
    /// The standard error of the mean of such numbers; 0 for a single one.
    pub(crate) standard_error: f64,
    /// The 95th percentile.
    pub(crate) p95: f64,
    /// The 99th percentile.
    pub(crate) p99: f64,
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
        let mean = values.iter().sum::<f64>() / count as f64;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        let pairs = count * (count - 1).max(1);
        Self {
            count,
            mean,
            standard_error: (squares / pairs as f64).sqrt(),
            median: values[(count - 1) / 2],
            p95: values[(count - 1) * 95 / 100],
            p99: values[(count - 1) * 99 / 100],
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
        // The variance of the whole numbers from 0 to n - 1 is n (n + 1) / 12.
        let standard_error = (102.0_f64 / 12.0).sqrt();
        let expected = Spread {
            count: 101,
            mean: 50.0,
            standard_error,
            median: 50.0,
            p95: 95.0,
            p99: 99.0,
            max: 100.0,
        };
        assert_eq!(spread, expected);
        assert_eq!(Spread::of([]), Spread::default());
    }
}
