//! How long does a cube take, and a table of reflectances by a published builder?

use divan::Bencher;
use rgb2spec::optimize::{gamut::Gamut, optimize};
use upglow::Model;
use upglow_color::Contract;
use upglow_fit::{Preset, Unwatched, build_cube};

fn main() {
    divan::main();
}

fn bench_build(bencher: Bencher<'_, '_>, model: &Model, preset: Preset, resolution: usize) {
    let contract = Contract::default();
    bencher.bench(|| {
        build_cube(&contract, model, preset.options(), resolution, &Unwatched)
            .expect("nobody stops it")
    });
}

/// The default build, the preset `natural`, at 32³ and 64³.
#[divan::bench(args = [32, 64], sample_count = 3, sample_size = 1)]
fn natural(bencher: Bencher<'_, '_>, resolution: usize) {
    bench_build(bencher, &Preset::Natural.model(), Preset::Natural, resolution);
}

/// The preset `konig2020`, 32³.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn konig2020(bencher: Bencher<'_, '_>) {
    bench_build(bencher, &Preset::Konig2020.model(), Preset::Konig2020, 32);
}

/// Reflectance alone, with the limit of `konig2020`, 32³.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn reflectance(bencher: Bencher<'_, '_>) {
    bench_build(bencher, &Model::Reflectance, Preset::Konig2020, 32);
}

/// The preset `jung2019`, analytic fluorescence, 32³.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn jung2019(bencher: Bencher<'_, '_>) {
    bench_build(bencher, &Preset::Jung2019.model(), Preset::Jung2019, 32);
}

/// The peer: crate `rgb2spec` 0.1.1, reflectance alone for sRGB, three tables of 32³.
#[divan::bench(sample_count = 1, sample_size = 1)]
fn peer_rgb2spec_srgb(bencher: Bencher<'_, '_>) {
    bencher.bench(|| optimize(Gamut::SRGB, 32).expect("it has a table for sRGB"));
}
