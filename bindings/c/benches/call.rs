//! The time of calls through the C ABI.
//!
//! Functions are called by pointers that the compiler cannot see through, as a C program calls them.
//! Times are for [`CALLS`] calls: "item/s" is calls per second.

use std::ffi::CStr;
use std::hint::black_box;

use divan::Bencher;
use divan::counter::ItemsCount;
use upglow::{Cube, DyeModel, DyeOptions, DyeSet, Edge, FitRecord, Fluorescence, Model, Node};
use upglow_c::{
    UpglowCube, UpglowMaterial, UpglowStatus, upglow_cube_from_memory, upglow_look_up,
    upglow_look_up_many, upglow_message, upglow_reflectance_4,
};
use upglow_color::Contract;

fn main() {
    divan::main();
}

/// Enough calls that the cost of the clock is negligible.
const CALLS: usize = 4096;

const RESOLUTION: usize = 32;

/// Whether the nodes fluoresce.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Passive,
    /// Every node has its own dyes: the most expensive case.
    Dyes,
}

const KINDS: [Kind; 2] = [Kind::Passive, Kind::Dyes];

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

    fn rgb(&mut self) -> [f32; 3] {
        [self.unit(), self.unit(), self.unit()]
    }

    fn node(&mut self, kind: Kind) -> Node {
        let reflectance = Edge {
            edge_nm: f64::from(350.0 + 400.0 * self.unit()),
            level: f64::from(3.0 * self.unit() - 1.5),
            slope_per_nm: f64::from(0.02 * self.unit() - 0.01),
        };
        let fluorescence = match kind {
            Kind::Passive => Fluorescence::None,
            Kind::Dyes => Fluorescence::Dyes {
                first: (0..7).filter(|_| self.unit() > 0.5).count(),
                weight: self.unit().into(),
                concentration: self.unit().into(),
            },
        };
        Node::new(reflectance, fluorescence, 0.0)
    }
}

fn cube(kind: Kind) -> Cube {
    let set = DyeSet::named("konig8").expect("built in");
    let model = Model::Dyes(DyeModel::new(set, DyeOptions::default()).expect("valid"));
    let mut random = Random(7);
    let nodes = (0..RESOLUTION.pow(3)).map(|_| random.node(kind)).collect();
    Cube::new(Contract::default(), model, FitRecord::default(), RESOLUTION, nodes).expect("valid")
}

/// A cube as C sees it; it lives as long as the bench.
fn handle(kind: Kind) -> *const UpglowCube {
    let bytes = cube(kind).to_bytes();
    let mut handle = std::ptr::null_mut();
    // SAFETY: the pointers are those of a slice and of a variable.
    expect_ok(unsafe { upglow_cube_from_memory(bytes.as_ptr(), bytes.len(), &raw mut handle) });
    handle
}

fn expect_ok(status: UpglowStatus) {
    // SAFETY: the message ends with a zero byte.
    assert_eq!(status, UpglowStatus::Ok, "{:?}", unsafe { CStr::from_ptr(upglow_message()) });
}

fn colors() -> Vec<[f32; 3]> {
    let mut random = Random(1);
    (0..CALLS).map(|_| random.rgb()).collect()
}

#[divan::bench(args = KINDS)]
fn look_up(bencher: Bencher, kind: Kind) {
    let (cube, colors) = (handle(kind), colors());
    let function = black_box(upglow_look_up as unsafe extern "C" fn(_, _, _) -> _);
    let mut material = std::mem::MaybeUninit::<UpglowMaterial>::zeroed();
    bencher.counter(ItemsCount::new(CALLS)).bench_local(|| {
        for rgb in &colors {
            // SAFETY: the pointers are those of a live cube, an array and a variable.
            black_box(unsafe { function(cube, rgb.as_ptr(), material.as_mut_ptr()) });
        }
    });
}

/// Colors per call: their materials fit into the cache of one core.
const BATCH: usize = 256;

#[divan::bench(args = KINDS)]
fn look_up_many(bencher: Bencher, kind: Kind) {
    let (cube, colors) = (handle(kind), colors());
    let function = black_box(upglow_look_up_many as unsafe extern "C" fn(_, _, _, _, _) -> _);
    let mut materials = vec![std::mem::MaybeUninit::<UpglowMaterial>::zeroed(); BATCH];
    let mut outside = 0_usize;
    bencher.counter(ItemsCount::new(CALLS)).bench_local(|| {
        for rgb in colors.chunks(BATCH) {
            let (rgb, to) = (rgb.as_ptr().cast(), materials.as_mut_ptr().cast());
            // SAFETY: the pointers are those of a live cube, of arrays and of a variable.
            black_box(unsafe { function(cube, rgb, to, BATCH, &raw mut outside) });
        }
    });
}

/// The same, one at a time.
#[divan::bench(args = KINDS)]
fn look_up_into_an_array(bencher: Bencher, kind: Kind) {
    let (cube, colors) = (handle(kind), colors());
    let function = black_box(upglow_look_up as unsafe extern "C" fn(_, _, _) -> _);
    let mut materials = vec![std::mem::MaybeUninit::<UpglowMaterial>::zeroed(); BATCH];
    bencher.counter(ItemsCount::new(CALLS)).bench_local(|| {
        for (rgb, material) in colors.iter().zip((0..BATCH).cycle()) {
            let to = materials[material].as_mut_ptr();
            // SAFETY: the pointers are those of a live cube, of an array and of a variable.
            black_box(unsafe { function(cube, rgb.as_ptr(), to) });
        }
    });
}

#[divan::bench(args = KINDS)]
fn look_up_and_reflectance_4(bencher: Bencher, kind: Kind) {
    let (cube, colors) = (handle(kind), colors());
    let look_up = black_box(upglow_look_up as unsafe extern "C" fn(_, _, _) -> _);
    let reflectance = black_box(upglow_reflectance_4 as unsafe extern "C" fn(_, _, _) -> _);
    let mut material = std::mem::MaybeUninit::<UpglowMaterial>::zeroed();
    let (nm, mut answer) = ([420.0, 500.0, 580.0, 660.0_f32], [0.0_f32; 4]);
    bencher.counter(ItemsCount::new(CALLS)).bench_local(|| {
        for rgb in &colors {
            // SAFETY: the pointers are those of a live cube, of arrays and of a variable.
            black_box(unsafe { look_up(cube, rgb.as_ptr(), material.as_mut_ptr()) });
            // SAFETY: the same, and the material was just looked up.
            black_box(unsafe { reflectance(material.as_ptr(), nm.as_ptr(), answer.as_mut_ptr()) });
            black_box(&answer);
        }
    });
}

/// The same work without the C ABI.
#[divan::bench(args = KINDS)]
fn in_rust(bencher: Bencher, kind: Kind) {
    let (table, colors) = (cube(kind).lookup_table(), colors());
    let nm = [420.0, 500.0, 580.0, 660.0];
    bencher.counter(ItemsCount::new(CALLS)).bench_local(|| {
        for rgb in &colors {
            black_box(table.lookup(*rgb).map(|mixture| mixture.reflectance4(black_box(nm)))).ok();
        }
    });
}
