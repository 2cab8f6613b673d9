//! No file makes a reader panic: truncated, altered and invented files are refused with a message of one
//! line.

#![expect(clippy::unwrap_used, reason = "a test fails where its files cannot be made")]

use std::path::{Path, PathBuf};

use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer,
    LayerAttributes, LineOrder, Vec2, WritableImage as _, f16,
};
use upglow_image::{ExrDescription, ExrWriter, Lint, Picture, SpectralPicture};

const SIZE: [usize; 2] = [40, 37];

/// The name of all files: only TGA goes by it.
const SAMPLE: &str = "x.tga";

fn value(x: usize, y: usize, c: usize) -> f32 {
    ((x * 5 + y * 11 + c * 3) % 97) as f32 / 97.0
}

fn exr_file(folder: &Path, compression: Compression, blocks: Blocks) -> Vec<u8> {
    let path = folder.join("sample.exr");
    let channel = |name: &str, c: usize| {
        let pixels = (0..SIZE[0] * SIZE[1]).map(|i| value(i % SIZE[0], i / SIZE[0], c));
        let samples = if c == 0 {
            FlatSamples::F32(pixels.collect())
        } else {
            FlatSamples::F16(pixels.map(f16::from_f32).collect())
        };
        AnyChannel::new(name, samples)
    };
    let names = ["B", "G", "R", "T.400,000000nm", "T.400,000000nm.410,000000nm", "T.410,000000nm"];
    let list = names.iter().enumerate().map(|(c, name)| channel(name, c)).collect();
    let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
    let layer = Layer::new(
        (SIZE[0], SIZE[1]),
        LayerAttributes::named("main"),
        encoding,
        AnyChannels::sort(list),
    );
    Image::from_layer(layer).write().to_file(&path).unwrap();
    std::fs::read(path).unwrap()
}

fn png_file(folder: &Path, interlaced: bool) -> Vec<u8> {
    if interlaced {
        return include_bytes!("data/interlaced.png").to_vec();
    }
    let path = folder.join("sample.png");
    let file = std::fs::File::create(&path).unwrap();
    let mut encoder = png::Encoder::new(file, 40, 37);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Sixteen);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header().unwrap();
    let bytes: Vec<u8> = (0..=250).cycle().take(40 * 37 * 6).collect();
    writer.write_image_data(&bytes).unwrap();
    drop(writer);
    std::fs::read(path).unwrap()
}

fn tiff_file(folder: &Path, compression: tiff::encoder::Compression) -> Vec<u8> {
    use tiff::encoder::{TiffEncoder, colortype};
    let path = folder.join("sample.tif");
    let file = std::fs::File::create(&path).unwrap();
    let mut encoder = TiffEncoder::new(file).unwrap().with_compression(compression);
    let samples: Vec<u16> = (0..40 * 37 * 3_u16).collect();
    encoder.write_image::<colortype::RGB16>(40, 37, &samples).unwrap();
    std::fs::read(path).unwrap()
}

/// Bytes in packets of ten repetitions and ten others, for pixels of `size` bytes.
fn packets(size: usize, repeated: u8, others: u8) -> Vec<u8> {
    let pixel = |i: usize| (0..size).map(move |k| (i * 7 + k).to_le_bytes()[0]);
    let run = std::iter::once(repeated).chain(pixel(3));
    run.chain(std::iter::once(others)).chain((0..10).flat_map(pixel)).collect()
}

fn tga_file(is_packed: bool) -> Vec<u8> {
    let mut bytes = vec![0, 0, if is_packed { 10 } else { 2 }, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    bytes.extend([40, 0, 37, 0, 24, 0x20]);
    if is_packed {
        bytes.extend(packets(3, 0x89, 9).repeat(2 * 37));
    } else {
        bytes.extend((0..=250).cycle().take(40 * 37 * 3));
    }
    bytes
}

fn radiance_file(is_packed: bool) -> Vec<u8> {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 37 +X 40\n".to_vec();
    for _ in 0..37 {
        if is_packed {
            bytes.extend([2, 2, 0, 40]);
            bytes.extend(packets(1, 138, 10).repeat(2 * 4));
        } else {
            bytes.extend((100..=250).cycle().take(40 * 4));
        }
    }
    bytes
}

fn samples(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut samples = Vec::new();
    for compression in [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
        Compression::B44,
        Compression::B44A,
        Compression::DWAA(None),
        Compression::DWAB(None),
    ] {
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(16, 16))] {
            let name = format!("{compression:?} {blocks:?}");
            samples.push((name, exr_file(folder, compression, blocks)));
        }
    }
    samples.push(("png".into(), png_file(folder, false)));
    samples.push(("interlaced png".into(), png_file(folder, true)));
    for (name, compression) in [
        ("plain", tiff::encoder::Compression::Uncompressed),
        ("lzw", tiff::encoder::Compression::Lzw),
        ("deflate", tiff::encoder::Compression::Deflate(Default::default())),
        ("packbits", tiff::encoder::Compression::Packbits),
    ] {
        samples.push((format!("{name} tiff"), tiff_file(folder, compression)));
    }
    samples.push(("baseline jpeg".into(), include_bytes!("data/baseline.jpg").to_vec()));
    samples.push(("progressive jpeg".into(), include_bytes!("data/progressive.jpg").to_vec()));
    for is_packed in [false, true] {
        samples.push((format!("tga, packed {is_packed}"), tga_file(is_packed)));
        samples.push((format!("radiance, packed {is_packed}"), radiance_file(is_packed)));
    }
    samples
}

/// Reads a file with every reader; returns the message of the first error.
fn read_all(path: &Path) -> Result<(), String> {
    let line = |error: &dyn std::fmt::Display| error.to_string();
    let mut picture = Picture::open(path).map_err(|e| line(&e))?;
    for band in picture.bands(16) {
        band.map_err(|e| line(&e))?;
    }
    if std::fs::read(path).unwrap().starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        Lint::of_file(path).map_err(|e| line(&e))?;
        let mut picture = SpectralPicture::open(path).map_err(|e| line(&e))?;
        picture.at(SIZE[0] / 2, SIZE[1] / 2).map_err(|e| line(&e))?;
    }
    Ok(())
}

fn check(path: &Path, name: &str, bytes: &[u8]) -> Result<(), String> {
    std::fs::write(path, bytes).unwrap();
    let result = std::panic::catch_unwind(|| read_all(path));
    let Ok(result) = result else {
        let kept = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("panicked");
        std::fs::write(&kept, bytes).unwrap();
        panic!("{name}: a reader panicked, see {}", kept.display());
    };
    if let Err(message) = &result {
        assert!(!message.contains('\n') && message.len() < 400, "{name}: {message:?}");
    }
    result
}

#[test]
fn whole_files_are_read() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in samples(folder.path()) {
        assert_eq!(check(&folder.path().join(SAMPLE), &name, &bytes), Ok(()), "{name}");
    }
}

#[test]
fn a_truncated_file_is_refused_wherever_it_ends() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in samples(folder.path()) {
        // Every length within the first header of each format, some lengths of the others.
        let step = if name.contains("Tiles") || name.contains('(') { 41 } else { 1 };
        let lengths = (0..bytes.len().min(400)).step_by(step);
        let lengths = lengths.chain((400..bytes.len()).step_by(211));
        for length in lengths {
            let result = check(&folder.path().join(SAMPLE), &name, &bytes[..length]);
            // Bytes after the last block of an interlaced PNG may not be read.
            let tail = name.contains("png") && length + 64 > bytes.len();
            let message = result.err().or(tail.then(String::new));
            assert!(message.is_some(), "{name} cut at {length} of {}", bytes.len());
        }
    }
}

/// A xorshift generator, which gives the same files in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        usize::try_from(self.0 % end as u64).unwrap()
    }

    fn byte(&mut self) -> u8 {
        u8::try_from(self.below(256)).unwrap()
    }
}

fn altered_files_panic_nowhere(rounds: usize) {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in samples(folder.path()) {
        for round in 0..rounds {
            let mut random = Random(0x9e37_79b9_7f4a_7c15 ^ (round as u64 + 1));
            let mut altered = bytes.clone();
            // Half the rounds alter the header, which has sizes and positions.
            let end = if round % 2 == 0 { altered.len().min(600) } else { altered.len() };
            for _ in 0..1 + random.below(4) {
                let at = random.below(end);
                altered[at] = if random.below(3) == 0 { 0xff } else { random.byte() };
            }
            let _ = check(&folder.path().join(SAMPLE), &name, &altered);
        }
    }
}

#[test]
fn altered_bytes_panic_nowhere() {
    altered_files_panic_nowhere(40);
}

#[test]
#[ignore = "slow: an hour"]
fn slow_altered_bytes_panic_nowhere() {
    altered_files_panic_nowhere(3000);
}

#[test]
fn noise_and_absent_files_are_refused_with_what_was_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x");
    let message = |bytes: &[u8]| check(&path, "noise", bytes).unwrap_err();
    assert_eq!(
        message(b"P6 640 480"),
        "the file begins with [50, 36, 20, 36], expected a picture: OpenEXR, TIFF, PNG, \
         JPEG, Radiance or TGA"
    );
    assert!(message(b"").starts_with("the file begins with [], expected"));
    assert!(read_all(&folder.path().join("absent")).is_err());
}

#[test]
fn a_table_that_the_file_cannot_hold_is_refused_before_it_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x");
    let description = ExrDescription::new([100_000, 100_000], ["R", "G", "B"]);
    drop(ExrWriter::create(&path, description).unwrap());
    // A small file with an enlarged data window.
    let mut bytes = exr_file(folder.path(), Compression::ZIP16, Blocks::ScanLines);
    let at = bytes.windows(10).position(|w| w == b"dataWindow").unwrap() + 10 + 1 + 6 + 4;
    bytes[at + 8..at + 12].copy_from_slice(&99_999_i32.to_le_bytes());
    bytes[at + 12..at + 16].copy_from_slice(&99_999_i32.to_le_bytes());
    let message = check(&path, "stretched", &bytes).unwrap_err();
    assert_eq!(message, "chunkCount is 3, expected at least 6250");
    let name = bytes.windows(10).position(|w| w == b"chunkCount").unwrap();
    bytes[name] = b'C';
    let message = check(&path, "stretched", &bytes).unwrap_err();
    assert!(message.starts_with("the file ends inside the table of 6250 blocks"), "{message}");
}

#[test]
fn a_row_of_tiles_that_would_fill_the_memory_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x");
    let mut bytes = exr_file(folder.path(), Compression::ZIP16, Blocks::Tiles(Vec2(16, 16)));
    let after = |bytes: &[u8], name: &[u8], kind: usize| {
        bytes.windows(name.len()).position(|w| w == name).unwrap() + name.len() + 1 + kind + 1 + 4
    };
    let at = after(&bytes, b"dataWindow", "box2i".len());
    bytes[at + 8..at + 12].copy_from_slice(&131_071_i32.to_le_bytes());
    bytes[at + 12..at + 16].copy_from_slice(&16_383_i32.to_le_bytes());
    let at = after(&bytes, b"tiles", "tiledesc".len());
    bytes[at..at + 4].copy_from_slice(&1024_u32.to_le_bytes());
    bytes[at + 4..at + 8].copy_from_slice(&16_384_u32.to_le_bytes());
    let name = bytes.windows(10).position(|w| w == b"chunkCount").unwrap();
    bytes[name] = b'C';
    let message = check(&path, "tall tiles", &bytes).unwrap_err();
    assert!(message.starts_with("a row of tiles takes "), "{message}");
}

/// What is no file of an end has no content that could be waited for.
#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.exr");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for path in [&pipe, Path::new("/dev/zero"), Path::new("/dev/urandom")] {
        for error in [
            Picture::open(path).unwrap_err().to_string(),
            Lint::of_file(path).unwrap_err().to_string(),
            SpectralPicture::open(path).unwrap_err().to_string(),
        ] {
            assert_eq!(error, "a device, pipe or socket", "{}", path.display());
        }
    }
}
