//! OpenEXR images, written by bands of rows.

use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;

use exr::compression::Compression as Method;
use half::f16;
use half::slice::HalfFloatSliceExt as _;
use rayon::prelude::*;
use upglow::Aside;
use upglow_color::RgbSpace;

use super::attribute::{Attributes, chromaticities, stated_space};
use super::header::{Arrangement, Channel, MAX_SIDE, Sample, Window, is_name, is_reserved, print};

/// How blocks of rows are compressed; all methods are lossless.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compression {
    /// Uncompressed.
    None,
    /// Each row separately: faster to read single texels from, and a little larger.
    Zips,
    /// Sixteen rows together.
    #[default]
    Zip,
}

impl Compression {
    fn method(self) -> Method {
        match self {
            Self::None => Method::Uncompressed,
            Self::Zips => Method::ZIP1,
            Self::Zip => Method::ZIP16,
        }
    }
}

/// The properties of an image that is to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct ExrDescription {
    /// Width and height, pixels.
    pub size: [usize; 2],
    /// Names of the channels, in the order of the planes of a band.
    pub channels: Vec<String>,
    /// Half or float, the same for all channels.
    pub sample: Sample,
    /// How blocks are compressed.
    pub compression: Compression,
    /// Further attributes of the file.
    pub(crate) attributes: Attributes,
    /// Data and display window; `None` for a picture that starts at (0, 0) and is displayed whole.
    pub(crate) windows: Option<[Window; 2]>,
}

impl ExrDescription {
    /// An image of `size` with these channels: half precision, ZIP, no attributes.
    #[must_use]
    pub fn new(size: [usize; 2], channels: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self {
            size,
            channels: channels.into_iter().map(Into::into).collect(),
            sample: Sample::Half,
            compression: Compression::default(),
            attributes: Attributes::new(),
            windows: None,
        }
    }

    /// The same image with another type of samples.
    #[must_use]
    pub fn with_sample(self, sample: Sample) -> Self {
        Self { sample, ..self }
    }

    /// The same image; the file states this RGB space.
    #[must_use]
    pub fn with_space(mut self, space: &RgbSpace) -> Self {
        self.attributes.insert("chromaticities".into(), chromaticities(space));
        self
    }

    /// The same image; the file states this RGB space as baked files do: by its name in the Color Interop Forum, or by
    /// its chromaticities if it has none.
    #[must_use]
    pub fn with_named_space(mut self, space: &RgbSpace) -> Self {
        self.attributes.extend([stated_space(space)]);
        self
    }
}

/// Why an OpenEXR file cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteExrError {
    /// The file cannot be written.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The description is invalid, a band does not fit it, or rows are missing.
    #[error("{found}, expected {expected}")]
    Invalid {
        /// The invalid property.
        found: String,
        /// What would be valid.
        expected: String,
    },
    /// A finite number that would become infinite in half precision.
    #[error("{value} in channel {channel}, expected at most 65504 in half precision, or float")]
    BeyondHalf {
        /// The channel.
        channel: String,
        /// The number.
        value: f32,
    },
}

impl WriteExrError {
    fn invalid(found: impl Into<String>, expected: impl ToString) -> Self {
        Self::Invalid { found: found.into(), expected: expected.to_string() }
    }
}

/// An OpenEXR file that is being written from top to bottom.
///
/// The file appears under its name when [`ExrWriter::finish`] returns; a writer that is dropped before
/// leaves no file. The bytes depend neither on the division into bands nor on the number of threads.
/// Memory: the band in the precision of the file, twice if it is compressed, and one block of rows.
#[derive(Debug)]
pub struct ExrWriter {
    file: BlockFile,
    /// First row of the data window.
    first_row: i32,
    /// Blocks that are written.
    blocks: usize,
    /// Rows of an incomplete block, in the layout of the file.
    pending: Vec<u8>,
    /// Rows received so far.
    rows: usize,
}

/// An OpenEXR file of blocks, rows or tiles, whose table is completed last. It appears under its name when
/// [`BlockFile::finish`] returns.
#[derive(Debug)]
pub(super) struct BlockFile {
    file: Aside,
    pub(super) description: ExrDescription,
    /// Indices of the caller's channels in the order of the file.
    order: Vec<usize>,
    /// Position of the table of blocks, bytes.
    table: u64,
    /// Position of the next block, bytes.
    position: u64,
    /// Positions of the blocks in the order of the table; 0 for those not written.
    offsets: Vec<u64>,
}

impl BlockFile {
    /// Starts a file that will be named `path`, with room for a table of as many blocks as a valid
    /// description has; returns also the first row of its data window.
    pub(super) fn create(
        path: &Path,
        description: ExrDescription,
        arrangement: Arrangement,
        blocks: impl FnOnce(&ExrDescription) -> usize,
    ) -> Result<(Self, i32), WriteExrError> {
        let (order, first_row, header) = begin(&description, arrangement)?;
        let blocks = blocks(&description);
        let table = header.len() as u64;
        let mut file = Aside::create(path)?;
        file.write_all(&header)?;
        file.write_all(&vec![0; 8 * blocks])?;
        let position = table + 8 * blocks as u64;
        let offsets = vec![0; blocks];
        Ok((Self { file, description, order, table, position, offsets }, first_row))
    }

    /// Bytes of a row of this width.
    pub(super) fn row_bytes(&self, width: usize) -> usize {
        width * self.order.len() * self.description.sample.bytes()
    }

    /// Fills the bytes of row `row` of planes of this width.
    pub(super) fn encode_row(
        &self,
        channels: &[&[f32]],
        width: usize,
        row: usize,
        bytes: &mut [u8],
    ) {
        let sample = self.description.sample;
        for (part, &channel) in bytes.chunks_exact_mut(width * sample.bytes()).zip(&self.order) {
            encode(sample, &channels[channel][row * width..(row + 1) * width], part);
        }
    }

    /// Writes a block, by its number in the table, with the numbers that it begins with.
    pub(super) fn write(
        &mut self,
        index: usize,
        head: &[i32],
        packed: &[u8],
    ) -> Result<(), WriteExrError> {
        let size = u32::try_from(packed.len()).map_err(io::Error::other)?;
        for number in head {
            self.file.write_all(&number.to_le_bytes())?;
        }
        self.file.write_all(&size.to_le_bytes())?;
        self.file.write_all(packed)?;
        self.offsets[index] = self.position;
        self.position += (4 * head.len() + 4 + packed.len()) as u64;
        Ok(())
    }

    /// Writes the table; the file only lacks its name.
    pub(super) fn into_file(mut self) -> Result<Aside, WriteExrError> {
        debug_assert!(self.offsets.iter().all(|&at| at > 0), "a block is missing");
        self.file.seek(SeekFrom::Start(self.table))?;
        let table: Vec<u8> = self.offsets.iter().flat_map(|at| at.to_le_bytes()).collect();
        self.file.write_all(&table)?;
        Ok(self.file)
    }
}

impl ExrWriter {
    /// Starts a file that will be named `path`.
    ///
    /// # Errors
    ///
    /// [`WriteExrError`] if the description is invalid or the path cannot be written.
    pub fn create(
        path: impl AsRef<Path>,
        description: ExrDescription,
    ) -> Result<Self, WriteExrError> {
        let blocks = |described: &ExrDescription| {
            described.size[1].div_ceil(described.compression.method().scan_lines_per_block())
        };
        let (file, first_row) =
            BlockFile::create(path.as_ref(), description, Arrangement::Rows, blocks)?;
        Ok(Self { file, first_row, blocks: 0, pending: Vec::new(), rows: 0 })
    }

    /// Writes the next rows: for each channel, in the caller's order, its samples row by row.
    ///
    /// # Errors
    ///
    /// [`WriteExrError`] if the band does not fit or the disk is full.
    pub fn write_band(&mut self, channels: &[&[f32]]) -> Result<(), WriteExrError> {
        let rows = self.check_band(channels)?;
        check_half(&self.file.description, channels)?;
        let width = self.file.description.size[0];
        let row_bytes = self.file.row_bytes(width);
        let start = self.pending.len();
        self.pending.resize(start + rows * row_bytes, 0);
        let (file, parts) = (&self.file, self.pending[start..].par_chunks_mut(row_bytes.max(1)));
        parts.enumerate().for_each(|(row, bytes)| file.encode_row(channels, width, row, bytes));
        self.rows += rows;
        self.write_blocks()
    }

    /// Completes the file and gives it its name. Returns its size in bytes.
    ///
    /// # Errors
    ///
    /// [`WriteExrError`] if rows are missing or the disk is full; no file is left then.
    pub fn finish(self) -> Result<u64, WriteExrError> {
        Ok(self.into_file()?.commit()?)
    }

    /// Completes the file but for its name, for files that appear together.
    ///
    /// # Errors
    ///
    /// As [`ExrWriter::finish`].
    pub fn into_file(self) -> Result<Aside, WriteExrError> {
        let expected = self.file.description.size[1];
        if self.rows != expected {
            return Err(WriteExrError::invalid(format!("{} rows", self.rows), expected));
        }
        self.file.into_file()
    }

    /// The number of rows of a valid band.
    fn check_band(&self, channels: &[&[f32]]) -> Result<usize, WriteExrError> {
        let [width, height] = self.file.description.size;
        let (found, expected) = (channels.len(), self.file.order.len());
        if found != expected {
            return Err(WriteExrError::invalid(format!("{found} channels in a band"), expected));
        }
        let rows = channels.first().map_or(0, |c| c.len() / width);
        let names = self.file.description.channels.iter();
        if let Some((name, plane)) = names.zip(channels).find(|(_, c)| c.len() != rows * width) {
            let found = format!("{} samples in channel {name}", plane.len());
            let expected = format!("{}: whole rows, the same in each channel", rows * width);
            return Err(WriteExrError::invalid(found, expected));
        }
        if self.rows + rows > height {
            return Err(WriteExrError::invalid(format!("{} rows", self.rows + rows), height));
        }
        Ok(rows)
    }

    /// Compresses and writes the complete blocks of the pending rows; at the end also the last one.
    fn write_blocks(&mut self) -> Result<(), WriteExrError> {
        let compression = self.file.description.compression;
        let block_rows = compression.method().scan_lines_per_block();
        let block_bytes = (block_rows * self.file.row_bytes(self.file.description.size[0])).max(1);
        let ready = if self.rows == self.file.description.size[1] {
            self.pending.len()
        } else {
            self.pending.len() / block_bytes * block_bytes
        };
        let blocks = self.pending[..ready].par_chunks(block_bytes);
        let packed: Vec<Vec<u8>> = blocks.map(|block| pack(compression, block)).collect();
        for bytes in packed {
            let row = i32::try_from(self.blocks * block_rows).unwrap_or(i32::MAX);
            self.file.write(self.blocks, &[self.first_row.saturating_add(row)], &bytes)?;
            self.blocks += 1;
        }
        self.pending.drain(..ready);
        Ok(())
    }
}

/// The smallest number that rounds to infinity in half precision: 65504 and half a step.
const HALF_OVERFLOW: f32 = 65520.0;

/// Refuses finite numbers that the samples of a file cannot hold.
pub(super) fn check_half(
    description: &ExrDescription,
    channels: &[&[f32]],
) -> Result<(), WriteExrError> {
    if description.sample != Sample::Half {
        return Ok(());
    }
    let beyond = |v: &f32| v.is_finite() && v.abs() >= HALF_OVERFLOW;
    let found =
        channels.par_iter().zip(&description.channels).find_map_first(|(plane, channel)| {
            Some((plane.iter().copied().find(|v| beyond(v))?, channel.clone()))
        });
    found.map_or(Ok(()), |(value, channel)| Err(WriteExrError::BeyondHalf { channel, value }))
}

/// The order of the channels in the file, its first row, and its header.
fn begin(
    description: &ExrDescription,
    arrangement: Arrangement,
) -> Result<(Vec<usize>, i32, Vec<u8>), WriteExrError> {
    let windows = check(description)?;
    let order = sorted(&description.channels)?;
    let sample = description.sample;
    let channel = |name: &String| Channel { name: name.clone(), sample, is_linear: false };
    let channels: Vec<Channel> = order.iter().map(|&c| channel(&description.channels[c])).collect();
    let method = description.compression.method();
    let header = print(&channels, method, windows, arrangement, &description.attributes);
    Ok((order, windows[0].min[1], header))
}

/// Data and display window of a valid description.
fn check(description: &ExrDescription) -> Result<[Window; 2], WriteExrError> {
    let [width, height] = description.size;
    if description.size.iter().any(|side| !(1..=MAX_SIDE).contains(side)) {
        let expected = format!("1 to {MAX_SIDE} a side");
        let found = format!("{width} by {height} pixels");
        return Err(WriteExrError::invalid(found, expected));
    }
    if description.sample == Sample::Uint {
        return Err(WriteExrError::invalid("unsigned samples", "half or float"));
    }
    let mut names = description.channels.iter().chain(description.attributes.keys());
    if let Some(found) = names.find(|name| !is_name(name)) {
        let found = format!("channel or attribute name {found:?}");
        return Err(WriteExrError::invalid(found, "1 to 255 characters"));
    }
    if let Some(found) = description.attributes.keys().find(|name| is_reserved(name)) {
        let expected = "a name that OpenEXR does not define itself";
        return Err(WriteExrError::invalid(format!("attribute {found:?}"), expected));
    }
    let windows = description.windows.unwrap_or([Window::of_size(description.size); 2]);
    debug_assert_eq!(windows[0].size(), Some(description.size), "a data window of another size");
    Ok(windows)
}

/// The indices of the names in alphabetical order, by bytes.
fn sorted(names: &[String]) -> Result<Vec<usize>, WriteExrError> {
    let mut order: Vec<usize> = (0..names.len()).collect();
    order.sort_by_key(|&i| names[i].as_bytes());
    if let Some(pair) = order.windows(2).find(|pair| names[pair[0]] == names[pair[1]]) {
        let found = format!("two channels named {:?}", names[pair[0]]);
        return Err(WriteExrError::invalid(found, "each name once"));
    }
    Ok(order)
}

fn encode(sample: Sample, values: &[f32], to: &mut [u8]) {
    match sample {
        Sample::Half => {
            // Many at once: asking which instructions there are takes longer than one conversion.
            let mut halves = [f16::ZERO; 256];
            let pieces = to.chunks_mut(2 * halves.len()).zip(values.chunks(halves.len()));
            for (to, values) in pieces {
                let halves = &mut halves[..values.len()];
                halves.convert_from_f32_slice(values);
                let bytes = to.as_chunks_mut().0.iter_mut().zip(halves);
                bytes.for_each(|(to, v)| *to = v.to_le_bytes());
            }
        }
        Sample::Float | Sample::Uint => {
            let bytes = to.as_chunks_mut().0.iter_mut().zip(values);
            bytes.for_each(|(to, v)| *to = v.to_le_bytes());
        }
    }
}

/// Level 1 compresses a material map four times as fast as level 4, to 1.05 times the size.
const DEFLATE_LEVEL: u8 = 1;

/// A block as the file holds it: compressed if that makes it shorter.
pub(super) fn pack(compression: Compression, block: &[u8]) -> Vec<u8> {
    if compression == Compression::None {
        return block.to_vec();
    }
    let packed = miniz_oxide::deflate::compress_to_vec_zlib(&differences(block), DEFLATE_LEVEL);
    if packed.len() < block.len() { packed } else { block.to_vec() }
}

/// Even bytes, then odd bytes, each as the difference from the byte before it, plus 128.
///
/// # Source
///
/// `openexr`, the predictor of ZIP compression.
fn differences(block: &[u8]) -> Vec<u8> {
    let mut separate = Vec::with_capacity(block.len());
    let (pairs, last) = block.as_chunks::<2>();
    separate.extend(pairs.iter().map(|[even, _]| *even).chain(last.iter().copied()));
    separate.extend(pairs.iter().map(|[_, odd]| *odd));
    let mut before = 128;
    for byte in &mut separate {
        let difference = byte.wrapping_sub(before).wrapping_add(128);
        before = std::mem::replace(byte, difference);
    }
    separate
}
