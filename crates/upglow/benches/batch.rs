//! How long do the colors of 10⁷ RGB take, and how long the reading and writing alone?

mod synthetic;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use synthetic::{Kind, Random, cube};
use upglow_color::{Contract, Grid};

fn main() {
    divan::main();
}

const COLORS: usize = 10_000_000;

fn random() -> Vec<[f32; 3]> {
    let mut random = Random(1);
    (0..COLORS).map(|_| random.rgb()).collect()
}

fn coherent() -> Vec<[f32; 3]> {
    let at = |i: usize, k: usize| 0.5 + 0.4 * (i as f32 * 1e-4 * (k + 1) as f32).sin();
    (0..COLORS).map(|i| [0, 1, 2].map(|k| at(i, k))).collect()
}

fn measure(bencher: Bencher, rgb: &[[f32; 3]], resolution: usize) {
    let colorimetry = Contract::default().on(Grid::FIT);
    let table = cube(resolution, Kind::Passive).color_table(&colorimetry);
    let mut xyz = vec![[0.0; 3]; rgb.len()];
    bencher.counter(ItemsCount::new(rgb.len())).bench_local(|| {
        let _ = black_box(table.xyz(black_box(rgb), &mut xyz));
    });
}

#[divan::bench(args = [32, 64], sample_count = 10)]
fn xyz_of_random(bencher: Bencher, resolution: usize) {
    measure(bencher, &random(), resolution);
}

#[divan::bench(args = [32, 64], sample_count = 10)]
fn xyz_of_coherent(bencher: Bencher, resolution: usize) {
    measure(bencher, &coherent(), resolution);
}

/// The limit: the arrays read and written, nothing computed.
#[divan::bench(sample_count = 10)]
fn copy(bencher: Bencher) {
    let rgb = random();
    let mut xyz = vec![[0.0; 3]; rgb.len()];
    bencher.counter(ItemsCount::new(rgb.len())).bench_local(|| {
        xyz.copy_from_slice(black_box(&rgb));
        black_box(&mut xyz);
    });
}
