//! Reads pictures of six formats by bands of rows.

pub(crate) mod band;
pub(crate) mod chromaticities;
mod code_points;
pub(crate) mod encoding;
pub(crate) mod error;
pub(crate) mod excerpt;
mod exif;
mod exr;
mod hdr;
mod icc;
pub(crate) mod interop;
mod jpeg;
pub(crate) mod linear;
mod orientation;
mod png;
mod source;
pub(crate) mod stated;
#[cfg(test)]
mod tests;
mod tga;
mod tiff;

use std::io::Read;
use std::path::Path;

use upglow::open_input;
use upglow_color::RgbSpace;

use self::band::Band;
use self::encoding::Encoding;
use self::error::PictureError;
use self::exr::ExrPicture;
use self::hdr::HdrPicture;
use self::jpeg::JpegPicture;
use self::orientation::Turned;
use self::png::PngPicture;
use self::source::{Alpha, Facts, Source};
use self::stated::{Chosen, Declared, Stated};
use self::tga::TgaPicture;
use self::tiff::TiffPicture;
use crate::exr::header::Window;

/// The formats that are read.
pub const FORMATS: &str = "OpenEXR, TIFF, PNG, JPEG, Radiance or TGA";

/// Suffixes of files in these formats; `tx` is a texture in OpenEXR or TIFF.
pub const SUFFIXES: [&str; 10] =
    ["exr", "tif", "tiff", "tx", "png", "jpg", "jpeg", "hdr", "pic", "tga"];

/// Reads a picture from top to bottom.
///
/// Supported are OpenEXR (rows or tiles, every compression but HTJ2K, no deep data; R, G, B or Y, with or
/// without A, also in a layer or part), TIFF (integers of 1 to 32 bits, floats of 16, 32 and 64 bits; gray
/// or RGB, with or without alpha and further samples; strips or tiles, interleaved or in planes; LZW,
/// deflate, `PackBits` or not compressed), PNG (all types), JPEG (gray or RGB of 8 bits, Huffman coded),
/// Radiance (RGBE; EXPOSURE and COLORCORR are undone) and TGA (gray, colors of 15 to 32 bits, color maps).
/// Of several levels of detail, as in `.tx`, the full one is read. Pictures that their files say are turned
/// or mirrored are read upright.
///
/// # Memory
///
/// A band takes 12 bytes per pixel, 16 with alpha, and as much again while it is decompressed: 32 MiB for
/// 64 rows of 16,384 columns. Files in tiles or blocks of rows take one more row of those. JPEG, interlaced
/// PNG and pictures that are not stored upright are decompressed whole, and refused above 1 GiB; so are rows of tiles
/// above 1 GiB, unless tiles of OpenEXR have at most 64 rows.
#[derive(Debug)]
pub struct Picture {
    source: Box<dyn Source>,
    facts: Facts,
    alpha: Option<Alpha>,
    next_row: usize,
}

impl Picture {
    /// Opens a picture, whose first bytes determine its format. TGA has none of its own: it is determined by
    /// its last bytes or the suffix `.tga`.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if the file cannot be read or is not a supported picture.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, PictureError> {
        Self::open_as(path.as_ref(), &Declared::default())
    }

    /// Opens a picture with the declared layer and use of alpha.
    ///
    /// # Errors
    ///
    /// As [`Picture::open`].
    pub fn open_as(path: &Path, declared: &Declared) -> Result<Self, PictureError> {
        let mut found = Vec::new();
        open_input(path)?.take(4).read_to_end(&mut found)?;
        let layer = declared.layer.as_deref();
        let is_exr = found == [0x76, 0x2f, 0x31, 0x01];
        let (source, mut facts): (Box<dyn Source>, Facts) = match found[..] {
            _ if is_exr => ExrPicture::open(path, layer)?,
            [b'I', b'I', 42 | 43, 0] | [b'M', b'M', 0, 42 | 43] => TiffPicture::open(path)?,
            [0x89, b'P', b'N', b'G'] => PngPicture::open(path)?,
            [0xff, 0xd8, 0xff, _] => JpegPicture::open(path)?,
            [b'#', b'?', ..] => HdrPicture::open(path)?,
            _ if tga::is_tga(path)? => TgaPicture::open(path)?,
            _ => return Err(PictureError::Format { found }),
        };
        if layer.is_some() && !is_exr {
            return Err(PictureError::NoLayers);
        }
        let alpha = stated::alpha(facts.last_sample, declared.alpha)?;
        let source = Turned::of(source, &mut facts)?;
        Ok(Self { source, facts, alpha, next_row: 0 })
    }

    /// The space and encoding to use: the declared ones, or those that the file states.
    pub(crate) fn chosen(&self, declared: &Declared) -> Result<Chosen, PictureError> {
        stated::choose(&self.facts.color, declared, self.alpha)
    }

    /// Width and height in pixels, 1 or more; those of the data window of an OpenEXR file.
    pub fn size(&self) -> [usize; 2] {
        self.facts.size
    }

    /// The RGB space that the file states, if any.
    ///
    /// OpenEXR: ACES2065-1 if `acesImageContainerFlag` is 1, else `colorInteropID`, else
    /// `chromaticities`. PNG: cICP, else the ICC profile, else sRGB, else cHRM. TIFF: the ICC profile,
    /// else the primaries and the white. JPEG: the ICC profile, else sRGB by Exif. Radiance: PRIMARIES.
    pub fn space(&self) -> Option<&RgbSpace> {
        match &self.facts.color.space {
            Stated::Yes { value, .. } => Some(value),
            _ => None,
        }
    }

    /// The encoding of stored numbers, if the file or its format states it.
    ///
    /// OpenEXR, Radiance and TIFF of floats are linear unless they state another one; PNG has cICP, an ICC
    /// profile, sRGB or gAMA; TIFF of integers an ICC profile; JPEG an ICC profile or sRGB by Exif.
    pub fn encoding(&self) -> Option<Encoding> {
        match self.facts.color.encoding {
            Stated::Yes { value, .. } => Some(value),
            _ => None,
        }
    }

    /// Whether bands have alpha.
    pub fn has_alpha(&self) -> bool {
        self.alpha.is_some()
    }

    /// How colors and alpha are combined; `None` without alpha. Bands have the colors as stored.
    pub(crate) fn alpha(&self) -> Option<Alpha> {
        self.alpha
    }

    /// Data and display window of an OpenEXR file.
    pub(crate) fn windows(&self) -> Option<[Window; 2]> {
        self.facts.windows
    }

    /// The next rows, fewer at the end of the picture; `None` after the last row.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if the file is damaged there.
    pub fn read_band(&mut self, rows: usize) -> Result<Option<Band>, PictureError> {
        let [width, height] = self.facts.size;
        if self.next_row >= height {
            return Ok(None);
        }
        let rows = self.next_row..height.min(self.next_row.saturating_add(rows.max(1)));
        let first_row = self.next_row;
        self.next_row = rows.end;
        let (rgb, last_sample) = self.source.read(rows)?;
        let alpha = last_sample.filter(|_| self.has_alpha());
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
