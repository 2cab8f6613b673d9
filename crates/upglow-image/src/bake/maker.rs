//! What every baked form says of its channels, and how it fills them.

use std::fmt::Debug;

use crate::exr::attribute::Attributes;
use crate::exr::header::Sample;
use crate::exr::writer::Compression;

/// Makes the channels of one form from linear RGB in the cube's space, each component in 0..=1.
pub(super) trait Maker: Debug + Sync {
    /// Names, in the order in which planes are filled.
    fn channels(&self) -> Vec<String>;

    /// What the file says besides.
    fn attributes(&self) -> Attributes;

    /// How the file is packed.
    fn compression(&self) -> Compression {
        Compression::Zip
    }

    /// Whether the channels are light, which OpenEXR has multiplied by alpha, and not properties of
    /// a material.
    fn is_light(&self) -> bool {
        false
    }

    /// The kind of number that holds the channels, where the caller asked for `asked`.
    fn sample(&self, asked: Sample) -> Sample {
        asked
    }

    /// Fills one row of each channel, `[channel][texel]`.
    fn fill(&self, rgb: &[[f32; 3]], planes: &mut [&mut [f32]]);
}
