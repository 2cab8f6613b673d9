//! How long does it take to evaluate a material that was looked up?
//!
//! Times are for [`CALLS`] evaluations of as many materials: "item/s" is evaluations per second.

mod synthetic;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use synthetic::{CALLS, Kind, Random, cube};
use upglow::{Bispectral, LookupTable, PackedMixture};

fn main() {
    divan::main();
}

const KINDS: [Kind; 4] = [Kind::Passive, Kind::Dyes, Kind::Film, Kind::Bells];
/// So few that they stay in the first-level cache: the look-up is another bench.
const MATERIALS: usize = 64;

fn blends(table: &LookupTable) -> Vec<PackedMixture<'_>> {
    let mut random = Random(1);
    (0..MATERIALS).map(|_| table.lookup(random.rgb()).expect("inside")).collect()
}

fn measure<const N: usize, R>(
    bencher: Bencher,
    kind: Kind,
    evaluate: impl Fn(&PackedMixture<'_>, [f32; N]) -> R,
) {
    let table = cube(32, kind).lookup_table();
    let blends = blends(&table);
    let mut random = Random(2);
    let nm: Vec<[f32; N]> =
        (0..CALLS).map(|_| std::array::from_fn(|_| random.wavelength_nm())).collect();
    bencher.counter(ItemsCount::new(CALLS)).bench_local(|| {
        for (nm, blend) in nm.iter().zip(blends.iter().cycle()) {
            black_box(evaluate(blend, *nm));
        }
    });
}

#[divan::bench(args = KINDS)]
fn reflectance(bencher: Bencher, kind: Kind) {
    measure(bencher, kind, |blend, [nm]| blend.reflectance(nm));
}

#[divan::bench(args = KINDS)]
fn reflectance4(bencher: Bencher, kind: Kind) {
    measure(bencher, kind, |blend, nm: [f32; 4]| blend.reflectance4(nm));
}

#[divan::bench(args = KINDS)]
fn reflectance8(bencher: Bencher, kind: Kind) {
    measure(bencher, kind, |blend, nm: [f32; 8]| blend.reflectance8(nm));
}

#[divan::bench(args = KINDS)]
fn reradiation(bencher: Bencher, kind: Kind) {
    measure(bencher, kind, |blend, [in_nm, out_nm]| blend.reradiation_per_nm(in_nm, out_nm));
}

#[divan::bench(args = KINDS)]
fn albedo(bencher: Bencher, kind: Kind) {
    measure(bencher, kind, |blend, [nm]| blend.albedo(nm));
}
