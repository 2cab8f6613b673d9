//! OpenEXR images in tiles, at all levels.

use std::io::{Seek, SeekFrom, Write};
use std::path::Path;

use upglow::Aside;

use super::header::Arrangement;
use super::writer::{ExrDescription, WriteExrError, begin, check_half, encode, pack};

/// Side of a tile, pixels, as texture systems expect it.
pub(crate) const TILE: usize = 64;

/// The sizes of all levels, from the full one to one pixel: half the sides, rounded down.
pub(crate) fn level_sizes(size: [usize; 2]) -> Vec<[usize; 2]> {
    let mut sizes = vec![size];
    while let Some(&last) = sizes.last()
        && last != [1, 1]
    {
        sizes.push(last.map(|side| (side / 2).max(1)));
    }
    sizes
}

/// Columns and rows of tiles of an image.
pub(crate) fn tile_counts(size: [usize; 2]) -> [usize; 2] {
    size.map(|side| side.div_ceil(TILE))
}

/// A tile of a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Tile {
    pub(crate) level: usize,
    /// Column and row of the tile.
    pub(crate) at: [usize; 2],
}

/// An OpenEXR file of all levels that is being written tile by tile. It appears under its name when
/// [`MipmapWriter::finish`] returns.
#[derive(Debug)]
pub(crate) struct MipmapWriter {
    file: Aside,
    description: ExrDescription,
    /// Indices of the caller's channels in the order of the file.
    order: Vec<usize>,
    /// Position of the table of tiles, bytes.
    table: u64,
    /// Position of the next tile, bytes.
    position: u64,
    /// Columns of tiles of each level, and the number of tiles before it.
    levels: Vec<(usize, usize)>,
    /// Positions of the tiles, level by level and row by row; 0 for those not written.
    offsets: Vec<u64>,
}

impl MipmapWriter {
    /// Starts a file that will be named `path`.
    ///
    /// # Errors
    ///
    /// [`WriteExrError`] if the description is invalid or the path cannot be written.
    pub(crate) fn create(path: &Path, description: ExrDescription) -> Result<Self, WriteExrError> {
        let side = u32::try_from(TILE).unwrap_or(u32::MAX);
        let (order, _, header) = begin(&description, Arrangement::Mipmap { side })?;
        let mut all = 0;
        let mut levels = Vec::new();
        for size in level_sizes(description.size) {
            let [across, down] = tile_counts(size);
            levels.push((across, all));
            all += across * down;
        }
        let table = header.len() as u64;
        let mut file = Aside::create(path)?;
        file.write_all(&header)?;
        file.write_all(&vec![0; 8 * all])?;
        let position = table + 8 * all as u64;
        Ok(Self { file, description, order, table, position, levels, offsets: vec![0; all] })
    }

    /// The compressed bytes of a tile of this width: for each channel, in the caller's order, its
    /// samples row by row.
    ///
    /// # Errors
    ///
    /// [`WriteExrError`] if a sample is too great for half precision.
    pub(crate) fn packed(
        &self,
        width: usize,
        planes: &[Vec<f32>],
    ) -> Result<Vec<u8>, WriteExrError> {
        let planes: Vec<&[f32]> = planes.iter().map(Vec::as_slice).collect();
        check_half(&self.description, &planes)?;
        let (sample, rows) = (self.description.sample, planes[0].len() / width);
        let mut bytes = vec![0; rows * width * planes.len() * sample.bytes()];
        let mut parts = bytes.chunks_exact_mut(width * sample.bytes());
        for row in 0..rows {
            for (&channel, part) in self.order.iter().zip(&mut parts) {
                encode(sample, &planes[channel][row * width..(row + 1) * width], part);
            }
        }
        Ok(pack(self.description.compression, &bytes))
    }

    /// Writes a tile that [`MipmapWriter::packed`] made.
    ///
    /// # Errors
    ///
    /// [`WriteExrError`] if the disk is full.
    pub(crate) fn write(&mut self, tile: Tile, packed: &[u8]) -> Result<(), WriteExrError> {
        let number = |n: usize| i32::try_from(n).unwrap_or(i32::MAX);
        let Tile { level, at: [x, y] } = tile;
        let head = [x, y, level, level, packed.len()].map(|n| number(n).to_le_bytes());
        self.file.write_all(head.as_flattened())?;
        self.file.write_all(packed)?;
        let (across, before) = self.levels[level];
        self.offsets[before + y * across + x] = self.position;
        self.position += (head.as_flattened().len() + packed.len()) as u64;
        Ok(())
    }

    /// Completes the file and gives it its name. Returns its size in bytes.
    ///
    /// # Errors
    ///
    /// [`WriteExrError`] if the disk is full; no file is left then.
    pub(crate) fn finish(mut self) -> Result<u64, WriteExrError> {
        debug_assert!(self.offsets.iter().all(|&at| at > 0), "a tile is missing");
        self.file.seek(SeekFrom::Start(self.table))?;
        let table: Vec<u8> = self.offsets.iter().flat_map(|at| at.to_le_bytes()).collect();
        self.file.write_all(&table)?;
        Ok(self.file.commit()?)
    }
}
