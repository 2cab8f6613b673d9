//! The blocks of an OpenEXR image: their positions and their decompression.

use std::cell::Cell;

use exr::math::{RoundingMode, Vec2};
use exr::meta::BlockDescription;
use exr::meta::attribute::{
    ChannelDescription, Compression, IntegerBounds, LevelMode, LineOrder, SampleType, Text,
    TileDescription,
};
use exr::meta::header::Header as UnpackHeader;
use half::slice::HalfFloatSliceExt;

use super::header::{Channel, Header, Sample};

thread_local! {
    /// Whether this thread is decompressing a block.
    pub(super) static UNPACKING: Cell<bool> = const { Cell::new(false) };
}

/// Most bytes of a decompressed block: 256 rows of 16,384 pixels in 64 float channels.
pub(crate) const MAX_BLOCK_BYTES: u64 = 1 << 30;

/// A rectangle of the image, at full resolution, that is compressed as one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Block {
    /// Its index in the table of blocks.
    pub(crate) index: usize,
    /// First column and row, from 0.
    pub(crate) origin: [usize; 2],
    /// Columns and rows.
    pub(crate) size: [usize; 2],
}

/// How an image is divided into blocks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blocks {
    image: [usize; 2],
    block: [usize; 2],
}

impl Blocks {
    pub(crate) fn of(header: &Header) -> Self {
        let rows = [header.size[0], header.method.scan_lines_per_block()];
        Self { image: header.size, block: header.tiles.unwrap_or(rows) }
    }

    /// Columns and rows of the largest block.
    pub(crate) fn block_size(self) -> [usize; 2] {
        [0, 1].map(|k| self.block[k].min(self.image[k]))
    }

    /// Columns and rows of blocks.
    pub(crate) fn counts(self) -> [usize; 2] {
        [0, 1].map(|k| self.image[k].div_ceil(self.block[k]))
    }

    /// The blocks that touch these columns and rows, row by row; the ranges are not empty.
    pub(crate) fn touching(
        self,
        [columns, rows]: [std::ops::Range<usize>; 2],
    ) -> impl Iterator<Item = Block> {
        let [across, _] = self.counts();
        let range = |k: usize, r: std::ops::Range<usize>| {
            r.start / self.block[k]..r.end.div_ceil(self.block[k])
        };
        let (left_to_right, down) = (range(0, columns), range(1, rows));
        down.flat_map(move |y| left_to_right.clone().map(move |x| self.at([x, y], across)))
    }

    fn at(self, position: [usize; 2], across: usize) -> Block {
        let origin = [0, 1].map(|k| position[k] * self.block[k]);
        let size = [0, 1].map(|k| self.block[k].min(self.image[k] - origin[k]));
        Block { index: position[1] * across + position[0], origin, size }
    }
}

/// Bytes of one pixel in all channels.
pub(crate) fn pixel_bytes(header: &Header) -> usize {
    header.channels.iter().map(|c| c.sample.bytes()).sum()
}

/// Decompresses blocks of one image.
#[derive(Debug)]
pub(crate) struct Unpacker {
    header: UnpackHeader,
}

impl Unpacker {
    pub(crate) fn new(header: &Header) -> Self {
        let channel = |c: &Channel| ChannelDescription {
            // DWA chooses the compression of a channel by its name.
            name: Text::new_or_none(&c.name).unwrap_or_default(),
            sample_type: match c.sample {
                Sample::Half => SampleType::F16,
                Sample::Float => SampleType::F32,
                Sample::Uint => SampleType::U32,
            },
            quantize_linearly: c.is_linear,
            sampling: Vec2(1, 1),
        };
        let size = Vec2(header.size[0], header.size[1]);
        let channels = header.channels.iter().map(channel).collect();
        let blocks = header.tiles.map_or(BlockDescription::ScanLines, |[width, height]| {
            BlockDescription::Tiles(TileDescription {
                tile_size: Vec2(width, height),
                level_mode: LevelMode::Singular,
                rounding_mode: RoundingMode::Down,
            })
        });
        let header = UnpackHeader::new("part".into(), size, channels).with_encoding(
            header.method,
            blocks,
            LineOrder::Increasing,
        );
        Self { header }
    }

    /// The samples of a block: rows, in each row the channels, in each channel the columns.
    ///
    /// The reason of a failure is said here: the texts of the crate are made for those who know its code.
    pub(crate) fn unpack(&self, packed: Vec<u8>, block: Block) -> Result<Vec<u8>, String> {
        let section = IntegerBounds::new((0, 0), (block.size[0], block.size[1]));
        let method = self.header.compression;
        let whole = block.size[0] * block.size[1] * self.header.channels.bytes_per_pixel;
        if matches!(method, Compression::DWAA(_) | Compression::DWAB(_)) && packed.len() != whole {
            check_dwa(&packed, whole)?;
        }
        // On damaged data the crate's B44 panics (1.74.2 subtracts with overflow), and its PIZ and DWA
        // use numbers of the file as indices. A file must not end the program, so panics are caught.
        UNPACKING.set(true);
        let unpacked = std::panic::catch_unwind(|| {
            method.decompress_image_section_from_le(&self.header, packed, section, false)
        });
        UNPACKING.set(false);
        match unpacked {
            Ok(Ok(bytes)) => Ok(bytes),
            Ok(Err(_)) | Err(_) => Err("it cannot be decompressed".into()),
        }
    }
}

/// Refuses impossible sizes in the header of a DWA block: the crate allocates what is stated there,
/// and a failed allocation ends the program.
fn check_dwa(packed: &[u8], whole: usize) -> Result<(), String> {
    /// Version, seven sizes in bytes, two counts of 16-bit numbers, and a choice.
    const COUNTERS: usize = 11;
    /// Pixels are padded to squares of 8 by 8, and run-length encoding may lengthen data.
    const PADDED: u64 = 64;
    /// Allowance for the padding of the smallest blocks.
    const LEAST: u64 = 1 << 16;
    let most = whole as u64 * PADDED + LEAST;
    let most = most.min(2 * MAX_BLOCK_BYTES);
    let counters = packed.as_chunks().0.iter().take(COUNTERS).map(|b| u64::from_le_bytes(*b));
    match counters.into_iter().find(|&found| found > most) {
        Some(found) => Err(format!("a section of {found} bytes for a block of {whole}")),
        None => Ok(()),
    }
}

/// Converts the samples in `bytes` to single precision.
pub(crate) fn decode(sample: Sample, bytes: &[u8], to: &mut [f32]) {
    fn fill<const N: usize>(to: &mut [f32], bytes: &[u8], value: impl Fn([u8; N]) -> f32) {
        to.iter_mut().zip(bytes.as_chunks().0).for_each(|(to, b)| *to = value(*b));
    }
    match sample {
        Sample::Half => {
            let halves: Vec<half::f16> =
                bytes.as_chunks().0.iter().map(|b| half::f16::from_le_bytes(*b)).collect();
            halves.convert_to_f32_slice(to);
        }
        Sample::Float => fill(to, bytes, f32::from_le_bytes),
        Sample::Uint => fill(to, bytes, |b| u32::from_le_bytes(b) as f32),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_tile_the_image_without_gap_or_overlap() {
        for (image, block) in [([37, 21], [16, 8]), ([5, 40], [5, 16]), ([64, 64], [64, 64])] {
            let blocks = Blocks { image, block };
            let mut covered = vec![0; image[0] * image[1]];
            for (n, block) in blocks.touching([0..image[0], 0..image[1]]).enumerate() {
                assert_eq!(block.index, n);
                for y in block.origin[1]..block.origin[1] + block.size[1] {
                    for x in block.origin[0]..block.origin[0] + block.size[0] {
                        covered[y * image[0] + x] += 1;
                    }
                }
            }
            assert!(covered.iter().all(|&n| n == 1));
            assert_eq!(blocks.touching([3..4, 20..21]).count(), 1);
        }
    }
}
