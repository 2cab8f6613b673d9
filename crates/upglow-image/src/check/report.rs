//! The report of a check.

use std::fmt;

use upglow_color::{Standing, StandingKind};

use super::cube_match::{ColorDifference, CubeMatch};
use super::palette::Ramp;
use super::raster::Raster;
use crate::picture::stated::Interpretation;

/// Which materials a picture needs.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CheckReport {
    /// The name of the picture's file.
    pub file: String,
    /// Texels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The RGB space that the picture was checked in: its own, or the cube's.
    pub rgb_space: String,
    /// How the numbers of the picture were understood.
    pub interpretation: Interpretation,
    /// The light under which materials must match it.
    pub illuminant: String,
    /// Numbers of texels of each kind.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub counts: Counts,
    /// The first texels of each flaw, in reading order.
    pub flaws: Vec<FlawedTexel>,
    /// The texels furthest beyond any material, then furthest beyond reflectance; at most
    /// [`Checker::WORST`](crate::Checker::WORST), no two of nearly the same color.
    pub worst: Vec<WorstTexel>,
    /// How well a cube's materials match the picture, if there is a cube.
    pub cube: Option<CubeMatch>,
    /// The map of the materials that are needed.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) heat: Raster,
    /// The maps of a cube, if there is one.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) cube_maps: Option<CubeMaps>,
    /// The picture in sRGB, reduced.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) thumbnail: Raster,
}

/// What a cube makes of a picture.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CubeMaps {
    /// ΔE00 of its blends.
    pub(super) differences: Raster,
    /// Their doses.
    pub(super) doses: Raster,
    /// The colors of the doses.
    pub(super) dose_ramp: Ramp,
}

impl CheckReport {
    /// The heat map, as a PNG file.
    ///
    /// With a cube it shows how far its blends are off: gray where they match, light to dark red on a
    /// logarithmic scale to 10 ΔE00, cyan where values are outside 0..=1. Without a cube it shows which
    /// materials are needed: gray where reflectances match the picture, yellow to brown where it needs
    /// fluorescence, pink to purple where no material matches it, cyan for NaN and infinite values.
    #[must_use]
    pub fn heat_map_png(&self) -> Vec<u8> {
        self.cube_maps.as_ref().map_or(&self.heat, |maps| &maps.differences).to_png()
    }
}

/// Numbers of texels of each kind.
///
/// `reflectance`, `needs_fluorescence`, `unreachable` and `no_color` add up to all texels. A texel may
/// have several flaws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// All texels.
    pub texels: u64,
    /// Some reflectance matches them.
    pub reflectance: u64,
    /// No reflectance matches them, but some fluorescent material does.
    pub needs_fluorescence: u64,
    /// No material matches them.
    pub unreachable: u64,
    /// A value is NaN or infinite.
    pub no_color: u64,
    /// Texels with each flaw, in the order of [`Flaw::ALL`].
    flawed: [u64; Flaw::ALL.len()],
}

impl Counts {
    /// Texels with this flaw.
    pub fn of(&self, flaw: Flaw) -> u64 {
        self.flawed[flaw as usize]
    }

    /// Whether every value is in 0..=1.
    pub fn all_in_range(&self) -> bool {
        self.flawed == [0; Flaw::ALL.len()]
    }

    /// `part` texels as a share of all, 0..=1.
    pub fn share(&self, part: u64) -> f64 {
        part as f64 / self.texels as f64
    }

    /// Counts a texel with this flaw.
    pub(super) fn add_flaw(&mut self, flaw: Flaw) {
        self.flawed[flaw as usize] += 1;
    }

    /// Counts a texel by the material it needs; `None` if a value is NaN or infinite.
    pub(super) fn add(&mut self, kind: Option<StandingKind>) {
        self.texels += 1;
        *match kind {
            Some(StandingKind::Reflectance) => &mut self.reflectance,
            Some(StandingKind::NeedsFluorescence) => &mut self.needs_fluorescence,
            Some(StandingKind::Unreachable) => &mut self.unreachable,
            None => &mut self.no_color,
        } += 1;
    }

    pub(super) fn join(&mut self, other: &Self) {
        self.texels += other.texels;
        self.reflectance += other.reflectance;
        self.needs_fluorescence += other.needs_fluorescence;
        self.unreachable += other.unreachable;
        self.no_color += other.no_color;
        self.flawed.iter_mut().zip(other.flawed).for_each(|(all, part)| *all += part);
    }
}

/// Serialized as shares of the kinds of materials, then counts of flaws.
#[cfg(feature = "serde")]
impl serde::Serialize for Counts {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeStruct as _;
        let mut fields = serializer.serialize_struct("Counts", 9)?;
        fields.serialize_field("texels", &self.texels)?;
        fields.serialize_field("shown_by_reflectance", &self.share(self.reflectance))?;
        fields.serialize_field("needs_fluorescence", &self.share(self.needs_fluorescence))?;
        fields.serialize_field("shown_by_nothing", &self.share(self.unreachable))?;
        fields.serialize_field("no_color", &self.no_color)?;
        fields.serialize_field("above_one", &self.of(Flaw::AboveOne))?;
        fields.serialize_field("negative", &self.of(Flaw::Negative))?;
        fields.serialize_field("not_a_number", &self.of(Flaw::NotANumber))?;
        fields.serialize_field("infinite", &self.of(Flaw::Infinite))?;
        fields.end()
    }
}

/// Why a value is not in 0..=1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Flaw {
    /// Finite and above 1.
    #[cfg_attr(feature = "serde", serde(rename = "above 1"))]
    AboveOne,
    /// Finite and below 0.
    #[cfg_attr(feature = "serde", serde(rename = "negative"))]
    Negative,
    /// Not a number.
    #[cfg_attr(feature = "serde", serde(rename = "no number"))]
    NotANumber,
    /// Infinite, of either sign.
    #[cfg_attr(feature = "serde", serde(rename = "infinite"))]
    Infinite,
}

impl Flaw {
    /// Every flaw.
    pub const ALL: [Self; 4] = [Self::AboveOne, Self::Negative, Self::NotANumber, Self::Infinite];

    /// Whether a channel of `rgb` has this flaw.
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
pub struct FlawedTexel {
    /// The flaw.
    pub flaw: Flaw,
    /// Column, from 0 at the left.
    pub x: usize,
    /// Row, from 0 at the top.
    pub y: usize,
    /// Its values.
    pub rgb: [f32; 3],
}

/// Compares the bits of the values, which may be NaN.
impl PartialEq for FlawedTexel {
    fn eq(&self, other: &Self) -> bool {
        let bits = |texel: &Self| texel.rgb.map(f32::to_bits);
        (self.flaw, self.x, self.y, bits(self)) == (other.flaw, other.x, other.y, bits(other))
    }
}

/// A texel that no reflectance matches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorstTexel {
    /// Column, from 0 at the left.
    pub x: usize,
    /// Row, from 0 at the top.
    pub y: usize,
    /// Its color, linear RGB of the contract's space.
    pub rgb: [f32; 3],
    /// The kind of material it needs, and its distances from the colors of materials.
    pub standing: Standing,
    /// From its color to the nearest one of the kind of material that it is furthest beyond.
    pub difference: ColorDifference,
    /// The texel's color, the nearest of a reflectance, and the nearest of any material, in sRGB.
    pub(super) swatches: [[u8; 3]; 3],
}

impl WorstTexel {
    /// The kind of material that the color needs, in words.
    pub fn needs(&self) -> &'static str {
        match self.standing.kind {
            StandingKind::Reflectance => "reflectance",
            StandingKind::NeedsFluorescence => "fluorescence",
            StandingKind::Unreachable => "nothing shows it",
        }
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for WorstTexel {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeStruct as _;
        let mut fields = serializer.serialize_struct("WorstTexel", 7)?;
        fields.serialize_field("x", &self.x)?;
        fields.serialize_field("y", &self.y)?;
        fields.serialize_field("rgb", &self.rgb)?;
        fields.serialize_field("needs", self.needs())?;
        fields.serialize_field("reflectance_de2000", &self.standing.reflectance.de2000)?;
        fields.serialize_field("material_de2000", &self.standing.fluorescence.de2000)?;
        fields.serialize_field("difference", &self.difference)?;
        fields.end()
    }
}
