//! The first few of many, whatever the order they come in.

use std::cmp::Ordering;

/// Keeps the `N` items that come first, at most one of each key.
///
/// Joining rankings of parts gives the ranking of the whole, in any order and for any parts.
#[derive(Clone, Debug)]
pub(super) struct Ranking<T, const N: usize> {
    found: Vec<T>,
}

/// What comes first, and what counts as the same.
pub(super) trait Ranked {
    type Key: PartialEq;

    fn key(&self) -> Self::Key;

    /// `Less` comes first. Two items are equal only if they are one.
    fn order(&self, other: &Self) -> Ordering;
}

impl<T, const N: usize> Default for Ranking<T, N> {
    fn default() -> Self {
        Self { found: Vec::new() }
    }
}

impl<T: Ranked, const N: usize> Ranking<T, N> {
    pub(super) fn found(&self) -> &[T] {
        &self.found
    }

    pub(super) fn add(&mut self, item: T) {
        let too_late = |last: &T| last.order(&item) != Ordering::Greater;
        if self.found.len() == N && self.found.last().is_some_and(too_late) {
            return;
        }
        let key = item.key();
        if let Some(twin) = self.found.iter().position(|other| other.key() == key) {
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

    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Item(u32, u8);

    impl Ranked for Item {
        type Key = u8;

        fn key(&self) -> u8 {
            self.1
        }

        fn order(&self, other: &Self) -> Ordering {
            self.0.cmp(&other.0)
        }
    }

    proptest! {
        #[test]
        fn parts_join_to_the_ranking_of_the_whole(
            numbers in prop::collection::vec(0..1000_u32, 0..200),
            keys in prop::collection::vec(0..9_u8, 200),
            cut in 0..200_usize,
        ) {
            let items: Vec<Item> = numbers
                .iter()
                .enumerate()
                .map(|(i, n)| Item(n * 200 + u32::try_from(i).unwrap(), keys[i]))
                .collect();
            let (first, second) = items.split_at(cut.min(items.len()));
            let rank = |items: &[Item]| {
                let mut ranking = Ranking::<Item, 4>::default();
                items.iter().for_each(|item| ranking.add(*item));
                ranking
            };
            let mut joined = rank(second);
            joined.join(rank(first));
            let mut sorted = items.clone();
            sorted.sort_by_key(|item| item.0);
            let mut seen = Vec::new();
            sorted.retain(|item| !seen.contains(&item.1) && { seen.push(item.1); true });
            sorted.truncate(4);
            prop_assert_eq!(joined.found(), &sorted[..]);
        }
    }
}
