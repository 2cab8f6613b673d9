//! How long does the kind of material that a color needs take?

use std::sync::OnceLock;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use upglow_color::{Contract, LinearRgb, StandingKind};
use upglow_fit::StandingTable;

fn main() {
    divan::main();
}

const TEXELS: u32 = 100_000;

/// Fills a cube evenly: the fractions of multiples of three irrational numbers.
fn spread(index: u32) -> [f64; 3] {
    const STEPS: [f64; 3] =
        [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_907_1];
    STEPS.map(|step| (f64::from(index) * step).fract())
}

/// Colors of paint and wood, well inside the colors of reflectances.
fn muted() -> Vec<LinearRgb> {
    let color = |[r, g, b]: [f64; 3]| LinearRgb([0.1 + 0.6 * r, 0.1 + 0.5 * g, 0.1 + 0.4 * b]);
    (0..TEXELS).map(spread).map(color).collect()
}

/// All colors of ACEScg.
fn any() -> Vec<LinearRgb> {
    (0..TEXELS).map(|index| LinearRgb(spread(index))).collect()
}

fn table() -> &'static StandingTable {
    static TABLE: OnceLock<StandingTable> = OnceLock::new();
    TABLE.get_or_init(|| StandingTable::new(&Contract::default()))
}

fn bench<T>(bencher: Bencher<'_, '_>, colors: &[LinearRgb], ask: impl Fn(LinearRgb) -> T + Sync) {
    // Examines the boxes, which is not to be measured.
    colors.iter().for_each(|&rgb| drop(black_box(ask(rgb))));
    bencher.counter(ItemsCount::new(colors.len())).bench(|| {
        colors.iter().for_each(|&rgb| drop(black_box(ask(rgb))));
    });
}

/// The kind of colors in boxes of one kind.
#[divan::bench]
fn kind_of_muted_colors(bencher: Bencher<'_, '_>) {
    bench(bencher, &muted(), |rgb| table().kind(rgb));
}

/// The kind and the distance of such colors.
#[divan::bench]
fn estimate_of_muted_colors(bencher: Bencher<'_, '_>) {
    bench(bencher, &muted(), |rgb| table().estimate(rgb));
}

/// The kind of any color, some on a surface.
#[divan::bench(sample_count = 5, sample_size = 1)]
fn kind_of_any_color(bencher: Bencher<'_, '_>) {
    bench(bencher, &any(), |rgb| table().kind(rgb));
}

/// The same with an empty table.
#[divan::bench(sample_count = 1, sample_size = 1)]
fn first_look_at_any_color(bencher: Bencher<'_, '_>) {
    let colors = any();
    bencher.counter(ItemsCount::new(colors.len())).bench(|| {
        let table = StandingTable::new(&Contract::default());
        colors.iter().filter(|&&rgb| table.kind(rgb) == StandingKind::Unreachable).count()
    });
}

/// The search that the table replaces.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn search_of_any_color(bencher: Bencher<'_, '_>) {
    let colors = any();
    bencher.counter(ItemsCount::new(colors.len())).bench(|| {
        colors.iter().for_each(|&rgb| {
            let _ = black_box(table().standing(rgb));
        });
    });
}
