//! The nearest colors that materials show, and marks for colors that they do not.

use upglow::{ColorTable, Cube};
use upglow_color::rounding::to_single;
use upglow_color::{Colorimetry, LinearRgb, Metric, Nearest, Screen, Standing, Xyz, choices};

use crate::cube::Stage;
use crate::progress::Watch;
use crate::standing_table::StandingTable;
use crate::verify::Stopped;

/// Materials whose colors are wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum MaterialSet {
    /// The blends of a cube.
    #[default]
    Cube,
    /// Every reflectance.
    Reflectance,
    /// Every material, fluorescent or not.
    Any,
}

choices!(MaterialSet, "set of materials", Cube = "cube", Reflectance = "reflectance", Any = "any");

/// What is shown of colors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ReachView {
    /// The nearest color of the materials.
    #[default]
    Nearest,
    /// The color itself where the materials show it within 1 ΔE00. Where they do not, flat magenta, or flat green for
    /// reds, blues and purples.
    OutOfReach,
}

choices!(ReachView, "view", Nearest = "nearest", OutOfReach = "out-of-reach");

/// The colors of a [`MaterialSet`] in the RGB of a cube.
///
/// For a cube the nearest color is that of its blend, which [`Cube::lookup`] returns for the color clamped to 0..=1;
/// else it is that of [`Standing`], by distance in XYZ.
#[derive(Debug)]
#[must_use]
pub struct NearestColors {
    set: MaterialSet,
    table: StandingTable,
    blends: ColorTable,
    screen: Screen,
    /// Magenta and green.
    marks: [LinearRgb; 2],
}

/// The nearest color of a set of materials.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct NearestColor {
    /// The nearest color; the color itself if the materials show it.
    pub rgb: LinearRgb,
    /// ΔE00 to it; 0 for a color that a [`Standing`] says to be within reach.
    pub de2000: f64,
}

/// Colors that materials miss by less than the first ΔE00 are not marked, from the second on in full, between in part: the
/// border is at 1, which is just visible. A narrower range would make it jagged between the entries of a table; with a
/// lower start, misses that nobody sees would tint dark colors, because marks are bright.
const MARKED_DE2000: [f64; 2] = [0.5, 1.5];

/// Magenta and green in the linear RGB of sRGB, which viewers can show. A saturated color resembles one of them
/// at most.
const MARKS: [[f64; 3]; 2] = [[1.0, 0.0, 1.0], [0.0, 1.0, 0.0]];

/// Colors with more red and blue than this share of green are marked green. Grays have 2: with less, overexposed
/// whites would be a mixture of both marks by their noise; with more, reds would resemble their mark.
const PURPLE: f64 = 3.0;

impl NearestColors {
    /// The colors of these materials, under the contract of the cube and in its RGB.
    ///
    /// # Panics
    ///
    /// Never: the matrix of sRGB can be inverted.
    pub fn new(cube: &Cube, set: MaterialSet) -> Self {
        let table = StandingTable::new(cube.contract());
        let blends = cube.color_table(table.colorimetry());
        let screen = Screen::srgb(table.colorimetry().white());
        let xyz_from_screen = screen.rgb_from_xyz_matrix().inverse().expect("sRGB has a volume");
        let marks = MARKS.map(|mark| table.colorimetry().rgb_from_xyz(Xyz(xyz_from_screen * mark)));
        Self { set, table, blends, screen, marks }
    }

    /// The least and the greatest red, green or blue of the colors of the materials.
    pub fn range(&self) -> [f64; 2] {
        let solids = self.table.solids();
        let solid = match self.set {
            MaterialSet::Cube => return [0.0, 1.0],
            MaterialSet::Reflectance => &solids.reflectance,
            MaterialSet::Any => &solids.fluorescence,
        };
        let rows = self.colorimetry().rgb_from_xyz_matrix().0;
        let furthest = |k: usize, sign: f64| {
            let color = solid.support(rows[k].map(|v| sign * v));
            self.colorimetry().rgb_from_xyz(color).0[k]
        };
        let all = |sign| [0, 1, 2].map(|k| furthest(k, sign)).into_iter();
        [all(-1.0).fold(0.0, f64::min), all(1.0).fold(1.0, f64::max)]
    }

    /// The nearest color of the materials.
    pub fn nearest(&self, rgb: LinearRgb) -> NearestColor {
        let Standing { reflectance, fluorescence, .. } = match self.set {
            MaterialSet::Cube => return self.blend(rgb),
            MaterialSet::Reflectance | MaterialSet::Any => self.table.standing(rgb),
        };
        let is_any = self.set == MaterialSet::Any;
        let Nearest { color, distance, de2000 } = if is_any { fluorescence } else { reflectance };
        let is_itself = distance == 0.0;
        let rgb = if is_itself { rgb } else { self.colorimetry().rgb_from_xyz(color) };
        NearestColor { rgb, de2000 }
    }

    /// The color that the cube shows for a color.
    fn blend(&self, rgb: LinearRgb) -> NearestColor {
        let mut xyz = [[0.0; 3]];
        let clamped = rgb.0.map(|v| to_single(v.clamp(0.0, 1.0)));
        self.blends.xyz(&[clamped], &mut xyz).expect("there is room for one color");
        let [shown] = xyz.map(|xyz| Xyz(xyz.map(f64::from)));
        let wanted = self.colorimetry().xyz_from_rgb(rgb);
        let de2000 = Metric::De2000.distance(self.colorimetry(), wanted, shown);
        NearestColor { rgb: self.colorimetry().rgb_from_xyz(shown), de2000 }
    }

    /// What `view` shows of a color.
    pub fn seen(&self, rgb: LinearRgb, view: ReachView) -> LinearRgb {
        let NearestColor { rgb: nearest, de2000 } = self.nearest(rgb);
        match view {
            ReachView::Nearest => nearest,
            ReachView::OutOfReach => {
                let [from, to] = MARKED_DE2000;
                let share = ((de2000 - from) / (to - from)).clamp(0.0, 1.0);
                let mark = self.mark(rgb).0;
                LinearRgb([0, 1, 2].map(|k| rgb.0[k] * (1.0 - share) + mark[k] * share))
            }
        }
    }

    /// What `view` shows of many colors, on all threads of the current rayon pool.
    ///
    /// # Errors
    ///
    /// [`Stopped`] if the watcher stops the work.
    pub fn seen_of_all(
        &self,
        colors: &[LinearRgb],
        view: ReachView,
        watch: &dyn Watch,
    ) -> Result<Vec<LinearRgb>, Stopped> {
        let stage = Stage::new("nearest colors", colors.len(), watch);
        stage.each(colors.len(), |i| self.seen(colors[i], view)).map_err(|_| Stopped)
    }

    /// Magenta, or green for reds, blues and purples.
    fn mark(&self, rgb: LinearRgb) -> LinearRgb {
        let [red, green, blue] = self.screen.rgb_from_xyz(self.colorimetry().xyz_from_rgb(rgb)).0;
        let [magenta_mark, green_mark] = self.marks;
        if red + blue > PURPLE * green { green_mark } else { magenta_mark }
    }

    fn colorimetry(&self) -> &Colorimetry {
        self.table.colorimetry()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Unwatched;
    use crate::{Preset, build_cube, random_rgb};
    use std::sync::OnceLock;
    use upglow::{Interpolation, ModelOnGrid};
    use upglow_color::{Contract, Grid, StandingKind};

    fn cube() -> &'static Cube {
        static CUBE: OnceLock<Cube> = OnceLock::new();
        CUBE.get_or_init(|| {
            let preset = Preset::default();
            build_cube(&Contract::default(), &preset.model(), preset.options(), 5, &Unwatched)
                .unwrap()
        })
    }

    #[test]
    fn the_nearest_color_is_that_of_the_standing_or_of_the_blend() {
        // Single precision of the colors of blends.
        const SINGLE: f64 = 1e-6;
        let table = StandingTable::new(cube().contract());
        let sums = ModelOnGrid::new(cube().model(), &cube().contract().on(Grid::FIT));
        let sets = [MaterialSet::Cube, MaterialSet::Reflectance, MaterialSet::Any];
        let [blends, reflectances, all] = sets.map(|set| NearestColors::new(cube(), set));
        for index in 0..200 {
            let rgb = random_rgb(5, index);
            let standing = table.standing(rgb);
            let xyz = |found: NearestColor| table.colorimetry().xyz_from_rgb(found.rgb);
            for (colors, expected) in
                [(&reflectances, standing.reflectance), (&all, standing.fluorescence)]
            {
                let found = colors.nearest(rgb);
                assert_eq!(found.de2000, expected.de2000);
                assert!((xyz(found) - expected.color).0.iter().all(|d| d.abs() < 1e-12));
                assert_eq!(expected.distance == 0.0, found.rgb == rgb);
            }
            let single = LinearRgb(rgb.0.map(|v| f64::from(to_single(v))));
            let blend = cube().lookup(single, Interpolation::Blend).unwrap().color(&sums);
            let off = (xyz(blends.nearest(rgb)) - blend).0;
            assert!(off.iter().all(|d| d.abs() < SINGLE), "{off:?}");
        }
    }

    #[test]
    fn colors_within_reach_are_unchanged_and_others_are_flat() {
        let colors = NearestColors::new(cube(), MaterialSet::Any);
        let view = |rgb| colors.seen(LinearRgb(rgb), ReachView::OutOfReach);
        for rgb in [[0.5, 0.4, 0.3], [0.9, 0.0, 0.9], [0.0; 3], [1.0; 3]] {
            assert_eq!(view(rgb), LinearRgb(rgb));
        }
        let [magenta, green] = colors.marks;
        assert_eq!((view([0.0, 1.0, 0.0]), view([0.0, 0.98, 0.01])), (magenta, magenta));
        assert_eq!((view([9.0, -1.0, 9.0]), view([9.0; 3])), (green, magenta));
        // Reflectances do not show this magenta.
        let colors = NearestColors::new(cube(), MaterialSet::Reflectance);
        assert_eq!(colors.seen(LinearRgb([0.9, 0.0, 0.9]), ReachView::OutOfReach), green);
    }

    #[test]
    fn the_range_holds_every_color_of_the_materials() {
        let table = StandingTable::new(cube().contract());
        for set in [MaterialSet::Reflectance, MaterialSet::Any] {
            let colors = NearestColors::new(cube(), set);
            let [least, most] = colors.range();
            assert!(least < 0.0 && most > 1.0, "{least} {most}");
            for index in 0..200 {
                let far = LinearRgb(random_rgb(6, index).0.map(|v| 20.0 * v - 8.0));
                let found = colors.nearest(far).rgb.0;
                // The search for the nearest color stops within a billionth.
                assert!(
                    found.iter().all(|v| (least - 1e-6..=most + 1e-6).contains(v)),
                    "{found:?}"
                );
                let kind = table.kind(far);
                assert!(kind > StandingKind::Reflectance || found == far.0);
            }
        }
    }

    #[test]
    fn threads_do_not_change_the_colors() {
        let colors = NearestColors::new(cube(), MaterialSet::Reflectance);
        let list: Vec<LinearRgb> = (0..500).map(|index| random_rgb(7, index)).collect();
        let alone: Vec<LinearRgb> =
            list.iter().map(|&rgb| colors.seen(rgb, ReachView::Nearest)).collect();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        let found = pool.install(|| colors.seen_of_all(&list, ReachView::Nearest, &Unwatched));
        assert_eq!(found.unwrap(), alone);
    }
}
