//! What a check says of a cube is what the cube does.

use std::sync::OnceLock;

use upglow::{Cube, Interpolation, ModelOnGrid};
use upglow_color::{Contract, Grid, LinearRgb, RgbSpace, StandingKind, ciede2000};
use upglow_fit::{Fitter, Preset, StandingTable, Unwatched, build_cube};

use super::hue::Hue;
use super::limits::Limits;
use super::palette::DIFFERENCE;
use super::text::percent;
use super::{CheckReport, Pass};
use crate::picture::stated::{Interpretation, Word};

const WIDTH: usize = 24;

fn cube() -> &'static Cube {
    static CUBE: OnceLock<Cube> = OnceLock::new();
    CUBE.get_or_init(|| built(Preset::Konig2020, Contract::default()))
}

fn built(preset: Preset, contract: Contract) -> Cube {
    build_cube(&contract, &preset.model(), preset.options(), 3, &Unwatched).unwrap()
}

fn limits(cube: &Cube) -> Limits<'_> {
    Limits::new(cube.contract().clone(), Some((cube, "cube")))
}

/// Colors of all hues and saturations, each twice.
fn colors() -> Vec<[f32; 3]> {
    let n: u16 = 12;
    let color = |i: u16| [i % n, i / n % n, i / 7 % n].map(|k| f32::from(k) / 11.0);
    (0..2 * n * n).map(|i| color(i / 2)).collect()
}

fn report(cube: &Cube, rgb: &[[f32; 3]], rows_at_once: usize) -> CheckReport {
    let limits = limits(cube);
    let mut pass = Pass::new(&limits, [WIDTH, rgb.len() / WIDTH]);
    for (i, band) in rgb.chunks(rows_at_once * WIDTH).enumerate() {
        pass.add(i * rows_at_once, band);
    }
    let word = |used: &str| Word { used: used.into(), by: "declared".into(), overruled: None };
    let understood =
        Interpretation { space: word("acescg"), encoding: word("linear"), alpha: "none" };
    pass.finish("picture.exr".into(), understood)
}

/// ΔE00 of each texel's mixture, in double precision.
fn differences(cube: &Cube, rgb: &[[f32; 3]]) -> Vec<f64> {
    let colorimetry = cube.contract().on(Grid::FIT);
    let sums = ModelOnGrid::new(cube.model(), &colorimetry);
    let difference = |rgb: &[f32; 3]| {
        let rgb = LinearRgb(rgb.map(f64::from));
        let blend = cube.lookup(rgb, Interpolation::Blend).unwrap().color(&sums);
        let pair = [colorimetry.xyz_from_rgb(rgb), blend];
        let [wanted, blend] = pair.map(|xyz| colorimetry.lab_from_xyz(xyz));
        ciede2000(wanted, blend)
    };
    rgb.iter().map(difference).collect()
}

/// Single precision of the cube's colors, where a small XYZ is magnified by ΔE00.
const SINGLE: f64 = 0.01;

#[test]
fn the_report_on_a_cube_is_the_same_for_any_bands_and_threads() {
    let mut rgb = colors();
    rgb[5] = [f32::NAN, 0.0, 0.0];
    rgb[77] = [1.5, 0.5, 0.5];
    let whole = report(cube(), &rgb, rgb.len() / WIDTH);
    for (rows, threads) in [(1, 1), (5, 2), (7, 3)] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| report(cube(), &rgb, rows));
        assert!(found == whole, "{rows} rows at once, {threads} threads");
    }
}

#[test]
fn the_map_of_differences_shows_those_that_are_computed_apart() {
    let rgb = colors();
    let found = report(cube(), &rgb, 4);
    let maps = found.cube_maps.unwrap();
    let (mut sum, mut greatest) = (0.0, 0.0_f64);
    for (de2000, shown) in differences(cube(), &rgb).into_iter().zip(&maps.differences.pixels) {
        sum += de2000;
        greatest = greatest.max(de2000);
        let between = [de2000 - SINGLE, de2000 + SINGLE].map(|v| DIFFERENCE.color(v.max(0.0)));
        for k in 0..3 {
            let range = between[0][k].min(between[1][k])..=between[0][k].max(between[1][k]);
            let is_gray = shown[0] == shown[1] && shown[1] == shown[2];
            assert!(if is_gray { de2000 < 2.0 * SINGLE } else { range.contains(&shown[k]) });
        }
    }
    let found = found.cube.unwrap();
    assert!((found.mean_de2000 - sum / rgb.len() as f64).abs() < SINGLE);
    assert!((found.greatest_de2000 - greatest).abs() < SINGLE);
    assert!(greatest > 1.0 && (found.worst[0].de2000 - greatest).abs() < SINGLE);
}

#[test]
fn counts_add_up() {
    let rgb = colors();
    let found = report(cube(), &rgb, 4).cube.unwrap();
    let texels = rgb.len() as f64;
    assert_eq!(found.kinds.each().iter().map(|(_, count)| count).sum::<u64>(), found.texels);
    let beyond = differences(cube(), &rgb).into_iter().filter(|de2000| *de2000 > 1.0).count();
    assert_eq!(found.beyond_one.texels(), beyond as u64);
    assert!((found.within_one - (texels - beyond as f64) / texels).abs() < 1e-12);
    let dye = &found.dye;
    // The amounts of the dyes add up to the dose; both are rounded to 2⁻³².
    let of_dyes: f64 = dye.dyes.iter().map(|used| used.share * used.mean).sum();
    assert!((of_dyes - dye.share * dye.mean_dose).abs() < 1e-8, "{dye:?}");
    let doses = rgb.iter().map(|rgb| {
        let rgb = LinearRgb(rgb.map(f64::from));
        let mixture = cube().lookup(rgb, Interpolation::Blend).unwrap();
        mixture.parts().map(|(weight, material)| weight * material.fluorescence.dose()).sum::<f64>()
    });
    let doses: Vec<f64> = doses.collect();
    let with_dye = doses.iter().filter(|dose| **dose > 0.0).count();
    assert_eq!(dye.share, with_dye as f64 / texels);
    assert!((dye.share * dye.mean_dose - doses.iter().sum::<f64>() / texels).abs() < 1e-8);
}

#[test]
fn headlines_are_true() {
    let table = StandingTable::new(cube().contract());
    let colorimetry = cube().contract().on(Grid::FIT);
    let nodes: Vec<[f32; 3]> = vec![[0.5; 3]; WIDTH];
    assert_eq!(report(cube(), &nodes, 1).headline(), "This cube matches every texel.");
    let all = colors();
    // Parts of the colors, each of which a different kind of color is most of.
    for rgb in [&all[..], &all[..WIDTH], &all[4 * WIDTH..7 * WIDTH], &all[9 * WIDTH..]] {
        let differences = differences(cube(), rgb);
        let beyond: Vec<_> = rgb.iter().zip(&differences).filter(|(_, d)| **d > 1.0).collect();
        let share = |count: usize| percent(count as f64 / rgb.len() as f64);
        let headline = report(cube(), rgb, 4).headline();
        let within = share(rgb.len() - beyond.len());
        assert!(beyond.is_empty() || headline.starts_with(&within), "{headline}");
        let described = |kind: StandingKind, hue: Option<Hue>| {
            let is_so = |rgb: [f32; 3]| {
                let rgb = LinearRgb(rgb.map(f64::from));
                let lab = colorimetry.lab_from_xyz(colorimetry.xyz_from_rgb(rgb));
                table.kind(rgb) == kind && hue.is_none_or(|hue| Hue::of(lab) == hue)
            };
            beyond.iter().filter(|(rgb, _)| is_so(**rgb)).count()
        };
        for (kind, words) in [
            (StandingKind::Reflectance, "that only a steeper reflectance or dye shows"),
            (StandingKind::NeedsFluorescence, "that only fluorescence shows"),
            (StandingKind::Unreachable, "that no material shows"),
        ] {
            if headline.contains(words) {
                let hue = Hue::ALL.into_iter().find(|hue| headline.contains(hue.words()));
                let count = described(kind, hue);
                assert!(2 * count > beyond.len(), "{headline} {count} of {}", beyond.len());
                assert_eq!(headline.contains("mostly"), count < beyond.len(), "{headline}");
            }
        }
    }
}

#[test]
fn changes_are_those_of_fits_where_all_texels_are_drawn() {
    let rgb: Vec<[f32; 3]> = colors().into_iter().step_by(6).take(2 * WIDTH).collect();
    let found = report(cube(), &rgb, 1).cube.unwrap();
    let share = |of: usize| of as f64 / rgb.len() as f64;
    assert_eq!(found.changes[0].within_one, found.within_one);
    let mut compared = 0;
    for preset in [Preset::Natural, Preset::Jung2019, Preset::Jakob2019] {
        let change = found.changes.iter().find(|c| c.options == format!("--preset {preset}"));
        let change = change.unwrap();
        let fitter = Fitter::new(cube().contract(), &preset.model(), preset.options()).unwrap();
        let fits = rgb.iter().map(|rgb| fitter.fit(LinearRgb(rgb.map(f64::from))).unwrap());
        let fits: Vec<_> = fits.collect();
        let within = share(fits.iter().filter(|fit| fit.de2000 <= 1.0).count());
        let with_dye = share(fits.iter().filter(|fit| fit.fluorescence.dose() > 0.0).count());
        // Rounding of sums.
        assert!((change.within_one - within).abs() < 1e-12, "{change:?} {within}");
        assert!((change.with_dye - with_dye).abs() < 1e-12, "{change:?} {with_dye}");
        compared += change.fitted;
    }
    assert_eq!(compared, 3 * rgb.len());
}

#[test]
fn a_wider_space_is_named_for_texels_outside() {
    let srgb = Contract { space: RgbSpace::named("srgb").unwrap(), ..Contract::default() };
    let cube = built(Preset::Jakob2019, srgb.clone());
    let rec2020 = Contract { space: RgbSpace::named("rec2020").unwrap(), ..srgb.clone() };
    let [srgb, rec2020] = [srgb, rec2020].map(|contract| contract.on(Grid::FIT));
    let green = rec2020.xyz_from_rgb(LinearRgb([0.01, 0.9, 0.01]));
    let green = srgb.rgb_from_xyz(green).0.map(upglow_color::rounding::to_single);
    let mut rgb = vec![[0.5; 3]; WIDTH];
    rgb[3] = green;
    let found = report(&cube, &rgb, 1);
    let wider = found.cube.as_ref().unwrap().wider_space.clone().unwrap();
    assert_eq!((wider.inside, wider.sampled), (1.0, 1));
    let space = Contract { space: RgbSpace::named(&wider.space).unwrap(), ..Contract::default() };
    let space = space.on(Grid::FIT);
    let inside = space.rgb_from_xyz(srgb.xyz_from_rgb(LinearRgb(green.map(f64::from))));
    assert!(inside.0.iter().all(|v| (0.0..=1.0).contains(v)), "{wider:?}");
    assert!(found.headline().contains("outside 0 to 1"), "{}", found.headline());
}

#[test]
fn the_page_of_a_cube_describes_each_picture_and_has_its_headings_in_order() {
    let mut rgb = colors();
    rgb[5] = [f32::NAN, 0.0, 0.0];
    let one = report(cube(), &rgb, 4);
    for pictures in [vec![one.clone()], vec![one.clone(); 2]] {
        let page = CheckReport::page(&pictures);
        let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
        let document = roxmltree::Document::parse_with_options(&page, options).unwrap();
        let elements = || document.descendants().filter(|node| node.is_element());
        let images: Vec<_> = elements().filter(|e| e.tag_name().name() == "img").collect();
        assert_eq!(images.len(), 4 * pictures.len());
        for image in images {
            let alt = image.attribute("alt").unwrap();
            assert!(alt.len() > 20 && alt.contains(|c: char| c.is_ascii_digit()), "{alt}");
        }
        let levels = elements().filter_map(|e| match e.tag_name().name() {
            "h1" => Some(1),
            "h2" => Some(2),
            "h3" => Some(3),
            _ => None,
        });
        let levels: Vec<i32> = levels.collect();
        assert_eq!(levels.iter().filter(|level| **level == 1).count(), 1);
        assert!(levels[0] == 1 && levels.windows(2).all(|pair| pair[1] <= pair[0] + 1));
        let tables = elements().filter(|e| e.tag_name().name() == "table");
        let scrolls = |e: roxmltree::Node<'_, '_>| {
            e.parent().is_some_and(|parent| parent.attribute("class") == Some("scroll"))
        };
        assert!(tables.into_iter().all(scrolls));
        assert!(page.contains(&one.headline().replace('&', "&amp;")));
    }
}
