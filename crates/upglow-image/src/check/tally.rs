//! What is counted and remembered of texels; parts of a picture add up to the whole, in any order.

use std::cmp::Ordering;
use std::fmt;

use upglow_color::StandingKind;
use upglow_fit::Estimate;

use super::opinion::OpinionTally;
use super::ranking::{Ranked, Ranking};

/// How many texels are what.
///
/// The first three and those with a value that is no number or infinite add up to all texels. The
/// last four count texels with such a value in any channel: one texel may count in more than one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Texels.
    pub texels: u64,
    /// Some reflectance shows them.
    pub reflectance: u64,
    /// No reflectance, but some fluorescent material shows them.
    pub needs_fluorescence: u64,
    /// No material shows them.
    pub unreachable: u64,
    /// No colors: a value is no number or infinite.
    pub no_color: u64,
    /// A value is finite and above 1.
    pub above_one: u64,
    /// A value is finite and below 0.
    pub negative: u64,
    /// A value is no number.
    pub not_a_number: u64,
    /// A value is infinite.
    pub infinite: u64,
}

impl Counts {
    /// Texels with this flaw.
    pub fn of(&self, flaw: Flaw) -> u64 {
        match flaw {
            Flaw::AboveOne => self.above_one,
            Flaw::Negative => self.negative,
            Flaw::NotANumber => self.not_a_number,
            Flaw::Infinite => self.infinite,
        }
    }

    /// Whether every value is in 0..=1.
    pub fn all_in_range(&self) -> bool {
        Flaw::ALL.iter().all(|&flaw| self.of(flaw) == 0)
    }

    fn add(&mut self, other: &Self) {
        self.texels += other.texels;
        self.reflectance += other.reflectance;
        self.needs_fluorescence += other.needs_fluorescence;
        self.unreachable += other.unreachable;
        self.no_color += other.no_color;
        self.above_one += other.above_one;
        self.negative += other.negative;
        self.not_a_number += other.not_a_number;
        self.infinite += other.infinite;
    }
}

/// A value that is no component of a color in a cube.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Flaw {
    /// Finite and above 1.
    #[cfg_attr(feature = "serde", serde(rename = "above 1"))]
    AboveOne,
    /// Finite and below 0.
    #[cfg_attr(feature = "serde", serde(rename = "negative"))]
    Negative,
    /// No number.
    #[cfg_attr(feature = "serde", serde(rename = "no number"))]
    NotANumber,
    /// Infinite, of either sign.
    #[cfg_attr(feature = "serde", serde(rename = "infinite"))]
    Infinite,
}

impl Flaw {
    /// Every flaw.
    pub const ALL: [Self; 4] = [Self::AboveOne, Self::Negative, Self::NotANumber, Self::Infinite];

    /// Whether a channel of `rgb` has it.
    pub fn is_in(self, rgb: [f32; 3]) -> bool {
        rgb.iter().any(|&v| match self {
            Self::AboveOne => v > 1.0 && v.is_finite(),
            Self::Negative => v < 0.0 && v.is_finite(),
            Self::NotANumber => v.is_nan(),
            Self::Infinite => v.is_infinite(),
        })
    }
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AboveOne => "above 1",
            Self::Negative => "negative",
            Self::NotANumber => "not a number",
            Self::Infinite => "infinite",
        })
    }
}

/// A texel with a flaw.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Located {
    /// What is wrong with it.
    pub flaw: Flaw,
    /// Column, from 0 at the left.
    pub x: usize,
    /// Row, from 0 at the top.
    pub y: usize,
    /// Its values.
    pub rgb: [f32; 3],
}

/// Two are equal if they have the same bits: a value may be no number.
impl PartialEq for Located {
    fn eq(&self, other: &Self) -> bool {
        let bits = |texel: &Self| texel.rgb.map(f32::to_bits);
        (self.flaw, self.x, self.y, bits(self)) == (other.flaw, other.x, other.y, bits(other))
    }
}

/// Flawed texels to tell the places of, for each flaw: enough to find the cause.
const LOCATED: usize = 4;

/// Texels that are measured when all are seen. More than are reported, for they are ranked by
/// estimates; each takes a tenth of a millisecond.
const CANDIDATES: usize = 32;

/// Steps from 0 to the largest channel: colors whose channels round to the same steps, with the
/// largest in the same octave, are nearly the same. With more, a slope of one hue fills the list;
/// with fewer, one texel stands for too many others.
const STEPS: f32 = 4.0;

/// What is known of a part of a picture.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    pub(super) counts: Counts,
    pub(super) worst: Ranking<Candidate, CANDIDATES>,
    pub(super) opinion: OpinionTally,
    flawed: [Ranking<Located, LOCATED>; Flaw::ALL.len()],
}

impl Tally {
    pub(super) fn with(mut self, other: Self) -> Self {
        self.counts.add(&other.counts);
        self.worst.join(other.worst);
        self.opinion.add(&other.opinion);
        self.flawed.iter_mut().zip(other.flawed).for_each(|(all, part)| all.join(part));
        self
    }

    /// Takes note of a texel whose values are all finite.
    pub(super) fn judged(&mut self, (x, y): (usize, usize), rgb: [f32; 3], found: &Estimate) {
        let Estimate { kind, distance, .. } = *found;
        self.counts.texels += 1;
        match kind {
            StandingKind::Reflectance => self.counts.reflectance += 1,
            StandingKind::NeedsFluorescence => self.counts.needs_fluorescence += 1,
            StandingKind::Unreachable => self.counts.unreachable += 1,
        }
        if kind != StandingKind::Reflectance {
            self.worst.add(Candidate::new((y, x), rgb, kind, distance));
        }
    }

    /// Takes note of a texel that is no color.
    pub(super) fn no_color(&mut self) {
        self.counts.texels += 1;
        self.counts.no_color += 1;
    }

    /// Takes note of a texel with a value outside 0..=1.
    pub(super) fn flawed(&mut self, (x, y): (usize, usize), rgb: [f32; 3]) {
        for (flaw, first) in Flaw::ALL.into_iter().zip(&mut self.flawed) {
            if flaw.is_in(rgb) {
                *self.counts.of_mut(flaw) += 1;
                first.add(Located { flaw, x, y, rgb });
            }
        }
    }

    pub(super) fn located(&self) -> Vec<Located> {
        self.flawed.iter().flat_map(|first| first.found().iter().copied()).collect()
    }
}

impl Counts {
    fn of_mut(&mut self, flaw: Flaw) -> &mut u64 {
        match flaw {
            Flaw::AboveOne => &mut self.above_one,
            Flaw::Negative => &mut self.negative,
            Flaw::NotANumber => &mut self.not_a_number,
            Flaw::Infinite => &mut self.infinite,
        }
    }
}

impl Ranked for Located {
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
    row_major: (usize, usize),
    pub(super) rgb: [f32; 3],
    pub(super) kind: StandingKind,
    distance: f64,
    key: [u32; 4],
}

impl Candidate {
    fn new(row_major: (usize, usize), rgb: [f32; 3], kind: StandingKind, distance: f64) -> Self {
        Self { row_major, rgb, kind, distance, key: likeness(rgb) }
    }

    /// Column and row.
    pub(super) fn place(&self) -> (usize, usize) {
        (self.row_major.1, self.row_major.0)
    }
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
        self.key
    }

    fn order(&self, other: &Self) -> Ordering {
        let worse = other.kind.cmp(&self.kind).then(other.distance.total_cmp(&self.distance));
        worse.then(self.row_major.cmp(&other.row_major))
    }
}
