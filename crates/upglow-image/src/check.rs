//! What a picture asks of materials, before anything is baked.

mod display;
mod html;
mod judge;
mod maps;
mod opinion;
mod palette;
mod ranking;
mod raster;
mod tally;

use rayon::prelude::*;

use display::Display;
pub use html::{CheckedPicture, check_page};
pub use judge::{Judge, JudgeError};
use maps::Maps;
pub use opinion::CubeOpinion;
pub use raster::Raster;
use tally::Tally;
pub use tally::{Counts, Flaw, Located};
use upglow_color::{LinearRgb, Standing};

/// Takes a picture by bands of rows, and says what each texel needs.
///
/// Memory is bounded: it holds two pictures of at most [`Checker::LONGER_SIDE`] pixels a side and
/// a few texels. The result does not depend on the bands or the number of threads.
///
/// # Examples
///
/// ```
/// use upglow_color::Contract;
/// use upglow_image::Judge;
///
/// let judge = Judge::new(&Contract::default());
/// let mut checker = judge.checker(3, 1)?;
/// checker.add(0, &[[0.5, 0.4, 0.3], [0.9, 0.0, 0.9], [0.0, 1.0, 0.0]])?;
/// let report = checker.finish()?;
/// assert_eq!(report.counts.reflectance, 1);
/// assert_eq!(report.counts.needs_fluorescence, 1);
/// assert_eq!(report.counts.unreachable, 1);
/// # Ok::<(), upglow_image::CheckError>(())
/// ```
#[derive(Debug)]
pub struct Checker<'a> {
    judge: &'a Judge,
    width: usize,
    height: usize,
    rows_seen: usize,
    maps: Maps,
    tally: Tally,
}

/// Why rows are not the rows of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckError {
    /// The picture has no texels.
    #[error("a picture of {width} × {height} texels, expected at least 1 × 1")]
    Size {
        /// Texels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// A band does not follow the one before.
    #[error("a band from row {found}, expected row {expected}")]
    Row {
        /// The band's first row.
        found: usize,
        /// The row that comes next.
        expected: usize,
    },
    /// A band does not hold whole rows.
    #[error("{found} texels, expected whole rows of {width}")]
    Length {
        /// Texels of the band.
        found: usize,
        /// Texels in a row.
        width: usize,
    },
    /// There are too many or too few rows.
    #[error("{found} rows, expected {expected}")]
    Rows {
        /// Rows given.
        found: usize,
        /// Rows of the picture.
        expected: usize,
    },
}

/// What a picture asks of materials.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckReport {
    /// Texels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// How many texels need what, and how many have values that no cube holds.
    pub counts: Counts,
    /// The first texels of each flaw, in reading order.
    pub located: Vec<Located>,
    /// The texels furthest beyond any material, then furthest beyond reflectance; at most
    /// [`Checker::WORST`], no two of nearly the same color.
    pub worst: Vec<WorstTexel>,
    /// How well a cube's materials show the picture, if a cube was asked.
    pub cube: Option<CubeOpinion>,
    /// Where the picture needs what.
    pub heat: Raster,
    /// The picture as sRGB shows it.
    pub thumbnail: Raster,
}

/// A texel that a reflectance does not show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorstTexel {
    /// Column, from 0 at the left.
    pub x: usize,
    /// Row, from 0 at the top.
    pub y: usize,
    /// Its color, linear RGB of the contract's space.
    pub rgb: [f32; 3],
    /// What it takes to show it, and how far it is from what materials show.
    pub standing: Standing,
    /// The color asked for, the nearest of a reflectance, and the nearest of any material, in sRGB.
    pub swatches: [[u8; 3]; 3],
}

impl Judge {
    /// A checker for a picture of this size.
    ///
    /// # Errors
    ///
    /// [`CheckError::Size`] if it has no texels.
    pub fn checker(&self, width: usize, height: usize) -> Result<Checker<'_>, CheckError> {
        if width == 0 || height == 0 {
            return Err(CheckError::Size { width, height });
        }
        let maps = Maps::new(width, height);
        Ok(Checker { judge: self, width, height, rows_seen: 0, maps, tally: Tally::default() })
    }
}

impl Checker<'_> {
    /// Greatest width and height of the pictures in a report.
    pub const LONGER_SIDE: usize = 1024;

    /// Greatest number of worst texels in a report.
    pub const WORST: usize = 10;

    /// Takes the next rows: linear RGB of the contract's space, row by row.
    ///
    /// # Errors
    ///
    /// [`CheckError`] if they do not follow the rows before, are not whole rows, or are more than
    /// the picture has; nothing is taken then.
    pub fn add(&mut self, first_row: usize, rgb: &[[f32; 3]]) -> Result<(), CheckError> {
        if first_row != self.rows_seen {
            return Err(CheckError::Row { found: first_row, expected: self.rows_seen });
        }
        if !rgb.len().is_multiple_of(self.width) {
            return Err(CheckError::Length { found: rgb.len(), width: self.width });
        }
        let rows = first_row + rgb.len() / self.width;
        if rows > self.height {
            return Err(CheckError::Rows { found: rows, expected: self.height });
        }
        let judge = self.judge;
        let found = self.maps.tiles(first_row, rgb).map(|tile| tile.judge(judge));
        let found = found.reduce(Tally::default, Tally::with);
        self.tally = std::mem::take(&mut self.tally).with(found);
        self.rows_seen = rows;
        Ok(())
    }

    /// The report.
    ///
    /// # Errors
    ///
    /// [`CheckError::Rows`] if rows are missing.
    pub fn finish(self) -> Result<CheckReport, CheckError> {
        if self.rows_seen < self.height {
            return Err(CheckError::Rows { found: self.rows_seen, expected: self.height });
        }
        let display = Display::new(self.judge);
        Ok(CheckReport {
            width: self.width,
            height: self.height,
            counts: self.tally.counts,
            located: self.tally.located(),
            worst: worst(self.judge, &display, &self.tally),
            cube: self.judge.has_cube().then(|| self.tally.opinion.finish()),
            heat: self.maps.heat(&display),
            thumbnail: self.maps.thumbnail(&display),
        })
    }
}

/// Measures the candidates, which were ranked by estimates, and keeps the worst.
fn worst(judge: &Judge, display: &Display, tally: &Tally) -> Vec<WorstTexel> {
    let candidates = tally.worst.found();
    let mut all: Vec<_> = candidates
        .par_iter()
        .map(|candidate| {
            let rgb = LinearRgb(candidate.rgb.map(f64::from));
            let standing = judge.table().standing(rgb);
            let asked = judge.table().colorimetry().xyz_from_rgb(rgb);
            let nearest = [standing.reflectance.color, standing.fluorescence.color];
            let swatches = [asked, nearest[0], nearest[1]].map(|xyz| display.srgb(xyz));
            let (x, y) = candidate.place();
            WorstTexel { x, y, rgb: candidate.rgb, standing, swatches }
        })
        .collect();
    let beyond = |t: &WorstTexel| t.standing.beyond().distance;
    all.sort_by(|a, b| {
        let worse = b.standing.kind.cmp(&a.standing.kind).then(beyond(b).total_cmp(&beyond(a)));
        worse.then((a.y, a.x).cmp(&(b.y, b.x)))
    });
    all.truncate(Checker::WORST);
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow_color::{Contract, LinearRgb, StandingKind};

    const WIDTH: usize = 61;
    const HEIGHT: usize = 47;

    /// All there may be in a picture: gradients, flat runs, bright, negative and broken texels.
    fn picture() -> Vec<[f32; 3]> {
        let texel = |i: usize| {
            let (x, y) = ((i % WIDTH) as f32 / 60.0, (i / WIDTH) as f32 / 46.0);
            match i % 97 {
                0 => [f32::NAN, 0.5, 2.0],
                1 => [0.1, f32::INFINITY, 0.0],
                2 => [1.2 + x, 0.9, y],
                3 => [0.2, -0.1 * y, x],
                4..40 => [0.25; 3],
                _ => [x, y * y, 1.0 - x * y],
            }
        };
        (0..WIDTH * HEIGHT).map(texel).collect()
    }

    fn judge() -> Judge {
        Judge::new(&Contract::default())
    }

    fn report(judge: &Judge, rgb: &[[f32; 3]], rows_at_once: usize) -> CheckReport {
        let mut checker = judge.checker(WIDTH, HEIGHT).unwrap();
        for (i, band) in rgb.chunks(rows_at_once * WIDTH).enumerate() {
            checker.add(i * rows_at_once, band).unwrap();
        }
        checker.finish().unwrap()
    }

    #[test]
    fn the_report_is_the_same_for_any_bands_and_threads() {
        let rgb = picture();
        let whole = report(&judge(), &rgb, HEIGHT);
        for (rows, threads) in [(1, 1), (5, 2), (16, 3)] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let found = pool.install(|| report(&judge(), &rgb, rows));
            assert!(found == whole, "{rows} rows at once, {threads} threads");
        }
    }

    #[test]
    fn each_texel_counts_for_what_it_needs() {
        let rgb = picture();
        let found = report(&judge(), &rgb, 7).counts;
        let finite = rgb.iter().filter(|t| t.iter().all(|v| v.is_finite()));
        let table = upglow_fit::StandingTable::new(&Contract::default());
        let standings: Vec<Standing> =
            finite.map(|t| table.standing(LinearRgb(t.map(f64::from)))).collect();
        let count = |kind| standings.iter().filter(|s| s.kind == kind).count() as u64;
        assert_eq!(found.reflectance, count(StandingKind::Reflectance));
        assert_eq!(found.unreachable, count(StandingKind::Unreachable));
        assert_eq!(found.no_color, (rgb.len() - standings.len()) as u64);
        let all = [found.reflectance, found.needs_fluorescence, found.unreachable, found.no_color];
        assert_eq!(all.iter().sum::<u64>(), rgb.len() as u64);
        assert_eq!(found.texels, rgb.len() as u64);
    }

    #[test]
    fn flawed_values_are_counted_and_the_first_are_located() {
        let rgb = picture();
        let found = report(&judge(), &rgb, HEIGHT);
        for flaw in Flaw::ALL {
            let flawed: Vec<usize> = (0..rgb.len()).filter(|&i| flaw.is_in(rgb[i])).collect();
            assert_eq!(found.counts.of(flaw), flawed.len() as u64, "{flaw:?}");
            let places: Vec<usize> = found
                .located
                .iter()
                .filter(|texel| texel.flaw == flaw)
                .map(|texel| texel.y * WIDTH + texel.x)
                .collect();
            assert!(!places.is_empty() && flawed.starts_with(&places), "{flaw:?} {places:?}");
        }
        // The first of them counts twice: it is no number, and above 1.
        assert!(Flaw::NotANumber.is_in(rgb[0]) && Flaw::AboveOne.is_in(rgb[0]));
    }

    #[test]
    fn the_worst_texel_is_the_worst_and_no_two_are_alike() {
        let rgb = picture();
        let judge = judge();
        let found = report(&judge, &rgb, HEIGHT).worst;
        let distance = |t: &[f32; 3]| {
            judge.table().standing(LinearRgb(t.map(f64::from))).fluorescence.distance
        };
        let finite = rgb.iter().filter(|t| t.iter().all(|v| v.is_finite()));
        let greatest = finite.map(distance).fold(0.0, f64::max);
        assert_eq!(found.len(), Checker::WORST);
        assert_eq!(found[0].standing.fluorescence.distance, greatest);
        for (i, texel) in found.iter().enumerate() {
            assert_eq!(rgb[texel.y * WIDTH + texel.x], texel.rgb);
            assert!(found[..i].iter().all(|other| other.rgb != texel.rgb));
        }
        let order: Vec<f64> = found.iter().map(|t| t.standing.fluorescence.distance).collect();
        assert!(order.is_sorted_by(|a, b| a >= b), "{order:?}");
    }

    #[test]
    fn maps_are_small_and_show_each_kind_in_its_color() {
        let judge = judge();
        let mut checker = judge.checker(5000, 3).unwrap();
        let mut rgb = vec![[0.2; 3]; 15_000];
        rgb[0] = [f32::NAN; 3];
        rgb[7505] = [0.0, 1.0, 0.0];
        rgb[2600] = [0.9, 0.0, 0.9];
        checker.add(0, &rgb).unwrap();
        let found = checker.finish().unwrap();
        assert_eq!((found.heat.width(), found.heat.height()), (1000, 1));
        let color = |column: usize| found.heat.pixels()[column];
        let [gray, broken, green, magenta] = [color(1), color(0), color(501), color(520)];
        assert!(gray[0] == gray[1] && gray[1] == gray[2]);
        // Cyan, purple and orange.
        assert!(broken[2] > broken[0] && broken[1] > broken[0]);
        assert!(green[2] > green[1] && green[0] >= green[2]);
        assert!(magenta[0] > magenta[1] && magenta[1] > magenta[2]);
    }

    #[test]
    fn rows_that_are_not_the_pictures_are_refused() {
        let judge = judge();
        assert_eq!(judge.checker(0, 4).map(|_| ()), Err(CheckError::Size { width: 0, height: 4 }));
        let mut checker = judge.checker(2, 2).unwrap();
        let rows = [[0.5; 3]; 6];
        assert_eq!(checker.add(1, &rows[..2]), Err(CheckError::Row { found: 1, expected: 0 }));
        assert_eq!(checker.add(0, &rows[..3]), Err(CheckError::Length { found: 3, width: 2 }));
        assert_eq!(checker.add(0, &rows), Err(CheckError::Rows { found: 3, expected: 2 }));
        checker.add(0, &rows[..2]).unwrap();
        assert_eq!(checker.finish().unwrap_err(), CheckError::Rows { found: 1, expected: 2 });
    }

    #[test]
    fn the_page_is_well_formed_and_names_are_text() {
        let report = report(&judge(), &picture(), HEIGHT);
        let name = "<script>alert('&\u{1}')</script>\".exr";
        let picture = CheckedPicture {
            name,
            space: "acescg",
            light: "D65 & \"sun\"",
            cube: None,
            report: &report,
        };
        for pictures in [vec![picture], vec![picture; 2]] {
            let page = check_page(&pictures);
            let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
            let document = roxmltree::Document::parse_with_options(&page, options).unwrap();
            let named = |tag| document.descendants().filter(move |n| n.tag_name().name() == tag);
            assert_eq!(named("script").count(), 0);
            assert_eq!(named("img").count(), 2 * pictures.len());
            let heading = named("h2").next().unwrap().text().unwrap();
            assert_eq!(heading, name.replace('\u{1}', "\u{FFFD}"));
            assert_eq!(page.matches("http").count(), 1, "only the name space of HTML");
        }
    }

    #[test]
    fn a_cube_that_has_the_picture_as_nodes_shows_it_within_its_own_difference() {
        use upglow::{DyeModel, DyeOptions, DyeSet, Model};
        use upglow_fit::{FitOptions, Unwatched, build_cube};
        let model = DyeModel::new(DyeSet::named("seed8").unwrap(), DyeOptions::default()).unwrap();
        let contract = Contract::default();
        let model = Model::Dyes(model);
        let cube = build_cube(&contract, &model, FitOptions::default(), 3, &Unwatched).unwrap();
        let judge = Judge::new(&contract).with_cube(&cube).unwrap();
        let nodes = cube.nodes().len();
        let rgb: Vec<[f32; 3]> =
            (0..nodes).map(|i| cube.coordinates(i).map(|k| k as f32 / 2.0)).collect();
        let mut checker = judge.checker(nodes, 1).unwrap();
        checker.add(0, &rgb).unwrap();
        let found = checker.finish().unwrap().cube.unwrap();
        let stored = cube.nodes().iter().map(|node| f64::from(node.de2000));
        assert_eq!(found.texels, nodes as u64);
        // Single precision, where a small XYZ is magnified by ΔE00.
        assert!((found.greatest - stored.fold(0.0, f64::max)).abs() < 0.01, "{found:?}");
        let other = Contract { adaptation: upglow_color::Adaptation::None, ..contract };
        assert!(matches!(Judge::new(&other).with_cube(&cube), Err(JudgeError::Contract)));
    }
}
