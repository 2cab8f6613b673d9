//! Which colors are checked: all nodes, a series of grays, and random colors.

use std::ops::Range;

use upglow::Cube;
use upglow_color::LinearRgb;

use super::VerifyOptions;
use super::finding::Subject;

/// How many grays from black to white are checked. Fewer could miss a cell of the largest cube, which
/// has 255 along the diagonal; more find nothing new within a cell.
const GRAYS: usize = 1001;

/// Colors per piece of work. With larger pieces threads idle at the end; smaller ones cost more
/// overhead. The report does not depend on it.
const PIECE: usize = 1024;

/// All colors to check, numbered from 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Subjects {
    nodes: usize,
    points: usize,
    seed: u64,
}

impl Subjects {
    pub(super) fn new(cube: &Cube, options: &VerifyOptions) -> Self {
        Self { nodes: cube.nodes().len(), points: options.points, seed: options.seed }
    }

    pub(super) fn len(&self) -> usize {
        (self.nodes + GRAYS).saturating_add(self.points)
    }

    pub(super) fn pieces(&self) -> usize {
        self.len().div_ceil(PIECE)
    }

    /// The numbers of the subjects in one piece.
    pub(super) fn piece(&self, number: usize) -> Range<usize> {
        number * PIECE..self.len().min((number + 1).saturating_mul(PIECE))
    }

    pub(super) fn get(&self, index: usize) -> Subject {
        let gray = index.wrapping_sub(self.nodes);
        let point = gray.wrapping_sub(GRAYS);
        if index < self.nodes {
            Subject::Node(index)
        } else if gray < GRAYS {
            Subject::Gray(LinearRgb([gray as f64 / (GRAYS - 1) as f64; 3]))
        } else {
            Subject::Point(random_rgb(self.seed, point))
        }
    }

    /// Whether this subject is one of the first `count` random colors.
    pub(super) fn is_among_first_points(&self, index: usize, count: usize) -> bool {
        (self.nodes + GRAYS..self.nodes + GRAYS + count).contains(&index)
    }
}

/// Pseudo-random color number `index` for a seed, each component in 0..1.
pub fn random_rgb(seed: u64, index: usize) -> LinearRgb {
    let first = (index as u64).wrapping_mul(3);
    LinearRgb([1, 2, 3].map(|k| unit(split_mix(seed, first.wrapping_add(k)))))
}

/// Number `step` of the `SplitMix64` sequence of a seed, computed without those before it.
///
/// # Source
///
/// Steele, Lea and Flood 2014, Fast splittable pseudorandom number generators, figure 13.
fn split_mix(seed: u64, step: u64) -> u64 {
    const GOLDEN_GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;
    let z = seed.wrapping_add(step.wrapping_mul(GOLDEN_GAMMA));
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The upper 53 bits as a number in 0..1.
fn unit(bits: u64) -> f64 {
    const STEP: f64 = 1.0 / (1_u64 << 53) as f64;
    (bits >> 11) as f64 * STEP
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sequence_is_split_mix_64() {
        // The published test sequence for seed 1234567 (Rosetta Code, Vigna's splitmix64.c).
        let expected = [6_457_827_717_110_365_317, 3_203_168_211_198_807_973];
        assert_eq!([1, 2].map(|step| split_mix(1_234_567, step)), expected);
    }

    #[test]
    fn pieces_hold_every_subject_once() {
        let subjects = Subjects { nodes: 1000, points: 5000, seed: 1 };
        let all: Vec<usize> = (0..subjects.pieces()).flat_map(|p| subjects.piece(p)).collect();
        assert_eq!(all, (0..7001).collect::<Vec<_>>());
        assert_eq!(subjects.get(999), Subject::Node(999));
        assert_eq!(subjects.get(2000), Subject::Gray(LinearRgb([1.0; 3])));
        assert!(subjects.is_among_first_points(2001, 1));
        assert!(!subjects.is_among_first_points(2000, 1));
    }

    #[test]
    fn the_number_of_points_may_be_any() {
        let subjects = Subjects { nodes: 8, points: usize::MAX, seed: u64::MAX };
        let last = subjects.piece(subjects.pieces() - 1);
        assert_eq!(last.end, usize::MAX);
        assert!(matches!(subjects.get(last.end - 1), Subject::Point(_)));
    }

    #[test]
    fn random_colors_fill_the_cube() {
        let mut mean = [0.0; 3];
        for i in 0..10_000 {
            let LinearRgb(rgb) = random_rgb(7, i);
            assert!(rgb.iter().all(|v| (0.0..1.0).contains(v)));
            (0..3).for_each(|k| mean[k] += rgb[k] / 10_000.0);
        }
        // Five standard errors of a mean of uniform numbers.
        assert!(mean.iter().all(|m| (m - 0.5).abs() < 0.015), "{mean:?}");
    }
}
