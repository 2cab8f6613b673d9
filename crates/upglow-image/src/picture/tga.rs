//! Colors of a TGA picture.
//!
//! # Source
//!
//! `tga`: the header, the extension area and the footer.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;

use upglow::open_input;

use super::error::PictureError;
use super::source::{Alpha, Facts, LastSample, Pixels, Source, add_bytes, check_size, pixels};
use super::stated::{Stated, StatedColor};

#[derive(Debug)]
pub(super) struct TgaPicture {
    file: BufReader<File>,
    width: usize,
    is_packed: bool,
    pixel: Pixel,
    colors: Option<Map>,
    packet: Packet,
    /// Where the rows begin, of a picture whose first row is the lowest; empty for others.
    starts: Vec<(u64, Packet)>,
}

/// How a pixel, or an entry of the color map, is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pixel {
    Gray,
    GrayAlpha,
    /// 5 bits each for red, green and blue, of which blue is lowest; then one bit that may be alpha.
    Rgb5 {
        has_bit: bool,
    },
    /// Blue, green, red.
    Bgr,
    Bgra,
    /// The position of a color in the map, of 1 or 2 bytes.
    Index {
        bytes: usize,
    },
}

/// The colors that pixels are positions in.
#[derive(Debug)]
struct Map {
    first: usize,
    channels: usize,
    samples: Vec<f32>,
}

/// What is left of a packet, which may go on in the next row.
#[derive(Clone, Copy, Debug)]
enum Packet {
    /// Pixels as they are.
    Plain(usize),
    /// Repetitions of a pixel.
    Run(usize, [u8; 4]),
}

const HEADER_BYTES: usize = 18;
const FOOTER_BYTES: u64 = 26;
const SIGNATURE: &[u8] = b"TRUEVISION-XFILE.\0";
/// Where the extension area says what alpha is, from its start.
const ATTRIBUTES_TYPE: u64 = 494;

const KINDS: &str = "gray of 8 bits, gray with alpha of 16, or colors of 15, 16, 24 or 32 bits: \
    save the picture as one of these";

/// Whether a file ends like a TGA file, or is named like one: its first bytes do not tell.
pub(super) fn is_tga(path: &Path) -> Result<bool, PictureError> {
    let suffix = path.extension().and_then(|suffix| suffix.to_str()).unwrap_or_default();
    Ok(suffix.eq_ignore_ascii_case("tga") || extension_area(&mut open_input(path)?)?.is_some())
}

/// The position of the extension area, which is 0 in files of version 2 without one; `None` for files
/// without the footer of version 2.
fn extension_area(file: &mut (impl Read + Seek)) -> Result<Option<u64>, PictureError> {
    let length = file.seek(SeekFrom::End(0))?;
    if length < FOOTER_BYTES {
        return Ok(None);
    }
    file.seek(SeekFrom::Start(length - FOOTER_BYTES))?;
    let mut footer = Vec::new();
    file.take(FOOTER_BYTES).read_to_end(&mut footer)?;
    let Some((position, rest)) = footer.split_first_chunk() else { return Ok(None) };
    let is_footer = rest.get(4..) == Some(SIGNATURE);
    Ok(is_footer.then(|| u32::from_le_bytes(*position).into()))
}

impl TgaPicture {
    pub(super) fn open(path: &Path) -> Result<(Box<dyn Source>, Facts), PictureError> {
        let mut file = BufReader::new(open_input(path)?);
        let attributes = attributes_type(&mut file)?;
        file.rewind()?;
        let header: [u8; HEADER_BYTES] = bytes(&mut file)?;
        let [text, map_type, kind, ..] = header;
        let word = |at: usize| usize::from(u16::from_le_bytes([header[at], header[at + 1]]));
        let size = [word(12), word(14)];
        let [depth, descriptor] = [header[16], header[17]];
        let alpha_bits = descriptor & 0x0f;
        let is_known = matches!(map_type, 0 | 1) && matches!(kind, 1..=3 | 9..=11);
        if !is_known || matches!(kind, 1 | 9) && map_type == 0 {
            return Err(damaged(format!("a header of kind {kind} with color map {map_type}")));
        }
        check_size(size)?;
        if descriptor & 0xc0 != 0 {
            return Err(PictureError::pixels("interleaved rows", "rows in order"));
        }
        skip(&mut file, text.into())?;
        let pixel = match kind {
            1 | 9 if matches!(depth, 8 | 16) => Pixel::Index { bytes: usize::from(depth / 8) },
            2 | 10 => Pixel::of_depth(depth, alpha_bits)?,
            3 | 11 if depth == 8 => Pixel::Gray,
            3 | 11 if depth == 16 && alpha_bits == 8 => Pixel::GrayAlpha,
            _ => return Err(PictureError::pixels(format!("pixels of {depth} bits"), KINDS)),
        };
        let has_map = matches!(pixel, Pixel::Index { .. });
        let mut colors = None;
        let mut stored = pixel;
        if map_type == 1 {
            let (first, count, depth) = (word(3), word(5), header[7]);
            if has_map {
                stored = Pixel::of_depth(depth, alpha_bits)?;
                colors = Some(Map::read(&mut file, stored, first, count)?);
            } else {
                skip(&mut file, count as u64 * u64::from(depth.div_ceil(8)))?;
            }
        }
        let facts = Facts {
            size,
            color: StatedColor { space: Stated::No, encoding: Stated::No },
            last_sample: last_sample(stored, alpha_bits, attributes),
            windows: None,
            // Rows are read from the top. They begin at the left unless bit 4 is set.
            orientation: if descriptor & 0x10 == 0 { 1 } else { 2 },
        };
        let (width, is_packed) = (size[0], kind >= 9);
        let (packet, starts) = (Packet::Plain(0), Vec::new());
        let mut picture = Self { file, width, is_packed, pixel, colors, packet, starts };
        // The first row is the lowest unless bit 5 is set.
        if descriptor & 0x20 == 0 {
            picture.find_rows(size[1])?;
        }
        Ok((Box::new(picture), facts))
    }

    /// Finds where the rows begin. Rows in packets must be read for that.
    fn find_rows(&mut self, rows: usize) -> Result<(), PictureError> {
        let mut row = vec![0; self.width * self.pixel.bytes()];
        let mut at = self.file.stream_position()?;
        for _ in 0..rows {
            self.starts.push((at, self.packet));
            if self.is_packed {
                self.row(&mut row)?;
                at = self.file.stream_position()?;
            } else {
                at += row.len() as u64;
            }
        }
        Ok(())
    }

    /// Reads the bytes of a row.
    fn row(&mut self, row: &mut [u8]) -> Result<(), PictureError> {
        if !self.is_packed {
            return exactly(&mut self.file, row);
        }
        let size = self.pixel.bytes();
        let mut rest = row;
        while !rest.is_empty() {
            if let Packet::Plain(0) | Packet::Run(0, _) = self.packet {
                let [code] = bytes(&mut self.file)?;
                let count = usize::from(code & 0x7f) + 1;
                self.packet = if code & 0x80 == 0 {
                    Packet::Plain(count)
                } else {
                    let mut pixel = [0; 4];
                    exactly(&mut self.file, &mut pixel[..size])?;
                    Packet::Run(count, pixel)
                };
            }
            let (Packet::Plain(left) | Packet::Run(left, _)) = self.packet;
            let count = left.min(rest.len() / size);
            let (now, later) = rest.split_at_mut(count * size);
            match &mut self.packet {
                Packet::Plain(left) => {
                    exactly(&mut self.file, now)?;
                    *left -= count;
                }
                Packet::Run(left, pixel) => {
                    now.chunks_exact_mut(size).for_each(|to| to.copy_from_slice(&pixel[..size]));
                    *left -= count;
                }
            }
            rest = later;
        }
        Ok(())
    }
}

impl Source for TgaPicture {
    fn read(&mut self, rows: Range<usize>) -> Result<Pixels, PictureError> {
        let mut row = vec![0; self.width * self.pixel.bytes()];
        let mut samples = Vec::new();
        for _ in rows {
            if let Some((at, packet)) = self.starts.pop() {
                self.file.seek(SeekFrom::Start(at))?;
                self.packet = packet;
            }
            self.row(&mut row)?;
            match &self.colors {
                Some(map) => map.add_colors(&row, self.pixel.bytes(), &mut samples)?,
                None => self.pixel.add_samples(&row, &mut samples),
            }
        }
        let channels = self.colors.as_ref().map_or(self.pixel.channels(), |map| map.channels);
        Ok(pixels(&samples, channels))
    }
}

impl Pixel {
    fn of_depth(depth: u8, alpha_bits: u8) -> Result<Self, PictureError> {
        match (depth, alpha_bits) {
            (15 | 16, 0) => Ok(Self::Rgb5 { has_bit: false }),
            (15 | 16, 1) => Ok(Self::Rgb5 { has_bit: true }),
            (24, 0) => Ok(Self::Bgr),
            (32, 0 | 8) => Ok(Self::Bgra),
            (depth, alpha) => {
                let found = format!("colors of {depth} bits, {alpha} of them beside the color");
                Err(PictureError::pixels(found, KINDS))
            }
        }
    }

    fn bytes(self) -> usize {
        match self {
            Self::Gray => 1,
            Self::GrayAlpha | Self::Rgb5 { .. } => 2,
            Self::Bgr => 3,
            Self::Bgra => 4,
            Self::Index { bytes } => bytes,
        }
    }

    fn channels(self) -> usize {
        match self {
            Self::Gray | Self::Index { .. } => 1,
            Self::GrayAlpha => 2,
            Self::Rgb5 { has_bit: false } | Self::Bgr => 3,
            Self::Rgb5 { has_bit: true } | Self::Bgra => 4,
        }
    }

    fn add_samples(self, bytes: &[u8], to: &mut Vec<f32>) {
        match self {
            Self::Gray | Self::GrayAlpha | Self::Index { .. } => add_bytes(bytes, to),
            Self::Bgr | Self::Bgra => {
                for pixel in bytes.chunks_exact(self.bytes()) {
                    add_bytes(&[pixel[2], pixel[1], pixel[0]], to);
                    add_bytes(&pixel[3..], to);
                }
            }
            Self::Rgb5 { has_bit } => {
                for pixel in bytes.as_chunks().0 {
                    let word = u16::from_le_bytes(*pixel);
                    let colors = [10, 5, 0].map(|shift| f32::from(word >> shift & 31) / 31.0);
                    to.extend(colors);
                    to.extend(has_bit.then_some(f32::from(word >> 15)));
                }
            }
        }
    }
}

impl Map {
    fn read(
        file: &mut impl Read,
        stored: Pixel,
        first: usize,
        count: usize,
    ) -> Result<Self, PictureError> {
        let mut entries = vec![0; count * stored.bytes()];
        exactly(file, &mut entries)?;
        let mut samples = Vec::new();
        stored.add_samples(&entries, &mut samples);
        Ok(Self { first, channels: stored.channels(), samples })
    }

    /// Adds the colors at positions of `size` bytes each.
    fn add_colors(&self, row: &[u8], size: usize, to: &mut Vec<f32>) -> Result<(), PictureError> {
        for bytes in row.chunks_exact(size) {
            let index = bytes.iter().rev().fold(0, |sum, byte| sum << 8 | usize::from(*byte));
            let entry = index.checked_sub(self.first).and_then(|i| {
                let at = i * self.channels;
                self.samples.get(at..at + self.channels)
            });
            let outside = || damaged(format!("color {index}, which its map lacks"));
            to.extend(entry.ok_or_else(outside)?);
        }
        Ok(())
    }
}

/// What the extension area says of the bits beside the colors, if there is one.
fn attributes_type(file: &mut (impl Read + Seek)) -> Result<Option<u8>, PictureError> {
    let Some(area) = extension_area(file)?.filter(|area| *area != 0) else { return Ok(None) };
    file.seek(SeekFrom::Start(area + ATTRIBUTES_TYPE))?;
    Ok(Some(bytes::<1>(file)?[0]))
}

fn last_sample(stored: Pixel, alpha_bits: u8, attributes: Option<u8>) -> LastSample {
    match (stored.channels(), attributes) {
        (1 | 3, _) => LastSample::Absent,
        // The header says that none of the bits is alpha.
        _ if alpha_bits == 0 => LastSample::NotAlpha,
        (_, Some(0..=2)) => LastSample::NotAlpha,
        (_, Some(3)) => LastSample::Alpha(Alpha::Straight),
        (_, Some(4)) => LastSample::Alpha(Alpha::Associated),
        _ => LastSample::Unstated,
    }
}

fn skip(file: &mut (impl Read + Seek), count: u64) -> Result<(), PictureError> {
    file.seek_relative(count.cast_signed())?;
    Ok(())
}

fn bytes<const N: usize>(file: &mut impl Read) -> Result<[u8; N], PictureError> {
    let mut bytes = [0; N];
    exactly(file, &mut bytes)?;
    Ok(bytes)
}

fn exactly(file: &mut impl Read, to: &mut [u8]) -> Result<(), PictureError> {
    file.read_exact(to).map_err(|error| PictureError::read(error, FORMAT))
}

const FORMAT: &str = "TGA";

fn damaged(found: String) -> PictureError {
    PictureError::Damaged { found, format: FORMAT }
}
