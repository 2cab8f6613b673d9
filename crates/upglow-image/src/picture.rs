//! Pictures of three formats, read by bands of rows.

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

/// A picture that is opened for reading from top to bottom.
///
/// OpenEXR (rows or tiles, every compression but HTJ2K and deep data; R, G, B or Y, with or without A,
/// also inside the only layer or part), TIFF (8 and 16 bit integers, 16 and 32 bit floats; gray or RGB,
/// with or without alpha; strips or tiles) and PNG (all kinds).
///
/// # Memory
///
/// A band of `rows` rows takes 12 bytes a pixel, 16 with alpha, and while it is made the same
/// again for what is unpacked: twice 16384 · 16 bytes a row for a picture of 16384 columns, or 32 MiB
/// for 64 rows. Files that are stored in tiles or blocks of rows add one row of those. Two
/// kinds of files must be unpacked at once: interlaced PNG, up to 1 GiB, and TIFF in one strip, up to
/// 1 GiB; larger ones are refused.
#[derive(Debug)]
pub struct Picture {
    source: Box<dyn Source>,
    facts: Facts,
    next_row: usize,
}

impl Picture {
    /// Opens a picture; its format is told by its first bytes.
    ///
    /// # Errors
    ///
    /// [`PictureError`] says what was found and what was expected; no content panics.
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

    /// Width and height, pixels; 1 or more. Of an OpenEXR file: the data window's.
    pub fn size(&self) -> [usize; 2] {
        self.facts.size
    }

    /// The RGB space that the file states; nothing is guessed.
    ///
    /// OpenEXR: `chromaticities`, or ACES2065-1 where `acesImageContainerFlag` is 1. PNG: cICP,
    /// sRGB or cHRM. TIFF: its primaries and white. A file with an ICC profile, which is not
    /// read, has none.
    pub fn space(&self) -> Option<&RgbSpace> {
        self.facts.space.as_ref()
    }

    /// How stored numbers stand for light, where the file or its format says.
    ///
    /// OpenEXR and floats are linear; PNG says by cICP, sRGB or gAMA; integers of a TIFF say nothing.
    pub fn encoding(&self) -> Option<Encoding> {
        self.facts.encoding
    }

    /// Whether bands have alpha.
    pub fn has_alpha(&self) -> bool {
        self.facts.alpha.is_some()
    }

    /// What alpha does to the colors; `None` where there is none. Colors are passed on as stored.
    pub(crate) fn alpha(&self) -> Option<Alpha> {
        self.facts.alpha
    }

    /// Data and display window of an OpenEXR file, for a file made from it.
    pub(crate) fn windows(&self) -> Option<[Window; 2]> {
        self.facts.windows
    }

    /// The next rows: at least `rows`, rounded up to whole blocks of the file, or what is left;
    /// `None` after the last.
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

    /// The bands of the rest of the picture, of about `rows` rows each, from top to bottom.
    ///
    /// Ends after an error.
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
