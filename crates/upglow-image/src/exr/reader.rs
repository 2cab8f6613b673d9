//! OpenEXR images, read by regions.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::ops::Range;
use std::path::Path;

use rayon::prelude::*;
use upglow::open_input;

use super::attribute::Attributes;
use super::blocks::{Block, Blocks, MAX_BLOCK_BYTES, UNPACKING, Unpacker, decode, pixel_bytes};
use super::error::{ExrError, listed};
use super::header::{Channel, Header, Headers, Sample, Window, method_name};
use super::mipmap::level_sizes;

/// One image of an OpenEXR file, opened for reading.
///
/// Reads flat images stored in rows or tiles, with every compression but HTJ2K and with half, float and
/// unsigned channels; if there are several levels, the one of full resolution. Reading a region takes
/// the memory of its blocks, compressed and decompressed, and of the requested samples; a block is at
/// most 1 GiB, and as much is kept of blocks of which only the first rows were read.
#[derive(Debug)]
pub struct ExrReader {
    file: BufReader<File>,
    length: u64,
    header: Header,
    unpacker: Unpacker,
    blocks: Blocks,
    /// Position of the table of blocks, bytes.
    table: u64,
    /// Decompressed blocks, by index, of which further rows follow those that were read last.
    kept: BTreeMap<usize, (Block, Vec<u8>)>,
    /// Number of the part, which each block of a multi-part file repeats.
    part: Option<i32>,
    /// Number of the level, which each tile repeats.
    level: i32,
}

impl ExrReader {
    /// Opens the first part of a file.
    ///
    /// # Errors
    ///
    /// [`ExrError`] if it cannot be read or is not a valid OpenEXR file of a kind that is read.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, ExrError> {
        Self::open_with(path.as_ref(), |_| Ok(0))
    }

    /// Opens a level of the first part of a file: 0 is the full one, the last one has one pixel.
    ///
    /// # Errors
    ///
    /// [`ExrError`] if it cannot be read or has no such level.
    pub fn open_level(path: impl AsRef<Path>, level: usize) -> Result<Self, ExrError> {
        let mut reader = Self::open(path)?;
        if level == 0 {
            return Ok(reader);
        }
        let has_levels = reader.header.is_mipmap && reader.part.is_none();
        let sizes = if has_levels { level_sizes(reader.size()) } else { vec![reader.size()] };
        let Some(&size) = sizes.get(level) else {
            let expected = format!("0 to {}", sizes.len() - 1);
            return Err(ExrError::invalid(format!("level {level}"), expected));
        };
        // Tiles do not shrink with the image, except at its border.
        let tiles = |size| Blocks::of(&Header { size, ..reader.header.clone() });
        let before: usize =
            sizes[..level].iter().map(|&size| tiles(size).counts()).map(|[x, y]| x * y).sum();
        reader.table += 8 * before as u64;
        reader.blocks = tiles(size);
        reader.header.size = size;
        reader.level = i32::try_from(level).unwrap_or(i32::MAX);
        Ok(reader)
    }

    /// Whether this thread is decompressing a block. A panic there is caught and becomes an error of
    /// the file, so a program's panic hook should not report it.
    pub fn is_unpacking() -> bool {
        UNPACKING.get()
    }

    /// Opens the part that `choose` picks by number.
    pub(crate) fn open_with<E: From<ExrError>>(
        path: &Path,
        choose: impl FnOnce(&[Header]) -> Result<usize, E>,
    ) -> Result<Self, E> {
        let file = open_input(path).map_err(ExrError::Io)?;
        let length = file.metadata().map_err(ExrError::Io)?.len();
        let mut file = BufReader::new(file);
        let headers = Headers::read(&mut file)?;
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
            let expected = format!("at most {MAX_BLOCK_BYTES}");
            return Err(ExrError::invalid(format!("a block of {block_bytes} bytes"), expected));
        }
        let table = end + counts[..index].iter().sum::<u64>() * 8;
        let part = multi_part.then(|| i32::try_from(index).unwrap_or(i32::MAX));
        Ok(Self {
            file,
            length,
            unpacker: Unpacker::new(&header),
            header,
            blocks,
            table,
            kept: BTreeMap::new(),
            part,
            level: 0,
        })
    }

    /// Width and height of the data window, pixels; 1 or more.
    pub fn size(&self) -> [usize; 2] {
        self.header.size
    }

    /// Names of the channels, in the order of the file: sorted.
    pub fn channel_names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.channels().iter().map(|channel| channel.name.as_str())
    }

    /// The channels, in the order of the file: by name.
    pub(crate) fn channels(&self) -> &[Channel] {
        &self.header.channels
    }

    /// The attributes, without those that the format itself defines.
    pub(crate) fn attributes(&self) -> &Attributes {
        &self.header.attributes
    }

    /// The data window and the display window.
    pub(crate) fn windows(&self) -> [Window; 2] {
        [self.header.data, self.header.display]
    }

    /// Rows of a block.
    pub fn block_rows(&self) -> usize {
        self.blocks.block_size()[1]
    }

    /// Bytes of all blocks beside each other, decompressed.
    pub(crate) fn block_row_bytes(&self) -> u64 {
        let [width, _] = self.size();
        width as u64 * self.block_rows() as u64 * pixel_bytes(&self.header) as u64
    }

    /// The index of the channel of this name.
    ///
    /// # Errors
    ///
    /// [`ExrError::NoChannel`] lists some of the names that exist.
    pub fn channel(&self, name: &str) -> Result<usize, ExrError> {
        let position = self.channel_names().position(|found| found == name);
        position.ok_or_else(|| ExrError::NoChannel {
            name: name.into(),
            expected: listed(self.channel_names()),
        })
    }

    /// All columns of some rows: for each requested channel, its samples row by row.
    ///
    /// # Errors
    ///
    /// [`ExrError`] if the image does not have these rows or a block is damaged.
    pub fn read_rows(
        &mut self,
        rows: Range<usize>,
        channels: &[usize],
    ) -> Result<Vec<Vec<f32>>, ExrError> {
        self.read_region(0..self.header.size[0], rows, channels)
    }

    /// Some columns of some rows: for each requested channel, its samples row by row.
    ///
    /// Rows and columns count from the first of the data window. Only the blocks that the region
    /// touches are read; they are decompressed on all cores. Those of which only the first rows are read
    /// are kept for a next call that continues there.
    ///
    /// # Errors
    ///
    /// [`ExrError`] if the image does not have these pixels or a block is damaged.
    pub fn read_region(
        &mut self,
        columns: Range<usize>,
        rows: Range<usize>,
        channels: &[usize],
    ) -> Result<Vec<Vec<f32>>, ExrError> {
        let size = self.header.size;
        if columns.is_empty() || rows.is_empty() || columns.end > size[0] || rows.end > size[1] {
            let (columns, rows) = ([columns.start, columns.end], [rows.start, rows.end]);
            return Err(ExrError::Outside { columns, rows, size });
        }
        let places = self.places(channels)?;
        let (region, pixel) = (Region { columns, rows }, pixel_bytes(&self.header));
        let mut planes = vec![vec![0.0; region.columns.len() * region.rows.len()]; channels.len()];
        let is_cut = |block: &Block| block.origin[1] + block.size[1] > region.rows.end;
        let mut copy = |block: Block, bytes: &[u8]| {
            for (plane, place) in planes.iter_mut().zip(&places) {
                region.copy((block, bytes), pixel, *place, plane);
            }
        };
        let mut kept = std::mem::take(&mut self.kept);
        kept.retain(|_, (block, _)| region.touches(block));
        kept.values().for_each(|(block, bytes)| copy(*block, bytes));
        let groups = self.block_groups(&region, &kept);
        kept.retain(|_, (block, _)| is_cut(block));
        let mut kept_bytes: usize = kept.values().map(|(_, bytes)| bytes.len()).sum();
        for group in groups {
            let packed = group
                .into_iter()
                .map(|block| Ok((block, self.packed(block)?)))
                .collect::<Result<Vec<_>, ExrError>>()?;
            let unpacked = packed
                .into_par_iter()
                .map(|(block, bytes)| Ok((block, self.unpack(block, bytes)?)))
                .collect::<Result<Vec<_>, ExrError>>()?;
            for (block, bytes) in unpacked {
                copy(block, &bytes);
                if is_cut(&block) && (kept_bytes + bytes.len()) as u64 <= MAX_BLOCK_BYTES {
                    kept_bytes += bytes.len();
                    kept.insert(block.index, (block, bytes));
                }
            }
        }
        self.kept = kept;
        Ok(planes)
    }

    /// The blocks of a region that are not known, in groups that fit in memory together.
    fn block_groups(
        &self,
        region: &Region,
        known: &BTreeMap<usize, (Block, Vec<u8>)>,
    ) -> Vec<Vec<Block>> {
        let touching = self.blocks.touching([region.columns.clone(), region.rows.clone()]);
        let blocks: Vec<Block> = touching.filter(|b| !known.contains_key(&b.index)).collect();
        let [columns, rows] = self.blocks.block_size();
        let bytes = (columns * rows * pixel_bytes(&self.header)).max(1);
        blocks.chunks((GROUP_BYTES / bytes).max(1)).map(<[Block]>::to_vec).collect()
    }

    /// Columns and rows of rectangles that cover the image, block by block, and are cheap to read one after the
    /// other: of each, the blocks and the samples of this many channels take some 64 MiB, or are a row of one block.
    pub(crate) fn pieces(&self, channels: usize) -> Vec<[Range<usize>; 2]> {
        let [width, height] = self.size();
        let [block_width, block_rows] = self.blocks.block_size();
        let column_bytes = pixel_bytes(&self.header).max(channels * size_of::<f32>()).max(1);
        let across = (GROUP_BYTES / (block_width * block_rows * column_bytes)).max(1) * block_width;
        let down = (GROUP_BYTES / (across.min(width) * column_bytes)).clamp(1, block_rows);
        let steps = |range: Range<usize>, step: usize| {
            let end = range.end;
            range.step_by(step).map(move |from| from..end.min(from + step))
        };
        steps(0..height, block_rows)
            .flat_map(|rows| steps(0..width, across).map(move |columns| (columns, rows.clone())))
            .flat_map(|(columns, rows)| steps(rows, down).map(move |rows| [columns.clone(), rows]))
            .collect()
    }

    /// For each of these channels, the bytes of one pixel in the channels before it, and its type of samples.
    fn places(&self, channels: &[usize]) -> Result<Vec<(usize, Sample)>, ExrError> {
        let each = self.channels().iter().scan(0, |before, channel| {
            let place = (*before, channel.sample);
            *before += channel.sample.bytes();
            Some(place)
        });
        let all: Vec<(usize, Sample)> = each.collect();
        let place = |&channel: &usize| {
            all.get(channel).copied().ok_or_else(|| {
                let expected = format!("0 to {}", all.len().saturating_sub(1));
                ExrError::NoChannel { name: format!("number {channel}"), expected }
            })
        };
        channels.iter().map(place).collect()
    }

    /// The compressed bytes of a block.
    fn packed(&mut self, block: Block) -> Result<Vec<u8>, ExrError> {
        let at = self.offset(block)?;
        let head = self.block_head(block);
        let mut found = vec![0; head.len() + 4];
        self.read_at(at, &mut found, block)?;
        let (position, size) = found.split_at(head.len());
        if position != head {
            let found = format!("it begins with {position:?}");
            return Err(self.damaged(block, found, format!("{head:?}")));
        }
        let size = size.first_chunk().copied().map_or(0, u32::from_le_bytes) as usize;
        let whole = block.size[0] * block.size[1] * pixel_bytes(&self.header);
        if size > whole {
            return Err(self.damaged(block, format!("{size} bytes"), format!("at most {whole}")));
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
            return Err(self.damaged(block, format!("its position is byte {at}"), expected));
        }
        Ok(at)
    }

    /// The first bytes of a block: its part, and its row or its tile and level.
    fn block_head(&self, block: Block) -> Vec<u8> {
        let number = |n: usize| i32::try_from(n).unwrap_or(i32::MAX);
        let [width, height] = self.blocks.block_size();
        let position = match self.header.tiles {
            Some(_) => {
                let [x, y] = [block.origin[0] / width, block.origin[1] / height].map(number);
                vec![x, y, self.level, self.level]
            }
            None => vec![self.header.data.min[1].saturating_add(number(block.origin[1]))],
        };
        self.part.into_iter().chain(position).flat_map(i32::to_le_bytes).collect()
    }

    fn read_at(&mut self, at: u64, to: &mut [u8], block: Block) -> Result<(), ExrError> {
        // A relative seek keeps the buffer, which holds the table's next entries.
        let here = self.file.stream_position()?;
        self.file.seek_relative(at.wrapping_sub(here).cast_signed())?;
        let read = self.file.read_exact(to);
        read.map_err(|error| ExrError::read(error, &format!("block {}", block.index)))
    }

    fn unpack(&self, block: Block, packed: Vec<u8>) -> Result<Vec<u8>, ExrError> {
        let expected = || format!("{} data of its size", method_name(self.header.method));
        let unpacked = self.unpacker.unpack(packed, block);
        unpacked.map_err(|found| self.damaged(block, found, expected()))
    }

    fn damaged(&self, block: Block, found: String, expected: String) -> ExrError {
        let [across, down] = self.blocks.counts();
        let (index, count) = (block.index, across * down);
        ExrError::invalid(format!("block {index} of {count} is damaged: {found}"), expected)
    }
}

/// Entries of a part's table of blocks.
fn table_length(part: &Header, multi_part: bool) -> Result<u64, ExrError> {
    let [across, down] = Blocks::of(part).counts();
    let blocks = across * down;
    match part.chunk_count {
        Some(count) if count < blocks => {
            Err(ExrError::header("chunkCount", count, format!("at least {blocks}")))
        }
        None if multi_part => Err(ExrError::header("chunkCount", "absent", "int")),
        count => Ok(count.unwrap_or(blocks) as u64),
    }
}

#[derive(Clone, Debug)]
struct Region {
    columns: Range<usize>,
    rows: Range<usize>,
}

/// Decompressed bytes of one group of blocks: enough work for many cores, little memory.
const GROUP_BYTES: usize = 64 << 20;

impl Region {
    fn touches(&self, block: &Block) -> bool {
        let meets = |k: usize, range: &Range<usize>| {
            range.start < block.origin[k] + block.size[k] && block.origin[k] < range.end
        };
        meets(0, &self.columns) && meets(1, &self.rows)
    }

    /// Copies the samples of one channel that lie in both the block and this region. `pixel` and
    /// `before` are the bytes of one pixel in all channels and in those before the channel.
    fn copy(
        &self,
        (block, bytes): (Block, &[u8]),
        pixel: usize,
        (before, sample): (usize, Sample),
        plane: &mut [f32],
    ) {
        let overlap = |k: usize, range: &Range<usize>| {
            let end = block.origin[k] + block.size[k];
            range.start.max(block.origin[k])..range.end.min(end)
        };
        let (columns, rows) = (overlap(0, &self.columns), overlap(1, &self.rows));
        let width = block.size[0];
        for y in rows {
            let row = (y - block.origin[1]) * width * pixel + before * width;
            let from = row + (columns.start - block.origin[0]) * sample.bytes();
            let row = (y - self.rows.start) * self.columns.len();
            let to = &mut plane[row + columns.start - self.columns.start..][..columns.len()];
            decode(sample, &bytes[from..from + columns.len() * sample.bytes()], to);
        }
    }
}
