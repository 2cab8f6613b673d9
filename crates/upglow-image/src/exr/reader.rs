//! OpenEXR images, read by regions.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;

use rayon::prelude::*;

use super::attribute::Attributes;
use super::blocks::{Block, Blocks, MAX_BLOCK_BYTES, UNPACKING, Unpacker, decode, pixel_bytes};
use super::error::ExrError;
use super::header::{Channel, Header, Headers, Sample, Window};

/// One image of an OpenEXR file, opened for reading.
///
/// Flat images stored by rows or tiles, every compression but HTJ2K, half, float and unsigned
/// channels; of several levels the full one. Reading a region takes the memory of its
/// blocks, packed and unpacked, and of the samples asked for; a block is at most 1 GiB.
#[derive(Debug)]
pub struct ExrReader {
    file: BufReader<File>,
    length: u64,
    header: Header,
    unpacker: Unpacker,
    blocks: Blocks,
    /// Where the table of blocks begins.
    table: u64,
    /// Number of the part, which each block repeats where there are several.
    part: Option<i32>,
}

impl ExrReader {
    /// Opens the only or first part of a file.
    ///
    /// # Errors
    ///
    /// [`ExrError`] says what was found and what was expected.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, ExrError> {
        Self::open_with(path.as_ref(), |_| Ok(0))
    }

    /// Whether this thread unpacks a block just now: a panic in there becomes an error that says what
    /// is wrong with the file, so a program's panic hook need not speak of it.
    pub fn is_unpacking() -> bool {
        UNPACKING.get()
    }

    /// Opens the part that `choose` picks by number.
    pub(crate) fn open_with<E: From<ExrError>>(
        path: &Path,
        choose: impl FnOnce(&[Header]) -> Result<usize, E>,
    ) -> Result<Self, E> {
        let (file, length, headers) = open_headers(path)?;
        let index = choose(&headers.parts)?;
        Ok(Self::of_part(file, length, headers, index)?)
    }

    fn of_part(
        file: BufReader<File>,
        length: u64,
        headers: Headers,
        index: usize,
    ) -> Result<Self, ExrError> {
        let Headers { mut parts, multi_part, end } = headers;
        let counts = parts.iter().map(|part| table_length(part, multi_part));
        let counts = counts.collect::<Result<Vec<_>, _>>()?;
        let all: u64 = counts.iter().sum();
        if end.saturating_add(all.saturating_mul(8)) > length {
            return Err(ExrError::truncated(format!("the table of {all} blocks")));
        }
        let header = parts.swap_remove(index);
        let blocks = Blocks::of(&header);
        let [columns, rows] = blocks.block_size().map(|side| side as u64);
        let block_bytes = columns * rows * pixel_bytes(&header) as u64;
        if block_bytes > MAX_BLOCK_BYTES {
            return Err(ExrError::BlockSize { found: block_bytes, expected: MAX_BLOCK_BYTES });
        }
        let table = end + counts[..index].iter().sum::<u64>() * 8;
        let part = multi_part.then(|| i32::try_from(index).unwrap_or(i32::MAX));
        Ok(Self { file, length, unpacker: Unpacker::new(&header), header, blocks, table, part })
    }

    /// Width and height of the data window, pixels; 1 or more.
    pub fn size(&self) -> [usize; 2] {
        self.header.size
    }

    /// Names of the channels, as the file orders them: by name.
    pub fn channel_names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.channels().iter().map(|channel| channel.name.as_str())
    }

    /// The channels, as the file orders them: by name.
    pub(crate) fn channels(&self) -> &[Channel] {
        &self.header.channels
    }

    /// The attributes that are not about how pixels are stored.
    pub(crate) fn attributes(&self) -> &Attributes {
        &self.header.attributes
    }

    /// Where the pixels lie, and the part of the plane that is meant to be seen.
    pub(crate) fn windows(&self) -> [Window; 2] {
        [self.header.data, self.header.display]
    }

    /// Rows that are stored together: reading fewer at once unpacks a block more than once.
    pub fn block_rows(&self) -> usize {
        self.blocks.block_size()[1]
    }

    /// The number of the channel of this name.
    ///
    /// # Errors
    ///
    /// [`ExrError::NoChannel`] names some that there are.
    pub fn channel(&self, name: &str) -> Result<usize, ExrError> {
        let mut names = self.channel_names();
        names.position(|found| found == name).ok_or_else(|| {
            /// A line that a person reads.
            const SHOWN: usize = 8;
            let more = if self.channels().len() > SHOWN { ", …" } else { "" };
            let some = self.channel_names().take(SHOWN).collect::<Vec<_>>().join(", ");
            ExrError::NoChannel { name: name.into(), expected: some + more }
        })
    }

    /// All columns of some rows: for each channel asked for, its samples row by row.
    ///
    /// # Errors
    ///
    /// [`ExrError`] if the rows are not the image's or a block is damaged.
    pub fn read_rows(
        &mut self,
        rows: Range<usize>,
        channels: &[usize],
    ) -> Result<Vec<Vec<f32>>, ExrError> {
        self.read_region(0..self.header.size[0], rows, channels)
    }

    /// Some columns of some rows: for each channel asked for, its samples row by row.
    ///
    /// Rows and columns count from the first of the data window. Only the blocks that are
    /// touched are read; they are unpacked on all cores.
    ///
    /// # Errors
    ///
    /// [`ExrError`] if the pixels are not the image's or a block is damaged.
    pub fn read_region(
        &mut self,
        columns: Range<usize>,
        rows: Range<usize>,
        channels: &[usize],
    ) -> Result<Vec<Vec<f32>>, ExrError> {
        let [width, height] = self.header.size;
        if columns.is_empty() || rows.is_empty() || columns.end > width || rows.end > height {
            let (columns, rows) = ([columns.start, columns.end], [rows.start, rows.end]);
            return Err(ExrError::Outside { columns, rows, width, height });
        }
        let samples = channels.iter().map(|&c| self.samples(c)).collect::<Result<Vec<_>, _>>()?;
        let region = Region { columns, rows };
        let mut planes = vec![vec![0.0; region.columns.len() * region.rows.len()]; channels.len()];
        for line in self.block_lines(&region) {
            let packed = line
                .into_iter()
                .map(|block| Ok((block, self.packed(block)?)))
                .collect::<Result<Vec<_>, ExrError>>()?;
            let unpacked = packed
                .into_par_iter()
                .map(|(block, bytes)| Ok((block, self.unpack(block, bytes)?)))
                .collect::<Result<Vec<_>, ExrError>>()?;
            for (block, bytes) in unpacked {
                for (plane, samples) in planes.iter_mut().zip(&samples) {
                    region.copy(block, &bytes, samples, plane);
                }
            }
        }
        Ok(planes)
    }

    /// The blocks of a region in groups that fit in memory together.
    fn block_lines(&self, region: &Region) -> Vec<Vec<Block>> {
        /// Unpacked bytes of one group: enough work for many cores, little memory.
        const GROUP_BYTES: usize = 64 << 20;
        let blocks: Vec<Block> =
            self.blocks.touching([region.columns.clone(), region.rows.clone()]).collect();
        let [columns, rows] = self.blocks.block_size();
        let bytes = (columns * rows * pixel_bytes(&self.header)).max(1);
        blocks.chunks((GROUP_BYTES / bytes).max(1)).map(<[Block]>::to_vec).collect()
    }

    /// Where in a pixel's row the samples of a channel lie.
    fn samples(&self, channel: usize) -> Result<ChannelSamples, ExrError> {
        let Some(found) = self.header.channels.get(channel) else {
            let expected = format!("0 to {}", self.header.channels.len().saturating_sub(1));
            return Err(ExrError::NoChannel { name: format!("number {channel}"), expected });
        };
        let before = self.header.channels[..channel].iter().map(|c| c.sample.bytes()).sum();
        Ok(ChannelSamples { before, sample: found.sample, pixel: pixel_bytes(&self.header) })
    }

    /// The packed bytes of a block.
    fn packed(&mut self, block: Block) -> Result<Vec<u8>, ExrError> {
        let at = self.offset(block)?;
        let damaged = |s: &Self, found: String, expected: String| s.damaged(block, found, expected);
        let head = self.block_head(block);
        let mut found = vec![0; head.len() + 4];
        self.read_at(at, &mut found, block)?;
        let (position, size) = found.split_at(head.len());
        if position != head {
            return Err(damaged(self, format!("it is of {position:?}"), format!("{head:?}")));
        }
        let size = size.first_chunk().copied().map_or(0, u32::from_le_bytes) as usize;
        let whole = block.size[0] * block.size[1] * pixel_bytes(&self.header);
        if size > whole {
            return Err(damaged(self, format!("{size} bytes"), format!("at most {whole}")));
        }
        let start = at + found.len() as u64;
        if start + size as u64 > self.length {
            return Err(ExrError::truncated(format!("block {}", block.index)));
        }
        let mut bytes = vec![0; size];
        self.read_at(start, &mut bytes, block)?;
        Ok(bytes)
    }

    fn offset(&mut self, block: Block) -> Result<u64, ExrError> {
        let mut bytes = [0; 8];
        self.read_at(self.table + 8 * block.index as u64, &mut bytes, block)?;
        let at = u64::from_le_bytes(bytes);
        let first = self.table;
        if at <= first || at.saturating_add(8) > self.length {
            let expected = format!("between {first} and {}, the size of the file", self.length);
            return Err(self.damaged(block, format!("it should be at byte {at}"), expected));
        }
        Ok(at)
    }

    /// What a block says first: its part, and its row or its tile and level.
    fn block_head(&self, block: Block) -> Vec<u8> {
        let number = |n: usize| i32::try_from(n).unwrap_or(i32::MAX);
        let [width, height] = self.blocks.block_size();
        let position = match self.header.tiles {
            Some(_) => {
                vec![number(block.origin[0] / width), number(block.origin[1] / height), 0, 0]
            }
            None => vec![self.header.data.min[1].saturating_add(number(block.origin[1]))],
        };
        self.part.into_iter().chain(position).flat_map(i32::to_le_bytes).collect()
    }

    fn read_at(&mut self, at: u64, to: &mut [u8], block: Block) -> Result<(), ExrError> {
        // A relative seek keeps the buffer, which holds the table's next entries.
        let here = self.file.stream_position()?;
        match i64::try_from(at).ok().zip(i64::try_from(here).ok()) {
            Some((at, here)) => self.file.seek_relative(at - here)?,
            None => drop(self.file.seek(SeekFrom::Start(at))?),
        }
        let read = self.file.read_exact(to);
        read.map_err(|error| ExrError::read(error, &format!("block {}", block.index)))
    }

    fn unpack(&self, block: Block, packed: Vec<u8>) -> Result<Vec<u8>, ExrError> {
        self.unpacker.unpack(packed, block).map_err(|found| {
            self.damaged(
                block,
                found,
                format!("{:?} data of its size", self.header.packing.method()),
            )
        })
    }

    fn damaged(&self, block: Block, found: String, expected: String) -> ExrError {
        let [across, down] = self.blocks.counts();
        ExrError::Block { index: block.index, count: across * down, found, expected }
    }
}

fn open_headers(path: &Path) -> Result<(BufReader<File>, u64, Headers), ExrError> {
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    let mut file = BufReader::new(file);
    let headers = Headers::read(&mut file)?;
    Ok((file, length, headers))
}

/// Entries of a part's table of blocks.
fn table_length(part: &Header, multi_part: bool) -> Result<u64, ExrError> {
    let [across, down] = Blocks::of(part).counts();
    match part.chunk_count {
        Some(count) if count >= across * down => Ok(count as u64),
        Some(count) => {
            let expected = format!("at least {}", across * down);
            Err(ExrError::header("chunkCount", count.to_string(), expected))
        }
        None if multi_part => Err(ExrError::header("chunkCount", "absent", "int")),
        None => Ok((across * down) as u64),
    }
}

/// A channel inside the rows of a block.
#[derive(Clone, Copy, Debug)]
struct ChannelSamples {
    /// Bytes of one pixel in the channels before it.
    before: usize,
    sample: Sample,
    /// Bytes of one pixel in all channels.
    pixel: usize,
}

#[derive(Clone, Debug)]
struct Region {
    columns: Range<usize>,
    rows: Range<usize>,
}

impl Region {
    /// Copies what a block has of this region into one channel's samples.
    fn copy(&self, block: Block, bytes: &[u8], of: &ChannelSamples, plane: &mut [f32]) {
        let overlap = |k: usize, range: &Range<usize>| {
            let end = block.origin[k] + block.size[k];
            range.start.max(block.origin[k])..range.end.min(end)
        };
        let (columns, rows) = (overlap(0, &self.columns), overlap(1, &self.rows));
        let (width, sample) = (block.size[0], of.sample.bytes());
        for y in rows {
            let row = (y - block.origin[1]) * width * of.pixel + of.before * width;
            let from = row + (columns.start - block.origin[0]) * sample;
            let to =
                (y - self.rows.start) * self.columns.len() + columns.start - self.columns.start;
            let samples = &bytes[from..from + columns.len() * sample];
            decode(of.sample, samples, &mut plane[to..to + columns.len()]);
        }
    }
}
