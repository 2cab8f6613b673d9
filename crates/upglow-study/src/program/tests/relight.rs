//! What is made of the colors of real surfaces, so that a change of it is noticed.

use upglow_color::{Contract, Grid, Illuminant};
use upglow_fit::{Preset, Unwatched};
use upglow_terminal::Report as _;

use crate::bispectral::shared;
use crate::commands::relight::measure;
use crate::lights::{SEVEN, lights};
use crate::relight::{LitSet, Relit, sets};
use crate::samples::SampleSet;
use crate::spread::Spread;
use crate::ways::{OneColor, Way, WholeMatrix, fits, ways};

const DOCUMENT: &str = include_str!("../../../../../docs/relighting.md");

/// One unit of the last printed digit: machines differ in the last bits of functions.
const PRINTED: f64 = 0.0101;

#[test]
fn fits_look_as_the_documents_say() {
    assert_documented(&sets(&[]), &fits());
}

#[test]
fn every_way_makes_of_fluorescent_materials_what_the_documents_say() {
    let measured = shared();
    if measured.is_empty() {
        eprintln!(
            "skipped: every_way_makes_of_fluorescent_materials_what_the_documents_say (no \
             ../shared/data/bispectral)"
        );
        return;
    }
    let mut ways = ways();
    ways.push(Box::new(WholeMatrix::of(&measured).unwrap()));
    assert_documented(&[SampleSet::fluorescent(&measured)], &ways);
}

#[test]
#[ignore = "slow"]
fn slow_every_way_looks_as_the_documents_say() {
    assert_documented(&sets(&[]), &ways());
}

/// Checks that each line of these tables is in the document.
fn assert_documented(sets: &[SampleSet], ways: &[Box<dyn Way>]) {
    assert_has_tables(DOCUMENT, &measure(sets, ways, &Unwatched).unwrap().text());
}

/// Checks that each line of a report's tables is in a document.
pub(super) fn assert_has_tables(document: &str, report: &str) {
    let mut table = Vec::new();
    for line in report.lines() {
        if line.starts_with("ΔE00") {
            let mut from = document.lines().skip_while(|documented| *documented != line);
            let title = from.next();
            let rest = from.take_while(|documented| !documented.starts_with("ΔE00 from"));
            table = title.into_iter().chain(rest).collect();
        }
        assert!(table.iter().any(|documented| is_same(line, documented)), "undocumented: {line}");
    }
}

/// Whether two lines have the same words, and numbers that are the same as far as they are printed.
fn is_same(line: &str, other: &str) -> bool {
    let words = |line: &str| line.split([' ', '(', ')']).map(str::to_owned).collect::<Vec<_>>();
    let (words, others) = (words(line), words(other));
    let is_near = |(one, two): (&String, &String)| match (one.parse::<f64>(), two.parse::<f64>()) {
        (Ok(one), Ok(two)) => (one - two).abs() < PRINTED,
        _ => one == two,
    };
    words.len() == others.len() && words.iter().zip(&others).all(is_near)
}

#[test]
fn the_default_relights_object_colors_better_than_one_hard_limit_of_slopes() {
    let (objects, lights) = (SampleSet::object_colors(), lights());
    let relit = |preset| {
        let way = OneColor::preset(preset, &Contract::default());
        Relit::of(&LitSet::new(&objects, &lights), &way).means(SEVEN)
    };
    let [natural, konig2020] = [Preset::Natural, Preset::Konig2020].map(relit);
    let gains = Spread::of(konig2020.iter().zip(natural).map(|(before, now)| before - now));
    // Three standard errors: chance alone would do this once in 700 times.
    assert!(gains.mean > 3.0 * gains.standard_error, "{gains:?}");
}

#[test]
fn every_measured_surface_has_a_color_of_the_default_space() {
    let colorimetry = Contract::default().on(Grid::FIT);
    for sample in sets(&[]).iter().flat_map(|set| &set.samples) {
        let color = sample.color(&Illuminant::default(), colorimetry.white());
        let rgb = colorimetry.rgb_from_xyz(color).0;
        assert!(rgb.iter().all(|v| (0.0..=1.0).contains(v)), "{} {rgb:?}", sample.name);
    }
}
