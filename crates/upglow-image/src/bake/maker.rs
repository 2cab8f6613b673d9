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

    /// Fills one row of each channel, `[channel][texel]`. Returns the kinds of the row's materials, if
    /// their differences from the colors are measured.
    fn fill(&self, rgb: &[[f32; 3]], planes: &mut [&mut [f32]]) -> Option<KindCounts>;
}
