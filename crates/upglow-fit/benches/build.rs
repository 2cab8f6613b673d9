//! How long does a cube take, and a table of reflectances by a published builder?

use divan::Bencher;
use rgb2spec::optimize::{gamut::Gamut, optimize};
use upglow::{AnalyticModel, DyeModel, DyeOptions, DyeSet, Model};
use upglow_color::Contract;
use upglow_fit::{Preset, Unwatched, build_cube};

fn main() {
    divan::main();
}

fn dyes(set: &str) -> Model {
    let set = DyeSet::named(set).expect("it is built in");
    Model::Dyes(DyeModel::new(set, DyeOptions::default()).expect("the defaults are valid"))
}

fn bench_build(bencher: Bencher<'_, '_>, model: &Model, resolution: usize) {
    let contract = Contract::default();
    bencher.bench(|| {
        build_cube(&contract, model, Preset::Konig2020.options(), resolution, &Unwatched)
            .expect("nobody stops it")
    });
}

/// The build of the preset `konig2020` at 32³ and 64³.
#[divan::bench(args = [32, 64], sample_count = 3, sample_size = 1)]
fn default(bencher: Bencher<'_, '_>, resolution: usize) {
    bench_build(bencher, &dyes("konig8"), resolution);
}

/// Fourteen dyes instead of eight, 32³.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn wide14(bencher: Bencher<'_, '_>) {
    bench_build(bencher, &dyes("wide14"), 32);
}

/// Reflectance alone, 32³.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn reflectance(bencher: Bencher<'_, '_>) {
    bench_build(bencher, &Model::Reflectance, 32);
}

/// Analytic fluorescence, 32³.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn analytic(bencher: Bencher<'_, '_>) {
    bench_build(bencher, &Model::Analytic(AnalyticModel::default()), 32);
}

/// The peer: crate `rgb2spec` 0.1.1, reflectance alone for sRGB, three tables of 32³.
#[divan::bench(sample_count = 1, sample_size = 1)]
fn peer_rgb2spec_srgb(bencher: Bencher<'_, '_>) {
    bencher.bench(|| optimize(Gamut::SRGB, 32).expect("it has a table for sRGB"));
}
