//! How well a cube's materials match a picture.

use upglow_color::rounding::to_single;
use upglow_color::{Lab, LinearRgb, StandingKind, Xyz, ciede2000};
use upglow_fit::{CubeSummary, KindCounts, MaterialKind};

use super::alternatives::{Change, MissedTexel, WiderSpace};
use super::display::Display;
use super::draw::Draw;
use super::dye_use::{DyeSums, DyeUse};
use super::hue::Hue;
use super::limits::{Blends, Limits};
use super::palette::CubeHeat;
use super::ranking::{Candidate, Ranking};

/// How well a cube's mixtures match the texels of a picture whose values are in 0..=1.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CubeMatch {
    /// The name of the cube's file.
    pub file: String,
    /// Texels with all values in 0..=1.
    pub texels: u64,
    /// Share of them matched within 1 ΔE00, 0..=1.
    pub within_one: f64,
    /// Share of them matched within 2 ΔE00, 0..=1.
    pub within_two: f64,
    /// Mean ΔE00.
    pub mean_de2000: f64,
    /// Greatest ΔE00.
    pub greatest_de2000: f64,
    /// Texels of each kind of material.
    pub kinds: KindCounts,
    /// Texels more than 1 ΔE00 off.
    pub beyond_one: BeyondOne,
    /// Where there is dye, and how much.
    pub dye: DyeUse,
    /// The texels furthest off, of those that the cube misses; at most
    /// [`Checker::WORST`](crate::Checker::WORST), no two of nearly the same color.
    pub worst: Vec<MissedTexel>,
    /// What other cubes would do, after what this one does.
    pub changes: Vec<Change>,
    /// An RGB space that has texels outside 0..=1 inside, if one has.
    pub wider_space: Option<WiderSpace>,
}

/// Texels of which a cube's blends are more than 1 ΔE00 off, by the kind of material that they need, and
/// by hue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BeyondOne {
    /// `[kind][hue]`, in the order of [`StandingKind`] and [`Hue::ALL`].
    counts: [[u64; Hue::ALL.len()]; KINDS.len()],
}

const KINDS: [StandingKind; 3] =
    [StandingKind::Reflectance, StandingKind::NeedsFluorescence, StandingKind::Unreachable];

impl BeyondOne {
    /// All of them.
    pub fn texels(&self) -> u64 {
        KINDS.iter().map(|kind| self.of(*kind)).sum()
    }

    /// Those that need this kind of material.
    pub fn of(&self, kind: StandingKind) -> u64 {
        self.counts[kind as usize].iter().sum()
    }

    /// The most frequent kind, its most frequent hue if that is more than half of all, and how many these are.
    pub(super) fn most(&self) -> (StandingKind, Option<Hue>, u64) {
        let kind = KINDS.into_iter().max_by_key(|kind| self.of(*kind)).expect("there are three");
        let count = |hue: Hue| self.counts[kind as usize][hue as usize];
        let hue = Hue::ALL.into_iter().find(|hue| 2 * count(*hue) > self.texels());
        (kind, hue, hue.map_or(self.of(kind), count))
    }

    fn add(&mut self, kind: StandingKind, hue: Hue) {
        self.counts[kind as usize][hue as usize] += 1;
    }

    fn join(&mut self, other: &Self) {
        let counts = self.counts.as_flattened_mut().iter_mut();
        counts.zip(other.counts.as_flattened()).for_each(|(all, part)| *all += part);
    }
}

/// Serialized as counts by the kind of material that the texels need.
#[cfg(feature = "serde")]
impl serde::Serialize for BeyondOne {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeStruct as _;
        let mut fields = serializer.serialize_struct("BeyondOne", 4)?;
        fields.serialize_field("texels", &self.texels())?;
        fields.serialize_field("shown_by_reflectance", &self.of(StandingKind::Reflectance))?;
        fields.serialize_field("needs_fluorescence", &self.of(StandingKind::NeedsFluorescence))?;
        fields.serialize_field("shown_by_nothing", &self.of(StandingKind::Unreachable))?;
        fields.end()
    }
}

/// Texels that are measured after all have been ranked; more than are reported would only cost time, as
/// their differences are known.
const CANDIDATES: usize = crate::Checker::WORST;

/// Texels that are drawn to be fitted in other ways, of each kind. The error of a share from so many is
/// at most 5 points; each takes a few milliseconds.
pub(super) const DRAWN: usize = 100;

/// The findings about blends, as integers so that the order of addition does not matter.
#[derive(Clone, Debug, Default)]
pub(super) struct BlendFindings {
    pub(super) texels: u64,
    within_one: u64,
    within_two: u64,
    sum: u128,
    greatest: f64,
    kinds: KindCounts,
    pub(super) beyond_one: BeyondOne,
    pub(super) dyes: DyeSums,
    pub(super) worst: Ranking<CANDIDATES>,
    /// Some texels within 1 ΔE00, beyond, and outside 0..=1.
    pub(super) drawn: [Draw<DRAWN>; 3],
}

/// Indices of the draws.
pub(super) const WITHIN: usize = 0;
pub(super) const BEYOND: usize = 1;
pub(super) const OUTSIDE: usize = 2;

/// A texel, what its color needs, and its color as the cube's blend has it; NaN outside 0..=1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blended {
    pub(super) at: [usize; 2],
    pub(super) rgb: [f32; 3],
    pub(super) needs: StandingKind,
    pub(super) blend: [f32; 3],
}

/// The unit of the sum of ΔE00: finer than the single precision of the cube.
const UNIT: f64 = 1.0 / 16_777_216.0;

impl BlendFindings {
    pub(super) fn join(&mut self, other: Self) {
        self.texels += other.texels;
        self.within_one += other.within_one;
        self.within_two += other.within_two;
        self.sum += other.sum;
        self.greatest = self.greatest.max(other.greatest);
        self.kinds.join(&other.kinds);
        self.beyond_one.join(&other.beyond_one);
        self.dyes.join(&other.dyes);
        self.worst.join(other.worst);
        self.drawn.iter_mut().zip(other.drawn).for_each(|(all, part)| all.join(part));
    }

    /// Adds a texel of finite values, and returns what the maps show of it.
    pub(super) fn add(
        &mut self,
        limits: &Limits<'_>,
        blends: &Blends<'_>,
        texel: Blended,
    ) -> CubeHeat {
        let Blended { at, rgb, needs, blend } = texel;
        let colorimetry = limits.table.colorimetry();
        let color = LinearRgb(rgb.map(f64::from));
        let Ok(kind) = blends.kinds.of(color) else {
            self.drawn[OUTSIDE].add(at, rgb);
            return CubeHeat { is_outside: true, ..CubeHeat::default() };
        };
        let dose = blends.doses.add(color, &mut self.dyes).unwrap_or_default();
        let wanted = colorimetry.xyz_from_rgb(color);
        let pair = [wanted, Xyz(blend.map(f64::from))];
        let [wanted, blend] = pair.map(|xyz| colorimetry.lab_from_xyz(xyz));
        let de2000 = ciede2000(wanted, blend);
        self.add_difference(de2000, kind);
        if de2000 > 1.0 {
            self.drawn[BEYOND].add(at, rgb);
            self.beyond_one.add(needs, Hue::of(wanted));
        } else {
            self.drawn[WITHIN].add(at, rgb);
        }
        if de2000 > CubeSummary::EXACT_DE2000 {
            let ([x, y], kind, distance) = (at, StandingKind::Reflectance, de2000);
            self.worst.add(Candidate { x, y, rgb, kind, distance });
        }
        let [de2000, dose] = [de2000, dose].map(to_single);
        CubeHeat { de2000, dose, is_outside: false }
    }

    fn add_difference(&mut self, de2000: f64, kind: MaterialKind) {
        self.texels += 1;
        self.within_one += u64::from(de2000 <= 1.0);
        self.within_two += u64::from(de2000 <= 2.0);
        self.sum += u128::from(units(de2000));
        self.greatest = self.greatest.max(de2000);
        self.kinds.add(kind);
    }

    pub(super) fn finish(
        &self,
        limits: &Limits<'_>,
        blends: &Blends<'_>,
        display: &Display,
    ) -> CubeMatch {
        let texels = self.texels.max(1) as f64;
        let within_one = self.within_one as f64 / texels;
        let dye = blends.doses.finish(&self.dyes, self.texels);
        let alternatives = blends.alternatives();
        CubeMatch {
            file: blends.file.clone(),
            texels: self.texels,
            within_one,
            within_two: self.within_two as f64 / texels,
            mean_de2000: self.sum as f64 * UNIT / texels,
            greatest_de2000: self.greatest,
            kinds: self.kinds,
            beyond_one: self.beyond_one,
            worst: alternatives.measure(&self.worst.found, limits, blends, display),
            changes: alternatives.changes(self, [within_one, dye.share]),
            wider_space: WiderSpace::of(self, limits),
            dye,
        }
    }
}

/// ΔL*, ΔC*, ΔH* from one color to another.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ColorDifference {
    /// Lighter is positive.
    pub lightness: f64,
    /// More colorful is positive.
    pub chroma: f64,
    /// Counterclockwise, from red to yellow, is positive.
    pub hue: f64,
}

impl ColorDifference {
    pub(super) fn new(from: Lab, to: Lab) -> Self {
        let [lightness, chroma, hue] = from.lch_difference(to);
        Self { lightness, chroma, hue }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the value is rounded first")]
#[expect(clippy::cast_sign_loss, reason = "color differences are not negative")]
fn units(de2000: f64) -> u64 {
    (de2000 / UNIT).round() as u64
}
