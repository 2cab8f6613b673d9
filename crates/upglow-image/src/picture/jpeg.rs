//! Colors of a JPEG picture.
//!
//! The crate decompresses. What a file is, its colors and whether it is whole are determined here, from its
//! markers: decoders fill what is missing with gray.
//!
//! # Source
//!
//! `jpeg`, annex B; `jfif`.

use std::fmt;
use std::ops::Range;
use std::path::Path;

use upglow::read_input;
use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;

use super::error::PictureError;
use super::exif::Exif;
use super::icc;
use super::source::{
    Facts, LastSample, MAX_AT_ONCE, Pixels, Source, add_bytes, check_memory, check_size, pixels,
};

pub(super) struct JpegPicture {
    size: [usize; 2],
    channels: usize,
    /// The bytes of the file, until they are decompressed.
    packed: Vec<u8>,
    /// What the decoder is asked for, so that it converts YCbCr and nothing else.
    wanted: ColorSpace,
    /// The samples of all pixels.
    whole: Vec<u8>,
}

impl fmt::Debug for JpegPicture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("JpegPicture").field("size", &self.size).finish_non_exhaustive()
    }
}

/// The frame of a picture: how its components are stored.
struct Frame {
    size: [usize; 2],
    /// The names of the components.
    components: Vec<u8>,
    is_progressive: bool,
}

/// What the segments of a file state.
#[derive(Default)]
struct Segments {
    frame: Option<Frame>,
    has_jfif: bool,
    /// The transform of an Adobe segment.
    transform: Option<u8>,
    exif: Option<Vec<u8>>,
    /// The number and bytes of each part of a profile, and how many there are.
    profile: Vec<(u8, u8, Vec<u8>)>,
    scans: usize,
    /// The byte after the end of the picture.
    end: usize,
}

mod marker {
    pub(super) const START_OF_SCAN: u8 = 0xda;
    pub(super) const END_OF_IMAGE: u8 = 0xd9;
    pub(super) const APP0: u8 = 0xe0;
    pub(super) const APP1: u8 = 0xe1;
    pub(super) const APP2: u8 = 0xe2;
    pub(super) const APP14: u8 = 0xee;
    pub(super) const COMMENT: u8 = 0xfe;
}

const KINDS: &str = "gray or RGB of 8 bits, Huffman coded: save the picture as one of these";
const FORMAT: &str = "JPEG";
const MAX_SIDE: usize = 0xffff;
/// More scans than this only make a small file slow to read; encoders write about ten.
const MAX_SCANS: usize = 100;

impl JpegPicture {
    pub(super) fn open(path: &Path) -> Result<(Box<dyn Source>, Facts), PictureError> {
        check_memory("a JPEG file", std::fs::metadata(path)?.len())?;
        let mut packed = read_input(path, MAX_AT_ONCE)?;
        let segments = Segments::read(&mut packed)?;
        packed.truncate(segments.end);
        let Some(Frame { size, components, is_progressive }) = &segments.frame else {
            return Err(damaged("no frame"));
        };
        check_size(*size)?;
        // The decoder holds the coefficients of pictures in several scans, 2 bytes each.
        let bytes_per_sample = if *is_progressive || segments.scans > 1 { 3 } else { 1 };
        let samples = size[0] as u64 * size[1] as u64 * components.len() as u64;
        check_memory("a JPEG picture", samples * bytes_per_sample + packed.len() as u64)?;
        let wanted = segments.wanted(components)?;
        let exif = match segments.exif {
            Some(data) => Exif::read(&data, FORMAT)?,
            None => Exif::ABSENT,
        };
        let color = match profile(segments.profile) {
            Some(profile) => icc::stated(&profile)?,
            None => exif.color,
        };
        let facts = Facts {
            size: *size,
            color,
            last_sample: LastSample::Absent,
            windows: None,
            orientation: exif.orientation,
        };
        let (size, channels) = (*size, components.len());
        Ok((Box::new(Self { size, channels, packed, wanted, whole: Vec::new() }), facts))
    }

    /// Decompresses all rows.
    fn unpack(&mut self) -> Result<(), PictureError> {
        let options = DecoderOptions::default()
            .set_max_width(MAX_SIDE)
            .set_max_height(MAX_SIDE)
            .set_strict_mode(true)
            .jpeg_set_max_scans(MAX_SCANS)
            .jpeg_set_out_colorspace(self.wanted);
        let packed = std::mem::take(&mut self.packed);
        let mut decoder = JpegDecoder::new_with_options(ZCursor::new(&packed[..]), options);
        self.whole = decoder.decode().map_err(|error| damaged(refusal(&error)))?;
        let expected = self.size[0] * self.size[1] * self.channels;
        if self.whole.len() == expected { Ok(()) } else { Err(damaged("a second frame")) }
    }
}

impl Source for JpegPicture {
    fn read(&mut self, rows: Range<usize>) -> Result<Pixels, PictureError> {
        if self.whole.is_empty() {
            self.unpack()?;
        }
        let row = self.size[0] * self.channels;
        let mut samples = Vec::with_capacity(rows.len() * row);
        add_bytes(&self.whole[rows.start * row..rows.end * row], &mut samples);
        Ok(pixels(&samples, self.channels))
    }
}

impl Segments {
    /// Reads the segments up to the end of the picture. Adobe's becomes a comment, because the decoder would
    /// take RGB for CMYK.
    fn read(bytes: &mut [u8]) -> Result<Self, PictureError> {
        let mut found = Self::default();
        let mut at = 2;
        loop {
            // Further bytes 0xff before a marker are allowed.
            let start = at;
            while bytes.get(at) == Some(&0xff) {
                at += 1;
            }
            let &marker = bytes.get(at).ok_or_else(cut)?;
            if at == start {
                return Err(damaged("bytes between its segments"));
            }
            let mark = at;
            at += 1;
            if marker == marker::END_OF_IMAGE {
                found.end = at;
                return Ok(found);
            }
            let length = bytes.get(at..at + 2).ok_or_else(cut)?;
            let length = usize::from(length[0]) << 8 | usize::from(length[1]);
            let segment = bytes.get(at + 2..at + length.max(2)).ok_or_else(cut)?;
            if length < 2 {
                return Err(damaged("a segment without a length"));
            }
            let is_adobe = found.add(marker, segment)?;
            if is_adobe {
                bytes[mark] = marker::COMMENT;
            }
            at += length;
            if marker == marker::START_OF_SCAN {
                at = end_of_scan(bytes, at).ok_or_else(cut)?;
                found.scans += 1;
            }
        }
    }

    /// Adds a segment, and returns whether it is Adobe's.
    fn add(&mut self, marker: u8, segment: &[u8]) -> Result<bool, PictureError> {
        // All codes of frames, without those of tables, an extension and arithmetic coding's conditions.
        let is_frame = matches!(marker, 0xc0..=0xcf) && !matches!(marker, 0xc4 | 0xc8 | 0xcc);
        if is_frame && self.frame.replace(Frame::of(marker, segment)?).is_some() {
            return Err(damaged("a second frame"));
        }
        match (marker, segment) {
            (marker::APP0, [b'J', b'F', b'I', b'F', 0, ..]) => self.has_jfif = true,
            (marker::APP1, [b'E', b'x', b'i', b'f', 0, _, exif @ ..]) if self.exif.is_none() => {
                self.exif = Some(exif.to_vec());
            }
            (marker::APP2, _) => {
                if let Some([number, count, part @ ..]) = segment.strip_prefix(b"ICC_PROFILE\0") {
                    self.profile.push((*number, *count, part.to_vec()));
                }
            }
            (marker::APP14, [b'A', b'd', b'o', b'b', b'e', _, _, _, _, _, _, transform, ..]) => {
                self.transform = Some(*transform);
                return Ok(true);
            }
            _ => {}
        }
        Ok(false)
    }

    /// What to ask the decoder for: YCbCr becomes RGB, and RGB stays.
    fn wanted(&self, components: &[u8]) -> Result<ColorSpace, PictureError> {
        match components.len() {
            1 => return Ok(ColorSpace::Luma),
            3 => {}
            4 => {
                let found = if self.transform == Some(2) { "YCCK pixels" } else { "CMYK pixels" };
                return Err(PictureError::pixels(found, KINDS));
            }
            other => return Err(PictureError::pixels(format!("{other} components"), KINDS)),
        }
        let is_named_rgb = components == b"RGB";
        let is_ycbcr = match self.transform {
            _ if self.has_jfif => true,
            Some(transform) => transform == 1,
            None => !is_named_rgb,
        };
        match (is_ycbcr, is_named_rgb) {
            (true, true) => Err(damaged("components R, G and B that are said to be YCbCr")),
            // The decoder takes other components for YCbCr, and leaves what is wanted as that.
            (false, false) => Ok(ColorSpace::YCbCr),
            _ => Ok(ColorSpace::RGB),
        }
    }
}

impl Frame {
    fn of(marker: u8, segment: &[u8]) -> Result<Self, PictureError> {
        let found = match marker {
            0xc3 => Some("lossless coding"),
            0xc5..=0xc7 => Some("hierarchical coding"),
            0xc9..=0xcf => Some("arithmetic coding"),
            _ => None,
        };
        if let Some(found) = found {
            return Err(PictureError::pixels(found, KINDS));
        }
        let &[bits, high, low, wide, narrow, count, ref components @ ..] = segment else {
            return Err(damaged("a frame without a size"));
        };
        if bits != 8 {
            return Err(PictureError::pixels(format!("samples of {bits} bits"), KINDS));
        }
        if components.len() != 3 * usize::from(count) {
            return Err(damaged("a frame of another length"));
        }
        let side = |high, low| usize::from(u16::from_be_bytes([high, low]));
        Ok(Self {
            size: [side(wide, narrow), side(high, low)],
            components: components.iter().step_by(3).copied().collect(),
            is_progressive: marker == 0xc2,
        })
    }
}

/// The position of the marker after the compressed data that begin at `at`.
fn end_of_scan(bytes: &[u8], at: usize) -> Option<usize> {
    let data = bytes.get(at..)?;
    let is_end = |pair: &[u8]| pair[0] == 0xff && !matches!(pair[1], 0 | 0xd0..=0xd7 | 0xff);
    Some(at + data.windows(2).position(is_end)?)
}

/// The profile whose parts these are; empty, which no profile is, if some are missing.
fn profile(mut parts: Vec<(u8, u8, Vec<u8>)>) -> Option<Vec<u8>> {
    let &(_, count, _) = parts.first()?;
    parts.sort_by_key(|(number, ..)| *number);
    let is_whole = parts.len() == usize::from(count) && (1..).zip(&parts).all(|(i, p)| i == p.0);
    Some(if is_whole { parts.into_iter().flat_map(|p| p.2).collect() } else { Vec::new() })
}

/// What the decoder found, in our words.
fn refusal(error: &DecodeErrors) -> &'static str {
    match error {
        DecodeErrors::HuffmanDecode(_) => "a table of codes is invalid or absent",
        DecodeErrors::DqtError(_) => "a table of steps is invalid",
        DecodeErrors::SosError(_) | DecodeErrors::SofError(_) => "a frame or scan is invalid",
        _ => "its data are invalid or end too early",
    }
}

fn cut() -> PictureError {
    damaged("it ends too early")
}

fn damaged(found: &str) -> PictureError {
    PictureError::Damaged { found: found.into(), format: FORMAT }
}
