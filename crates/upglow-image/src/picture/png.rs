//! Colors of a PNG file.

use std::fmt;
use std::fs::File;
use std::io::BufReader;
use std::ops::Range;
use std::path::Path;

use png::{
    BitDepth, ColorType, DecodeOptions, Decoder, DecodingError, Info, Reader, Transformations,
};
use upglow::open_input;
use upglow_color::RgbSpace;

use super::chromaticities::space;
use super::encoding::Encoding;
use super::error::PictureError;
use super::exif::Exif;
use super::source::{
    Alpha, Facts, LastSample, Pixels, Source, add_bytes, add_words, check_memory, check_size,
    pixels,
};
use super::stated::{Stated, StatedColor};
use super::{code_points, icc};

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
        let mut options = DecodeOptions::default();
        options.set_ignore_checksums(false);
        // A damaged chunk of colors must not count as absent.
        options.set_skip_ancillary_crc_failures(false);
        options.set_ignore_text_chunk(true);
        let file = BufReader::new(open_input(path)?);
        let mut decoder = Decoder::new_with_options(file, options);
        decoder.set_limits(png::Limits { bytes: CHUNK_BYTES });
        decoder.set_transformations(Transformations::EXPAND);
        let reader = decoder.read_info().map_err(refusal)?;
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
        let facts = Facts {
            size,
            color: stated_color(info)?,
            last_sample: match has_alpha {
                true => LastSample::Alpha(Alpha::Straight),
                false => LastSample::Absent,
            },
            windows: None,
            orientation: match &info.exif_metadata {
                Some(exif) => Exif::read(exif, FORMAT)?.orientation,
                None => 1,
            },
        };
        let row = vec![0; usize::try_from(row_bytes).unwrap_or(0)];
        let deep = depth == BitDepth::Sixteen;
        Ok((Box::new(Self { reader, row, channels, deep, whole: None }), facts))
    }

    fn whole(&mut self) -> Result<&[u8], PictureError> {
        if self.whole.is_none() {
            let mut bytes = vec![0; self.row.len() * self.reader.info().height as usize];
            self.reader.next_frame(&mut bytes).map_err(refusal)?;
            self.reader.finish().map_err(refusal)?;
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
            add_samples(bytes, deep, &mut samples);
        } else {
            let is_last = rows.end == self.reader.info().height as usize;
            for _ in rows {
                self.reader.read_row(&mut self.row).map_err(refusal)?;
                add_samples(&self.row, self.deep, &mut samples);
            }
            if is_last {
                // The checksums of the last chunk come after its last row.
                self.reader.finish().map_err(refusal)?;
            }
        }
        Ok(pixels(&samples, self.channels))
    }
}

/// Adds samples of 8 or 16 bits as fractions of the greatest.
fn add_samples(bytes: &[u8], deep: bool, to: &mut Vec<f32>) {
    if deep {
        add_words(bytes.as_chunks().0.iter().map(|b| u16::from_be_bytes(*b)), to);
    } else {
        add_bytes(bytes, to);
    }
}

/// What is wrong with a file that the decoder refuses.
fn refusal(error: DecodingError) -> PictureError {
    let found = match error {
        DecodingError::IoError(error) => return PictureError::read(error, FORMAT),
        DecodingError::LimitsExceeded => {
            let (found, expected) = (u64::MAX, CHUNK_BYTES as u64);
            return PictureError::Memory { what: "a chunk of its header", found, expected };
        }
        _ => "its data or a checksum is wrong",
    };
    PictureError::Damaged { found: found.into(), format: FORMAT }
}

const FORMAT: &str = "PNG";

/// What a file states, by the chunk of the highest priority: cICP, iCCP, sRGB, then gAMA and cHRM.
fn stated_color(info: &Info<'_>) -> Result<StatedColor, PictureError> {
    if let Some(points) = info.coding_independent_code_points {
        let (primaries, transfer) = (points.color_primaries, points.transfer_function);
        let is_full_range = points.is_video_full_range_image;
        return code_points::stated(primaries, transfer, points.matrix_coefficients, is_full_range);
    }
    if let Some(profile) = &info.icc_profile {
        return icc::stated(profile);
    }
    if info.srgb.is_some() {
        let space = RgbSpace::named("srgb").expect("it is built in");
        return Ok(StatedColor::yes(space, Encoding::Srgb, "sRGB"));
    }
    let pair = |(x, y): (png::ScaledFloat, png::ScaledFloat)| {
        [x, y].map(|v| f64::from(v.into_scaled()) / f64::from(png::ScaledFloat::SCALING))
    };
    let stated = info
        .chrm_chunk
        .and_then(|c| space([pair(c.red), pair(c.green), pair(c.blue)], pair(c.white)));
    let gamma = info.gama_chunk.and_then(|g| of_gamma(f64::from(g.into_scaled())));
    Ok(StatedColor {
        space: stated.map_or(Stated::No, |space| Stated::yes(space, "cHRM")),
        encoding: gamma.map_or(Stated::No, |encoding| Stated::yes(encoding, "gAMA")),
    })
}

/// The encoding of a gAMA chunk, which states 100000/γ.
fn of_gamma(stated: f64) -> Option<Encoding> {
    let gamma = f64::from(png::ScaledFloat::SCALING) / stated;
    match gamma {
        1.0 => Some(Encoding::Linear),
        _ => Some(Encoding::Gamma(gamma)).filter(|_| gamma.is_finite()),
    }
}
