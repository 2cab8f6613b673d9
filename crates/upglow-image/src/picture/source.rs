//! What every format of pictures gives: facts, and colors by rows.

use std::fmt::Debug;
use std::ops::Range;

use upglow_color::RgbSpace;

use super::encoding::Encoding;
use super::error::PictureError;
use crate::exr::header::{MAX_SIDE, Window};

/// A picture of one format, opened.
pub(super) trait Source: Debug + Send {
    /// The colors of the next rows; ranges follow each other from the top.
    fn read(&mut self, rows: Range<usize>) -> Result<Pixels, PictureError>;
}

/// What alpha does to the colors beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Alpha {
    /// Colors are multiplied by it already, as OpenEXR has it.
    Associated,
    /// Colors are as if all were opaque, as PNG has it.
    Straight,
}

/// What a picture says of itself.
#[derive(Clone, Debug)]
pub(super) struct Facts {
    pub(super) size: [usize; 2],
    pub(super) space: Option<RgbSpace>,
    pub(super) encoding: Option<Encoding>,
    pub(super) alpha: Option<Alpha>,
    pub(super) windows: Option<[Window; 2]>,
    /// Rows that are stored together.
    pub(super) block_rows: usize,
}

/// What may be unpacked at once where a file cannot be read by bands.
pub(super) const MAX_AT_ONCE: u64 = 1 << 30;

/// Colors and alpha of some rows.
pub(super) type Pixels = (Vec<[f32; 3]>, Option<Vec<f32>>);

/// Interleaved samples as colors and alpha.
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

pub(super) fn check_size(found: [usize; 2]) -> Result<(), PictureError> {
    if found.iter().all(|side| (1..=MAX_SIDE).contains(side)) {
        return Ok(());
    }
    Err(PictureError::Size { found })
}

pub(super) fn check_memory(what: &'static str, found: u64) -> Result<(), PictureError> {
    if found <= MAX_AT_ONCE {
        return Ok(());
    }
    Err(PictureError::Memory { what, found, expected: MAX_AT_ONCE })
}
