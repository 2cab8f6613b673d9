//! The findings about the texels of a picture; those of parts add up to those of the whole in any order.

use upglow_color::StandingKind;
use upglow_fit::Estimate;

use super::cube_match::BlendFindings;
use super::ranking::{Candidate, Ranking};
use super::report::{Counts, Flaw, FlawedTexel};

/// Texels that are listed for each flaw: enough to find the cause.
const FIRST_FLAWED: usize = 4;

/// Texels that are measured after all have been ranked. More than are reported, because the ranking
/// uses estimates; each takes a tenth of a millisecond.
const CANDIDATES: usize = 32;

/// The findings about a part of a picture.
#[derive(Clone, Debug, Default)]
pub(super) struct Findings {
    pub(super) counts: Counts,
    pub(super) worst: Ranking<CANDIDATES>,
    pub(super) blends: BlendFindings,
    flawed: [Vec<FlawedTexel>; Flaw::ALL.len()],
}

impl Findings {
    pub(super) fn with(mut self, other: Self) -> Self {
        self.counts.join(&other.counts);
        self.worst.join(other.worst);
        self.blends.join(other.blends);
        for (all, part) in self.flawed.iter_mut().zip(other.flawed) {
            all.extend(part);
            all.sort_by_key(|texel| (texel.y, texel.x));
            all.truncate(FIRST_FLAWED);
        }
        self
    }

    /// Counts a texel whose values are all finite.
    pub(super) fn add_color(&mut self, [x, y]: [usize; 2], rgb: [f32; 3], found: &Estimate) {
        let Estimate { kind, distance, .. } = *found;
        self.counts.add(Some(kind));
        if kind != StandingKind::Reflectance {
            self.worst.add(Candidate { x, y, rgb, kind, distance });
        }
    }

    /// Counts a texel with a value outside 0..=1. Texels are added in reading order.
    pub(super) fn add_flaws(&mut self, [x, y]: [usize; 2], rgb: [f32; 3]) {
        for (flaw, first) in Flaw::ALL.into_iter().zip(&mut self.flawed) {
            if flaw.is_in(rgb) {
                self.counts.add_flaw(flaw);
                if first.len() < FIRST_FLAWED {
                    first.push(FlawedTexel { flaw, x, y, rgb });
                }
            }
        }
    }

    pub(super) fn flaws(&self) -> Vec<FlawedTexel> {
        self.flawed.concat()
    }
}
