//! The interface of the formats: facts about a picture, and colors by rows.

use std::fmt::Debug;
use std::ops::Range;

use super::error::PictureError;
use super::stated::StatedColor;
use crate::exr::header::{MAX_SIDE, Window};

/// An open picture of one format.
pub(super) trait Source: Debug + Send {
    /// Reads the next rows. Ranges are consecutive and start at the top.
    fn read(&mut self, rows: Range<usize>) -> Result<Pixels, PictureError>;
}

/// How colors and alpha are combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Alpha {
    /// Stored colors are multiplied by alpha, as in OpenEXR.
    Associated,
    /// Colors are not multiplied by alpha, as in PNG.
    Straight,
}

/// What a file says of the sample after the colors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LastSample {
    /// There is none.
    Absent,
    /// It is alpha.
    Alpha(Alpha),
    /// It is something else, unless the caller declares it to be alpha.
    NotAlpha,
    /// Nothing.
    Unstated,
}

/// Facts about a picture.
#[derive(Clone, Debug)]
pub(super) struct Facts {
    pub(super) size: [usize; 2],
    pub(super) color: StatedColor,
    pub(super) last_sample: LastSample,
    pub(super) windows: Option<[Window; 2]>,
    /// Orientation as in TIFF and Exif, 1 to 8; 1 is upright.
    pub(super) orientation: u64,
}

/// Most bytes that are decompressed at once if a file cannot be read by bands.
pub(super) const MAX_AT_ONCE: u64 = 1 << 30;

/// Colors of some rows, and their alpha or other last sample.
pub(super) type Pixels = (Vec<[f32; 3]>, Option<Vec<f32>>);

/// Separates interleaved samples into colors and alpha.
///
/// `channels` is 1 (gray), 2 (gray and alpha), 3 (RGB) or 4 (RGB and alpha).
pub(super) fn pixels(samples: &[f32], channels: usize) -> Pixels {
    let each = || samples.chunks_exact(channels.max(1));
    let rgb = match channels {
        1 | 2 => each().map(|p| [p[0]; 3]).collect(),
        _ => each().map(|p| [p[0], p[1], p[2]]).collect(),
    };
    let alpha = matches!(channels, 2 | 4).then(|| each().map(|p| p[channels - 1]).collect());
    (rgb, alpha)
}

/// Adds integers of 8 bits as fractions of the greatest, 0..=1.
pub(super) fn add_bytes(bytes: &[u8], to: &mut Vec<f32>) {
    to.extend(bytes.iter().map(|v| f32::from(*v) / f32::from(u8::MAX)));
}

/// Adds integers of 16 bits as fractions of the greatest, 0..=1.
pub(super) fn add_words(words: impl Iterator<Item = u16>, to: &mut Vec<f32>) {
    to.extend(words.map(|v| f32::from(v) / f32::from(u16::MAX)));
}

pub(super) fn check_size(found: [usize; 2]) -> Result<(), PictureError> {
    let is_valid = found.iter().all(|side| (1..=MAX_SIDE).contains(side));
    is_valid.then_some(()).ok_or(PictureError::Size { found })
}

pub(super) fn check_memory(what: &'static str, found: u64) -> Result<(), PictureError> {
    let expected = MAX_AT_ONCE;
    (found <= expected).then_some(()).ok_or(PictureError::Memory { what, found, expected })
}
