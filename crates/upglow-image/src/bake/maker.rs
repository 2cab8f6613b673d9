//! The channels and attributes of each baked form.

use std::fmt::Debug;

use upglow_fit::KindCounts;

use crate::exr::attribute::Attributes;
use crate::exr::header::Sample;
use crate::exr::writer::Compression;

/// Makes the channels of one form from linear RGB in the cube's space, each component in 0..=1.
pub(super) trait Maker: Debug + Sync {
    /// Names of the channels, in the order of the planes.
    fn channels(&self) -> Vec<String>;

    /// Attributes of the file.
    fn attributes(&self) -> Attributes;

    /// How the file is compressed.
    fn compression(&self) -> Compression {
        Compression::Zip
    }

    /// Whether the channels are light, which OpenEXR stores multiplied by alpha, instead of properties
    /// of a material.
    fn is_light(&self) -> bool {
        false
    }

    /// The type of samples, given the one that the caller requested.
    fn sample(&self, requested: Sample) -> Sample {
        requested
    }

    /// Fills the channels of some texels, `[channel][texel]`.
    fn fill(&self, rgb: &[[f32; 3]], planes: &mut [&mut [f32]]) -> Filled;
}

/// Facts about texels whose channels were filled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Filled {
    /// The kinds of their materials, if their differences from the colors are measured.
    pub(super) kinds: Option<KindCounts>,
    /// How many colors are outside the colors of a screen.
    pub(super) beyond_screen: u64,
}

impl Filled {
    pub(super) fn with(self, other: &Self) -> Self {
        let kinds = match (self.kinds, &other.kinds) {
            (Some(mut all), Some(more)) => {
                all.join(more);
                Some(all)
            }
            (one, more) => one.or(*more),
        };
        Self { kinds, beyond_screen: self.beyond_screen + other.beyond_screen }
    }
}

impl From<KindCounts> for Filled {
    fn from(kinds: KindCounts) -> Self {
        Self { kinds: Some(kinds), beyond_screen: 0 }
    }
}
