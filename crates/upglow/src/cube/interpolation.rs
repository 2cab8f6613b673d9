//! How colors between the nodes of a cube are interpolated.

use upglow_color::{LinearRgb, choices};

use crate::material::Material;
use crate::material::features::Features;
use crate::material::sigmoid::Sigmoid;

/// How a color between nodes gets its material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// The four materials at the corners of the color's tetrahedron, mixed by weight. Where the
    /// corners match their colors, so does every point between them.
    #[default]
    Blend,
    /// The material of the nearest node.
    None,
    /// One reflectance from mixed coefficients c0, c1, c2.
    Coefficients,
    /// One reflectance from mixed shift, width and slope; coefficients where a corner is flat.
    Features,
    /// Features, but coefficients where the slopes of the corners differ in sign.
    Hybrid,
}

choices!(
    Interpolation,
    "interpolation",
    Blend = "blend",
    None = "none",
    Coefficients = "coefficients",
    Features = "features",
    Hybrid = "hybrid"
);

impl Interpolation {
    /// The materials to mix, from the corners' materials and weights.
    ///
    /// All but `Blend` and `None` replace the corners' reflectances by one and leave their
    /// fluorescence: a mixture with the dyes of all corners.
    pub(crate) fn parts(self, corners: [(f64, Material); 4]) -> [(f64, Material); 4] {
        let reflectance = match self {
            Self::Blend => return corners,
            Self::None => return nearest(corners),
            Self::Coefficients => coefficients(&corners),
            Self::Features => features(&corners).unwrap_or_else(|| coefficients(&corners)),
            Self::Hybrid if signs_differ(&corners) => coefficients(&corners),
            Self::Hybrid => features(&corners).unwrap_or_else(|| coefficients(&corners)),
        };
        corners.map(|(weight, material)| (weight, Material { reflectance, ..material }))
    }
}

type Weighted = [(f64, Material); 4];

fn nearest(mut corners: Weighted) -> Weighted {
    let heaviest = (1..4).fold(0, |best, i| if corners[i].0 > corners[best].0 { i } else { best });
    for (i, (weight, _)) in corners.iter_mut().enumerate() {
        *weight = if i == heaviest { 1.0 } else { 0.0 };
    }
    corners
}

fn coefficients(corners: &Weighted) -> Sigmoid {
    let mix = |of: fn(&Sigmoid) -> f64| corners.iter().map(|(w, m)| w * of(&m.reflectance)).sum();
    Sigmoid { c0: mix(|r| r.c0), c1: mix(|r| r.c1), c2: mix(|r| r.c2) }
}

/// `None` where a corner that takes part is flat or straight, or the mean slope is zero.
fn features(corners: &Weighted) -> Option<Sigmoid> {
    let mut mean = Features { shift_nm: 0.0, width_nm: 0.0, slope_per_nm: 0.0 };
    for (weight, material) in corners.iter().filter(|(weight, _)| *weight > 0.0) {
        let corner = material.reflectance.to_vertex()?.to_features()?;
        mean.shift_nm += weight * corner.shift_nm;
        mean.width_nm += weight * corner.width_nm;
        mean.slope_per_nm += weight * corner.slope_per_nm;
    }
    mean.to_sigmoid().ok()
}

fn signs_differ(corners: &Weighted) -> bool {
    let signs = || corners.iter().filter(|(w, _)| *w > 0.0).map(|(_, m)| m.reflectance.c0);
    signs().any(|c0| c0 > 0.0) && signs().any(|c0| c0 < 0.0)
}

/// The nodes `[blue, green, red]` and weights of the tetrahedron that holds a color.
///
/// Each cell of the grid is cut into six tetrahedra around its diagonal from dark to bright, so
/// that grays are mixtures of grays. `rgb` must be in 0..=1.
pub(crate) fn tetrahedron(resolution: usize, rgb: LinearRgb) -> [([usize; 3], f64); 4] {
    let last = (resolution - 1) as f64;
    let corner = cell(resolution, rgb);
    let mut fraction = [0.0; 3];
    for k in 0..3 {
        fraction[k] = rgb.0[k] * last - corner[k] as f64;
    }
    // From the dark corner one axis at a time, the largest fraction first. Ranks replace
    // branches, because processors cannot predict the order of an image's channels.
    let [r, g, b] = fraction;
    let rank = [
        usize::from(g > r) + usize::from(b > r),
        usize::from(r >= g) + usize::from(b > g),
        usize::from(r >= b) + usize::from(g >= b),
    ];
    let mut sorted = [0.0; 3];
    for k in 0..3 {
        sorted[rank[k]] = fraction[k];
    }
    let node = |step: usize| [2, 1, 0].map(|k| corner[k] + usize::from(rank[k] < step));
    [
        (node(0), 1.0 - sorted[0]),
        (node(1), sorted[0] - sorted[1]),
        (node(2), sorted[1] - sorted[2]),
        (node(3), sorted[2]),
    ]
}

/// The red, green and blue index of the darkest node of the cell that holds a color.
#[inline]
pub(crate) fn cell(resolution: usize, rgb: LinearRgb) -> [usize; 3] {
    let last = (resolution - 1) as f64;
    rgb.0.map(|value| lower_node(value * last, resolution))
}

/// The node at or below a position in 0..=resolution − 1, and at most the last but one.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the position is at least 0 and its fraction is meant to go"
)]
fn lower_node(position: f64, resolution: usize) -> usize {
    (position as usize).min(resolution - 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_tetrahedron_holds_its_color(
            rgb in prop::array::uniform3(0.0..=1.0),
            resolution in 2_usize..70,
        ) {
            let corners = tetrahedron(resolution, LinearRgb(rgb));
            let total: f64 = corners.iter().map(|(_, w)| w).sum();
            // Rounding only, of positions up to 70.
            prop_assert!((total - 1.0).abs() < 1e-12);
            for (axis, value) in rgb.iter().enumerate() {
                let last = (resolution - 1) as f64;
                let sum: f64 = corners.iter().map(|(n, w)| w * n[2 - axis] as f64 / last).sum();
                prop_assert!((sum - value).abs() < 1e-12);
            }
            for (node, weight) in corners {
                prop_assert!(weight >= 0.0 && node.iter().all(|&n| n < resolution));
            }
        }

        #[test]
        fn grays_are_mixtures_of_grays(v in 0.0..=1.0) {
            for (node, weight) in tetrahedron(32, LinearRgb([v; 3])) {
                prop_assert!(weight == 0.0 || (node[0] == node[1] && node[1] == node[2]));
            }
        }
    }

    #[test]
    fn names_round_trip() {
        for name in ["blend", "none", "coefficients", "features", "hybrid"] {
            assert_eq!(name.parse::<Interpolation>().unwrap().to_string(), name);
        }
    }

    #[test]
    fn hybrid_is_features_for_like_slopes_and_coefficients_for_unlike() {
        let with = |slope_per_nm: f64, shift_nm: f64| {
            let features = Features { shift_nm, width_nm: 60.0, slope_per_nm };
            (0.25, Material::passive(features.to_sigmoid().unwrap()))
        };
        let like = [with(0.01, 500.0), with(0.008, 540.0), with(0.01, 520.0), with(0.002, 530.0)];
        let unlike = [with(0.01, 500.0), with(-0.008, 540.0), with(0.01, 520.0), with(0.01, 530.0)];
        assert_eq!(Interpolation::Hybrid.parts(like), Interpolation::Features.parts(like));
        assert_eq!(Interpolation::Hybrid.parts(unlike), Interpolation::Coefficients.parts(unlike));
        let shift = Interpolation::Features.parts(like)[0].1.reflectance.to_vertex().unwrap();
        assert!((shift.shift_nm - 522.5).abs() < 1e-9);
    }
}
