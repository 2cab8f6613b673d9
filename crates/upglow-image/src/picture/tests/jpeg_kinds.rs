//! Every kind of JPEG reads as it was written, or is refused by name.

use std::path::Path;

use super::super::Picture;
use super::super::encoding::Encoding;
use super::super::stated::Declared;

/// A file whose blocks of 8 by 8 have one number each, which JPEG stores exactly.
#[derive(Clone, Debug)]
struct File {
    size: [usize; 2],
    /// The marker of the frame.
    frame: u8,
    bits: u8,
    /// Name, and samples across and down, of each component.
    components: Vec<(u8, [usize; 2])>,
    /// Units between restarts.
    restart: Option<usize>,
    /// Segments before the frame.
    further: Vec<u8>,
}

const BASELINE: u8 = 0xc0;
const PROGRESSIVE: u8 = 0xc2;

/// The number of a block of a component. Colors of YCbCr vary by columns of 16 pixels only in Y.
fn number(component: usize, [x, y]: [usize; 2]) -> u8 {
    match component {
        0 => u8::try_from((x * 57 + y * 91 + 40) % 256).unwrap(),
        1 => 90,
        _ => 170,
    }
}

fn segment(marker: u8, data: &[u8]) -> Vec<u8> {
    let length = u16::try_from(data.len() + 2).unwrap().to_be_bytes();
    [&[0xff, marker], &length[..], data].concat()
}

fn jfif() -> Vec<u8> {
    segment(0xe0, b"JFIF\0\x01\x02\0\0\x01\0\x01\0\0")
}

fn adobe(transform: u8) -> Vec<u8> {
    segment(0xee, &[&b"Adobe\0\x64\0\0\0\0"[..], &[transform]].concat())
}

/// Exif data of an orientation and a color space.
fn exif(orientation: u16, color_space: u16) -> Vec<u8> {
    let field = |tag: u16, kind: u16, value: u32| {
        let head = [tag.to_le_bytes(), kind.to_le_bytes()].concat();
        [head, 1_u32.to_le_bytes().to_vec(), value.to_le_bytes().to_vec()].concat()
    };
    let mut data = b"Exif\0\0II\x2a\0\x08\0\0\0\x02\0".to_vec();
    data.extend(field(274, 3, orientation.into()));
    data.extend(field(34665, 4, 8 + 2 + 2 * 12 + 4));
    data.extend([0, 0, 0, 0, 1, 0]);
    data.extend(field(40961, 3, color_space.into()));
    data.extend([0; 4]);
    segment(0xe1, &data)
}

/// Bits, highest first, with the zero that follows each byte 0xff.
#[derive(Default)]
struct Bits {
    bytes: Vec<u8>,
    open: u32,
    count: u32,
}

impl Bits {
    fn add(&mut self, value: u32, count: u32) {
        for bit in (0..count).rev() {
            self.open = self.open << 1 | value >> bit & 1;
            self.count += 1;
            if self.count == 8 {
                let byte = u8::try_from(self.open).unwrap();
                self.bytes.push(byte);
                if byte == 0xff {
                    self.bytes.push(0);
                }
                (self.open, self.count) = (0, 0);
            }
        }
    }

    fn fill(&mut self) {
        while self.count != 0 {
            self.add(1, 1);
        }
    }

    /// The difference of a number: its length as a code of four bits, then its bits.
    fn difference(&mut self, value: i32) {
        let length = 32 - value.unsigned_abs().leading_zeros();
        self.add(length, 4);
        let bits = if value < 0 { value + (1 << length) - 1 } else { value };
        self.add(bits.unsigned_abs(), length);
    }
}

impl File {
    fn new(components: &[u8], further: Vec<u8>) -> Self {
        let components = components.iter().map(|&name| (name, [1, 1])).collect();
        let size = [37, 43];
        Self { size, frame: BASELINE, bits: 8, components, restart: None, further }
    }

    fn bytes(&self) -> Vec<u8> {
        let side = |k: usize| u16::try_from(self.size[k]).unwrap().to_be_bytes();
        let count = u8::try_from(self.components.len()).unwrap();
        let mut frame = vec![self.bits];
        frame.extend(side(1));
        frame.extend(side(0));
        frame.push(count);
        let mut scan = vec![count];
        for (name, [across, down]) in &self.components {
            frame.extend([*name, u8::try_from(across << 4 | down).unwrap(), 0]);
            scan.extend([*name, 0]);
        }
        let is_progressive = self.frame == PROGRESSIVE;
        scan.extend([0, if is_progressive { 0 } else { 63 }, 0]);
        let mut bytes = vec![0xff, 0xd8];
        bytes.extend(&self.further);
        bytes.extend(segment(0xdb, &[vec![0], vec![1; 64]].concat()));
        bytes.extend(segment(self.frame, &frame));
        // Codes of four bits for lengths 0 to 11; one bit for the end of a block.
        let lengths = [&[0, 0, 0, 0, 12][..], &[0; 12]].concat();
        bytes.extend(segment(0xc4, &[lengths, (0..12).collect()].concat()));
        bytes.extend(segment(0xc4, &[&[0x10, 1][..], &[0; 15], &[0]].concat()));
        if let Some(units) = self.restart {
            bytes.extend(segment(0xdd, &u16::try_from(units).unwrap().to_be_bytes()));
        }
        bytes.extend(segment(0xda, &scan));
        bytes.extend(self.data(is_progressive));
        bytes.extend([0xff, 0xd9]);
        bytes
    }

    fn data(&self, is_progressive: bool) -> Vec<u8> {
        let most = |k: usize| self.components.iter().map(|c| c.1[k]).max().unwrap();
        let is_alone = self.components.len() == 1;
        let [across, down] =
            [0, 1].map(|k| self.size[k].div_ceil(8 * if is_alone { 1 } else { most(k) }));
        let mut bits = Bits::default();
        let mut last = vec![0; self.components.len()];
        for unit in 0..across * down {
            if let Some(every) = self.restart
                && unit > 0
                && unit.is_multiple_of(every)
            {
                bits.fill();
                bits.bytes.extend([0xff, 0xd0 | u8::try_from((unit / every - 1) % 8).unwrap()]);
                last.fill(0);
            }
            for (c, (_, sampling)) in self.components.iter().enumerate() {
                let [wide, high] = if is_alone { [1, 1] } else { *sampling };
                for block in 0..wide * high {
                    let x = unit % across * wide + block % wide;
                    let y = unit / across * high + block / wide;
                    let value = 8 * (i32::from(number(c, [x, y])) - 128);
                    bits.difference(value - last[c]);
                    last[c] = value;
                    if !is_progressive {
                        bits.add(0, 1);
                    }
                }
            }
        }
        bits.fill();
        bits.bytes
    }
}

/// Colors as integers of 8 bits.
fn read(path: &Path, bytes: &[u8]) -> Result<Vec<[f32; 3]>, String> {
    std::fs::write(path, bytes).unwrap();
    let mut picture = Picture::open(path).map_err(|error| error.to_string())?;
    let mut rgb = Vec::new();
    for band in picture.bands(5) {
        let band = band.map_err(|error| error.to_string())?;
        assert!(band.alpha.is_none());
        rgb.extend(band.rgb.into_iter().map(|rgb| rgb.map(|v| v * 255.0)));
    }
    Ok(rgb)
}

/// Red, green and blue of JFIF's YCbCr.
fn rgb_of([y, cb, cr]: [f32; 3]) -> [f32; 3] {
    let (cb, cr) = (cb - 128.0, cr - 128.0);
    let rgb = [y + 1.402 * cr, y - 0.344_136 * cb - 0.714_136 * cr, y + 1.772 * cb];
    rgb.map(|v| v.clamp(0.0, 255.0))
}

#[test]
fn every_kind_reads_as_it_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.jpg");
    let colors = [
        (File::new(&[1], jfif()), false),
        (File::new(&[1, 2, 3], jfif()), true),
        (File::new(&[1, 2, 3], Vec::new()), true),
        (File::new(&[0, 1, 2], adobe(1)), true),
        (File::new(&[1, 2, 3], adobe(0)), false),
        (File::new(b"RGB", Vec::new()), false),
    ];
    let mut count = 0;
    for (file, is_ycbcr) in colors {
        for sampling in [[1, 1], [2, 1], [1, 2], [2, 2], [4, 1]] {
            for frame in [BASELINE, 0xc1, PROGRESSIVE] {
                for restart in [None, Some(1), Some(3)] {
                    let mut file = File { frame, restart, ..file.clone() };
                    file.components[0].1 = sampling;
                    let kind = format!("{file:?}");
                    let rgb = read(&path, &file.bytes()).unwrap_or_else(|e| panic!("{kind}: {e}"));
                    assert_eq!(rgb.len(), file.size[0] * file.size[1], "{kind}");
                    for (i, found) in rgb.into_iter().enumerate() {
                        let block = [i % file.size[0] / 8, i / file.size[0] / 8];
                        let stored = [0, 1, 2].map(|c| f32::from(number(c, block)));
                        let (expected, tolerance) = match (file.components.len(), is_ycbcr) {
                            (1, _) => ([stored[0]; 3], 0.0),
                            // Both of the decoder's roundings.
                            (_, true) => (rgb_of(stored), 1.0),
                            _ => (stored, 0.0),
                        };
                        let off = (0..3).any(|k| (found[k] - expected[k]).abs() > tolerance + 1e-4);
                        assert!(!off, "{i} of {kind}: {found:?}, expected {expected:?}");
                    }
                    count += 1;
                }
            }
        }
    }
    println!("{count} kinds of JPEG");
}

#[test]
fn what_is_not_read_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.jpg");
    let plain = File::new(&[1, 2, 3], jfif());
    let coded = |frame| File { frame, ..plain.clone() };
    for (file, found) in [
        (coded(0xc3), "lossless coding"),
        (coded(0xc5), "hierarchical coding"),
        (coded(0xc9), "arithmetic coding"),
        (coded(0xca), "arithmetic coding"),
        (File { bits: 12, ..coded(0xc1) }, "samples of 12 bits"),
        (File::new(&[1, 2, 3, 4], adobe(0)), "CMYK pixels"),
        (File::new(&[1, 2, 3, 4], Vec::new()), "CMYK pixels"),
        (File::new(&[1, 2, 3, 4], adobe(2)), "YCCK pixels"),
        (File::new(&[1, 2], jfif()), "2 components"),
        (File::new(b"RGB", jfif()), "damaged: components R, G and B that are said to be YCbCr"),
        (File { size: [0, 8], ..plain.clone() }, "0 by 8 pixels"),
    ] {
        let message = read(&path, &file.bytes()).unwrap_err();
        assert!(message.starts_with(found) && message.contains("expected"), "{message}");
    }
}

#[test]
fn a_file_that_ends_early_is_refused_wherever_it_ends() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.jpg");
    for frame in [BASELINE, PROGRESSIVE] {
        let whole = File { frame, ..File::new(&[1, 2, 3], jfif()) }.bytes();
        for length in 4..whole.len() {
            let message = read(&path, &whole[..length]).unwrap_err();
            assert_eq!(message, "damaged: it ends too early, expected a whole JPEG picture");
        }
        // What follows the end is no part of the picture.
        assert!(read(&path, &[&whole[..], &[0; 9]].concat()).is_ok());
    }
}

#[test]
fn exif_and_profiles_are_followed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.jpg");
    let stated = |further: Vec<u8>| {
        let file = File::new(&[1, 2, 3], further);
        std::fs::write(&path, file.bytes()).unwrap();
        let picture = Picture::open(&path).unwrap();
        let chosen = picture.chosen(&Declared::default()).map_err(|e| e.to_string());
        chosen.map(|c| (c.space.name().to_owned(), c.encoding, c.interpretation.space.by))
    };
    let unstated = "the file does not state its RGB space and encoding, expected a declaration";
    assert_eq!(stated(jfif()).unwrap_err(), unstated);
    assert_eq!(stated(exif(1, 0xffff)).unwrap_err(), unstated);
    let srgb = Ok(("srgb".to_owned(), Encoding::Srgb, "Exif".to_owned()));
    assert_eq!(stated(exif(1, 1)), srgb);
    assert!(stated(exif(1, 2)).unwrap_err().starts_with("Exif with ColorSpace 2"));
    let part = |number: u8, count: u8| {
        let head = [&b"ICC_PROFILE\0"[..], &[number, count], &[0; 40]].concat();
        segment(0xe2, &head)
    };
    // A profile has priority, and a part of one is not read.
    let message = stated([exif(1, 1), part(2, 2)].concat()).unwrap_err();
    assert!(message.starts_with("a damaged ICC profile"), "{message}");

    let file = File { size: [16, 8], ..File::new(&[1], exif(6, 1)) };
    let rgb = read(&path, &file.bytes()).unwrap();
    assert_eq!(Picture::open(&path).unwrap().size(), [8, 16]);
    let [left, right] = [[0, 0], [1, 0]].map(|at| f32::from(number(0, at)));
    assert!((rgb[0][0] - left).abs() < 1e-4 && (rgb[127][0] - right).abs() < 1e-4, "{rgb:?}");
}
