//! How fast is a material map written and read, by compression?

use divan::counter::BytesCount;
use divan::{Bencher, black_box};
use upglow_image::{Compression, ExrDescription, ExrWriter, Picture, Sample};

fn main() {
    divan::main();
}

const SIDE: usize = 2048;
const BAND: usize = 64;
const NAMES: [&str; 6] = ["center", "height", "curve", "dye", "weight", "concentration"];

/// Six smooth fields with the noise of a photograph: what a texture of materials looks like.
fn planes() -> Vec<Vec<f32>> {
    let mut state = 0x1234_5678_u32;
    let mut noise = move || {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        (state >> 8) as f32 / 16_777_216.0
    };
    let mut sample = |c: usize, x: usize, y: usize| {
        let (u, v) = (x as f32 / SIDE as f32, y as f32 / SIDE as f32);
        let detail = 0.02 * noise();
        match c {
            0 => 520.0 + 80.0 * (9.0 * u).sin() + 40.0 * detail,
            1 => 0.5 * (u * 7.0 + v).cos() + detail,
            2 => 0.3 + 0.2 * (v * 3.0 + u * 11.0).sin() + detail,
            3 => (u * 8.0).floor(),
            4 => (u * 8.0).fract() + detail,
            _ => {
                if u > 0.5 {
                    (u - 0.5) * 0.9 + detail
                } else {
                    0.0
                }
            }
        }
    };
    (0..6).map(|c| (0..SIDE * SIDE).map(|i| sample(c, i % SIDE, i / SIDE)).collect()).collect()
}

fn write(path: &std::path::Path, planes: &[Vec<f32>], compression: Compression) -> u64 {
    let mut description = ExrDescription::new([SIDE, SIDE], NAMES).with_sample(Sample::Half);
    description.compression = compression;
    let mut writer = ExrWriter::create(path, description).expect("a folder to write in");
    for top in (0..SIDE).step_by(BAND) {
        let range = top * SIDE..(top + BAND) * SIDE;
        let band: Vec<&[f32]> = planes.iter().map(|plane| &plane[range.clone()]).collect();
        writer.write_band(&band).expect("room on the disk");
    }
    writer.finish().expect("all rows")
}

const COMPRESSIONS: [Compression; 3] = [Compression::None, Compression::Zips, Compression::Zip];

#[divan::bench(args = COMPRESSIONS, sample_count = 5)]
fn write_six_channels_of_2048(bencher: Bencher<'_, '_>, compression: Compression) {
    let folder = tempfile::tempdir().expect("a folder");
    let planes = planes();
    bencher
        .counter(BytesCount::new(SIDE * SIDE * 6 * 2))
        .bench_local(|| write(&folder.path().join("x.exr"), &planes, compression));
    let bytes = write(&folder.path().join("x.exr"), &planes, compression);
    println!("{compression:?}: {:.3} of the bytes", bytes as f64 / (SIDE * SIDE * 12) as f64);
}

#[divan::bench(args = COMPRESSIONS, sample_count = 5)]
fn read_rgb_of_2048(bencher: Bencher<'_, '_>, compression: Compression) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("x.exr");
    let planes = planes();
    let mut description = ExrDescription::new([SIDE, SIDE], ["R", "G", "B"]);
    description.compression = compression;
    let mut writer = ExrWriter::create(&path, description).expect("a folder to write in");
    writer.write_band(&[&planes[1], &planes[2], &planes[4]]).expect("room on the disk");
    writer.finish().expect("all rows");
    bencher.counter(BytesCount::new(SIDE * SIDE * 6)).bench_local(|| {
        let mut picture = Picture::open(&path).expect("a picture");
        for band in picture.bands(BAND) {
            black_box(band.expect("whole"));
        }
    });
}
