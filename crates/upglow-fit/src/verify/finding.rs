//! Counts and worst values, collected in pieces and merged in order.

use upglow::Cube;
use upglow_color::LinearRgb;

use super::Offender;

/// One of the colors that are checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Subject {
    /// The node with this index.
    Node(usize),
    /// R = G = B between nodes.
    Gray(LinearRgb),
    /// A random color.
    Point(LinearRgb),
}

impl Subject {
    pub(super) fn rgb(self, cube: &Cube) -> LinearRgb {
        match self {
            Self::Node(index) => cube.node_rgb(index),
            Self::Gray(rgb) | Self::Point(rgb) => rgb,
        }
    }
}

/// A value, and the color it was found for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Finding {
    pub(super) value: f64,
    pub(super) subject: Subject,
    pub(super) wavelength_nm: Option<f64>,
}

impl Finding {
    pub(super) fn offender(self, cube: &Cube) -> Offender {
        let Self { value: found, wavelength_nm, subject } = self;
        let node = match subject {
            Subject::Node(index) => Some(cube.coordinates(index)),
            Subject::Gray(_) | Subject::Point(_) => None,
        };
        Offender { found, wavelength_nm, node, rgb: Some(subject.rgb(cube)), dye: None }
    }
}

/// The findings for one law so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Outcome {
    pub(super) checked: usize,
    pub(super) violations: usize,
    pub(super) worst: Option<Finding>,
}

impl Outcome {
    /// Records a value that must not exceed `most`. NaN exceeds everything.
    pub(super) fn see(&mut self, mut finding: Finding, most: f64) {
        if finding.value.is_nan() {
            finding.value = f64::INFINITY;
        }
        self.checked += 1;
        self.violations += usize::from(finding.value > most);
        self.keep_worst(finding);
    }

    /// Merges the outcome of a later piece; the first of equally bad findings stays.
    pub(super) fn add(&mut self, later: Self) {
        self.checked += later.checked;
        self.violations += later.violations;
        if let Some(finding) = later.worst {
            self.keep_worst(finding);
        }
    }

    fn keep_worst(&mut self, finding: Finding) {
        if self.worst.is_none_or(|worst| finding.value > worst.value) {
            self.worst = Some(finding);
        }
    }
}

/// The greater of two values; NaN is greater than any number.
pub(super) fn worse(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// The greatest of some values and its index; NaN counts as infinite.
pub(super) fn greatest(values: impl Iterator<Item = f64>) -> (f64, usize) {
    let mut best = (f64::NEG_INFINITY, 0);
    for (i, value) in values.enumerate() {
        let value = if value.is_nan() { f64::INFINITY } else { value };
        if value > best.0 {
            best = (value, i);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding(value: f64, node: usize) -> Finding {
        Finding { value, subject: Subject::Node(node), wavelength_nm: None }
    }

    #[test]
    fn merged_pieces_equal_the_whole_and_the_first_of_equals_stays() {
        let mut whole = Outcome::default();
        let mut parts = [Outcome::default(); 2];
        for (i, value) in [0.5, 2.0, 1.0, 2.0].into_iter().enumerate() {
            whole.see(finding(value, i), 1.0);
            parts[i / 2].see(finding(value, i), 1.0);
        }
        let mut sum = parts[0];
        sum.add(parts[1]);
        assert_eq!(sum, whole);
        assert_eq!((whole.checked, whole.violations), (4, 2));
        assert_eq!(whole.worst, Some(finding(2.0, 1)));
    }

    #[test]
    fn nan_breaks_every_law() {
        let mut outcome = Outcome::default();
        outcome.see(finding(f64::NAN, 0), f64::MAX);
        assert_eq!(outcome.violations, 1);
        assert!(worse(f64::NAN, 1.0).is_nan() && worse(1.0, f64::NAN).is_nan());
        assert_eq!(greatest([1.0, f64::NAN, 3.0].into_iter()), (f64::INFINITY, 1));
    }
}
