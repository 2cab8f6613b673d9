//! Checks which materials a picture needs and what a cube makes of it, before anything is baked.

mod alternatives;
mod cube_match;
pub(crate) mod display;
mod draw;
mod dye_use;
mod findings;
mod html;
mod hue;
mod limits;
mod maps;
mod palette;
mod ranking;
mod raster;
mod report;
mod text;
mod verdict;

use std::path::Path;

use rayon::prelude::*;
use upglow::Cube;
use upglow_color::{Contract, Grid, LinearRgb};
use upglow_fit::{StandingTable, Stopped, Watch};

use self::display::Display;
use self::findings::Findings;
use self::limits::Limits;
use self::maps::Maps;
use self::ranking::Candidate;
use self::report::CubeMaps;
use crate::picture::error::PictureError;
use crate::picture::linear::LinearPicture;
use crate::picture::stated::{Declared, Interpretation};

pub use self::alternatives::{Cause, Change, MissedTexel, WiderSpace};
pub use self::cube_match::{BeyondOne, ColorDifference, CubeMatch};
pub use self::dye_use::{DyeUse, UsedDye};
pub use self::report::{CheckReport, Counts, Flaw, FlawedTexel, WorstTexel};

/// Checks for each texel of a picture which kind of material its color needs, and what a cube makes of it.
///
/// A picture is read by bands of rows, and two maps of at most 1024 pixels per side and a few texels are
/// kept, so memory is bounded. Reports depend neither on the bands nor on the number of threads.
///
/// # Examples
///
/// ```
/// use upglow_color::{Contract, RgbSpace};
/// use upglow_fit::Unwatched;
/// use upglow_image::{Checker, Declared, ExrDescription, ExrWriter};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("three.exr");
/// let three = ExrDescription::new([3, 1], ["R", "G", "B"]).with_space(&RgbSpace::default());
/// let mut writer = ExrWriter::create(&path, three)?;
/// writer.write_band(&[&[0.5, 0.9, 0.0], &[0.4, 0.0, 1.0], &[0.3, 0.9, 0.0]])?;
/// writer.finish()?;
///
/// let mut checker = Checker::new(Contract::default(), Declared::default());
/// let report = checker.check(&path, &Unwatched)?;
/// assert_eq!(report.counts.reflectance, 1);
/// assert_eq!(report.counts.needs_fluorescence, 1);
/// assert_eq!(report.counts.unreachable, 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Checker<'c> {
    contract: Contract,
    declared: Declared,
    /// A cube and the name of its file.
    cube: Option<(&'c Cube, String)>,
    /// The limits of each RGB space so far, for further pictures.
    known: Vec<Limits<'c>>,
}

/// Why a picture cannot be checked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckError {
    /// The picture cannot be read, or its RGB space or encoding is unknown.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The cube was built for another contract.
    #[error("the cube was built for another RGB space, light, observer or adaptation")]
    Contract,
    /// The watcher stopped the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// Rows that are read at a time: enough to keep all cores busy.
const BAND_ROWS: usize = 64;

impl<'c> Checker<'c> {
    /// Most texels in [`CheckReport::worst`].
    pub const WORST: usize = 10;

    /// Checks each picture in its own RGB space, under the light, observer and adaptation of `contract`.
    #[must_use]
    pub fn new(contract: Contract, declared: Declared) -> Self {
        Self { contract, declared, cube: None, known: Vec::new() }
    }

    /// Checks pictures in the RGB space of `cube`, and also how well its mixtures match each texel, where they
    /// have dye, why the worst texels are missed, and what other cubes would do. Reports name it `file`.
    ///
    /// # Errors
    ///
    /// [`CheckError::Contract`] if it was built for another contract.
    pub fn with_cube(mut self, cube: &'c Cube, file: String) -> Result<Self, CheckError> {
        self.contract.space = cube.contract().space.clone();
        if cube.contract().on(Grid::FIT) != self.contract.on(Grid::FIT) {
            return Err(CheckError::Contract);
        }
        self.cube = Some((cube, file));
        Ok(self)
    }

    /// Checks the picture at `input` on all threads of the current rayon pool.
    ///
    /// # Errors
    ///
    /// [`CheckError`] if the picture cannot be read, its alpha is NaN or infinite somewhere, or the watcher
    /// stops.
    pub fn check(
        &mut self,
        input: impl AsRef<Path>,
        watch: &dyn Watch,
    ) -> Result<CheckReport, CheckError> {
        let input = input.as_ref();
        let mut picture = LinearPicture::open(input, &self.declared)?;
        let size = picture.picture().size();
        let limits = self.limits(&picture);
        let limits = &self.known[limits];
        picture.convert_to(&limits.contract);
        let mut pass = Pass::new(limits, size);
        picture.for_each_band(BAND_ROWS, "checking", watch, |band| {
            band.check_alpha()?;
            pass.add(band.first_row, &band.rgb);
            Ok::<_, CheckError>(())
        })?;
        Ok(pass.finish(input.display().to_string(), picture.interpretation().clone()))
    }

    /// The index of the limits for a picture: in the cube's RGB space, or in the picture's own.
    fn limits(&mut self, picture: &LinearPicture) -> usize {
        let mut contract = self.contract.clone();
        if self.cube.is_none() {
            contract.space = picture.space().clone();
        }
        let known = self.known.iter().position(|limits| limits.contract == contract);
        known.unwrap_or_else(|| {
            let cube = self.cube.as_ref().map(|(cube, file)| (*cube, file.as_str()));
            self.known.push(Limits::new(contract, cube));
            self.known.len() - 1
        })
    }
}

/// The check of one picture, whose rows are added once, from top to bottom.
struct Pass<'a, 'c> {
    limits: &'a Limits<'c>,
    size: [usize; 2],
    maps: Maps,
    findings: Findings,
}

impl<'a, 'c> Pass<'a, 'c> {
    fn new(limits: &'a Limits<'c>, size: [usize; 2]) -> Self {
        Self { limits, size, maps: Maps::new(size), findings: Findings::default() }
    }

    /// Adds whole rows of linear RGB in the contract's space.
    fn add(&mut self, first_row: usize, rgb: &[[f32; 3]]) {
        let found = self.maps.check(first_row, rgb, self.limits);
        self.findings = std::mem::take(&mut self.findings).with(found);
    }

    fn finish(self, file: String, interpretation: Interpretation) -> CheckReport {
        let Self { limits, size: [width, height], maps, findings } = self;
        let display = Display::new(limits.table.colorimetry());
        let cube = limits.cube.as_ref();
        CheckReport {
            file,
            width,
            height,
            rgb_space: limits.contract.space.name().into(),
            interpretation,
            illuminant: limits.contract.illuminant.name().into(),
            counts: findings.counts,
            flaws: findings.flaws(),
            worst: worst(&limits.table, &display, &findings),
            cube: cube.map(|cube| findings.blends.finish(limits, cube, &display)),
            cube_maps: cube.map(|cube| {
                let dose_ramp = cube.dose_ramp();
                let [differences, doses] = maps.of_cube(dose_ramp, &display);
                CubeMaps { differences, doses, dose_ramp }
            }),
            heat: maps.heat(&display),
            thumbnail: maps.thumbnail(&display),
        }
    }
}

/// Measures the candidates, which were ranked by estimates, and returns the worst.
fn worst(table: &StandingTable, display: &Display, findings: &Findings) -> Vec<WorstTexel> {
    let candidates = &findings.worst.found;
    let mut all: Vec<_> = candidates
        .par_iter()
        .map(|&Candidate { x, y, rgb, .. }| {
            let color = LinearRgb(rgb.map(f64::from));
            let standing = table.standing(color);
            let own = table.colorimetry().xyz_from_rgb(color);
            let nearest = [own, standing.reflectance.color, standing.fluorescence.color];
            let pair = [own, standing.beyond().color];
            let [from, to] = pair.map(|xyz| table.colorimetry().lab_from_xyz(xyz));
            let difference = ColorDifference::new(from, to);
            let swatches = display.srgb_together(nearest);
            WorstTexel { x, y, rgb, standing, difference, swatches }
        })
        .collect();
    let beyond = |texel: &WorstTexel| texel.standing.beyond().distance;
    all.sort_by(|a, b| {
        let worse = b.standing.kind.cmp(&a.standing.kind).then(beyond(b).total_cmp(&beyond(a)));
        worse.then((a.y, a.x).cmp(&(b.y, b.x)))
    });
    all.truncate(Checker::WORST);
    all
}

#[cfg(test)]
mod cube_tests;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::stated::Word;
    use upglow_color::{Contract, LinearRgb, Standing, StandingKind};

    const WIDTH: usize = 61;
    const HEIGHT: usize = 47;

    /// A picture with gradients, flat runs, bright and negative texels, and NaN and infinities.
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

    fn limits() -> Limits<'static> {
        Limits::new(Contract::default(), None)
    }

    fn understood() -> Interpretation {
        let word = |used: &str| Word { used: used.into(), by: "declared".into(), overruled: None };
        Interpretation { space: word("acescg"), encoding: word("linear"), alpha: "none" }
    }

    fn report(limits: &Limits<'_>, rgb: &[[f32; 3]], rows_at_once: usize) -> CheckReport {
        let mut pass = Pass::new(limits, [WIDTH, HEIGHT]);
        for (i, band) in rgb.chunks(rows_at_once * WIDTH).enumerate() {
            pass.add(i * rows_at_once, band);
        }
        pass.finish("<script>alert('&\u{1}')</script>\".exr".into(), understood())
    }

    #[test]
    fn the_report_is_the_same_for_any_bands_and_threads() {
        let rgb = picture();
        let whole = report(&limits(), &rgb, HEIGHT);
        for (rows, threads) in [(1, 1), (5, 2), (16, 3)] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let found = pool.install(|| report(&limits(), &rgb, rows));
            assert!(found == whole, "{rows} rows at once, {threads} threads");
        }
    }

    #[test]
    fn each_texel_is_counted_by_the_material_it_needs() {
        let rgb = picture();
        let found = report(&limits(), &rgb, 7).counts;
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
        let found = report(&limits(), &rgb, HEIGHT);
        for flaw in Flaw::ALL {
            let flawed: Vec<usize> = (0..rgb.len()).filter(|&i| flaw.is_in(rgb[i])).collect();
            assert_eq!(found.counts.of(flaw), flawed.len() as u64, "{flaw:?}");
            let places: Vec<usize> = found
                .flaws
                .iter()
                .filter(|texel| texel.flaw == flaw)
                .map(|texel| texel.y * WIDTH + texel.x)
                .collect();
            assert!(!places.is_empty() && flawed.starts_with(&places), "{flaw:?} {places:?}");
        }
        // The first of them counts twice: it is NaN, and above 1.
        assert!(Flaw::NotANumber.is_in(rgb[0]) && Flaw::AboveOne.is_in(rgb[0]));
    }

    #[test]
    fn the_worst_texel_is_the_worst_and_no_two_are_alike() {
        let rgb = picture();
        let limits = limits();
        let found = report(&limits, &rgb, HEIGHT).worst;
        let distance =
            |t: &[f32; 3]| limits.table.standing(LinearRgb(t.map(f64::from))).fluorescence.distance;
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
        let limits = limits();
        let mut pass = Pass::new(&limits, [5000, 3]);
        let mut rgb = vec![[0.2; 3]; 15_000];
        rgb[0] = [f32::NAN; 3];
        rgb[7505] = [0.0, 1.0, 0.0];
        rgb[2600] = [0.9, 0.0, 0.9];
        pass.add(0, &rgb);
        let found = pass.finish("wide.exr".into(), understood());
        assert_eq!((found.heat.width, found.heat.height), (1000, 1));
        let color = |column: usize| found.heat.pixels[column];
        let [gray, broken, green, magenta] = [color(1), color(0), color(501), color(520)];
        assert!(gray[0] == gray[1] && gray[1] == gray[2]);
        // Cyan, purple and orange.
        assert!(broken[2] > broken[0] && broken[1] > broken[0]);
        assert!(green[2] > green[1] && green[0] >= green[2]);
        assert!(magenta[0] > magenta[1] && magenta[1] > magenta[2]);
    }

    #[test]
    fn the_page_is_well_formed_and_names_are_text() {
        let report = CheckReport {
            illuminant: "D65 & \"sun\"".into(),
            ..report(&limits(), &picture(), HEIGHT)
        };
        let name = report.file.clone();
        for pictures in [vec![report.clone()], vec![report.clone(); 2]] {
            let page = CheckReport::page(&pictures);
            let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
            let document = roxmltree::Document::parse_with_options(&page, options).unwrap();
            let named = |tag| document.descendants().filter(move |n| n.tag_name().name() == tag);
            assert_eq!(named("script").count(), 0);
            assert_eq!(named("img").count(), 2 * pictures.len());
            let tag = if pictures.len() == 1 { "h1" } else { "h2" };
            let heading = named(tag).next().unwrap().text().unwrap();
            assert_eq!(heading, name.replace('\u{1}', "\u{FFFD}"));
            assert_eq!(page.matches("http").count(), 1, "only the name space of HTML");
        }
    }

    #[test]
    fn a_cube_with_the_picture_as_nodes_matches_it_within_the_stored_difference() {
        use upglow::{DyeModel, DyeOptions, DyeSet, Model};
        use upglow_fit::{CubeSummary, Preset, Unwatched, build_cube};
        let model = DyeModel::new(DyeSet::named("konig8").unwrap(), DyeOptions::default()).unwrap();
        let contract = Contract::default();
        let model = Model::Dyes(model);
        let cube =
            build_cube(&contract, &model, Preset::Konig2020.options(), 3, &Unwatched).unwrap();
        let limits = Limits::new(contract.clone(), Some((&cube, "cube")));
        let nodes = cube.nodes().len();
        let rgb: Vec<[f32; 3]> =
            (0..nodes).map(|i| cube.coordinates(i).map(|k| k as f32 / 2.0)).collect();
        let mut pass = Pass::new(&limits, [nodes, 1]);
        pass.add(0, &rgb);
        let found = pass.finish("nodes.exr".into(), understood()).cube.unwrap();
        let stored = cube.nodes().iter().map(|node| f64::from(node.de2000));
        assert_eq!(found.texels, nodes as u64);
        // Single precision, where a small XYZ is magnified by ΔE00.
        let miss = (found.greatest_de2000 - stored.fold(0.0, f64::max)).abs();
        assert!(miss < 0.01, "{found:?}");
        assert_eq!(found.kinds, CubeSummary::of(&cube).kinds);
        let other = Contract { adaptation: upglow_color::Adaptation::None, ..contract };
        let refused = Checker::new(other, Declared::default()).with_cube(&cube, "cube".into());
        assert!(matches!(refused, Err(CheckError::Contract)));
    }
}
