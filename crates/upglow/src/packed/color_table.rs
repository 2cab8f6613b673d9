//! Colors of whole images.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x4, f32x16, i32x16, mask32x16};
use upglow_color::Colorimetry;
use upglow_color::rounding::to_single;

use crate::cube::Cube;
use crate::material::model_on_grid::ModelOnGrid;
use crate::packed::lookup_table::axis;

/// The colors that the materials of a [`Cube`] have under the contract's light.
///
/// The color of a mixture is the weighted mean of its materials' colors. The tetrahedral
/// interpolation of the nodes' colors is therefore exactly [`crate::Mixture::color`] with
/// [`crate::Interpolation::Blend`], without any spectrum.
#[must_use]
#[derive(Clone, Debug)]
pub struct ColorTable {
    simd_level: Level,
    resolution: u32,
    /// X, Y, Z and 0, `[blue][green][red]`.
    nodes: Vec<[f32; 4]>,
}

/// Two arrays differ in length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("room for {found} colors, expected {expected}, one for each RGB")]
pub struct LengthError {
    /// Colors that the output holds.
    pub found: usize,
    /// Colors of the input.
    pub expected: usize,
}

impl Cube {
    /// The colors of the nodes under the light and on the grid of `colorimetry`.
    pub fn color_table(&self, colorimetry: &Colorimetry) -> ColorTable {
        let sums = ModelOnGrid::new(self.model(), colorimetry);
        let color = |index| {
            let [x, y, z] = sums.color(self.node_material(index)).0.map(to_single);
            [x, y, z, 0.0]
        };
        let nodes = (0..self.nodes().len()).map(color).collect();
        ColorTable { simd_level: Level::new(), resolution: axis(self), nodes }
    }
}

impl ColorTable {
    /// X, Y, Z of the material of each RGB; NaN where a component is not in 0..=1. Returns how many
    /// colors are outside.
    ///
    /// # Errors
    ///
    /// [`LengthError`] if the arrays differ in length; `xyz` is then untouched.
    pub fn xyz(&self, rgb: &[[f32; 3]], xyz: &mut [[f32; 3]]) -> Result<usize, LengthError> {
        if rgb.len() != xyz.len() {
            return Err(LengthError { found: xyz.len(), expected: rgb.len() });
        }
        let outside = dispatch!(self.simd_level, simd => simd.vectorize(
            #[inline(always)]
            || self.xyz_in_groups(simd, rgb, xyz),
        ));
        Ok(outside)
    }

    #[inline(always)]
    fn xyz_in_groups<S: Simd>(&self, simd: S, rgb: &[[f32; 3]], xyz: &mut [[f32; 3]]) -> usize {
        let (groups, rest) = rgb.as_chunks::<GROUP>();
        let (xyz_groups, xyz_rest) = xyz.as_chunks_mut::<GROUP>();
        let mut corners = CornersOfMany { nodes: [[0; GROUP]; 4], weights: [[0.0; GROUP]; 4] };
        let mut outside = 0;
        for (rgb, xyz) in groups.iter().zip(xyz_groups) {
            outside += self.group(simd, &mut corners, rgb, xyz);
        }
        let mut last = ([[0.0; 3]; GROUP], [[0.0; 3]; GROUP]);
        last.0[..rest.len()].copy_from_slice(rest);
        outside += self.group(simd, &mut corners, &last.0, &mut last.1);
        xyz_rest.copy_from_slice(&last.1[..rest.len()]);
        outside
    }

    /// First finds the nodes of all colors, in vectors, then mixes: the loads of one color need not
    /// wait for the arithmetic of the next. Returns how many colors are outside.
    #[inline(always)]
    fn group<S: Simd>(
        &self,
        simd: S,
        corners: &mut CornersOfMany,
        rgb: &[[f32; 3]; GROUP],
        xyz: &mut [[f32; 3]; GROUP],
    ) -> usize {
        let outside = corners.find(simd, self.resolution, &channels(rgb));
        self.mix(simd, corners, xyz);
        let mut count = 0;
        if outside != 0 {
            for i in (0..GROUP).filter(|i| outside >> i & 1 == 1) {
                xyz[i] = [f32::NAN; 3];
                count += 1;
            }
        }
        count
    }

    /// The weighted means of the nodes' colors. All but the last are written as four numbers; the
    /// next color overwrites the fourth.
    #[inline(always)]
    fn mix<S: Simd>(&self, simd: S, corners: &CornersOfMany, xyz: &mut [[f32; 3]; GROUP]) {
        let flat = xyz.as_flattened_mut();
        for i in 0..GROUP - 1 {
            self.mean(simd, corners, i).store_slice(&mut flat[3 * i..3 * i + 4]);
        }
        let [x, y, z, _]: [f32; 4] = self.mean(simd, corners, GROUP - 1).into();
        xyz[GROUP - 1] = [x, y, z];
    }

    #[inline(always)]
    fn mean<S: Simd>(&self, simd: S, corners: &CornersOfMany, i: usize) -> f32x4<S> {
        let mut sum = f32x4::splat(simd, 0.0);
        for k in 0..4 {
            let color = f32x4::load_array_ref(
                simd,
                &self.nodes[corners.nodes[k][i].cast_unsigned() as usize],
            );
            let part = color * corners.weights[k][i];
            // Not `mul_add`: all processors give the same bits.
            sum = if k == 0 { part } else { sum + part };
        }
        sum
    }
}

/// Reds, greens and blues, `[channel][color]`.
#[inline(always)]
fn channels(rgb: &[[f32; 3]; GROUP]) -> [[f32; GROUP]; 3] {
    let mut channels = [[0.0; GROUP]; 3];
    for i in 0..GROUP {
        for k in 0..3 {
            channels[k][i] = rgb[i][k];
        }
    }
    channels
}

/// The four nodes around each of [`GROUP`] colors and their weights, `[corner][color]`.
#[derive(Clone, Copy, Debug)]
struct CornersOfMany {
    nodes: [[i32; GROUP]; 4],
    weights: [[f32; GROUP]; 4],
}

impl CornersOfMany {
    /// [`crate::packed::lookup_table::Corners`] of many colors. Colors outside are clamped, NaN to 0;
    /// each sets a bit of the result.
    #[inline(always)]
    fn find<S: Simd>(&mut self, simd: S, resolution: u32, rgb: &[[f32; GROUP]; 3]) -> u64 {
        let mut outside = 0;
        for start in (0..GROUP).step_by(VECTOR) {
            let channel = |k: usize| f32x16::from_slice(simd, &rgb[k][start..start + VECTOR]);
            let rgb = [channel(0), channel(1), channel(2)];
            outside |= self.find_vector(simd, resolution, rgb, start) << start;
        }
        outside
    }

    #[inline(always)]
    fn find_vector<S: Simd>(
        &mut self,
        simd: S,
        resolution: u32,
        [red, green, blue]: [f32x16<S>; 3],
        start: usize,
    ) -> u64 {
        let n = resolution.cast_signed();
        let (red, r, red_odd) = cell(simd, n - 1, red);
        let (green, g, green_odd) = cell(simd, n - 1, green);
        let (blue, b, blue_odd) = cell(simd, n - 1, blue);
        let to = |step| i32x16::splat(simd, step);
        let [to_red, to_green, to_blue] = [to(1), to(n), to(n * n)];
        let [red_green, red_blue, green_blue] = [r.simd_ge(g), r.simd_ge(b), g.simd_ge(b)];
        let to_greatest = red_green
            .select(red_blue.select(to_red, to_blue), green_blue.select(to_green, to_blue));
        let to_least = red_green
            .select(green_blue.select(to_blue, to_green), red_blue.select(to_blue, to_red));
        let [greater, smaller] = [r.max(g), r.min(g)];
        let [greatest, least] = [greater.max(b), smaller.min(b)];
        let middle = smaller.max(greater.min(b));
        let dark = (blue * n + green) * n + red;
        let bright = dark + (1 + n + n * n);
        let nodes = [dark, dark + to_greatest, bright - to_least, bright];
        let weights = [1.0 - greatest, greatest - middle, middle - least, least];
        for k in 0..4 {
            nodes[k].store_slice(&mut self.nodes[k][start..start + VECTOR]);
            weights[k].store_slice(&mut self.weights[k][start..start + VECTOR]);
        }
        (red_odd | green_odd | blue_odd).to_bitmask()
    }
}

/// The cells of one channel that numbers are in, where in them, 0..=1, and which are outside of
/// all.
#[inline(always)]
fn cell<S: Simd>(simd: S, cells: i32, channel: f32x16<S>) -> (i32x16<S>, f32x16<S>, mask32x16<S>) {
    // Not `max`, which may return NaN.
    let clamped = channel.simd_gt(0.0).select(channel, f32x16::splat(simd, 0.0)).min(1.0);
    // Single precision will do: between nodes a color changes by no more than 1/cells.
    let position = clamped * single(cells);
    let below: i32x16<S> = position.to_int();
    let below = below.min(cells - 1);
    (below, position - below.to_float::<f32x16<S>>(), clamped.simd_ne(channel))
}

/// Colors whose nodes are found before any is mixed: enough for the compiler to separate channels in
/// vectors, and few enough to keep loads from waiting. With 64, unrelated colors take a fifth more
/// time.
const GROUP: usize = 32;

/// Numbers of the widest vector.
const VECTOR: usize = 16;

/// A number of cells along an axis, exactly.
#[expect(clippy::cast_precision_loss, reason = "it is at most 255")]
#[inline(always)]
fn single(count: i32) -> f32 {
    count as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cube::FitRecord;
    use crate::cube::interpolation::Interpolation;
    use crate::random::{Random, models};
    use upglow_color::{Contract, Grid, LinearRgb};

    #[test]
    fn colors_are_those_of_the_mixtures() {
        // Single precision of colors up to 1 and of positions up to 4.
        const SINGLE: f64 = 2e-6;
        let contract = Contract::default();
        let colorimetry = contract.on(Grid::FIT);
        for (seed, model) in (0..).zip(models()) {
            let mut random = Random::new(seed);
            let nodes = (0..125).map(|_| random.node(&model)).collect();
            let cube = Cube::new(contract.clone(), model, FitRecord::default(), 5, nodes).unwrap();
            let sums = ModelOnGrid::new(cube.model(), &colorimetry);
            let table = cube.color_table(&colorimetry);
            let mut rgb: Vec<[f32; 3]> =
                (0..50).map(|_| [(); 3].map(|()| to_single(random.unit()))).collect();
            rgb.extend([[0.0; 3], [1.0; 3], [1.0, 0.0, 1.0]]);
            let mut xyz = vec![[0.0; 3]; rgb.len()];
            assert_eq!(table.xyz(&rgb, &mut xyz), Ok(0));
            for (rgb, xyz) in rgb.iter().zip(xyz) {
                let color = LinearRgb(rgb.map(f64::from));
                let expected = cube.lookup(color, Interpolation::Blend).unwrap().color(&sums);
                for k in 0..3 {
                    let error = f64::from(xyz[k]) - expected.0[k];
                    assert!(error.abs() < SINGLE, "{rgb:?} {xyz:?} {expected:?}");
                }
            }
        }
    }

    #[test]
    fn the_widest_vectors_compute_the_bits_of_the_plain_ones() {
        let model = models().pop().unwrap();
        let mut random = Random::new(5);
        let nodes = (0..125).map(|_| random.node(&model)).collect();
        let cube = Cube::new(Contract::default(), model, FitRecord::default(), 5, nodes).unwrap();
        let wide = cube.color_table(&Contract::default().on(Grid::FIT));
        let plain = ColorTable { simd_level: Level::baseline(), ..wide.clone() };
        let rgb: Vec<[f32; 3]> =
            (0..1000).map(|_| [(); 3].map(|()| to_single(random.unit()))).collect();
        let mut xyz = [vec![[0.0; 3]; rgb.len()], vec![[0.0; 3]; rgb.len()]];
        assert_eq!(wide.xyz(&rgb, &mut xyz[0]), Ok(0));
        assert_eq!(plain.xyz(&rgb, &mut xyz[1]), Ok(0));
        assert_eq!(xyz[0], xyz[1]);
    }

    #[test]
    fn colors_outside_are_nan_and_counted() {
        let nodes = vec![crate::Node::default(); 8];
        let model = crate::Model::Reflectance;
        let cube = Cube::new(Contract::default(), model, FitRecord::default(), 2, nodes).unwrap();
        let table = cube.color_table(&Contract::default().on(Grid::FIT));
        let mut rgb = vec![[0.5; 3]; 40];
        for (i, odd) in [(0, f32::NAN), (17, -1e-9), (31, 1.001), (39, f32::INFINITY)] {
            rgb[i][i % 3] = odd;
        }
        let mut xyz = vec![[0.0; 3]; 40];
        assert_eq!(table.xyz(&rgb, &mut xyz), Ok(4));
        for (i, xyz) in xyz.iter().enumerate() {
            assert_eq!(xyz.iter().any(|v| v.is_nan()), [0, 17, 31, 39].contains(&i), "{i}");
        }
        assert_eq!(
            table.xyz(&rgb, &mut xyz[1..]).unwrap_err().to_string(),
            "room for 39 colors, expected 40, one for each RGB"
        );
    }
}
