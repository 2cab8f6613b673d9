//! A lattice of boxes over a cube of RGB; corners and boxes are measured when they are asked for.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};

use upglow_color::rounding::{to_single, whole};
use upglow_color::{ColorSolid, LinearRgb, Metric, StandingKind, Xyz};

use super::reach::{Reach, Side, parted};

#[derive(Debug)]
pub(super) struct BoxLattice {
    origin: [f64; 3],
    /// From one corner to the next, of either sign.
    step: [f64; 3],
    /// Boxes along an axis.
    boxes: usize,
    /// How often boxes were divided to come here.
    depth: u32,
    /// `[blue][green][red]`.
    corners: Vec<OnceLock<Corner>>,
    /// `[blue][green][red]`.
    cells: Vec<OnceLock<Cell>>,
}

/// What is known of all colors in a box.
#[derive(Debug)]
pub(super) enum Cell {
    Settled(StandingKind),
    /// Some of its parts may be settled.
    Divided(Box<BoxLattice>),
    /// Each color needs its own search, or the box is worth dividing further.
    Mixed(Box<Mixed>),
}

/// A box that a surface passes through.
#[derive(Debug, Default)]
pub(super) struct Mixed {
    asked: AtomicU32,
    parts: OnceLock<BoxLattice>,
}

/// What is known at a corner of boxes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) reflectance: Offset,
    pub(super) fluorescence: Offset,
}

/// How far a point is from a solid, and in what direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Offset {
    /// 0 only well inside.
    distance: f32,
    de2000: f32,
    /// Direction from the nearest point of the solid; of no length well inside.
    normal: [f32; 3],
}

const INSIDE: Offset = Offset { distance: 0.0, de2000: 0.0, normal: [0.0; 3] };

/// Boxes along each axis of the first lattice. More cost a search each that most pictures never
/// use; fewer leave more colors to be looked for in divided boxes.
const COARSE: usize = 32;

/// Parts along each axis of a box that a surface passes through. More take memory for the whole
/// surface (4 KB a box at 4, eightfold at 8); fewer take more steps.
const PARTS: usize = 4;

/// A box this deep, 1/128 of the lattice, is divided further only once it was asked for
/// [`OFTEN`]: what is interpolated must not depend on what was asked before, and boxes so small
/// are fine enough for that.
const FINE: u32 = 1;

/// Searches in a box that cost as much as dividing it. Fewer divides boxes that are never asked
/// for again; more searches for colors that fill half a picture.
const OFTEN: u32 = 64;

/// No box is divided deeper, to 1/8192: there is always a color on the surface itself.
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

    /// The box around `rgb`, which must be in the cube.
    pub(super) fn cell(&self, rgb: LinearRgb, reach: &Reach) -> &Cell {
        let at = self.position(rgb).map(|(index, _)| index);
        let [r, g, b] = at;
        let index = (b * self.boxes + g) * self.boxes + r;
        self.cells[index].get_or_init(|| self.settle(at, reach))
    }

    /// Distance and ΔE00 between the corners of a box that [`BoxLattice::cell`] was asked for.
    ///
    /// The distance from a convex body is a convex function, so the distance is not understated.
    pub(super) fn interpolate(&self, rgb: LinearRgb, of: impl Fn(&Corner) -> Offset) -> [f64; 2] {
        let position = self.position(rgb);
        let mut sum = [0.0; 2];
        for corner in 0..8 {
            let side = |k: usize| corner >> k & 1;
            let share = |k: usize| [1.0 - position[k].1, position[k].1][side(k)];
            let weight = share(0) * share(1) * share(2);
            let at = [0, 1, 2].map(|k| position[k].0 + side(k));
            let corner = self.corners[self.corner_index(at)].get();
            let found = of(corner.expect("a box is settled by its corners"));
            sum[0] += weight * f64::from(found.distance);
            sum[1] += weight * f64::from(found.de2000);
        }
        sum
    }

    /// For each axis the number of the box and the place in it, 0..=1.
    fn position(&self, rgb: LinearRgb) -> [(usize, f64); 3] {
        [0, 1, 2].map(|k| {
            let position = (rgb.0[k] - self.origin[k]) / self.step[k];
            let index = whole(position).min(self.boxes - 1);
            (index, position - index as f64)
        })
    }

    fn settle(&self, at: [usize; 3], reach: &Reach) -> Cell {
        let corners = self.corners_of(at, reach);
        let mut points = box_corners(at).map(|at| reach.colorimetry.xyz_from_rgb(self.rgb(at)));
        let points = std::array::from_fn(|_| points.next().expect("a box has eight corners"));
        let side = |solid: &ColorSolid, of: fn(&Corner) -> Offset| {
            side_of(solid, &corners.map(|c| of(&c)), &points)
        };
        let reflectance = side(&reach.solids.reflectance, |c| c.reflectance);
        if reflectance == Side::Inside {
            return Cell::Settled(StandingKind::Reflectance);
        }
        match (reflectance, side(&reach.solids.fluorescence, |c| c.fluorescence)) {
            (_, Side::Outside) => Cell::Settled(StandingKind::Unreachable),
            (Side::Outside, Side::Inside) => Cell::Settled(StandingKind::NeedsFluorescence),
            _ => self.divide(at),
        }
    }

    fn divide(&self, at: [usize; 3]) -> Cell {
        if self.depth >= FINE {
            return Cell::Mixed(Box::default());
        }
        Cell::Divided(Box::new(self.parts(at)))
    }

    /// A lattice over one box.
    fn parts(&self, at: [usize; 3]) -> Self {
        let step = self.step.map(|s| s / PARTS as f64);
        Self::new(self.rgb(at).0, step, PARTS, self.depth + 1)
    }

    /// The kind of a color in a box that a surface passes through.
    pub(super) fn kind_in(&self, mixed: &Mixed, rgb: LinearRgb, reach: &Reach) -> StandingKind {
        let asked = mixed.asked.fetch_add(1, Ordering::Relaxed);
        if self.depth >= DEEPEST || (asked < OFTEN && mixed.parts.get().is_none()) {
            return reach.kind(rgb);
        }
        let at = self.position(rgb).map(|(index, _)| index);
        let parts = mixed.parts.get_or_init(|| self.parts(at));
        match parts.cell(rgb, reach) {
            Cell::Settled(kind) => *kind,
            Cell::Divided(_) => unreachable!("boxes this small are not divided at once"),
            Cell::Mixed(mixed) => parts.kind_in(mixed, rgb, reach),
        }
    }

    fn corners_of(&self, at: [usize; 3], reach: &Reach) -> [Corner; 8] {
        let mut all = box_corners(at).map(|at| {
            *self.corners[self.corner_index(at)]
                .get_or_init(|| Corner::measure(self.rgb(at), reach))
        });
        std::array::from_fn(|_| all.next().expect("a box has eight corners"))
    }

    fn corner_index(&self, [r, g, b]: [usize; 3]) -> usize {
        (b * (self.boxes + 1) + g) * (self.boxes + 1) + r
    }

    fn rgb(&self, at: [usize; 3]) -> LinearRgb {
        LinearRgb([0, 1, 2].map(|k| self.origin[k] + at[k] as f64 * self.step[k]))
    }
}

impl Corner {
    fn measure(rgb: LinearRgb, reach: &Reach) -> Self {
        let color = reach.colorimetry.xyz_from_rgb(rgb);
        let reflectance = Offset::measure(color, &reach.solids.reflectance, reach);
        // Every reflectance is a fluorescent material that does not fluoresce.
        let fluorescence = if reflectance.distance == 0.0 {
            INSIDE
        } else {
            Offset::measure(color, &reach.solids.fluorescence, reach)
        };
        Self { reflectance, fluorescence }
    }
}

impl Offset {
    fn measure(color: Xyz, solid: &ColorSolid, reach: &Reach) -> Self {
        // No nearer than the color itself, for the way from the middle leads outward.
        let further = reach.further_out(color);
        let nearest = solid.nearest(further);
        if nearest.distance == 0.0 {
            return INSIDE;
        }
        let de2000 = Metric::De2000.distance(&reach.colorimetry, color, nearest.color);
        let normal = (further - nearest.color) / nearest.distance;
        Self {
            distance: rounded_up(nearest.distance),
            de2000: rounded_up(de2000),
            normal: normal.0.map(rounded_up),
        }
    }
}

fn side_of(solid: &ColorSolid, corners: &[Offset; 8], points: &[Xyz; 8]) -> Side {
    if corners.iter().all(|corner| corner.distance == 0.0) {
        return Side::Inside;
    }
    let outside = corners.iter().all(|corner| corner.distance > 0.0)
        && corners.iter().any(|corner| parted(solid, corner.normal.map(f64::from), points));
    if outside { Side::Outside } else { Side::Unknown }
}

fn box_corners(at: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..8_usize).map(move |corner| [0, 1, 2].map(|k| at[k] + (corner >> k & 1)))
}

/// Single precision, not below the value.
fn rounded_up(value: f64) -> f32 {
    let single = to_single(value);
    if f64::from(single) < value { single.next_up() } else { single }
}
