//! Reads pictures of three formats by bands of rows.

pub(crate) mod band;
pub(crate) mod chromaticities;
pub(crate) mod encoding;
pub(crate) mod error;
mod exr;
pub(crate) mod linear;
mod png;
mod source;
#[cfg(test)]
mod tests;
mod tiff;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use upglow_color::RgbSpace;

use self::band::Band;
use self::encoding::Encoding;
use self::error::PictureError;
use self::exr::ExrPicture;
use self::png::PngPicture;
use self::source::{Alpha, Facts, Source};
use self::tiff::TiffPicture;
use crate::exr::header::Window;

/// Reads a picture from top to bottom.
///
/// Supported are OpenEXR (rows or tiles, every compression but HTJ2K, no deep data; R, G, B or Y, with or
/// without A, also in the only layer or part), TIFF (8 and 16 bit integers, 16 and 32 bit floats; gray or
/// RGB, with or without alpha; strips or tiles) and PNG (all types).
///
/// # Memory
///
/// A band takes 12 bytes per pixel, 16 with alpha, and as much again while it is decompressed: 32 MiB for
/// 64 rows of 16,384 columns. Files in tiles or blocks of rows take one more row of those. Interlaced PNG
/// and TIFF in a single strip are decompressed whole, and refused above 1 GiB.
#[derive(Debug)]
pub struct Picture {
    source: Box<dyn Source>,
    facts: Facts,
    next_row: usize,
}

impl Picture {
    /// Opens a picture, whose first bytes determine its format.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if the file cannot be read or is not a supported picture.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, PictureError> {
        let path = path.as_ref();
        let mut found = Vec::new();
        File::open(path)?.take(4).read_to_end(&mut found)?;
        let (source, facts): (Box<dyn Source>, Facts) = match found[..] {
            [0x76, 0x2f, 0x31, 0x01] => ExrPicture::open(path)?,
            [b'I', b'I', 42 | 43, 0] | [b'M', b'M', 0, 42 | 43] => TiffPicture::open(path)?,
            [0x89, b'P', b'N', b'G'] => PngPicture::open(path)?,
            _ => return Err(PictureError::Format { found }),
        };
        Ok(Self { source, facts, next_row: 0 })
    }

    /// Width and height in pixels, 1 or more; those of the data window of an OpenEXR file.
    pub fn size(&self) -> [usize; 2] {
        self.facts.size
    }

    /// The RGB space that the file states, if any.
    ///
    /// OpenEXR: `chromaticities`, or ACES2065-1 if `acesImageContainerFlag` is 1. PNG: cICP, sRGB or
    /// cHRM. TIFF: the primaries and the white. `None` for files with an ICC profile, which is not read.
    pub fn space(&self) -> Option<&RgbSpace> {
        self.facts.space.as_ref()
    }

    /// The encoding of stored numbers, if the file or its format states it.
    ///
    /// OpenEXR and TIFF of floats are linear; PNG has cICP, sRGB or gAMA; TIFF of integers states none.
    pub fn encoding(&self) -> Option<Encoding> {
        self.facts.encoding
    }

    /// Whether bands have alpha.
    pub fn has_alpha(&self) -> bool {
        self.facts.alpha.is_some()
    }

    /// How colors and alpha are combined; `None` without alpha. Bands have the colors as stored.
    pub(crate) fn alpha(&self) -> Option<Alpha> {
        self.facts.alpha
    }

    /// Data and display window of an OpenEXR file.
    pub(crate) fn windows(&self) -> Option<[Window; 2]> {
        self.facts.windows
    }

    /// The next rows: `rows`, rounded up to whole blocks of the file, or fewer at the end of the picture;
    /// `None` after the last row.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if the file is damaged there.
    pub fn read_band(&mut self, rows: usize) -> Result<Option<Band>, PictureError> {
        let [width, height] = self.facts.size;
        if self.next_row >= height {
            return Ok(None);
        }
        let whole = rows.max(1).next_multiple_of(self.facts.block_rows);
        let rows = self.next_row..height.min(self.next_row.saturating_add(whole));
        let first_row = self.next_row;
        self.next_row = rows.end;
        let (rgb, alpha) = self.source.read(rows)?;
        Ok(Some(Band { first_row, width, rgb, alpha }))
    }

    /// The bands of the rest of the picture, each like [`Picture::read_band`]. Ends after an error.
    pub fn bands(&mut self, rows: usize) -> impl Iterator<Item = Result<Band, PictureError>> + '_ {
        std::iter::from_fn(move || {
            let band = self.read_band(rows).transpose();
            if matches!(band, Some(Err(_))) {
                self.next_row = self.facts.size[1];
            }
            band
        })
    }
}
