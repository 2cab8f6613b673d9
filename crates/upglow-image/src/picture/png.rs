//! Colors of a PNG file.

mod chunks;

use std::fmt;
use std::fs::File;
use std::io::{BufReader, Seek as _};
use std::ops::Range;
use std::path::Path;

use png::{
    BitDepth, ColorType, DecodeOptions, Decoder, DecodingError, Info, Reader, Transformations,
};
use upglow::open_input;
use upglow_color::RgbSpace;

use self::chunks::Chunks;
use super::chromaticities::stated;
use super::encoding::Encoding;
use super::error::PictureError;
use super::exif::Exif;
use super::source::{
    Alpha, Facts, LastSample, Pixels, Source, add_bytes, add_words, check_memory, check_size,
    pixels,
};
use super::stated::{Stated, StatedColor, StatementError};
use super::{code_points, icc};

pub(super) struct PngPicture {
    reader: Reader<BufReader<File>>,
    row: Vec<u8>,
    channels: usize,
    deep: bool,
    /// The color of each index, if pixels are indices.
    palette: Option<Palette>,
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
        let mut file = BufReader::new(open_input(path)?);
        let chunks = Chunks::read(&mut file)?;
        let size = chunks.size;
        check_size(size)?;
        let by_code_points = chunks.code_points.map(of_code_points).transpose()?;
        file.rewind()?;
        let mut decoder = Decoder::new_with_options(file, options);
        decoder.set_limits(png::Limits { bytes: CHUNK_BYTES });
        // The decoder makes black of indices that the palette lacks.
        decoder.set_transformations(match chunks.is_indexed {
            true => Transformations::IDENTITY,
            false => Transformations::EXPAND,
        });
        let reader = decoder.read_info().map_err(refusal)?;
        let info = reader.info();
        chunks.check_all_are_in(info)?;
        let palette = chunks.is_indexed.then(|| Palette::of(info)).transpose()?;
        let (mut color, depth) = reader.output_color_type();
        if chunks.is_indexed {
            color = if info.trns.is_some() { ColorType::Rgba } else { ColorType::Rgb };
        }
        let channels = color.samples();
        let row_bytes = reader.output_line_size(info.width).unwrap_or(usize::MAX) as u64;
        if info.interlaced {
            check_memory("an interlaced picture", row_bytes.saturating_mul(size[1] as u64))?;
        }
        let has_alpha = matches!(color, ColorType::GrayscaleAlpha | ColorType::Rgba);
        let facts = Facts {
            size,
            color: by_code_points.map_or_else(|| stated_color(info), Ok)?,
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
        Ok((Box::new(Self { reader, row, channels, deep, palette, whole: None }), facts))
    }

    fn decode_whole(&mut self) -> Result<(), PictureError> {
        if self.whole.is_none() {
            let mut bytes = vec![0; self.row.len() * self.reader.info().height as usize];
            self.reader.next_frame(&mut bytes).map_err(refusal)?;
            self.reader.finish().map_err(refusal)?;
            self.whole = Some(bytes);
        }
        Ok(())
    }

    /// Adds the samples of a row as fractions of the greatest.
    fn add_row(&self, row: &[u8], to: &mut Vec<f32>) -> Result<(), PictureError> {
        match &self.palette {
            Some(palette) => {
                let width = self.reader.info().width as usize;
                return palette.add_row(row, width, to);
            }
            None if self.deep => {
                add_words(row.as_chunks().0.iter().map(|b| u16::from_be_bytes(*b)), to);
            }
            None => add_bytes(row, to),
        }
        Ok(())
    }
}

/// The colors of indices.
struct Palette {
    /// Red, green and blue of each, and alpha if the file has it, as fractions.
    samples: Vec<f32>,
    channels: usize,
    /// Bits of an index.
    bits: usize,
}

impl Palette {
    fn of(info: &Info<'_>) -> Result<Self, PictureError> {
        let rgb = info.palette.as_deref().unwrap_or(&[]).as_chunks::<3>().0;
        let alpha = info.trns.as_deref();
        let opacities = alpha.map_or(0, <[u8]>::len);
        if opacities > rgb.len() {
            return Err(damaged(format!("{opacities} alphas for {} colors", rgb.len())));
        }
        let mut samples = Vec::new();
        for (i, rgb) in rgb.iter().enumerate() {
            add_bytes(rgb, &mut samples);
            if let Some(alpha) = alpha {
                add_bytes(&[alpha.get(i).copied().unwrap_or(u8::MAX)], &mut samples);
            }
        }
        let channels = 3 + usize::from(alpha.is_some());
        Ok(Self { samples, channels, bits: usize::from(info.bit_depth as u8) })
    }

    fn add_row(&self, row: &[u8], width: usize, to: &mut Vec<f32>) -> Result<(), PictureError> {
        let together = 8 / self.bits;
        for i in 0..width {
            let below = 8 - self.bits * (1 + i % together);
            let index = usize::from(row[i / together] >> below) & ((1 << self.bits) - 1);
            let at = index * self.channels;
            let color = self.samples.get(at..at + self.channels);
            let outside = || damaged(format!("color {index}, which its map lacks"));
            to.extend(color.ok_or_else(outside)?);
        }
        Ok(())
    }
}

impl Source for PngPicture {
    fn read(&mut self, rows: Range<usize>) -> Result<Pixels, PictureError> {
        let mut samples = Vec::with_capacity(rows.len() * self.row.len());
        if self.reader.info().interlaced {
            self.decode_whole()?;
            let whole = self.whole.as_deref().unwrap_or(&[]);
            for row in whole.chunks_exact(self.row.len()).skip(rows.start).take(rows.len()) {
                self.add_row(row, &mut samples)?;
            }
        } else {
            let is_last = rows.end == self.reader.info().height as usize;
            for _ in rows {
                self.reader.read_row(&mut self.row).map_err(refusal)?;
                self.add_row(&self.row, &mut samples)?;
            }
            if is_last {
                // The checksums of the last chunk come after its last row.
                self.reader.finish().map_err(refusal)?;
            }
        }
        Ok(pixels(&samples, self.channels))
    }
}

/// What is wrong with a file that the decoder refuses.
fn refusal(error: DecodingError) -> PictureError {
    let found = match error {
        DecodingError::IoError(error) => return PictureError::read(error, FORMAT),
        DecodingError::LimitsExceeded => {
            let most = CHUNK_BYTES >> 20;
            return PictureError::pixels(
                format!("a chunk of over {most} MiB before the pixels"),
                "smaller ones: save the picture without it",
            );
        }
        _ => "its data or a checksum is wrong",
    };
    damaged(found)
}

fn damaged(found: impl Into<String>) -> PictureError {
    PictureError::Damaged { found: found.into(), format: FORMAT }
}

const FORMAT: &str = "PNG";

fn of_code_points(
    [primaries, transfer, matrix, range]: [u8; 4],
) -> Result<StatedColor, PictureError> {
    match range {
        0 | 1 => code_points::stated(primaries, transfer, matrix, range == 1),
        _ => Err(damaged(format!("its cICP chunk has {range} in place of 0 or 1 for its range"))),
    }
}

/// What a file without cICP states, by the chunk of the highest priority: iCCP, sRGB, then gAMA and cHRM.
fn stated_color(info: &Info<'_>) -> Result<StatedColor, PictureError> {
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
    Ok(StatedColor {
        space: info.chrm_chunk.map_or(Stated::No, |c| {
            stated("cHRM", [pair(c.red), pair(c.green), pair(c.blue)], pair(c.white))
        }),
        encoding: info.gama_chunk.map_or(Stated::No, |g| of_gamma(f64::from(g.into_scaled()))),
    })
}

/// The encoding of a gAMA chunk, which states 100000/γ.
fn of_gamma(stated: f64) -> Stated<Encoding> {
    const BY: &str = "gAMA";
    let found = f64::from(png::ScaledFloat::SCALING) / stated;
    match Encoding::of_gamma(found) {
        Some(Encoding::Gamma(1.0)) => Stated::yes(Encoding::Linear, BY),
        Some(encoding) => Stated::yes(encoding, BY),
        None => Stated::invalid(StatementError::Gamma { by: BY, found }),
    }
}
