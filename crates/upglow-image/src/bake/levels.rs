//! The colors of a picture at all levels, filtered as its rows arrive.

use rayon::prelude::*;
use upglow_color::rounding::to_single;

use crate::exr::mipmap::{TILE, level_sizes};
use crate::picture::band::Band;

/// Filters the rows of a picture into those of all levels.
///
/// A texel of a level is the mean of the texels that it covers in the level before, by the area that it
/// covers of each and by their alpha, as what is transparent is not seen. Where all are transparent, it
/// is the mean by area alone. Its alpha is the mean by area.
///
/// Memory: a row of tiles of each level, which is twice one of the picture.
#[derive(Debug)]
pub(super) struct Levels {
    levels: Vec<Level>,
}

/// A row of tiles of a level.
#[derive(Clone, Debug)]
pub(super) struct LevelRows {
    pub(super) level: usize,
    pub(super) rows: Band,
}

/// Sums over texels: red, green and blue by area and alpha, alpha by area, red, green and blue by area.
type Sums = [f64; 7];

#[derive(Debug)]
struct Level {
    size: [usize; 2],
    /// Rows that arrived.
    rows: usize,
    /// Those of the row of tiles that is not complete.
    pending: Band,
    /// The row of the next level that is not complete.
    sums: Vec<Sums>,
}

impl Levels {
    /// The levels of a picture of this size.
    pub(super) fn new(size: [usize; 2], has_alpha: bool) -> Self {
        let sizes = level_sizes(size);
        let level = |(i, &size): (usize, &[usize; 2])| Level {
            size,
            rows: 0,
            pending: empty(0, size[0], has_alpha),
            sums: vec![Sums::default(); sizes.get(i + 1).map_or(0, |next| next[0])],
        };
        Self { levels: sizes.iter().enumerate().map(level).collect() }
    }

    /// Adds the next rows of the picture; returns the rows of tiles that they complete, in an order that
    /// does not depend on how rows are divided into bands.
    pub(super) fn push(&mut self, band: &Band) -> Vec<LevelRows> {
        let next_width = self.levels.get(1).map_or(0, |next| next.size[0]);
        let alpha = |row: usize| Some(&band.alpha.as_ref()?[row * band.width..][..band.width]);
        let rows = band.rgb.par_chunks(band.width).enumerate();
        let sums: Vec<Vec<Sums>> =
            rows.map(|(row, rgb)| across(rgb, alpha(row), next_width)).collect();
        let mut complete = Vec::new();
        for ((row, rgb), sums) in band.rgb.chunks(band.width).enumerate().zip(sums) {
            self.push_row(0, (rgb, alpha(row)), &sums, &mut complete);
        }
        complete
    }

    /// Adds a row to a level, and its sums over columns to the next one.
    fn push_row(
        &mut self,
        number: usize,
        (rgb, alpha): (&[[f32; 3]], Option<&[f32]>),
        sums: &[Sums],
        complete: &mut Vec<LevelRows>,
    ) {
        let size_of = |number: usize| self.levels.get(number).map(|level| level.size);
        let [next, after] = [number + 1, number + 2].map(size_of);
        let level = &mut self.levels[number];
        let row = level.rows;
        level.add(number, rgb, alpha, complete);
        let Some([_, next_rows]) = next else { return };
        let [width, height] = level.size;
        let area = (width * height) as f64;
        let mut rows = Vec::new();
        for (to, weight) in covering(row, height, next_rows) {
            for (sum, add) in level.sums.iter_mut().zip(sums) {
                (0..sum.len()).for_each(|k| sum[k] += weight * add[k]);
            }
            if (to + 1) * height <= (row + 1) * next_rows {
                let cleared = vec![Sums::default(); level.sums.len()];
                rows.push(std::mem::replace(&mut level.sums, cleared));
            }
        }
        for sums in rows {
            let rgb: Vec<[f32; 3]> = sums.iter().map(|sums| color(sums, area)).collect();
            let alpha = alpha.map(|_| -> Vec<f32> {
                sums.iter().map(|sums| to_single(sums[3] / area)).collect()
            });
            let alpha = alpha.as_deref();
            let sums = across(&rgb, alpha, after.map_or(0, |[width, _]| width));
            self.push_row(number + 1, (&rgb, alpha), &sums, complete);
        }
    }
}

impl Level {
    fn add(
        &mut self,
        number: usize,
        rgb: &[[f32; 3]],
        alpha: Option<&[f32]>,
        complete: &mut Vec<LevelRows>,
    ) {
        self.rows += 1;
        self.pending.rgb.extend(rgb);
        if let (Some(pending), Some(alpha)) = (&mut self.pending.alpha, alpha) {
            pending.extend(alpha);
        }
        if self.rows.is_multiple_of(TILE) || self.rows == self.size[1] {
            let following = empty(self.rows, self.size[0], alpha.is_some());
            let rows = std::mem::replace(&mut self.pending, following);
            complete.push(LevelRows { level: number, rows });
        }
    }
}

fn empty(first_row: usize, width: usize, has_alpha: bool) -> Band {
    Band { first_row, width, rgb: Vec::new(), alpha: has_alpha.then(Vec::new) }
}

/// A side of `from` texels is divided into `to` texels instead: the new texels that overlap the old texel
/// `i`, in order, and the length of each overlap, in units in which a new texel is `from` long.
fn covering(i: usize, from: usize, to: usize) -> impl Iterator<Item = (usize, f64)> {
    let [start, end] = [i * to, (i + 1) * to];
    (start / from..end.div_ceil(from)).map(move |k| {
        let length = end.min((k + 1) * from) - start.max(k * from);
        (k, length as f64)
    })
}

/// Sums over the columns that each texel of a row of `to` texels covers.
fn across(rgb: &[[f32; 3]], alpha: Option<&[f32]>, to: usize) -> Vec<Sums> {
    let mut sums = vec![Sums::default(); to];
    if to == 0 {
        return sums;
    }
    let width = rgb.len();
    for (i, rgb) in rgb.iter().enumerate() {
        let rgb = rgb.map(f64::from);
        let alpha = alpha.map_or(1.0, |alpha| f64::from(alpha[i]));
        // Negative alpha covers nothing.
        let alpha = alpha.clamp(0.0, 1.0);
        for (k, length) in covering(i, width, to) {
            let [r, g, b] = rgb.map(|v| v * length);
            let add = [r * alpha, g * alpha, b * alpha, length * alpha, r, g, b];
            (0..add.len()).for_each(|n| sums[k][n] += add[n]);
        }
    }
    sums
}

/// The mean of sums over texels of this area in all. Rounding must not leave the range of the texels.
fn color(sums: &Sums, area: f64) -> [f32; 3] {
    let [r, g, b, alpha, all @ ..] = *sums;
    let mean = if alpha > 0.0 { [r, g, b].map(|v| v / alpha) } else { all.map(|v| v / area) };
    mean.map(|v| to_single(v.clamp(0.0, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pushed(
        size: [usize; 2],
        rgb: &[[f32; 3]],
        alpha: Option<&[f32]>,
        rows: usize,
    ) -> Vec<LevelRows> {
        let mut levels = Levels::new(size, alpha.is_some());
        let bands = (0..size[1]).step_by(rows).map(|first_row| {
            let texels = first_row * size[0]..(first_row + rows).min(size[1]) * size[0];
            let alpha = alpha.map(|alpha| alpha[texels.clone()].to_vec());
            Band { first_row, width: size[0], rgb: rgb[texels].to_vec(), alpha }
        });
        bands.flat_map(|band| levels.push(&band)).collect()
    }

    fn picture(size: [usize; 2]) -> Vec<[f32; 3]> {
        let texel = |i: usize| [0.1, 0.37, 0.73].map(|a: f32| (a * i as f32).fract());
        (0..size[0] * size[1]).map(texel).collect()
    }

    #[test]
    fn every_level_has_all_its_rows_whatever_the_bands() {
        for size in [[1, 1], [3, 7], [130, 67], [64, 200], [1, 300]] {
            let rgb = picture(size);
            let whole = pushed(size, &rgb, None, size[1]);
            for (level, [width, height]) in level_sizes(size).into_iter().enumerate() {
                let of_level = whole.iter().filter(|rows| rows.level == level);
                let count: usize = of_level.map(|rows| rows.rows.rgb.len()).sum();
                assert_eq!(count, width * height, "{size:?} {level}");
            }
            let parts = pushed(size, &rgb, None, 5);
            let same =
                whole.iter().zip(&parts).all(|(a, b)| a.level == b.level && a.rows == b.rows);
            assert!(same && whole.len() == parts.len(), "{size:?}");
        }
    }

    #[test]
    fn the_last_level_is_the_mean_of_the_picture() {
        // Eight roundings to single precision of numbers up to 1.
        const ROUNDING: f64 = 1e-6;
        for size in [[64, 64], [37, 5], [1, 9], [129, 255]] {
            let rgb = picture(size);
            let rows = pushed(size, &rgb, None, 3);
            let last = rows.last().unwrap();
            for k in 0..3 {
                let mean = rgb.iter().map(|rgb| f64::from(rgb[k])).sum::<f64>() / rgb.len() as f64;
                let found = f64::from(last.rows.rgb[0][k]);
                assert!((found - mean).abs() < ROUNDING, "{size:?}: {found} {mean}");
            }
        }
    }

    #[test]
    fn what_is_transparent_does_not_color_what_is_not() {
        let rgb = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]];
        let of = |alpha: [f32; 4]| {
            let rows = pushed([2, 2], &rgb, Some(&alpha), 1);
            let last = rows.last().unwrap().rows.clone();
            (last.rgb[0], last.alpha.unwrap()[0])
        };
        assert_eq!(of([1.0, 0.0, 0.0, 0.0]), ([1.0, 0.0, 0.0], 0.25));
        assert_eq!(of([0.5, 0.0, 0.0, 0.5]), ([0.5, 0.5, 0.0], 0.25));
        assert_eq!(of([0.0; 4]), ([0.25, 0.25, 0.5], 0.0));
    }
}
