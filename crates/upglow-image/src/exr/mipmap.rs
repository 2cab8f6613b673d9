//! OpenEXR images in tiles, at all levels.

use std::path::Path;

use upglow::Aside;

use super::header::Arrangement;
use super::writer::{BlockFile, ExrDescription, WriteExrError, check_half, pack};

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
    file: BlockFile,
    /// Columns of tiles of each level, and the number of tiles before it.
    levels: Vec<(usize, usize)>,
}

impl MipmapWriter {
    /// Starts a file that will be named `path`.
    ///
    /// # Errors
    ///
    /// [`WriteExrError`] if the description is invalid or the path cannot be written.
    pub(crate) fn create(path: &Path, description: ExrDescription) -> Result<Self, WriteExrError> {
        let side = u32::try_from(TILE).unwrap_or(u32::MAX);
        let mut levels = Vec::new();
        let (file, _) =
            BlockFile::create(path, description, Arrangement::Mipmap { side }, |described| {
                let mut all = 0;
                for size in level_sizes(described.size) {
                    let [across, down] = tile_counts(size);
                    levels.push((across, all));
                    all += across * down;
                }
                all
            })?;
        Ok(Self { file, levels })
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
        check_half(&self.file.description, &planes)?;
        let rows = planes[0].len() / width;
        let row_bytes = self.file.row_bytes(width);
        let mut bytes = vec![0; rows * row_bytes];
        for (row, bytes) in bytes.chunks_exact_mut(row_bytes).enumerate() {
            self.file.encode_row(&planes, width, row, bytes);
        }
        Ok(pack(self.file.description.compression, &bytes))
    }

    /// Writes a tile that [`MipmapWriter::packed`] made.
    ///
    /// # Errors
    ///
    /// [`WriteExrError`] if the disk is full.
    pub(crate) fn write(&mut self, tile: Tile, packed: &[u8]) -> Result<(), WriteExrError> {
        let number = |n: usize| i32::try_from(n).unwrap_or(i32::MAX);
        let Tile { level, at: [x, y] } = tile;
        let (across, before) = self.levels[level];
        self.file.write(before + y * across + x, &[x, y, level, level].map(number), packed)
    }

    /// Completes the file but for its name.
    ///
    /// # Errors
    ///
    /// [`WriteExrError`] if the disk is full; no file is left then.
    pub(crate) fn into_file(self) -> Result<Aside, WriteExrError> {
        self.file.into_file()
    }
}
