//! What is counted and remembered of texels; parts of a picture add up to the whole, in any order.

use std::cmp::Ordering;

use upglow_color::StandingKind;
use upglow_fit::Estimate;

use super::cube_match::DifferenceSums;
use super::ranking::{Ranked, Ranking};
use super::report::{Counts, Flaw, FlawedTexel};

/// Flawed texels to tell the places of, for each flaw: enough to find the cause.
const FIRST_FLAWED: usize = 4;

/// Texels that are measured when all are seen. More than are reported, for they are ranked by
/// estimates; each takes a tenth of a millisecond.
const CANDIDATES: usize = 32;

/// Steps from 0 to the largest channel: colors whose channels round to the same steps, with the
/// largest in the same octave, are nearly the same. With more, a slope of one hue fills the list;
/// with fewer, one texel stands for too many others.
const STEPS: f32 = 4.0;

/// What is known of a part of a picture.
#[derive(Clone, Debug, Default)]
pub(super) struct Findings {
    pub(super) counts: Counts,
    pub(super) worst: Ranking<Candidate, CANDIDATES>,
    pub(super) differences: DifferenceSums,
    flawed: [Ranking<FlawedTexel, FIRST_FLAWED>; Flaw::ALL.len()],
}

impl Findings {
    pub(super) fn with(mut self, other: Self) -> Self {
        self.counts.join(&other.counts);
        self.worst.join(other.worst);
        self.differences.join(&other.differences);
        self.flawed.iter_mut().zip(other.flawed).for_each(|(all, part)| all.join(part));
        self
    }

    /// Counts a texel whose values are all finite.
    pub(super) fn add_color(&mut self, [x, y]: [usize; 2], rgb: [f32; 3], found: &Estimate) {
        let Estimate { kind, distance, .. } = *found;
        self.counts.add(Some(kind));
        if kind != StandingKind::Reflectance {
            self.worst.add(Candidate { x, y, rgb, kind, distance, likeness: likeness(rgb) });
        }
    }

    /// Counts a texel with a value outside 0..=1.
    pub(super) fn add_flaws(&mut self, [x, y]: [usize; 2], rgb: [f32; 3]) {
        for (flaw, first) in Flaw::ALL.into_iter().zip(&mut self.flawed) {
            if flaw.is_in(rgb) {
                self.counts.add_flaw(flaw);
                first.add(FlawedTexel { flaw, x, y, rgb });
            }
        }
    }

    pub(super) fn flaws(&self) -> Vec<FlawedTexel> {
        self.flawed.iter().flat_map(|first| first.found().iter().copied()).collect()
    }
}

impl Ranked for FlawedTexel {
    type Key = (usize, usize);

    fn key(&self) -> Self::Key {
        (self.y, self.x)
    }

    fn order(&self, other: &Self) -> Ordering {
        self.key().cmp(&other.key())
    }
}

/// A texel that may be among the worst.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) x: usize,
    pub(super) y: usize,
    pub(super) rgb: [f32; 3],
    pub(super) kind: StandingKind,
    distance: f64,
    likeness: [u32; 4],
}

/// The same for colors that are nearly the same.
fn likeness(rgb: [f32; 3]) -> [u32; 4] {
    let largest = rgb.iter().fold(f32::MIN_POSITIVE, |m, v| m.max(v.abs()));
    let octave = largest.to_bits() >> (f32::MANTISSA_DIGITS - 1);
    // Adding 0 makes one zero of two.
    let [r, g, b] = rgb.map(|v| ((v / largest * STEPS).round() + 0.0).to_bits());
    [octave, r, g, b]
}

impl Ranked for Candidate {
    type Key = [u32; 4];

    fn key(&self) -> Self::Key {
        self.likeness
    }

    fn order(&self, other: &Self) -> Ordering {
        let worse = other.kind.cmp(&self.kind).then(other.distance.total_cmp(&self.distance));
        worse.then((self.y, self.x).cmp(&(other.y, other.x)))
    }
}
