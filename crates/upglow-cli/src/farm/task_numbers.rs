//! The numbers of tasks: `3`, `1-50` or `1,4,7-9`.

use std::ops::RangeInclusive;
use std::path::Path;
use std::str::FromStr;

use upglow_terminal::Failure;

/// Numbers of tasks in the order given, from 1 on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct TaskNumbers(Vec<RangeInclusive<usize>>);

impl FromStr for TaskNumbers {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let range = |part: &str| {
            let (first, last) = part.split_once('-').unwrap_or((part, part));
            let (first, last) = (first.trim().parse().ok()?, last.trim().parse().ok()?);
            (1..=last).contains(&first).then_some(first..=last)
        };
        let ranges: Option<Vec<_>> = text.split(',').map(range).collect();
        ranges
            .map(Self)
            .ok_or_else(|| format!("{text:?}, expected numbers from 1 on as 3, 1-50 or 1,4,7-9"))
    }
}

impl TaskNumbers {
    pub(crate) fn iter(&self) -> impl Iterator<Item = usize> {
        self.0.iter().flat_map(Clone::clone)
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.0.iter().map(|range| range.end() - range.start() + 1).fold(0, usize::saturating_add)
    }

    /// Checks that a plan with `count` tasks has them all.
    pub(crate) fn check(&self, plan: &Path, count: usize) -> Result<(), Failure> {
        match self.0.iter().map(|range| *range.end()).find(|last| *last > count) {
            None => Ok(()),
            Some(last) => {
                let plan = plan.display();
                let message = format!("task {last}, expected 1 to {count}, those of {plan}");
                Err(Failure::option("--task", message))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_given_alone_as_ranges_or_as_a_list() {
        let numbers = |text: &str| {
            let numbers = text.parse::<TaskNumbers>()?;
            assert_eq!(numbers.count(), numbers.iter().count());
            Ok::<_, String>(numbers.iter().collect::<Vec<_>>())
        };
        assert_eq!(numbers("3"), Ok(vec![3]));
        assert_eq!(numbers("2-4"), Ok(vec![2, 3, 4]));
        assert_eq!(numbers("7, 1-2,9-9"), Ok(vec![7, 1, 2, 9]));
        for text in ["", "0", "4-2", "1-", "-1", "a", "1,,2", "1-2-3", "0-3", "1.5"] {
            assert!(numbers(text).is_err(), "{text}");
        }
    }
}
