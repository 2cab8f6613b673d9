//! How long does one material per texel take?

use std::hint::black_box;
use std::sync::OnceLock;

use divan::Bencher;
use divan::counter::ItemsCount;
use upglow::{Cube, Node};
use upglow_color::{Contract, Grid, LinearRgb, RgbSpace};
use upglow_fit::{Polisher, Preset, Unwatched, build_cube};

fn main() {
    divan::main();
}

/// Texels of one measurement: short enough that some run undisturbed on a busy machine.
const TEXELS: usize = 4096;

/// The pictures there are.
#[derive(Clone, Copy, Debug)]
enum Picture {
    /// Random encoded sRGB.
    Srgb,
    /// Random over the whole of ACEScg.
    Cube,
    /// An image-like gradient in sRGB.
    Gradient,
}

const PICTURES: [Picture; 3] = [Picture::Srgb, Picture::Cube, Picture::Gradient];

/// The default cube, built once.
fn cube() -> &'static Cube {
    static CUBE: OnceLock<Cube> = OnceLock::new();
    CUBE.get_or_init(|| {
        let (model, options) = (Preset::Natural.model(), Preset::Natural.options());
        build_cube(&Contract::default(), &model, options, 32, &Unwatched).expect("nobody stops it")
    })
}

/// Steele's `SplitMix64`.
fn unit(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

#[expect(clippy::cast_possible_truncation, reason = "images are in single precision")]
fn texels(picture: Picture) -> Vec<[f32; 3]> {
    let space = RgbSpace::named("srgb").expect("it is built in");
    let srgb = Contract { space, ..Contract::default() }.on(Grid::FIT);
    let acescg = Contract::default().on(Grid::FIT);
    let decoded = |encoded: [f64; 3]| {
        let linear = LinearRgb(encoded.map(|v| v.powf(2.2)));
        acescg.rgb_from_xyz(srgb.xyz_from_rgb(linear)).0
    };
    let mut state = 1;
    let mut texel = |i: usize| match picture {
        Picture::Srgb => decoded([(); 3].map(|()| unit(&mut state))),
        Picture::Cube => [(); 3].map(|()| unit(&mut state)),
        Picture::Gradient => {
            decoded([1.0, 2.0, 3.0].map(|k| 0.5 + 0.4 * (i as f64 * 4e-3 * k).sin()))
        }
    };
    (0..TEXELS).map(|i| texel(i).map(|v| (v as f32).clamp(0.0, 1.0))).collect()
}

fn measure(
    bencher: Bencher<'_, '_>,
    picture: Picture,
    work: impl Fn(&Polisher<'_>, &[[f32; 3]], &mut [Node]),
) {
    let polisher = Polisher::new(cube()).expect("the cube has a usable limit");
    let rgb = texels(picture);
    let mut out = vec![Node::default(); rgb.len()];
    bencher.counter(ItemsCount::new(rgb.len())).bench_local(|| {
        work(&polisher, black_box(&rgb), &mut out);
        black_box(&mut out);
    });
}

#[divan::bench(args = PICTURES, sample_count = 100, sample_size = 1)]
fn polish(bencher: Bencher<'_, '_>, picture: Picture) {
    measure(bencher, picture, |polisher, rgb, out| {
        polisher.polish(rgb, out).expect("both are of one length");
    });
}

#[divan::bench(args = PICTURES, sample_count = 100, sample_size = 1)]
fn interpolate(bencher: Bencher<'_, '_>, picture: Picture) {
    measure(bencher, picture, |polisher, rgb, out| {
        polisher.interpolate(rgb, out).expect("both are of one length");
    });
}
