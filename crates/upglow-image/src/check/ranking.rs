//! The worst texels of a picture.

use std::cmp::Ordering;

use upglow_color::StandingKind;

/// Steps from 0 to the largest channel: colors whose channels round to the same steps, and whose
/// largest channels are in the same octave, are alike. With more steps, a gradient of one hue fills the
/// list; with fewer, one texel stands for too many others.
const STEPS: f32 = 4.0;

/// A texel that may be among the worst.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    pub(super) x: usize,
    pub(super) y: usize,
    pub(super) rgb: [f32; 3],
    /// The kind of material that the color needs, which comes first; the same for all where only the
    /// distance counts.
    pub(super) kind: StandingKind,
    /// Estimated distance beyond the colors of materials, or beyond those of reflectances; or a cube's
    /// difference.
    pub(super) distance: f64,
}

impl Candidate {
    /// The same for colors that are alike.
    fn likeness(&self) -> [u32; 4] {
        let largest = self.rgb.iter().fold(f32::MIN_POSITIVE, |m, v| m.max(v.abs()));
        let octave = largest.to_bits() >> (f32::MANTISSA_DIGITS - 1);
        // Adding 0 turns −0 into 0.
        let [r, g, b] = self.rgb.map(|v| ((v / largest * STEPS).round() + 0.0).to_bits());
        [octave, r, g, b]
    }

    /// `Less` for the worse of two texels. `Equal` only for the same texel.
    fn order(&self, other: &Self) -> Ordering {
        let worse = other.kind.cmp(&self.kind).then(other.distance.total_cmp(&self.distance));
        worse.then((self.y, self.x).cmp(&(other.y, other.x)))
    }
}

/// The `N` worst candidates, of which no two are alike.
///
/// Joining the rankings of the parts of a picture gives the ranking of the whole, in any order and for
/// any division into parts.
#[derive(Clone, Debug, Default)]
pub(super) struct Ranking<const N: usize> {
    /// From the worst on.
    pub(super) found: Vec<Candidate>,
}

impl<const N: usize> Ranking<N> {
    pub(super) fn add(&mut self, item: Candidate) {
        let too_late = |last: &Candidate| last.order(&item) != Ordering::Greater;
        if self.found.len() == N && self.found.last().is_some_and(too_late) {
            return;
        }
        let likeness = item.likeness();
        if let Some(twin) = self.found.iter().position(|other| other.likeness() == likeness) {
            if too_late(&self.found[twin]) {
                return;
            }
            self.found.remove(twin);
        }
        let index = self.found.partition_point(|other| other.order(&item) == Ordering::Less);
        self.found.insert(index, item);
        self.found.truncate(N);
    }

    pub(super) fn join(&mut self, other: Self) {
        other.found.into_iter().for_each(|item| self.add(item));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn parts_join_to_the_ranking_of_the_whole(
            distances in prop::collection::vec(0..50_u32, 0..200),
            colors in prop::collection::vec(0..9_u8, 200),
            cut in 0..200_usize,
        ) {
            let items: Vec<Candidate> = distances
                .iter()
                .zip(&colors)
                .enumerate()
                .map(|(x, (&distance, &color))| Candidate {
                    x,
                    y: 0,
                    rgb: [f32::from(color % 3) / 2.0, f32::from(color / 3) / 2.0, 1.0],
                    kind: StandingKind::Unreachable,
                    distance: f64::from(distance),
                })
                .collect();
            let (first, second) = items.split_at(cut.min(items.len()));
            let rank = |items: &[Candidate]| {
                let mut ranking = Ranking::<4>::default();
                items.iter().for_each(|item| ranking.add(*item));
                ranking
            };
            let mut joined = rank(second);
            joined.join(rank(first));
            let mut sorted = items.clone();
            sorted.sort_by(|a, b| b.distance.total_cmp(&a.distance).then(a.x.cmp(&b.x)));
            let mut seen = Vec::new();
            sorted.retain(|item| !seen.contains(&item.rgb) && { seen.push(item.rgb); true });
            sorted.truncate(4);
            prop_assert_eq!(joined.found, sorted);
        }
    }
}
