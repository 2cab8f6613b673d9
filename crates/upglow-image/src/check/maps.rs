//! The maps and the thumbnail, which are accumulated while rows are read.

use rayon::prelude::*;
use upglow_color::rounding::to_single;
use upglow_color::{LinearRgb, StandingKind};
use upglow_fit::Estimate;

use super::cube_match::Blended;
use super::display::Display;
use super::findings::Findings;
use super::limits::Limits;
use super::palette::{CubeHeat, Heat, Ramp};
use super::raster::Raster;

/// Blocks of a picture; each becomes a pixel of the maps.
#[derive(Debug)]
pub(super) struct Maps {
    width: usize,
    /// Texels per side of a block.
    side: usize,
    /// Blocks in a row.
    columns: usize,
    /// `[row][column]`.
    blocks: Vec<Block>,
}

/// The findings about a block.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    /// Sums over the texels with finite values, in multiples of [`UNIT`].
    sum: [u64; 3],
    colors: u32,
    worst: Heat,
    cube: CubeHeat,
}

/// Greatest width and height of the maps.
const LONGER_SIDE: usize = 1024;

/// The unit of sums: finer than the steps of 8-bit sRGB near black.
const UNIT: f64 = 1.0 / 1_048_576.0;

/// Horizontally adjacent blocks per parallel task.
const BLOCKS_TOGETHER: usize = 64;

impl Maps {
    pub(super) fn new([width, height]: [usize; 2]) -> Self {
        let side = width.max(height).div_ceil(LONGER_SIDE);
        let (columns, rows) = (width.div_ceil(side), height.div_ceil(side));
        Self { width, side, columns, blocks: vec![Block::default(); columns * rows] }
    }

    /// Checks the texels of a band of whole rows.
    pub(super) fn check(
        &mut self,
        first_row: usize,
        band: &[[f32; 3]],
        limits: &Limits<'_>,
    ) -> Findings {
        let Self { width, side, columns, .. } = *self;
        let rows = first_row..first_row + band.len() / width;
        let block_rows = rows.start / side..rows.end.div_ceil(side);
        let touched = block_rows.start * columns..block_rows.end * columns;
        let block_rows = self.blocks[touched].par_chunks_mut(columns).enumerate();
        let found = block_rows.flat_map(|(i, row)| {
            let top = (rows.start / side + i) * side;
            let rows = top.max(rows.start)..(top + side).min(rows.end);
            row.par_chunks_mut(BLOCKS_TOGETHER).enumerate().map(move |(j, blocks)| {
                let left = j * BLOCKS_TOGETHER * side;
                let right = (left + blocks.len() * side).min(width);
                let texels = |y: usize| &band[(y - first_row) * width..][left..right];
                let rows = rows.clone().map(|y| (y, texels(y)));
                check_blocks(blocks, side, left, rows, limits)
            })
        });
        found.reduce(Findings::default, Findings::with)
    }

    pub(super) fn heat(&self, display: &Display) -> Raster {
        self.raster(|block| block.worst.color(display.brightness(block.mean())))
    }

    /// The map of a cube's differences, and that of its doses.
    pub(super) fn of_cube(&self, doses: Ramp, display: &Display) -> [Raster; 2] {
        let bright = |block: &Block| display.brightness(block.mean());
        [
            self.raster(|block| block.cube.difference_color(bright(block))),
            self.raster(|block| block.cube.dose_color(doses, bright(block))),
        ]
    }

    pub(super) fn thumbnail(&self, display: &Display) -> Raster {
        self.raster(|block| display.srgb_of_rgb(block.mean()))
    }

    fn raster(&self, color: impl Fn(&Block) -> [u8; 3] + Sync + Send) -> Raster {
        Raster::new(self.columns, self.blocks.par_iter().map(color).collect())
    }
}

/// Checks horizontally adjacent blocks, of which `rows` has numbers and texels. The first column is
/// `left`.
fn check_blocks<'b>(
    blocks: &mut [Block],
    side: usize,
    left: usize,
    rows: impl Iterator<Item = (usize, &'b [[f32; 3]])>,
    limits: &Limits<'_>,
) -> Findings {
    let mut texel_check = TexelCheck { limits, last: None, findings: Findings::default() };
    let mut blended = Vec::new();
    for (y, texels) in rows {
        if let Some(cube) = &limits.cube {
            blended.resize(texels.len(), [0.0; 3]);
            cube.colors.xyz(texels, &mut blended).expect("there is room for each texel");
        }
        for (x, &rgb) in texels.iter().enumerate() {
            let blend = blended.get(x).copied();
            texel_check.add([left + x, y], rgb, blend, &mut blocks[x / side]);
        }
    }
    texel_check.findings
}

/// Checks one texel after another.
struct TexelCheck<'a, 'c> {
    limits: &'a Limits<'c>,
    /// The previous color: pictures contain many runs of the same color.
    last: Option<([f32; 3], Estimate)>,
    findings: Findings,
}

impl TexelCheck<'_, '_> {
    /// Adds a texel. `blend` is the color that the cube makes of it, if there is a cube.
    fn add(&mut self, at: [usize; 2], rgb: [f32; 3], blend: Option<[f32; 3]>, block: &mut Block) {
        if rgb.iter().any(|v| !(0.0..=1.0).contains(v)) {
            self.findings.add_flaws(at, rgb);
        }
        if !rgb.iter().all(|v| v.is_finite()) {
            self.findings.counts.add(None);
            block.worst = Heat::NoColor;
            block.cube.is_outside = true;
            return;
        }
        let found = self.estimate(rgb);
        self.findings.add_color(at, rgb, &found);
        block.add(rgb, &found);
        if let (Some(cube), Some(blend)) = (&self.limits.cube, blend) {
            let texel = Blended { at, rgb, needs: found.kind, blend };
            block.cube.add(self.findings.blends.add(self.limits, cube, texel));
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
        // Single precision suffices for a pixel's color.
        let de2000 = to_single(found.de2000);
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

/// A value clamped to 0..=1, in multiples of [`UNIT`].
#[expect(clippy::cast_possible_truncation, reason = "the fraction is dropped on purpose")]
#[expect(clippy::cast_sign_loss, reason = "the value is clamped first")]
fn units(value: f32) -> u64 {
    (f64::from(value.clamp(0.0, 1.0)) / UNIT) as u64
}
