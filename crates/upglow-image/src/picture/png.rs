//! Colors of a PNG file.

use std::fmt;
use std::fs::File;
use std::io::BufReader;
use std::ops::Range;
use std::path::Path;

use png::{
    BitDepth, CodingIndependentCodePoints, ColorType, Decoder, Info, Reader, Transformations,
};
use upglow_color::RgbSpace;

use super::chromaticities::space;
use super::encoding::Encoding;
use super::error::PictureError;
use super::source::{Alpha, Facts, Pixels, Source, check_memory, check_size, pixels};

pub(super) struct PngPicture {
    reader: Reader<BufReader<File>>,
    row: Vec<u8>,
    channels: usize,
    deep: bool,
    /// All rows of an interlaced picture, once it has been read.
    whole: Option<Vec<u8>>,
}

impl fmt::Debug for PngPicture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PngPicture").field("info", self.reader.info()).finish_non_exhaustive()
    }
}

/// Memory limit of the decoder for profiles and other chunks, bytes.
const CHUNK_BYTES: usize = 64 << 20;

impl PngPicture {
    pub(super) fn open(path: &Path) -> Result<(Box<dyn Source>, Facts), PictureError> {
        let limits = png::Limits { bytes: CHUNK_BYTES };
        let mut decoder = Decoder::new_with_limits(BufReader::new(File::open(path)?), limits);
        decoder.set_transformations(Transformations::EXPAND);
        decoder.set_ignore_text_chunk(true);
        let reader = decoder.read_info()?;
        let info = reader.info();
        let size = [info.width as usize, info.height as usize];
        check_size(size)?;
        let (color, depth) = reader.output_color_type();
        let channels = color.samples();
        let row_bytes = reader.output_line_size(info.width).unwrap_or(usize::MAX) as u64;
        if info.interlaced {
            check_memory("an interlaced picture", row_bytes.saturating_mul(size[1] as u64))?;
        }
        let has_alpha = matches!(color, ColorType::GrayscaleAlpha | ColorType::Rgba);
        let (space, encoding) = color_of(info);
        let facts = Facts {
            size,
            space,
            encoding,
            alpha: has_alpha.then_some(Alpha::Straight),
            windows: None,
            block_rows: 1,
        };
        let row = vec![0; usize::try_from(row_bytes).unwrap_or(0)];
        let deep = depth == BitDepth::Sixteen;
        Ok((Box::new(Self { reader, row, channels, deep, whole: None }), facts))
    }

    fn whole(&mut self) -> Result<&[u8], PictureError> {
        if self.whole.is_none() {
            let mut bytes = vec![0; self.row.len() * self.reader.info().height as usize];
            self.reader.next_frame(&mut bytes)?;
            self.whole = Some(bytes);
        }
        Ok(self.whole.as_deref().unwrap_or(&[]))
    }
}

impl Source for PngPicture {
    fn read(&mut self, rows: Range<usize>) -> Result<Pixels, PictureError> {
        let mut samples = Vec::with_capacity(rows.len() * self.row.len());
        if self.reader.info().interlaced {
            let (row_bytes, deep) = (self.row.len(), self.deep);
            let bytes = &self.whole()?[rows.start * row_bytes..rows.end * row_bytes];
            to_fractions(bytes, deep, &mut samples);
        } else {
            for _ in rows {
                self.reader.read_row(&mut self.row)?;
                to_fractions(&self.row, self.deep, &mut samples);
            }
        }
        Ok(pixels(&samples, self.channels))
    }
}

/// Converts integers to fractions of the greatest, 0..=1.
fn to_fractions(bytes: &[u8], deep: bool, to: &mut Vec<f32>) {
    if deep {
        let words = bytes.as_chunks().0.iter();
        to.extend(words.map(|b| f32::from(u16::from_be_bytes(*b)) / f32::from(u16::MAX)));
    } else {
        to.extend(bytes.iter().map(|b| f32::from(*b) / f32::from(u8::MAX)));
    }
}

/// Space and encoding that a file states, from the chunk of the highest priority.
fn color_of(info: &Info<'_>) -> (Option<RgbSpace>, Option<Encoding>) {
    if let Some(code_points) = info.coding_independent_code_points {
        return of_code_points(code_points);
    }
    if info.icc_profile.is_some() {
        return (None, None);
    }
    if info.srgb.is_some() {
        return (RgbSpace::named("srgb").ok(), Some(Encoding::Srgb));
    }
    let pair = |(x, y): (png::ScaledFloat, png::ScaledFloat)| {
        [x, y].map(|v| f64::from(v.into_scaled()) / f64::from(png::ScaledFloat::SCALING))
    };
    let stated = info
        .chrm_chunk
        .and_then(|c| space([pair(c.red), pair(c.green), pair(c.blue)], pair(c.white)));
    let gamma = info.gama_chunk.map(|g| f64::from(g.into_scaled()));
    (stated, gamma.and_then(of_gamma))
}

/// The encoding of a gAMA chunk, which states 100000/γ.
fn of_gamma(stated: f64) -> Option<Encoding> {
    let gamma = f64::from(png::ScaledFloat::SCALING) / stated;
    match gamma {
        1.0 => Some(Encoding::Linear),
        _ => Some(Encoding::Gamma(gamma)).filter(|_| gamma.is_finite()),
    }
}

/// The space and encoding of code points of ITU-T H.273, if they are supported.
fn of_code_points(points: CodingIndependentCodePoints) -> (Option<RgbSpace>, Option<Encoding>) {
    if points.matrix_coefficients != 0 || !points.is_video_full_range_image {
        return (None, None);
    }
    let name = match points.color_primaries {
        1 => Some("srgb"),
        9 => Some("rec2020"),
        12 => Some("p3-d65"),
        _ => None,
    };
    let encoding = match points.transfer_function {
        4 => Some(Encoding::Gamma(2.2)),
        5 => Some(Encoding::Gamma(2.8)),
        8 => Some(Encoding::Linear),
        13 => Some(Encoding::Srgb),
        _ => None,
    };
    (name.and_then(|name| RgbSpace::named(name).ok()), encoding)
}
