//! OpenEXR images, written by bands of rows.

use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;

use half::f16;
use rayon::prelude::*;
use upglow::Aside;
use upglow_color::RgbSpace;

use super::attribute::{Attributes, chromaticities};
use super::header::{Channel, MAX_SIDE, Packing, Sample, Window, is_name, is_reserved, print};

/// How blocks of rows are packed; all are without loss.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compression {
    /// Not at all.
    None,
    /// Each row by itself: quick to read a texel from, a little larger.
    Zips,
    /// Sixteen rows together.
    #[default]
    Zip,
}

impl Compression {
    fn packing(self) -> Packing {
        match self {
            Self::None => Packing::NONE,
            Self::Zips => Packing::ZIPS,
            Self::Zip => Packing::ZIP,
        }
    }
}

/// What an image is, before its pixels are written.
#[derive(Clone, Debug, PartialEq)]
pub struct ExrDescription {
    /// Width and height, pixels.
    pub size: [usize; 2],
    /// Names of the channels, in the order in which bands bring them.
    pub channels: Vec<String>,
    /// Half or float, for every channel.
    pub sample: Sample,
    /// How blocks are packed.
    pub compression: Compression,
    /// What the file states besides.
    pub(crate) attributes: Attributes,
    /// Where the picture lies, and what of the plane is seen; `None` puts its first pixel at
    /// (0, 0) and shows all of it.
    pub(crate) windows: Option<[Window; 2]>,
}

impl ExrDescription {
    /// An image of `size` with these channels: half, ZIP, no attributes.
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

    /// The same image, its samples stored so.
    #[must_use]
    pub fn with_sample(self, sample: Sample) -> Self {
        Self { sample, ..self }
    }

    /// The same image, packed so.
    #[must_use]
    pub fn with_compression(self, compression: Compression) -> Self {
        Self { compression, ..self }
    }

    /// The same image; the file says that its colors are of this RGB space.
    #[must_use]
    pub fn with_space(mut self, space: &RgbSpace) -> Self {
        self.attributes.insert("chromaticities".into(), chromaticities(space));
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
    /// The picture is empty or too large.
    #[error("{} by {} pixels, expected 1 to {MAX_SIDE} a side", .found[0], .found[1])]
    Size {
        /// Width and height.
        found: [usize; 2],
    },
    /// A channel has no name, a name that is too long, or one with a zero byte.
    #[error("channel or attribute name {found:?}, expected 1 to 255 characters")]
    Name {
        /// The name.
        found: String,
    },
    /// Two channels have one name.
    #[error("two channels named {found:?}, expected each name once")]
    Twice {
        /// The name.
        found: String,
    },
    /// An attribute has a name that the format itself uses.
    #[error("attribute {found:?} is the format's own, expected another name")]
    Reserved {
        /// The name.
        found: String,
    },
    /// Samples of a kind that is not written.
    #[error("unsigned samples, expected half or float")]
    Sample,
    /// A band has another number of channels than the file.
    #[error("{found} channels in a band, expected {expected}")]
    Channels {
        /// Channels of the band.
        found: usize,
        /// Channels of the file.
        expected: usize,
    },
    /// The channels of a band are not whole rows, or not equally many.
    #[error(
        "{found} samples in channel {channel}, expected {expected}: whole rows, the same in each channel"
    )]
    Samples {
        /// The channel.
        channel: String,
        /// Its samples.
        found: usize,
        /// The samples of the band's first channel, in whole rows.
        expected: usize,
    },
    /// More or fewer rows than the picture has.
    #[error("{found} rows, expected {expected}")]
    Rows {
        /// Rows given.
        found: usize,
        /// Rows of the picture.
        expected: usize,
    },
    /// A finite number that would become infinite in half precision.
    #[error(
        "{value} in channel {channel}, expected at most 65504 in half precision; float holds it"
    )]
    BeyondHalf {
        /// The channel.
        channel: String,
        /// The number.
        value: f32,
    },
}

/// An OpenEXR file being written, by rows from top to bottom.
///
/// It appears under its name when [`ExrWriter::finish`] returns; dropped before, it leaves
/// nothing. The same pixels give the same bytes, for any cut into bands and any number of threads.
/// Memory: the band in the file's precision, twice where it is packed, and one block of rows.
#[derive(Debug)]
pub struct ExrWriter {
    file: Aside,
    description: ExrDescription,
    /// Numbers of the caller's channels in the file's order.
    order: Vec<usize>,
    /// First row of the data window.
    first_row: i32,
    /// Where the table of blocks begins.
    table: u64,
    /// Where the next block begins.
    position: u64,
    offsets: Vec<u64>,
    /// Rows of a block that is not yet whole, in the file's layout.
    pending: Vec<u8>,
    /// Rows given so far.
    rows: usize,
}

impl ExrWriter {
    /// Starts the file that will stand at `path`.
    ///
    /// # Errors
    ///
    /// [`WriteExrError`] if the description makes no file or the path cannot be written.
    pub fn create(
        path: impl AsRef<Path>,
        description: ExrDescription,
    ) -> Result<Self, WriteExrError> {
        let windows = check(&description)?;
        let order = sorted(&description.channels)?;
        let channels: Vec<Channel> = order
            .iter()
            .map(|&c| Channel {
                name: description.channels[c].clone(),
                sample: description.sample,
                is_linear: false,
            })
            .collect();
        let packing = description.compression.packing();
        let header = print(&channels, packing, windows, &description.attributes);
        let table = header.len() as u64;
        let count = description.size[1].div_ceil(packing.rows());
        let mut file = Aside::create(path.as_ref())?;
        file.write_all(&header)?;
        file.write_all(&vec![0; 8 * count])?;
        Ok(Self {
            file,
            order,
            first_row: windows[0].min[1],
            table,
            position: table + 8 * count as u64,
            offsets: Vec::with_capacity(count),
            pending: Vec::new(),
            rows: 0,
            description,
        })
    }

    /// Writes the next rows: for each channel, in the caller's order, its samples row by row.
    ///
    /// # Errors
    ///
    /// [`WriteExrError`] if the band does not fit or the disk is full.
    pub fn write_band(&mut self, channels: &[&[f32]]) -> Result<(), WriteExrError> {
        let rows = self.check_band(channels)?;
        if self.description.sample == Sample::Half {
            self.check_half(channels)?;
        }
        let row_bytes = self.row_bytes();
        let start = self.pending.len();
        self.pending.resize(start + rows * row_bytes, 0);
        let (order, sample) = (&self.order, self.description.sample);
        let width = self.description.size[0];
        self.pending[start..].par_chunks_mut(row_bytes.max(1)).enumerate().for_each(
            |(row, bytes)| {
                let parts = bytes.chunks_exact_mut(width * sample.bytes());
                for (part, &channel) in parts.zip(order) {
                    encode(sample, &channels[channel][row * width..(row + 1) * width], part);
                }
            },
        );
        self.rows += rows;
        self.write_blocks()
    }

    /// Gives the file its name; returns its size in bytes.
    ///
    /// # Errors
    ///
    /// [`WriteExrError`] if rows are missing or the disk is full; then there is no file.
    pub fn finish(mut self) -> Result<u64, WriteExrError> {
        let expected = self.description.size[1];
        if self.rows != expected {
            return Err(WriteExrError::Rows { found: self.rows, expected });
        }
        self.file.seek(SeekFrom::Start(self.table))?;
        let table: Vec<u8> = self.offsets.iter().flat_map(|at| at.to_le_bytes()).collect();
        self.file.write_all(&table)?;
        Ok(self.file.commit()?)
    }

    fn row_bytes(&self) -> usize {
        self.description.size[0] * self.order.len() * self.description.sample.bytes()
    }

    /// The number of rows of a band that fits.
    fn check_band(&self, channels: &[&[f32]]) -> Result<usize, WriteExrError> {
        let [width, height] = self.description.size;
        let (found, expected) = (channels.len(), self.order.len());
        if found != expected {
            return Err(WriteExrError::Channels { found, expected });
        }
        let rows = channels.first().map_or(0, |c| c.len() / width);
        let names = self.description.channels.iter();
        if let Some((name, plane)) = names.zip(channels).find(|(_, c)| c.len() != rows * width) {
            let (channel, found, expected) = (name.clone(), plane.len(), rows * width);
            return Err(WriteExrError::Samples { channel, found, expected });
        }
        if self.rows + rows > height {
            return Err(WriteExrError::Rows { found: self.rows + rows, expected: height });
        }
        Ok(rows)
    }

    fn check_half(&self, channels: &[&[f32]]) -> Result<(), WriteExrError> {
        let beyond = |v: &f32| v.is_finite() && v.abs() >= HALF_OVERFLOW;
        let found = channels.par_iter().position_first(|plane| plane.iter().any(beyond));
        let Some(channel) = found else { return Ok(()) };
        let value = channels[channel].iter().copied().find(|v| beyond(v)).unwrap_or(f32::NAN);
        Err(WriteExrError::BeyondHalf {
            channel: self.description.channels[channel].clone(),
            value,
        })
    }

    /// Packs and writes the whole blocks among the pending rows, and the last one at the end.
    fn write_blocks(&mut self) -> Result<(), WriteExrError> {
        let block_rows = self.description.compression.packing().rows();
        let block_bytes = (block_rows * self.row_bytes()).max(1);
        let ready = if self.rows == self.description.size[1] {
            self.pending.len()
        } else {
            self.pending.len() / block_bytes * block_bytes
        };
        let compression = self.description.compression;
        let packed: Vec<Vec<u8>> = self.pending[..ready]
            .par_chunks(block_bytes)
            .map(|block| pack(compression, block))
            .collect();
        for bytes in packed {
            let row = self.offsets.len() * block_rows;
            let row = self.first_row.saturating_add(i32::try_from(row).unwrap_or(i32::MAX));
            let size = u32::try_from(bytes.len()).map_err(io::Error::other)?;
            self.file.write_all(&row.to_le_bytes())?;
            self.file.write_all(&size.to_le_bytes())?;
            self.file.write_all(&bytes)?;
            self.offsets.push(self.position);
            self.position += 8 + bytes.len() as u64;
        }
        self.pending.drain(..ready);
        Ok(())
    }
}

/// The least number that rounds to infinity in half precision: 65504 and half a step.
const HALF_OVERFLOW: f32 = 65520.0;

/// Data and display window of a description that makes a file.
fn check(description: &ExrDescription) -> Result<[Window; 2], WriteExrError> {
    let found = description.size;
    if found.iter().any(|side| !(1..=MAX_SIDE).contains(side)) {
        return Err(WriteExrError::Size { found });
    }
    if description.sample == Sample::Uint {
        return Err(WriteExrError::Sample);
    }
    let mut names = description.channels.iter().chain(description.attributes.keys());
    if let Some(found) = names.find(|name| !is_name(name)).cloned() {
        return Err(WriteExrError::Name { found });
    }
    if let Some(found) = description.attributes.keys().find(|name| is_reserved(name)) {
        return Err(WriteExrError::Reserved { found: found.clone() });
    }
    let windows = description.windows.unwrap_or([Window::of_size(found); 2]);
    debug_assert_eq!(windows[0].size(), Some(found), "a data window of another size");
    Ok(windows)
}

/// The numbers of the names in alphabetical order, by bytes.
fn sorted(names: &[String]) -> Result<Vec<usize>, WriteExrError> {
    let mut order: Vec<usize> = (0..names.len()).collect();
    order.sort_by_key(|&i| names[i].as_bytes());
    match order.windows(2).find(|pair| names[pair[0]] == names[pair[1]]) {
        Some(pair) => Err(WriteExrError::Twice { found: names[pair[0]].clone() }),
        None => Ok(order),
    }
}

fn encode(sample: Sample, values: &[f32], to: &mut [u8]) {
    fn fill<const N: usize>(to: &mut [u8], values: &[f32], bytes: impl Fn(f32) -> [u8; N]) {
        to.as_chunks_mut().0.iter_mut().zip(values).for_each(|(to, v)| *to = bytes(*v));
    }
    match sample {
        Sample::Half => fill(to, values, |v| f16::from_f32(v).to_le_bytes()),
        Sample::Float | Sample::Uint => fill(to, values, f32::to_le_bytes),
    }
}

/// Level 1 packs a material map four times as fast as level 4, to 1.05 times the size.
const DEFLATE_LEVEL: u8 = 1;

/// A block as the file holds it: packed, or as it is where packing does not shorten it.
fn pack(compression: Compression, block: &[u8]) -> Vec<u8> {
    if compression == Compression::None {
        return block.to_vec();
    }
    let packed = miniz_oxide::deflate::compress_to_vec_zlib(&differences(block), DEFLATE_LEVEL);
    if packed.len() < block.len() { packed } else { block.to_vec() }
}

/// Even bytes, then odd bytes, each as the difference from the byte before, plus 128.
///
/// # Source
///
/// `openexr`, the predictor of ZIP compression.
fn differences(block: &[u8]) -> Vec<u8> {
    let even = block.iter().step_by(2);
    let odd = block.iter().skip(1).step_by(2);
    let mut before = None;
    even.chain(odd)
        .map(|&byte| {
            let difference = before.map_or(byte, |b: u8| byte.wrapping_sub(b).wrapping_add(128));
            before = Some(byte);
            difference
        })
        .collect()
}
