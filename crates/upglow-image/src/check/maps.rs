//! The heat map and the thumbnail, gathered while rows pass.

use std::ops::Range;

use rayon::prelude::*;
use upglow_color::rounding::to_single;
use upglow_color::{LinearRgb, StandingKind};
use upglow_fit::Estimate;

use super::display::Display;
use super::findings::Findings;
use super::limits::Limits;
use super::palette::Heat;
use super::raster::Raster;

/// Blocks of a picture, each a pixel of the maps.
#[derive(Debug)]
pub(super) struct Maps {
    width: usize,
    /// Texels along a side of a block.
    side: usize,
    /// Blocks in a row.
    columns: usize,
    /// `[row][column]`.
    blocks: Vec<Block>,
}

/// What is known of a block.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    /// Sums over the texels that are colors, in multiples of [`UNIT`].
    sum: [u64; 3],
    colors: u32,
    worst: Heat,
}

/// Greatest width and height of the maps.
const LONGER_SIDE: usize = 1024;

/// Values are summed in multiples of this: finer than 8 bits of sRGB are at black.
const UNIT: f64 = 1.0 / 1_048_576.0;

/// Blocks side by side that one core works on at a time.
const BLOCKS_TOGETHER: usize = 64;

/// Some blocks of a row, and the part of a band that falls in them.
pub(super) struct Tile<'a> {
    blocks: &'a mut [Block],
    side: usize,
    rows: Range<usize>,
    columns: Range<usize>,
    band: &'a [[f32; 3]],
    first_row: usize,
    width: usize,
}

impl Maps {
    pub(super) fn new([width, height]: [usize; 2]) -> Self {
        let side = width.max(height).div_ceil(LONGER_SIDE);
        let (columns, rows) = (width.div_ceil(side), height.div_ceil(side));
        Self { width, side, columns, blocks: vec![Block::default(); columns * rows] }
    }

    /// The blocks that a band falls in, for many cores.
    pub(super) fn tiles<'a>(
        &'a mut self,
        first_row: usize,
        band: &'a [[f32; 3]],
    ) -> impl ParallelIterator<Item = Tile<'a>> {
        let Self { width, side, columns, .. } = *self;
        let rows = first_row..first_row + band.len() / width;
        let block_rows = rows.start / side..rows.end.div_ceil(side);
        let touched = block_rows.start * columns..block_rows.end * columns;
        self.blocks[touched].par_chunks_mut(columns).enumerate().flat_map(move |(i, row)| {
            let top = (block_rows.start + i) * side;
            let rows = top.max(rows.start)..(top + side).min(rows.end);
            row.par_chunks_mut(BLOCKS_TOGETHER).enumerate().map(move |(j, blocks)| {
                let left = j * BLOCKS_TOGETHER * side;
                let columns = left..(left + blocks.len() * side).min(width);
                Tile { blocks, side, rows: rows.clone(), columns, band, first_row, width }
            })
        })
    }

    pub(super) fn heat(&self, display: &Display) -> Raster {
        self.raster(|block| block.worst.color(display.brightness(block.mean())))
    }

    pub(super) fn thumbnail(&self, display: &Display) -> Raster {
        self.raster(|block| display.srgb_of_rgb(block.mean()))
    }

    fn raster(&self, color: impl Fn(&Block) -> [u8; 3] + Sync + Send) -> Raster {
        Raster::new(self.columns, self.blocks.par_iter().map(color).collect())
    }
}

impl Tile<'_> {
    /// Finds what its texels need.
    pub(super) fn check(self, limits: &Limits) -> Findings {
        let Self { blocks, side, rows, columns, band, first_row, width } = self;
        let mut texel_check = TexelCheck { limits, last: None, findings: Findings::default() };
        for y in rows {
            let row = (y - first_row) * width;
            let texels = &band[row + columns.start..row + columns.end];
            for (i, (part, block)) in texels.chunks(side).zip(blocks.iter_mut()).enumerate() {
                let left = columns.start + i * side;
                for (dx, &rgb) in part.iter().enumerate() {
                    texel_check.add([left + dx, y], rgb, block);
                }
            }
            if let Some(cube) = &limits.cube {
                let differences = &mut texel_check.findings.differences;
                differences.ask(cube, limits.table.colorimetry(), texels);
            }
        }
        texel_check.findings
    }
}

/// Checks one texel after another.
struct TexelCheck<'a> {
    limits: &'a Limits,
    /// The last color, for pictures are full of runs.
    last: Option<([f32; 3], Estimate)>,
    findings: Findings,
}

impl TexelCheck<'_> {
    fn add(&mut self, at: [usize; 2], rgb: [f32; 3], block: &mut Block) {
        if rgb.iter().any(|v| !(0.0..=1.0).contains(v)) {
            self.findings.add_flaws(at, rgb);
        }
        if rgb.iter().all(|v| v.is_finite()) {
            let found = self.estimate(rgb);
            self.findings.add_color(at, rgb, &found);
            block.add(rgb, &found);
        } else {
            self.findings.counts.add(None);
            block.worst = Heat::NoColor;
        }
    }

    fn estimate(&mut self, rgb: [f32; 3]) -> Estimate {
        match self.last {
            Some((last, found)) if last == rgb => found,
            _ => {
                let found = self.limits.table.estimate(LinearRgb(rgb.map(f64::from)));
                self.last = Some((rgb, found));
                found
            }
        }
    }
}

impl Block {
    fn add(&mut self, rgb: [f32; 3], found: &Estimate) {
        (0..3).for_each(|k| self.sum[k] += units(rgb[k]));
        self.colors += 1;
        // Single precision is plenty for a color.
        let de2000 = f64::from(to_single(found.de2000));
        let worst = match found.kind {
            StandingKind::Reflectance => return,
            StandingKind::NeedsFluorescence => Heat::Fluorescence(de2000),
            StandingKind::Unreachable => Heat::Unreachable(de2000),
        };
        if worst > self.worst {
            self.worst = worst;
        }
    }

    fn mean(&self) -> [f64; 3] {
        self.sum.map(|sum| sum as f64 * UNIT / f64::from(self.colors.max(1)))
    }
}

/// A value as a screen shows it, 0..=1, in whole multiples of [`UNIT`].
#[expect(clippy::cast_possible_truncation, reason = "the fraction is meant to go")]
#[expect(clippy::cast_sign_loss, reason = "it is clamped first")]
fn units(value: f32) -> u64 {
    (f64::from(value.clamp(0.0, 1.0)) / UNIT) as u64
}
