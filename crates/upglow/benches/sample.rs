//! How long does it take to draw a wavelength, and to say how likely it was?
//!
//! Times are for [`CALLS`] draws: "item/s" is draws per second.

mod synthetic;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use synthetic::{CALLS, Kind, Random, cube};
use upglow::{Bispectral, PackedMixture};

fn main() {
    divan::main();
}

const KINDS: [Kind; 4] = [Kind::Passive, Kind::Dyes, Kind::Film, Kind::Bells];
const MATERIALS: usize = 64;

fn measure<R>(
    bencher: Bencher,
    kind: Kind,
    draw: impl Fn(&PackedMixture<'_>, [f32; 2], [f32; 2]) -> R,
) {
    let table = cube(32, kind).lookup_table();
    let mut random = Random(1);
    let blends: Vec<PackedMixture<'_>> =
        (0..MATERIALS).map(|_| table.lookup(random.rgb()).expect("inside")).collect();
    let numbers: Vec<[[f32; 2]; 2]> = (0..CALLS)
        .map(|_| {
            let nm = [random.wavelength_nm(), random.wavelength_nm()];
            [nm, [random.unit(), random.unit()]]
        })
        .collect();
    bencher.counter(ItemsCount::new(CALLS)).bench_local(|| {
        for ([nm, u], blend) in numbers.iter().zip(blends.iter().cycle()) {
            black_box(draw(blend, *nm, *u));
        }
    });
}

#[divan::bench(args = KINDS)]
fn sample_incident(bencher: Bencher, kind: Kind) {
    measure(bencher, kind, |blend, [nm, _], u| blend.sample_incident(nm, u));
}

#[divan::bench(args = KINDS)]
fn sample_outgoing(bencher: Bencher, kind: Kind) {
    measure(bencher, kind, |blend, [nm, _], u| blend.sample_outgoing(nm, u));
}

#[divan::bench(args = KINDS)]
fn incident_pdf(bencher: Bencher, kind: Kind) {
    measure(bencher, kind, |blend, [in_nm, out_nm], _| blend.incident_pdf_per_nm(in_nm, out_nm));
}

#[divan::bench(args = KINDS)]
fn outgoing_pdf(bencher: Bencher, kind: Kind) {
    measure(bencher, kind, |blend, [in_nm, out_nm], _| blend.outgoing_pdf_per_nm(in_nm, out_nm));
}
