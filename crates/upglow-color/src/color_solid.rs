//! The convex set of colors that materials of one kind can have under one light.

use crate::colorimetry::Colorimetry;
use crate::metric::Metric;
use crate::values::Xyz;

/// The set of colors of all reflectances, or of all fluorescent materials, under one light.
///
/// The set is convex, and defined by its support function: for each direction, the color furthest in
/// that direction. It belongs to a material that reflects or re-radiates all or nothing of each band.
#[derive(Clone, Debug)]
#[must_use]
pub struct ColorSolid {
    colorimetry: Colorimetry,
    /// From the red end.
    bands: Vec<Band>,
    /// Color of one emitted photon at each wavelength of the grid, from the red end; empty for
    /// reflectances.
    emitted: Vec<[f64; 3]>,
}

/// One band of incident light.
#[derive(Clone, Copy, Debug)]
struct Band {
    /// Number of photons, relative.
    photons: f64,
    /// Color of one that is reflected.
    reflected: [f64; 3],
    /// How many of [`ColorSolid::emitted`] have at least the wavelength of this band.
    longer: usize,
}

/// The point of a [`ColorSolid`] nearest to a color.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Nearest {
    /// The nearest color of the solid by Euclidean distance in XYZ; for a color inside, the color itself.
    pub color: Xyz,
    /// Euclidean distance to it in XYZ; 0 for a color inside.
    pub distance: f64,
    /// ΔE00 to it; 0 for a color inside. Another color on the surface may be nearer in ΔE00.
    pub de2000: f64,
}

impl Nearest {
    /// The result for a color inside.
    pub(crate) fn itself(color: Xyz) -> Self {
        Self { color, distance: 0.0, de2000: 0.0 }
    }
}

/// Colors closer than this in XYZ count as inside. Larger hides real gaps (one ΔE00 is about 1e-3
/// near white); smaller makes white, which is a corner of the solid, unreachable because of rounding.
const ON_THE_SURFACE: f64 = 1e-9;

/// The search stops at this relative difference between the distance found and the lower bound that
/// the support function proves.
const RELATIVE_GAP: f64 = 1e-9;

/// Ends searches that rounding would keep going; they take 10 to 40 steps.
const STEP_LIMIT: usize = 500;

impl ColorSolid {
    /// The colors of all reflectances 0 ≤ r(λ) ≤ 1: the solid of `macadam`.
    ///
    /// # Source
    ///
    /// `macadam`; as a support function, h(n) = Σ max(0, n·wᵢ).
    pub fn reflectance(colorimetry: &Colorimetry) -> Self {
        Self::new(colorimetry, false)
    }

    /// The colors of all ideal fluorescent materials: each incident photon leaves as at most one
    /// photon, in its own band or at any longer wavelength.
    ///
    /// Light moved from λi to λo keeps the share λi/λo of its energy:
    /// h(n) = Σ E(λi) · max(0, max over λo ≥ λi of (λi/λo) n·x̄ȳz̄(λo)).
    pub fn fluorescence(colorimetry: &Colorimetry) -> Self {
        Self::new(colorimetry, true)
    }

    fn new(colorimetry: &Colorimetry, fluorescent: bool) -> Self {
        let photon = |nm: f64, matching: &[f64; 3]| matching.map(|m| m / nm);
        let outgoing_nm: Vec<f64> = match fluorescent {
            true => colorimetry.grid().wavelengths_nm().rev().collect(),
            false => Vec::new(),
        };
        let matching = colorimetry.matching().iter().rev();
        let emitted = outgoing_nm.iter().zip(matching).map(|(&nm, m)| photon(nm, m)).collect();
        let incident = colorimetry.irradiance().iter().zip(colorimetry.seen());
        let bands = colorimetry.wavelengths_nm().iter().zip(incident).rev();
        let band = |(&nm, (&irradiance, seen))| Band {
            photons: irradiance * nm,
            reflected: photon(nm, seen),
            longer: outgoing_nm.partition_point(|outgoing| *outgoing >= nm),
        };
        Self { colorimetry: colorimetry.clone(), bands: bands.map(band).collect(), emitted }
    }

    /// The color of the solid that lies furthest in direction `n`.
    pub fn support(&self, n: [f64; 3]) -> Xyz {
        let better = |a, b| if dot(n, a) > dot(n, b) { a } else { b };
        let mut sum = Xyz::default();
        let (mut seen, mut emitted) = (0, [0.0; 3]);
        for band in &self.bands {
            for photon in &self.emitted[seen..band.longer] {
                emitted = better(*photon, emitted);
            }
            seen = band.longer;
            sum += band.photons * Xyz(better(band.reflected, emitted));
        }
        sum
    }

    /// Whether some material of this kind has this color.
    pub fn contains(&self, color: Xyz) -> bool {
        self.search(color, false).is_none()
    }

    /// The nearest color that some material of this kind has.
    pub fn nearest(&self, color: Xyz) -> Nearest {
        self.search(color, true).map_or(Nearest::itself(color), |offset| {
            let distance = dot(offset, offset).sqrt();
            let nearest = color + offset.into();
            let de2000 = Metric::De2000.distance(&self.colorimetry, color, nearest);
            Nearest { color: nearest, distance, de2000 }
        })
    }

    /// The vector from `color` to the nearest point of the solid, or, unless `is_nearest` is needed,
    /// to some point that proves `color` outside; `None` if it is inside or on the surface.
    ///
    /// Each step adds the support point in the direction of `color` to a simplex, and keeps the
    /// corners of the face that the point nearest to `color` lies in.
    ///
    /// # Source
    ///
    /// `gilbert`; the nearest point of a simplex by trying all its faces, which is exact for up to
    /// four corners.
    fn search(&self, color: Xyz, is_nearest: bool) -> Option<[f64; 3]> {
        let relative = |p: Xyz| (p - color).0;
        let mut nearest = relative(self.support([1.0; 3]));
        let mut simplex = Simplex::from_iter([nearest]);
        for _ in 0..STEP_LIMIT {
            let square = dot(nearest, nearest);
            if square <= ON_THE_SURFACE * ON_THE_SURFACE {
                break;
            }
            let next = relative(self.support(nearest.map(|v| -v)));
            let bound = dot(nearest, next);
            if square - bound <= RELATIVE_GAP * square || (!is_nearest && bound > 0.0) {
                break;
            }
            simplex.push(next);
            let (point, corners) = nearest_of_simplex(&simplex);
            if dot(point, point) >= square {
                break;
            }
            (nearest, simplex) = (point, corners);
        }
        if dot(nearest, nearest).sqrt() <= ON_THE_SURFACE { None } else { Some(nearest) }
    }
}

/// Most corners of a face: in three dimensions the nearest point of more corners lies in a face of
/// fewer.
const FACE: usize = 4;

/// The corners of a simplex or of a face, without allocation: a search tries dozens of faces.
#[derive(Clone, Copy, Debug)]
struct Simplex {
    points: [[f64; 3]; FACE + 1],
    count: usize,
}

impl Simplex {
    fn push(&mut self, point: [f64; 3]) {
        self.points[self.count] = point;
        self.count += 1;
    }

    fn points(&self) -> &[[f64; 3]] {
        &self.points[..self.count]
    }

    /// The corners whose bits are set.
    fn face(&self, mask: u32) -> Self {
        let numbered = self.points().iter().enumerate();
        numbered.filter(|(i, _)| mask >> i & 1 == 1).map(|(_, point)| *point).collect()
    }
}

impl FromIterator<[f64; 3]> for Simplex {
    fn from_iter<I: IntoIterator<Item = [f64; 3]>>(points: I) -> Self {
        let mut corners = Self { points: [[0.0; 3]; FACE + 1], count: 0 };
        points.into_iter().for_each(|point| corners.push(point));
        corners
    }
}

/// The point of the convex hull of some points nearest to the origin, and the corners of the face it
/// lies in, which the last point is one of: the others alone were known not to be nearer.
fn nearest_of_simplex(corners: &Simplex) -> ([f64; 3], Simplex) {
    let last = 1_u32 << (corners.count - 1);
    let masks = (last..2 * last).filter(|mask| mask.count_ones() as usize <= FACE);
    let (point, mask) = masks
        .filter_map(|mask| Some((nearest_of_plane(corners.face(mask).points())?, mask)))
        .min_by(|(p, _), (q, _)| dot(*p, *p).total_cmp(&dot(*q, *q)))
        .expect("the last corner is a face that holds its own nearest point");
    (point, corners.face(mask))
}

/// The point of the plane through a face nearest to the origin; `None` if it is outside the face or
/// the face is degenerate.
fn nearest_of_plane(face: &[[f64; 3]]) -> Option<[f64; 3]> {
    let edges: Simplex = face[1..].iter().map(|p| sub(*p, face[0])).collect();
    let edges = edges.points();
    let weights = solve_gram(edges, face[0])?;
    let weights = &weights[..edges.len()];
    let first = 1.0 - weights.iter().sum::<f64>();
    if first < 0.0 || weights.iter().any(|&w| w < 0.0) {
        return None;
    }
    let moved =
        |k: usize| face[0][k] + edges.iter().zip(weights).map(|(e, w)| w * e[k]).sum::<f64>();
    Some([0, 1, 2].map(moved))
}

/// Weights uⱼ with eᵢ · (origin + Σ uⱼ eⱼ) = 0 for all edges eᵢ, at most three; `None` for
/// dependent edges.
fn solve_gram(edges: &[[f64; 3]], origin: [f64; 3]) -> Option<[f64; FACE - 1]> {
    let n = edges.len();
    let mut rows = [[0.0; FACE]; FACE - 1];
    for (row, e) in rows.iter_mut().zip(edges) {
        row.iter_mut().zip(edges).for_each(|(v, f)| *v = dot(*e, *f));
        row[n] = -dot(*e, origin);
    }
    for pivot in 0..n {
        let pivot_row = rows[pivot];
        let diagonal = pivot_row[pivot];
        // Below this share of the edge's squared length only rounding is left.
        if diagonal <= 1e-14 * dot(edges[pivot], edges[pivot]) {
            return None;
        }
        for (_, row) in rows[..n].iter_mut().enumerate().filter(|(r, _)| *r != pivot) {
            let factor = row[pivot] / diagonal;
            row.iter_mut().zip(&pivot_row).for_each(|(v, p)| *v -= factor * p);
        }
    }
    let mut weights = [0.0; FACE - 1];
    (0..n).for_each(|i| weights[i] = rows[i][n] / rows[i][i]);
    Some(weights)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contract::Contract;
    use crate::grid::Grid;
    use crate::values::LinearRgb;
    use proptest::prelude::*;

    fn solids() -> (Colorimetry, ColorSolid, ColorSolid) {
        let colorimetry = Contract::default().on(Grid::FIT);
        let (r, f) =
            (ColorSolid::reflectance(&colorimetry), ColorSolid::fluorescence(&colorimetry));
        (colorimetry, r, f)
    }

    #[test]
    fn white_black_and_gray_are_reflectances() {
        let (colorimetry, reflectance, _) = solids();
        for v in [0.0, 0.3, 1.0] {
            assert!(reflectance.contains(colorimetry.xyz_from_rgb(LinearRgb([v; 3]))), "{v}");
        }
        assert!(!reflectance.contains(colorimetry.xyz_from_rgb(LinearRgb([1.001; 3]))));
    }

    #[test]
    fn pure_green_is_unreachable_at_a_distance() {
        let (colorimetry, reflectance, fluorescence) = solids();
        let green = colorimetry.xyz_from_rgb(LinearRgb([0.0, 1.0, 0.0]));
        let (r, f) = (reflectance.nearest(green), fluorescence.nearest(green));
        assert!(r.distance > f.distance && f.distance > 1e-3, "{r:?} {f:?}");
        assert!(fluorescence.contains(f.color) || fluorescence.nearest(f.color).distance < 1e-7);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn a_sampled_reflectance_is_inside_and_beyond_the_support_is_outside(
            samples in prop::collection::vec(0.0..1.0, Grid::FIT.len()),
            n in prop::array::uniform3(-1.0..1.0),
        ) {
            prop_assume!(dot(n, n) > 0.01);
            let (colorimetry, reflectance, fluorescence) = solids();
            let color = colorimetry.xyz_from_reflectance(samples);
            prop_assert!(reflectance.contains(color) && fluorescence.contains(color));
            for solid in [&reflectance, &fluorescence] {
                let edge = solid.support(n);
                let beyond = edge + 0.01 * Xyz(n);
                prop_assert!(!solid.contains(beyond));
                let nearest = solid.nearest(beyond);
                // The support point is at this distance; the plane through it proves that none is nearer.
                prop_assert!(nearest.distance <= 0.01 * dot(n, n).sqrt() + 1e-9);
                prop_assert!((nearest.distance - 0.01 * dot(n, n).sqrt()).abs() < 1e-6);
            }
        }
    }
}
