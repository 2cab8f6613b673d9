//! How long does it take to evaluate the materials of the default cube?
//!
//! The benches of `upglow` use synthetic cubes, the worst case; this one uses the materials of a real
//! cube at random colors. Times are for [`CALLS`] evaluations.

use std::sync::LazyLock;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use upglow::{Bispectral, LookupTable, PackedMixture};
use upglow_color::Contract;
use upglow_fit::{Preset, Unwatched, build_cube};

fn main() {
    divan::main();
}

const CALLS: usize = 4096;
/// Few enough for the second-level cache, and too many for branch prediction to learn.
const MATERIALS: usize = 1024;

static TABLE: LazyLock<LookupTable> = LazyLock::new(|| {
    let (model, options) = (Preset::Natural.model(), Preset::Natural.options());
    let cube = build_cube(&Contract::default(), &model, options, 32, &Unwatched);
    cube.expect("nobody stops it").lookup_table()
});

/// Which materials of the cube.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Of all colors.
    All,
    /// Of the colors that fluoresce.
    Fluorescent,
}

const KINDS: [Kind; 2] = [Kind::All, Kind::Fluorescent];

/// Steele's `SplitMix64`.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1_u32 << 24) as f32
    }

    fn wavelength_nm(&mut self) -> f32 {
        380.0 + 340.0 * self.unit()
    }

    fn blend(&mut self) -> PackedMixture<'static> {
        TABLE.lookup([self.unit(), self.unit(), self.unit()]).expect("inside")
    }
}

fn measure<R>(
    bencher: Bencher<'_, '_>,
    kind: Kind,
    evaluate: impl Fn(&PackedMixture<'_>, [f32; 8], [f32; 2]) -> R,
) {
    let mut random = Random(1);
    let wanted = |blend: &PackedMixture<'_>| matches!(kind, Kind::All) || blend.is_fluorescent();
    let blends: Vec<_> =
        std::iter::repeat_with(|| random.blend()).filter(wanted).take(MATERIALS).collect();
    let numbers: Vec<([f32; 8], [f32; 2])> = (0..CALLS)
        .map(|_| (std::array::from_fn(|_| random.wavelength_nm()), [random.unit(), random.unit()]))
        .collect();
    bencher.counter(ItemsCount::new(CALLS)).bench_local(|| {
        for ((nm, u), blend) in numbers.iter().zip(blends.iter().cycle()) {
            black_box(evaluate(blend, *nm, *u));
        }
    });
}

#[divan::bench(args = KINDS)]
fn reflectance4(bencher: Bencher<'_, '_>, kind: Kind) {
    measure(bencher, kind, |blend, [a, b, c, d, ..], _| blend.reflectance4([a, b, c, d]));
}

#[divan::bench(args = KINDS)]
fn reflectance8(bencher: Bencher<'_, '_>, kind: Kind) {
    measure(bencher, kind, |blend, nm, _| blend.reflectance8(nm));
}

#[divan::bench(args = KINDS)]
fn reradiation(bencher: Bencher<'_, '_>, kind: Kind) {
    measure(bencher, kind, |blend, [in_nm, out_nm, ..], _| blend.reradiation_per_nm(in_nm, out_nm));
}

#[divan::bench(args = KINDS)]
fn sample_incident(bencher: Bencher<'_, '_>, kind: Kind) {
    measure(bencher, kind, |blend, [nm, ..], u| blend.sample_incident(nm, u));
}

#[divan::bench(args = KINDS)]
fn sample_outgoing(bencher: Bencher<'_, '_>, kind: Kind) {
    measure(bencher, kind, |blend, [nm, ..], u| blend.sample_outgoing(nm, u));
}

#[divan::bench(args = KINDS)]
fn incident_pdf(bencher: Bencher<'_, '_>, kind: Kind) {
    measure(bencher, kind, |blend, [in_nm, out_nm, ..], _| {
        blend.incident_pdf_per_nm(in_nm, out_nm)
    });
}

#[divan::bench(args = KINDS)]
fn outgoing_pdf(bencher: Bencher<'_, '_>, kind: Kind) {
    measure(bencher, kind, |blend, [in_nm, out_nm, ..], _| {
        blend.outgoing_pdf_per_nm(in_nm, out_nm)
    });
}
