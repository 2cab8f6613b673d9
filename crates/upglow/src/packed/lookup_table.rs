//! A cube compiled for looking up millions of colors.

use upglow_color::rounding::to_single;

use crate::cube::{Cube, LookupError};
use crate::material::model::Model;
use crate::packed::mixture::PackedMixture;
use crate::packed::model::PackedModel;
use crate::packed::node::PackedNode;
use crate::packed::vector::{greater_of, smaller_of, with_baseline};

/// A [`Cube`] in single precision, packed so that a look-up touches as few cache lines as it can.
///
/// It returns the material of [`Cube::lookup`] with [`crate::Interpolation::Blend`], within 1e-5, in
/// a fraction of the time. For the colors of whole images use a [`crate::ColorTable`].
///
/// # Examples
///
/// ```
/// use upglow::{Cube, Edge, FitRecord, Fluorescence, Model, Node};
/// use upglow_color::Contract;
///
/// let gray = Edge { edge_nm: 550.0, level: 0.0, slope_per_nm: 0.0 };
/// let nodes = vec![Node::new(gray, Fluorescence::None, 0.0); 8];
/// let cube = Cube::new(Contract::default(), Model::Reflectance, FitRecord::default(), 2, nodes)?;
/// let table = cube.lookup_table();
/// let mixture = table.lookup([0.2, 0.5, 0.1])?;
/// assert_eq!(mixture.reflectance4([400.0, 500.0, 600.0, 700.0]), [0.5; 4]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Clone, Debug)]
pub struct LookupTable {
    model: PackedModel,
    resolution: u32,
    nodes: Vec<PackedNode>,
}

impl Cube {
    /// The cube compiled for looking up millions of colors.
    pub fn lookup_table(&self) -> LookupTable {
        LookupTable {
            model: PackedModel::new(self.model()),
            resolution: axis(self),
            nodes: self.packed_nodes().collect(),
        }
    }
}

/// Nodes along each axis, for arithmetic with numbers of nodes, which are below 2²⁴.
pub(crate) fn axis(cube: &Cube) -> u32 {
    u32::try_from(cube.resolution()).expect("a cube has at most 256 nodes along an axis")
}

impl LookupTable {
    /// What the fluorescence is made of.
    pub fn model(&self) -> &Model {
        &self.model.model
    }

    /// Nodes along each axis.
    pub fn resolution(&self) -> usize {
        self.resolution as usize
    }

    /// The material of a color, ready to evaluate; nothing is allocated.
    ///
    /// # Errors
    ///
    /// [`LookupError::Outside`] if a component is not a number in 0..=1. Clamp first
    /// for the nearest color of the cube.
    pub fn lookup(&self, rgb: [f32; 3]) -> Result<PackedMixture<'_>, LookupError> {
        let corners = Corners::around(self.resolution, rgb)
            .ok_or_else(|| LookupError::outside(rgb.map(f64::from)))?;
        let nodes = corners.nodes.map(|node| &self.nodes[node as usize]);
        Ok(with_baseline!(simd => PackedMixture::new(simd, &self.model, corners.weights, nodes)))
    }
}

/// The four nodes of a color's tetrahedron.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corners {
    pub(crate) nodes: [u32; 4],
    pub(crate) weights: [f32; 4],
}

impl Corners {
    /// The tetrahedron of [`Cube::corners`], found without a branch; `None` outside 0..=1.
    #[inline(always)]
    pub(crate) fn around(resolution: u32, rgb: [f32; 3]) -> Option<Self> {
        if !rgb.iter().all(|v| (0.0..=1.0).contains(v)) {
            return None;
        }
        // In double precision: a position below 255 leaves too few digits for the fraction.
        let last = f64::from(resolution - 1);
        let (mut first, mut fraction) = ([0; 3], [0.0; 3]);
        for k in 0..3 {
            let position = f64::from(rgb[k]) * last;
            first[k] = whole(position).min(resolution - 2);
            fraction[k] = to_single(position - f64::from(first[k]));
        }
        Some(Self::of(resolution, first, fraction))
    }

    /// The tetrahedron in the cell whose darkest node is `first`, red first, at `fraction` of the
    /// way to the brightest. Masks replace branches, because processors cannot predict the order of
    /// an image's channels.
    #[inline(always)]
    pub(crate) fn of(resolution: u32, first: [u32; 3], [r, g, b]: [f32; 3]) -> Self {
        let n = resolution;
        let [to_red, to_green, to_blue] = [1, n, n * n];
        let mask = |holds: bool| u32::from(holds).wrapping_neg();
        let [red_green, red_blue, green_blue] = [mask(r >= g), mask(r >= b), mask(g >= b)];
        let to_greatest = (to_red & red_green & red_blue)
            | (to_green & !red_green & green_blue)
            | (to_blue & !red_blue & !green_blue);
        let to_least = (to_red & !red_green & !red_blue)
            | (to_green & red_green & !green_blue)
            | (to_blue & red_blue & green_blue);
        let [greater, smaller] = [greater_of(r, g), smaller_of(r, g)];
        let [greatest, least] = [greater_of(greater, b), smaller_of(smaller, b)];
        let middle = greater_of(smaller, smaller_of(greater, b));
        let dark = (first[2] * n + first[1]) * n + first[0];
        let bright = dark + to_red + to_green + to_blue;
        Self {
            nodes: [dark, dark + to_greatest, bright - to_least, bright],
            weights: [1.0 - greatest, greatest - middle, middle - least, least],
        }
    }
}

/// The whole part of a position in a cube.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the position is at least 0 and its fraction is meant to go"
)]
#[inline(always)]
fn whole(position: f64) -> u32 {
    // Through a signed number, which processors convert in one instruction.
    position as i32 as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bispectral::Bispectral;
    use crate::cube::FitRecord;
    use crate::cube::interpolation::Interpolation;
    use crate::material::edge::Edge;
    use crate::random::{Random, models};
    use fearless_simd::Level;
    use proptest::prelude::*;
    use upglow_color::{Contract, LinearRgb};

    proptest! {
        #[test]
        fn corners_are_those_of_the_cube(
            rgb in prop::array::uniform3(0.0_f32..=1.0),
            resolution in 2_u32..256,
        ) {
            let expected = crate::cube::interpolation::tetrahedron(resolution as usize,
                LinearRgb(rgb.map(f64::from)),
            );
            let corners = Corners::around(resolution, rgb).unwrap();
            for ((node, weight), ([b, g, r], expected)) in
                corners.nodes.into_iter().zip(corners.weights).zip(expected)
            {
                // Rounding only, to single precision of fractions.
                prop_assert!((f64::from(weight) - expected).abs() < 2e-7);
                if weight > 0.0 {
                    let n = resolution as usize;
                    prop_assert_eq!(node as usize, (b * n + g) * n + r);
                }
            }
        }
    }

    #[test]
    fn what_is_outside_is_refused_by_name() {
        let model = Model::Reflectance;
        let nodes = vec![crate::Node::default(); 8];
        let cube = Cube::new(Contract::default(), model, FitRecord::default(), 2, nodes).unwrap();
        let table = cube.lookup_table();
        for (rgb, message) in [
            ([0.0, f32::NAN, 0.0], "green is NaN, expected 0 to 1, the range of the cube"),
            ([0.0, 0.5, 1.5], "blue is 1.5, expected 0 to 1, the range of the cube"),
            ([-0.25, 0.5, 0.5], "red is -0.25, expected 0 to 1, the range of the cube"),
            ([f32::INFINITY, 0.5, 0.5], "red is inf, expected 0 to 1, the range of the cube"),
        ] {
            assert_eq!(table.lookup(rgb).unwrap_err().to_string(), message);
        }
    }

    #[test]
    fn a_blend_answers_what_the_mixture_answers() {
        // Single precision of numbers near 10 under the root, and of curves at 1 nm.
        const SINGLE: f64 = 1e-5;
        // Densities are up to 0.05 per nm.
        const SINGLE_PER_NM: f64 = 1e-6;
        for (seed, model) in (0..).zip(models()) {
            let mut random = Random::new(seed);
            let nodes = (0..125).map(|_| random.node(&model)).collect();
            let cube =
                Cube::new(Contract::default(), model, FitRecord::default(), 5, nodes).unwrap();
            let table = cube.lookup_table();
            for _ in 0..2000 {
                let rgb = [(); 3].map(|()| to_single(random.unit()));
                let blend = table.lookup(rgb).unwrap();
                let mixture =
                    cube.lookup(LinearRgb(rgb.map(f64::from)), Interpolation::Blend).unwrap();
                let nm = [(); 8].map(|()| to_single(random.between(290.0, 840.0)));
                let eight = blend.reflectance8(nm);
                let four = blend.reflectance4([nm[0], nm[1], nm[2], nm[3]]);
                for k in 0..8 {
                    let close = |a: f32, b: f64, limit: f64| {
                        assert!((f64::from(a) - b).abs() < limit, "{a} {b} {blend:?} {nm:?}");
                    };
                    let (at, out) = (f64::from(nm[k]), f64::from(nm[(k + 1) % 8]));
                    let expected = mixture.reflectance(at);
                    close(eight[k], expected, SINGLE);
                    close(four[k % 4], mixture.reflectance(f64::from(nm[k % 4])), SINGLE);
                    close(blend.reflectance(nm[k]), expected, SINGLE);
                    close(blend.albedo(nm[k]), mixture.albedo(at), SINGLE);
                    let moved = blend.reradiation_per_nm(nm[k], nm[(k + 1) % 8]);
                    close(moved, mixture.reradiation_per_nm(at, out), SINGLE_PER_NM);
                }
                assert_eq!(blend.is_fluorescent(), mixture.is_fluorescent());
            }
        }
    }

    #[test]
    fn the_widest_vectors_answer_what_the_plain_ones_answer() {
        // Wide ones round a product and a sum once, plain ones twice: a few units in the last
        // place of numbers near 10 under the root.
        const FUSED: f32 = 4e-6;
        for (seed, model) in (0..).zip(models()) {
            let mut random = Random::new(seed);
            let nodes = (0..27).map(|_| random.node(&model)).collect();
            let cube =
                Cube::new(Contract::default(), model, FitRecord::default(), 3, nodes).unwrap();
            let (wide, mut plain) = (cube.lookup_table(), cube.lookup_table());
            plain.model.simd_level = Level::baseline();
            for _ in 0..2000 {
                let rgb = [(); 3].map(|()| to_single(random.unit()));
                let nm = [(); 8].map(|()| to_single(random.between(290.0, 840.0)));
                let [wide, plain] = [&wide, &plain].map(|table| {
                    let blend = table.lookup(rgb).unwrap();
                    let [a, b, c, d] = blend.reflectance4([nm[0], nm[2], nm[4], nm[6]]);
                    let [e, f, g, h, i, j, k, l] = blend.reflectance8(nm);
                    [a, b, c, d, e, f, g, h, i, j, k, l]
                });
                for (wide, plain) in wide.into_iter().zip(plain) {
                    assert!((wide - plain).abs() < FUSED, "{wide} {plain}");
                }
            }
        }
    }

    #[test]
    fn edges_far_from_all_light_are_restated_near_it() {
        // Single precision of numbers near 10 under the root.
        const SINGLE: f64 = 1e-5;
        for edge_nm in [-3e5_f32, 1.5e5, 2e6] {
            let edge = Edge { edge_nm: edge_nm.into(), level: 1.0, slope_per_nm: 1e-6 };
            let node = crate::Node::new(edge, crate::Fluorescence::None, 0.0);
            let model = Model::Reflectance;
            let cube =
                Cube::new(Contract::default(), model, FitRecord::default(), 2, vec![node; 8]);
            let table = cube.unwrap().lookup_table();
            let blend = table.lookup([0.5; 3]).unwrap();
            for nm in [300.0, 550.0, 830.0_f32] {
                let error = f64::from(blend.reflectance(nm)) - node.edge().at(nm.into());
                assert!(error.abs() < SINGLE, "{edge_nm} {nm} {error}");
            }
        }
    }

    #[test]
    fn reflectances_are_fractions_for_the_strangest_nodes_and_wavelengths() {
        let strange = [0.0, 1e-30, 1e30, -1e30, f32::MAX, f32::MIN, 550.0, 0.01];
        let mut random = Random::new(3);
        let nodes = (0..64).map(|_| {
            let mut pick = || strange[random.below(8)];
            crate::Node { reflectance: [pick(), pick(), pick()], ..crate::Node::default() }
        });
        // Stranger than a cube accepts: packed nodes stay finite by themselves.
        let model = Model::Reflectance;
        let nodes = nodes.map(|node| PackedNode::new(&node, &model)).collect();
        let table = LookupTable { model: PackedModel::new(&model), resolution: 4, nodes };
        for _ in 0..1000 {
            let rgb = [(); 3].map(|()| to_single(random.unit()));
            let blend = table.lookup(rgb).unwrap();
            let eight =
                blend.reflectance8([-1e30, 0.0, 300.0, 450.0, 550.0, 830.0, 1e30, f32::NAN]);
            let [seven @ .., last] = eight;
            for r in blend.reflectance4([300.0, 450.0, 550.0, 830.0]).into_iter().chain(seven) {
                assert!((0.0..=1.0).contains(&r), "{r} {blend:?}");
            }
            assert!(last.is_nan());
        }
    }
}
