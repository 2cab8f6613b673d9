//! Colors of a TIFF file.

use std::fs::File;
use std::io::BufReader;
use std::ops::Range;
use std::path::Path;

use tiff::ColorType;
use tiff::decoder::ifd::Value;
use tiff::decoder::{ChunkType, Decoder, DecodingResult, DecodingSampleType, Limits};
use tiff::tags::Tag;
use upglow_color::RgbSpace;

use super::chromaticities::space;
use super::encoding::Encoding;
use super::error::PictureError;
use super::source::{Alpha, Facts, MAX_AT_ONCE, Pixels, Source, check_memory, check_size, pixels};

#[derive(Debug)]
pub(super) struct TiffPicture {
    decoder: Decoder<BufReader<File>>,
    size: [usize; 2],
    /// Columns and rows of a strip or tile.
    chunk: [usize; 2],
    channels: usize,
    /// Separately stored planes; 1 if pixels are interleaved.
    planes: usize,
}

/// Memory limit for a directory entry: the offsets of two million strips or tiles.
const MAX_DIRECTORY_BYTES: usize = 16 << 20;
const KINDS: &str = "gray or RGB of 8 or 16 bit integers, or 16 or 32 bit floats";
const WHITE_POINT: Tag = Tag::Unknown(318);
const PRIMARIES: Tag = Tag::Unknown(319);

impl TiffPicture {
    pub(super) fn open(path: &Path) -> Result<(Box<dyn Source>, Facts), PictureError> {
        let at_once = usize::try_from(MAX_AT_ONCE).unwrap_or(usize::MAX);
        let mut limits = Limits::default();
        limits.decoding_buffer_size = at_once;
        limits.intermediate_buffer_size = at_once;
        limits.ifd_value_size = MAX_DIRECTORY_BYTES;
        let decoder = Decoder::new(BufReader::new(File::open(path)?))?;
        let mut decoder = decoder.with_limits(limits);
        let (width, height) = decoder.dimensions()?;
        let size = [width as usize, height as usize];
        check_size(size)?;
        let color = decoder.colortype()?;
        let (channels, alpha) = match color {
            ColorType::Gray(_) => (1, None),
            ColorType::GrayA(_) => (2, Some(alpha_kind(&mut decoder))),
            ColorType::RGB(_) => (3, None),
            ColorType::RGBA(_) => (4, Some(alpha_kind(&mut decoder))),
            other => return Err(kind(format!("{other:?} pixels"))),
        };
        let (columns, rows) = decoder.chunk_dimensions();
        let chunk = [columns as usize, rows as usize];
        if chunk.contains(&0) {
            return Err(kind(format!("strips or tiles of {columns} by {rows} pixels")));
        }
        let chunk = [0, 1].map(|k| chunk[k].min(size[k].next_multiple_of(chunk[k])));
        let planar = decoder.find_tag_unsigned::<u16>(Tag::PlanarConfiguration)? == Some(2);
        let planes = if planar { channels } else { 1 };
        let strip_rows = chunk[1].min(size[1]) as u64;
        let samples = chunk[0] as u64 * strip_rows * (channels / planes) as u64;
        check_memory("a strip or tile", samples * u64::from(color.bit_depth().div_ceil(8)))?;
        let is_float = check_sample(&mut decoder)?;
        let facts = Facts {
            size,
            space: stated_space(&mut decoder),
            encoding: is_float.then_some(Encoding::Linear),
            alpha,
            windows: None,
            block_rows: chunk[1].min(size[1]),
        };
        Ok((Box::new(Self { decoder, size, chunk, channels, planes }), facts))
    }

    /// Copies the samples of a strip or tile of one plane to their places in `samples`.
    fn copy(
        &self,
        chunk: &[f32],
        at: [usize; 2],
        plane: usize,
        rows: &Range<usize>,
        samples: &mut [f32],
    ) -> Result<(), PictureError> {
        let [left, top] = [0, 1].map(|k| at[k] * self.chunk[k]);
        let columns = self.chunk[0].min(self.size[0] - left);
        let together = self.channels / self.planes;
        let last = (top + self.chunk[1]).min(rows.end);
        let (found, expected) = (chunk.len(), columns * (last - top) * together);
        if found < expected {
            return Err(kind(format!("{found} of {expected} samples in a strip or tile")));
        }
        for y in top..last {
            let line = &chunk[(y - top) * columns * together..][..columns * together];
            let row = &mut samples[(y - rows.start) * self.size[0] * self.channels..];
            let row = &mut row[left * self.channels..(left + columns) * self.channels];
            for (to, from) in row.chunks_exact_mut(self.channels).zip(line.chunks_exact(together)) {
                to[plane..plane + together].copy_from_slice(from);
            }
        }
        Ok(())
    }
}

impl Source for TiffPicture {
    fn read(&mut self, rows: Range<usize>) -> Result<Pixels, PictureError> {
        let mut samples = vec![0.0; rows.len() * self.size[0] * self.channels];
        let across = match self.decoder.get_chunk_type() {
            ChunkType::Strip => 1,
            ChunkType::Tile => self.size[0].div_ceil(self.chunk[0]),
        };
        let down = self.size[1].div_ceil(self.chunk[1]);
        for y in rows.start / self.chunk[1]..rows.end.div_ceil(self.chunk[1]) {
            for chunk in 0..across * self.planes {
                let (x, plane) = (chunk % across, chunk / across);
                let index = u32::try_from((plane * down + y) * across + x);
                let index = index.map_err(|_| kind(format!("{} planes", self.planes)))?;
                let chunk = self.decoder.read_chunk(index)?;
                self.copy(&fractions(chunk)?, [x, y], plane, &rows, &mut samples)?;
            }
        }
        Ok(pixels(&samples, self.channels))
    }
}

fn kind(found: String) -> PictureError {
    PictureError::Pixels { found, expected: KINDS }
}

/// Whether samples are floats; an error for unsupported types.
fn check_sample(decoder: &mut Decoder<BufReader<File>>) -> Result<bool, PictureError> {
    let found = decoder.image_chunk_buffer_layout(0)?.sample_type;
    match found {
        Some(DecodingSampleType::U8 | DecodingSampleType::U16) => Ok(false),
        Some(DecodingSampleType::F16 | DecodingSampleType::F32) => Ok(true),
        other => Err(kind(format!("{other:?} samples"))),
    }
}

/// Converts integers to fractions of the greatest; floats are unchanged.
fn fractions(samples: DecodingResult) -> Result<Vec<f32>, PictureError> {
    let most = [f32::from(u8::MAX), f32::from(u16::MAX)];
    Ok(match samples {
        DecodingResult::U8(values) => values.iter().map(|v| f32::from(*v) / most[0]).collect(),
        DecodingResult::U16(values) => values.iter().map(|v| f32::from(*v) / most[1]).collect(),
        DecodingResult::F16(values) => values.iter().map(|v| v.to_f32()).collect(),
        DecodingResult::F32(values) => values,
        _ => return Err(kind("other samples".into())),
    })
}

/// Extra samples of type 1 are associated alpha; all others are treated as straight alpha.
fn alpha_kind(decoder: &mut Decoder<BufReader<File>>) -> Alpha {
    match decoder.get_tag_u16_vec(Tag::ExtraSamples).as_deref() {
        Ok([1, ..]) => Alpha::Associated,
        _ => Alpha::Straight,
    }
}

/// The space of a file that states primaries and white and has no ICC profile.
fn stated_space(decoder: &mut Decoder<BufReader<File>>) -> Option<RgbSpace> {
    if decoder.find_tag(Tag::IccProfile).ok()?.is_some() {
        return None;
    }
    let mut numbers = |tag: Tag| fraction_list(decoder.find_tag(tag).ok()??);
    let white: [f64; 2] = numbers(WHITE_POINT)?.try_into().ok()?;
    let [rx, ry, gx, gy, bx, by]: [f64; 6] = numbers(PRIMARIES)?.try_into().ok()?;
    space([[rx, ry], [gx, gy], [bx, by]], white)
}

/// A list of rational numbers.
fn fraction_list(value: Value) -> Option<Vec<f64>> {
    let Value::List(values) = value else { return None };
    let number = |value: &Value| match *value {
        Value::Rational(above, below) => Some(f64::from(above) / f64::from(below)),
        _ => None,
    };
    values.iter().map(number).collect()
}
