//! Colors of whole images.

use fearless_simd::{Level, Simd, dispatch};
use upglow_color::Colorimetry;

use crate::lookup_table::{Corners, axis, greater_of, smaller_of, to_single};
use crate::{Cube, ModelOnGrid};

/// The colors that the materials of a [`Cube`] have under the contract's light.
///
/// The color of a mixture is the weighted mean of its materials' colors, so the color of any
/// looked-up material needs no spectrum: it is the tetrahedral interpolation of the nodes' colors,
/// and exactly that of [`crate::Mixture::color`] with [`crate::Interpolation::Blend`].
#[derive(Clone, Debug)]
pub struct ColorTable {
    level: Level,
    resolution: u32,
    /// X, Y, Z and nothing, `[blue][green][red]`.
    nodes: Vec<[f32; 4]>,
}

/// Two arrays that should be of one length are not.
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
        ColorTable { level: Level::new(), resolution: axis(self), nodes }
    }
}

impl ColorTable {
    /// X, Y, Z of the material of each RGB; not-a-number where a component is not in 0..=1.
    /// Returns how many those are.
    ///
    /// # Errors
    ///
    /// [`LengthError`] if the arrays differ in length; `xyz` is then untouched.
    pub fn xyz(&self, rgb: &[[f32; 3]], xyz: &mut [[f32; 3]]) -> Result<usize, LengthError> {
        if rgb.len() != xyz.len() {
            return Err(LengthError { found: xyz.len(), expected: rgb.len() });
        }
        let outside = dispatch!(self.level, simd => simd.vectorize(
            #[inline(always)]
            || self.xyz_in_groups(rgb, xyz),
        ));
        Ok(outside)
    }

    #[inline(always)]
    fn xyz_in_groups(&self, rgb: &[[f32; 3]], xyz: &mut [[f32; 3]]) -> usize {
        let (groups, rest) = rgb.as_chunks::<GROUP>();
        let (xyz_groups, xyz_rest) = xyz.as_chunks_mut::<GROUP>();
        let mut outside = 0;
        for (rgb, xyz) in groups.iter().zip(xyz_groups) {
            outside += self.group(rgb, xyz);
        }
        let mut last = ([[0.0; 3]; GROUP], [[0.0; 3]; GROUP]);
        last.0[..rest.len()].copy_from_slice(rest);
        outside += self.group(&last.0, &mut last.1);
        xyz_rest.copy_from_slice(&last.1[..rest.len()]);
        outside
    }

    /// First all places in the table, in vectors, then all colors: the loads of one color need not
    /// wait for the arithmetic of the next. Returns how many colors are outside.
    #[inline(always)]
    fn group(&self, rgb: &[[f32; 3]; GROUP], xyz: &mut [[f32; 3]; GROUP]) -> usize {
        let (mut nodes, mut weights) = ([[0; GROUP]; 4], [[0.0; GROUP]; 4]);
        let mut outside = [0; GROUP];
        for i in 0..GROUP {
            let corners = self.clamped(rgb[i]);
            for k in 0..4 {
                nodes[k][i] = corners.nodes[k];
                weights[k][i] = corners.weights[k];
            }
            outside[i] = rgb[i].iter().map(|v| u32::from(!(0.0..=1.0).contains(v))).sum();
        }
        for i in 0..GROUP {
            let mut sum = [0.0; 4];
            for k in 0..4 {
                let color = self.nodes[nodes[k][i] as usize];
                (0..4).for_each(|m| sum[m] += weights[k][i] * color[m]);
            }
            xyz[i] = [sum[0], sum[1], sum[2]];
        }
        let mut count = 0;
        if outside.iter().sum::<u32>() > 0 {
            for i in (0..GROUP).filter(|&i| outside[i] > 0) {
                xyz[i] = [f32::NAN; 3];
                count += 1;
            }
        }
        count
    }

    /// The corners of the nearest color of the cube, and those of 0 for what is no number.
    #[inline(always)]
    fn clamped(&self, rgb: [f32; 3]) -> Corners {
        let last = self.resolution - 1;
        let (mut first, mut fraction) = ([0; 3], [0.0; 3]);
        for k in 0..3 {
            // Single precision will do: between nodes a color changes by no more than 1/last.
            let position = smaller_of(greater_of(rgb[k], 0.0), 1.0) * single(last);
            let below = whole(position);
            first[k] = if below < last { below } else { last - 1 };
            fraction[k] = position - single(first[k]);
        }
        Corners::of(self.resolution, first, fraction)
    }
}

/// Colors that are worked on side by side: whole vectors of any width up to 16. Their places and
/// weights stay in the first-level cache.
const GROUP: usize = 16;

/// A number of nodes along an axis, which is far below 2²⁴.
#[expect(clippy::cast_precision_loss, reason = "it is at most 256")]
#[inline(always)]
fn single(count: u32) -> f32 {
    // By way of a signed number, which processors convert in one instruction.
    count.cast_signed() as f32
}

/// The whole part of a position in a cube.
#[expect(clippy::cast_possible_truncation, reason = "the fraction is meant to go")]
#[inline(always)]
fn whole(position: f32) -> u32 {
    (position as i32).cast_unsigned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Random, models};
    use crate::{FitRecord, Interpolation};
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
    fn the_widest_vectors_give_the_bits_that_the_plain_ones_give() {
        let model = models().pop().unwrap();
        let mut random = Random::new(5);
        let nodes = (0..125).map(|_| random.node(&model)).collect();
        let cube = Cube::new(Contract::default(), model, FitRecord::default(), 5, nodes).unwrap();
        let wide = cube.color_table(&Contract::default().on(Grid::FIT));
        let plain = ColorTable { level: Level::baseline(), ..wide.clone() };
        let rgb: Vec<[f32; 3]> =
            (0..1000).map(|_| [(); 3].map(|()| to_single(random.unit()))).collect();
        let mut xyz = [vec![[0.0; 3]; rgb.len()], vec![[0.0; 3]; rgb.len()]];
        assert_eq!(wide.xyz(&rgb, &mut xyz[0]), Ok(0));
        assert_eq!(plain.xyz(&rgb, &mut xyz[1]), Ok(0));
        assert_eq!(xyz[0], xyz[1]);
    }

    #[test]
    fn what_is_outside_has_no_color_and_is_counted() {
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
