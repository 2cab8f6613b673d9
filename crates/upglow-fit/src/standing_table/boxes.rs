//! A lattice of boxes over a cube of RGB; corners and boxes are examined when they are first needed.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};

use upglow_color::rounding::{to_single, whole};
use upglow_color::{
    ColorSolid, ColorSolids, Colorimetry, Contract, Grid, LinearRgb, Metric, StandingKind, Xyz,
};

/// The colors that materials reach under one contract.
#[derive(Debug)]
pub(super) struct Reach {
    pub(super) colorimetry: Colorimetry,
    pub(super) solids: ColorSolids,
    /// Half of white, deep inside both solids.
    middle: Xyz,
}

#[derive(Debug)]
pub(super) struct BoxLattice {
    origin: [f64; 3],
    /// From one corner to the next, of either sign.
    step: [f64; 3],
    /// Boxes along an axis.
    boxes: usize,
    /// How often boxes were divided to make this lattice.
    depth: u32,
    /// Of both solids, `[blue][green][red]`.
    corners: Vec<OnceLock<[Offset; 2]>>,
    /// `[blue][green][red]`.
    cells: Vec<OnceLock<Cell>>,
}

/// What is known about the colors in a box.
#[derive(Debug)]
pub(super) enum Cell {
    /// All are of this kind.
    Settled(StandingKind),
    /// The kind of some of its parts may be known.
    Divided(Box<BoxLattice>),
    /// Each color needs a search, until the box is worth dividing.
    Mixed(Box<Mixed>),
}

/// A box that a surface passes through.
#[derive(Debug, Default)]
pub(super) struct Mixed {
    /// Planes that touch each solid near the box: what is beyond one needs no search.
    planes: OnceLock<[Vec<Plane>; 2]>,
    searches: AtomicU32,
    parts: OnceLock<BoxLattice>,
}

/// Indices of the solids in the offsets of a corner.
pub(super) const REFLECTANCE: usize = 0;
pub(super) const FLUORESCENCE: usize = 1;

/// How far a point is from a solid, and in what direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Offset {
    /// 0 only well inside.
    distance: f32,
    de2000: f32,
    /// Unit vector from the nearest point of the solid; 0 well inside.
    normal: [f32; 3],
}

const INSIDE: Offset = Offset { distance: 0.0, de2000: 0.0, normal: [0.0; 3] };

/// Boxes along each axis of the first lattice. More cost searches for boxes that most pictures do not
/// use; fewer send more colors to divided boxes.
const COARSE: usize = 32;

/// Parts along each axis of a divided box. More take memory along the whole surface (4 KB per box at 4,
/// eight times that at 8); fewer take more steps.
const PARTS: usize = 4;

/// A box this deep, 1/128 of the lattice, is divided only after [`OFTEN`] searches. Estimates do not use
/// such divisions, as they must not depend on earlier colors, and boxes so small are fine enough.
const FINE: u32 = 1;

/// Searches that cost as much as dividing a box. Fewer divides boxes that are not needed again; more
/// repeats searches for colors that fill half a picture.
const OFTEN: u32 = 64;

/// Boxes this deep, 1/8192, are not divided: some box always has the surface in it.
const DEEPEST: u32 = 4;

impl BoxLattice {
    /// The cube from black to ±2^`exponent`; the bits of `octant` are the signs, red the lowest.
    pub(super) fn around_black(exponent: i64, octant: usize) -> Self {
        let side = f64::from(i32::try_from(exponent).expect("it is a few bits")).exp2();
        let step = side / COARSE as f64;
        let signed = [0, 1, 2].map(|k| if octant >> k & 1 == 1 { -step } else { step });
        Self::new([0.0; 3], signed, COARSE, 0)
    }

    fn new(origin: [f64; 3], step: [f64; 3], boxes: usize, depth: u32) -> Self {
        let corners = std::iter::repeat_with(OnceLock::new).take((boxes + 1).pow(3)).collect();
        let cells = std::iter::repeat_with(OnceLock::new).take(boxes.pow(3)).collect();
        Self { origin, step, boxes, depth, corners, cells }
    }

    /// The box around `rgb`, which must be in the lattice.
    pub(super) fn cell(&self, rgb: LinearRgb, reach: &Reach) -> &Cell {
        let at = self.position(rgb).map(|(index, _)| index);
        let [r, g, b] = at;
        let index = (b * self.boxes + g) * self.boxes + r;
        self.cells[index].get_or_init(|| self.settle(at, reach))
    }

    /// Distance and ΔE00 from a solid, interpolated between the corners of a box that
    /// [`BoxLattice::cell`] has examined.
    ///
    /// The distance from a convex set is a convex function, so it is never underestimated.
    pub(super) fn interpolate(&self, rgb: LinearRgb, solid: usize) -> [f64; 2] {
        let position = self.position(rgb);
        let mut sum = [0.0; 2];
        for corner in 0..8 {
            let side = |k: usize| corner >> k & 1;
            let share = |k: usize| [1.0 - position[k].1, position[k].1][side(k)];
            let weight = share(0) * share(1) * share(2);
            let at = [0, 1, 2].map(|k| position[k].0 + side(k));
            let corner = self.corners[self.corner_index(at)].get();
            let found = corner.expect("a box is examined by its corners")[solid];
            sum[0] += weight * f64::from(found.distance);
            sum[1] += weight * f64::from(found.de2000);
        }
        sum
    }

    /// For each axis the index of the box and the position in it, 0..=1.
    fn position(&self, rgb: LinearRgb) -> [(usize, f64); 3] {
        [0, 1, 2].map(|k| {
            let position = (rgb.0[k] - self.origin[k]) / self.step[k];
            let index = whole(position).min(self.boxes - 1);
            (index, position - index as f64)
        })
    }

    fn settle(&self, at: [usize; 3], reach: &Reach) -> Cell {
        let at_corners = corners(at);
        let corners = at_corners.map(|at| {
            *self.corners[self.corner_index(at)].get_or_init(|| reach.offsets(self.rgb(at)))
        });
        let points = at_corners.map(|at| reach.colorimetry.xyz_from_rgb(self.rgb(at)));
        let is_inside = |solid: usize| corners.iter().all(|corner| corner[solid].distance == 0.0);
        let is_outside = |solid: usize| {
            corners.iter().all(|corner| corner[solid].distance > 0.0)
                && corners.iter().any(|corner| {
                    let normal = corner[solid].normal.map(f64::from);
                    Plane::at(reach.solid(solid), normal).separates(&points)
                })
        };
        if is_inside(REFLECTANCE) {
            Cell::Settled(StandingKind::Reflectance)
        } else if is_outside(FLUORESCENCE) {
            Cell::Settled(StandingKind::Unreachable)
        } else if is_outside(REFLECTANCE) && is_inside(FLUORESCENCE) {
            Cell::Settled(StandingKind::NeedsFluorescence)
        } else if self.depth >= FINE {
            Cell::Mixed(Box::default())
        } else {
            Cell::Divided(Box::new(self.parts(at)))
        }
    }

    /// A lattice over one box.
    fn parts(&self, at: [usize; 3]) -> Self {
        let step = self.step.map(|s| s / PARTS as f64);
        Self::new(self.rgb(at).0, step, PARTS, self.depth + 1)
    }

    /// The kind of a color in a box that a surface passes through.
    pub(super) fn kind_in(&self, mixed: &Mixed, rgb: LinearRgb, reach: &Reach) -> StandingKind {
        let at = self.position(rgb).map(|(index, _)| index);
        let color = reach.colorimetry.xyz_from_rgb(rgb);
        let planes = mixed.planes.get_or_init(|| self.planes(at, reach));
        let is_beyond = |solid: usize| planes[solid].iter().any(|p| p.separates(&[color]));
        if is_beyond(FLUORESCENCE) {
            return StandingKind::Unreachable;
        }
        let is_glowing = is_beyond(REFLECTANCE);
        // Without a plane no corner is beyond what fluoresces, so nothing in the box is.
        if is_glowing && planes[FLUORESCENCE].is_empty() {
            return StandingKind::NeedsFluorescence;
        }
        let searches = mixed.searches.fetch_add(1, Ordering::Relaxed);
        if self.depth >= DEEPEST || (searches < OFTEN && mixed.parts.get().is_none()) {
            return match is_glowing {
                true => reach.kind_beyond_reflectance(color),
                false => reach.solids.kind(color),
            };
        }
        let parts = mixed.parts.get_or_init(|| self.parts(at));
        match parts.cell(rgb, reach) {
            Cell::Settled(kind) => *kind,
            Cell::Divided(_) => unreachable!("boxes this small are only divided after searches"),
            Cell::Mixed(mixed) => parts.kind_in(mixed, rgb, reach),
        }
    }

    /// Planes that touch each solid, in the directions of the corners outside of it.
    fn planes(&self, at: [usize; 3], reach: &Reach) -> [Vec<Plane>; 2] {
        [REFLECTANCE, FLUORESCENCE].map(|solid| {
            let offsets = corners(at).map(|at| {
                let corner = self.corners[self.corner_index(at)].get();
                corner.expect("a box is examined by its corners")[solid]
            });
            let outside = offsets.into_iter().filter(|offset| offset.distance > 0.0);
            outside
                .map(|offset| Plane::at(reach.solid(solid), offset.normal.map(f64::from)))
                .collect()
        })
    }

    fn corner_index(&self, [r, g, b]: [usize; 3]) -> usize {
        (b * (self.boxes + 1) + g) * (self.boxes + 1) + r
    }

    fn rgb(&self, at: [usize; 3]) -> LinearRgb {
        LinearRgb([0, 1, 2].map(|k| self.origin[k] + at[k] as f64 * self.step[k]))
    }
}

/// A point is well inside if it still is when it moves away from the middle by this share. It must
/// keep proofs far from the 1e-9 in XYZ at which a search stops, or results could differ from those of
/// the search; larger only takes more searches, and overestimates distances by as much.
const WELL_INSIDE: f64 = 1e-6;

/// A box is well outside if a plane separates it from the solid by this much in XYZ; for the same
/// reason.
const WELL_OUTSIDE: f64 = 1e-7;

impl Reach {
    pub(super) fn new(contract: &Contract) -> Self {
        let colorimetry = contract.on(Grid::FIT);
        let solids = ColorSolids::new(&colorimetry);
        let middle = colorimetry.white() / 2.0;
        Self { colorimetry, solids, middle }
    }

    /// The kind of material that `rgb` needs, by search.
    pub(super) fn kind(&self, rgb: LinearRgb) -> StandingKind {
        self.solids.kind(self.colorimetry.xyz_from_rgb(rgb))
    }

    /// The kind of a color that no reflectance reaches, by search.
    fn kind_beyond_reflectance(&self, color: Xyz) -> StandingKind {
        match self.solids.fluorescence.contains(color) {
            true => StandingKind::NeedsFluorescence,
            false => StandingKind::Unreachable,
        }
    }

    fn solid(&self, index: usize) -> &ColorSolid {
        [&self.solids.reflectance, &self.solids.fluorescence][index]
    }

    fn offsets(&self, rgb: LinearRgb) -> [Offset; 2] {
        let color = self.colorimetry.xyz_from_rgb(rgb);
        let reflectance = self.offset(color, REFLECTANCE);
        // The solid of all materials contains that of reflectances.
        let is_inside = reflectance.distance == 0.0;
        [reflectance, if is_inside { INSIDE } else { self.offset(color, FLUORESCENCE) }]
    }

    fn offset(&self, color: Xyz, solid: usize) -> Offset {
        // Further from the middle, so not nearer to the solid than the color itself.
        let further = color + WELL_INSIDE * (color - self.middle);
        let nearest = self.solid(solid).nearest(further);
        if nearest.distance == 0.0 {
            return INSIDE;
        }
        let de2000 = Metric::De2000.distance(&self.colorimetry, color, nearest.color);
        let normal = (further - nearest.color) / nearest.distance;
        Offset {
            distance: rounded_up(nearest.distance),
            de2000: rounded_up(de2000),
            normal: normal.0.map(rounded_up),
        }
    }
}

/// Where the eight corners of a box are.
fn corners(at: [usize; 3]) -> [[usize; 3]; 8] {
    std::array::from_fn(|corner| [0, 1, 2].map(|k| at[k] + (corner >> k & 1)))
}

/// A plane that touches a solid.
#[derive(Clone, Copy, Debug)]
struct Plane {
    /// Of about unit length, away from the solid.
    normal: [f64; 3],
    /// Of the solid, along the normal.
    height: f64,
}

impl Plane {
    fn at(solid: &ColorSolid, normal: [f64; 3]) -> Self {
        let plane = Self { normal, height: 0.0 };
        Self { height: plane.over(solid.support(normal)), ..plane }
    }

    /// Whether it separates all `points` from its solid.
    fn separates(&self, points: &[Xyz]) -> bool {
        points.iter().all(|&point| self.over(point) > WELL_OUTSIDE)
    }

    fn over(&self, point: Xyz) -> f64 {
        (0..3).map(|k| self.normal[k] * point.0[k]).sum::<f64>() - self.height
    }
}

/// Single precision, not below the value.
fn rounded_up(value: f64) -> f32 {
    let single = to_single(value);
    if f64::from(single) < value { single.next_up() } else { single }
}
