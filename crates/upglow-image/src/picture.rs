//! Pictures of three formats, read by bands of rows.

pub(crate) mod band;
pub(crate) mod chromaticities;
pub(crate) mod encoding;
mod exr;
pub(crate) mod linear;
mod png;
mod tiff;

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use upglow_color::RgbSpace;

use self::exr::ExrPicture;
use self::png::PngPicture;
use self::tiff::TiffPicture;
use crate::exr::error::ExrError;
use crate::exr::header::MAX_SIDE;
use crate::exr::header::Window;
use crate::picture::band::Band;
use crate::picture::encoding::Encoding;

/// Why a picture cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The file cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The file is of none of the formats.
    #[error("the file begins with {found:02x?}, expected an OpenEXR, TIFF or PNG picture")]
    Format {
        /// Its first bytes, four at most.
        found: Vec<u8>,
    },
    /// An OpenEXR file that cannot be read.
    #[error(transparent)]
    Exr(#[from] ExrError),
    /// A PNG file that cannot be read.
    #[error("damaged, expected a whole PNG picture")]
    Png(#[from] ::png::DecodingError),
    /// A TIFF file that cannot be read.
    #[error("damaged, expected a whole TIFF picture")]
    Tiff(#[from] ::tiff::TiffError),
    /// A kind of pixels that is not read.
    #[error("{found}, expected {expected}")]
    Pixels {
        /// The kind.
        found: String,
        /// The kinds that are read.
        expected: &'static str,
    },
    /// An OpenEXR file without one clear set of RGB channels.
    #[error("channels {}, expected {expected}", .found.join(", "))]
    Channels {
        /// Channels or layers that there are, some of them if they are many.
        found: Vec<String>,
        /// What is read.
        expected: String,
    },
    /// A picture larger than this program holds.
    #[error("{} by {} pixels, expected 1 to {MAX_SIDE} a side", .found[0], .found[1])]
    Size {
        /// Width and height.
        found: [usize; 2],
    },
    /// A piece of the file that must be unpacked at once is too large.
    #[error("{what} takes {found} bytes, expected at most {expected}")]
    Memory {
        /// The piece.
        what: &'static str,
        /// Bytes it takes.
        found: u64,
        /// The most that is given.
        expected: u64,
    },
}

/// What alpha does to the colors beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alpha {
    /// Colors are multiplied by it already, as OpenEXR has it.
    Associated,
    /// Colors are as if all were opaque, as PNG has it.
    Straight,
}

/// A picture that is opened for reading from top to bottom.
///
/// OpenEXR (rows or tiles, every compression but HTJ2K and deep data; R, G, B or Y, with or without A,
/// also inside one layer or part), TIFF (8 and 16 bit integers, 16 and 32 bit floats; gray or RGB,
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
    source: Source,
    facts: Facts,
    next_row: usize,
}

/// What a picture says of itself.
#[derive(Clone, Debug)]
struct Facts {
    size: [usize; 2],
    space: Option<RgbSpace>,
    encoding: Option<Encoding>,
    alpha: Option<Alpha>,
    windows: Option<[Window; 2]>,
    /// Rows that are stored together.
    block_rows: usize,
}

#[derive(Debug)]
enum Source {
    Exr(Box<ExrPicture>),
    Tiff(Box<TiffPicture>),
    Png(Box<PngPicture>),
}

/// What may be unpacked at once where a file cannot be read by bands.
const MAX_AT_ONCE: u64 = 1 << 30;

impl Picture {
    /// Opens a picture; its format is told by its first bytes.
    ///
    /// # Errors
    ///
    /// [`PictureError`] says what was found and what was expected; no content panics.
    pub fn open(path: &Path) -> Result<Self, PictureError> {
        Self::open_with(path, None)
    }

    /// Opens one layer or part of an OpenEXR picture, by name.
    ///
    /// # Errors
    ///
    /// [`PictureError`]; [`PictureError::Channels`] if there is no such layer.
    pub fn open_layer(path: &Path, layer: &str) -> Result<Self, PictureError> {
        Self::open_with(path, Some(layer))
    }

    fn open_with(path: &Path, layer: Option<&str>) -> Result<Self, PictureError> {
        let mut found = Vec::new();
        File::open(path)?.take(4).read_to_end(&mut found)?;
        let (source, facts) = match found[..] {
            [0x76, 0x2f, 0x31, 0x01] => {
                let (picture, facts) = ExrPicture::open(path, layer)?;
                (Source::Exr(Box::new(picture)), facts)
            }
            [b'I', b'I', 42 | 43, 0] | [b'M', b'M', 0, 42 | 43] if layer.is_none() => {
                let (picture, facts) = TiffPicture::open(path)?;
                (Source::Tiff(Box::new(picture)), facts)
            }
            [0x89, b'P', b'N', b'G'] if layer.is_none() => {
                let (picture, facts) = PngPicture::open(path)?;
                (Source::Png(Box::new(picture)), facts)
            }
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
    pub fn alpha(&self) -> Option<Alpha> {
        self.facts.alpha
    }

    /// Data and display window of an OpenEXR file, for a file made from it.
    pub fn windows(&self) -> Option<[Window; 2]> {
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
        let (rgb, alpha) = match &mut self.source {
            Source::Exr(picture) => picture.read(rows)?,
            Source::Tiff(picture) => picture.read(rows)?,
            Source::Png(picture) => picture.read(rows)?,
        };
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

/// Colors and alpha of some rows.
type Pixels = (Vec<[f32; 3]>, Option<Vec<f32>>);

/// Interleaved samples as colors and alpha.
///
/// `channels` is 1 (gray), 2 (gray and alpha), 3 (RGB) or 4 (RGB and alpha).
fn pixels(samples: &[f32], channels: usize) -> Pixels {
    let each = || samples.chunks_exact(channels.max(1));
    let rgb = match channels {
        1 | 2 => each().map(|p| [p[0]; 3]).collect(),
        _ => each().map(|p| [p[0], p[1], p[2]]).collect(),
    };
    let alpha = matches!(channels, 2 | 4).then(|| each().map(|p| p[channels - 1]).collect());
    (rgb, alpha)
}

fn check_size(found: [usize; 2]) -> Result<(), PictureError> {
    if found.iter().all(|side| (1..=MAX_SIDE).contains(side)) {
        return Ok(());
    }
    Err(PictureError::Size { found })
}

fn check_memory(what: &'static str, found: u64) -> Result<(), PictureError> {
    if found <= MAX_AT_ONCE {
        return Ok(());
    }
    Err(PictureError::Memory { what, found, expected: MAX_AT_ONCE })
}
