//! How long does it take to get the material of a color, ready to evaluate?
//!
//! Times are for [`CALLS`] look-ups: "item/s" is look-ups per second.

mod synthetic;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use synthetic::{CALLS, Kind, Random, cube};
use upglow::Interpolation;
use upglow_color::{Grid, LinearRgb, ReducedBasis};

fn main() {
    divan::main();
}

/// Unrelated colors, as of a path tracer's hits.
fn unrelated<T>(bencher: Bencher, answer: impl Fn([f32; 3]) -> T) {
    let mut random = Random(1);
    // More colors than the caches' neighborhoods can be learned for.
    let rgb: Vec<[f32; 3]> = (0..65 * CALLS).map(|_| random.rgb()).collect();
    let mut next = 0;
    bencher.counter(ItemsCount::new(CALLS)).bench_local(|| {
        next = (next + CALLS) % (64 * CALLS);
        for &rgb in &rgb[next..next + CALLS] {
            let _ = black_box(&answer(rgb));
        }
    });
}

#[divan::bench(args = [32, 64])]
fn random(bencher: Bencher, resolution: usize) {
    let table = cube(resolution, Kind::Film).lookup_table();
    unrelated(bencher, |rgb| table.lookup(rgb));
}

/// Colors that change little from one to the next, as along a texture's rows.
#[divan::bench(args = [32, 64])]
fn coherent(bencher: Bencher, resolution: usize) {
    let table = cube(resolution, Kind::Film).lookup_table();
    let rgb: Vec<[f32; 3]> = (0..CALLS)
        .map(|i| {
            let t = i as f32 / CALLS as f32;
            [0.3 + 0.2 * t, 0.5 - 0.1 * t, 0.4 + 0.1 * (40.0 * t).sin()]
        })
        .collect();
    bencher.counter(ItemsCount::new(CALLS)).bench_local(|| {
        for &rgb in &rgb {
            let _ = black_box(&table.lookup(rgb));
        }
    });
}

/// The 4×4 matrices of unrelated colors, for engines without spectra.
#[divan::bench(args = [32, 64])]
fn reduced_matrix(bencher: Bencher, resolution: usize) {
    let cube = cube(resolution, Kind::Film);
    let basis = ReducedBasis::try_new(cube.contract(), Grid::FIT).expect("daylight has every part");
    let table = cube.reduced_table(&basis);
    unrelated(bencher, |rgb| table.matrix(rgb));
}

/// The double-precision path that the table replaces.
#[divan::bench(args = [32, 64])]
fn random_in_double_precision(bencher: Bencher, resolution: usize) {
    let cube = cube(resolution, Kind::Film);
    let mut random = Random(1);
    let rgb: Vec<LinearRgb> = (0..CALLS).map(|_| LinearRgb(random.rgb().map(f64::from))).collect();
    bencher.counter(ItemsCount::new(CALLS)).bench_local(|| {
        for &rgb in &rgb {
            let _ = black_box(cube.lookup(rgb, Interpolation::Blend));
        }
    });
}
