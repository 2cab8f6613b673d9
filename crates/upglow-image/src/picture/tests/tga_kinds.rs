//! Every kind of TGA reads as it was written, or is refused by name.

use std::path::Path;

use super::super::Picture;
use super::super::stated::{Declared, DeclaredAlpha};
use super::byte;

const SIZE: [usize; 2] = [13, 7];

/// A file to write.
#[derive(Clone, Copy, Debug)]
struct File {
    kind: u8,
    depth: u8,
    alpha_bits: u8,
    /// Bits of an entry of the color map.
    map_depth: u8,
    /// Bits 4 and 5: rows from the right, and from the top.
    origin: u8,
    is_packed: bool,
    /// What the extension area says of alpha.
    attributes: Option<u8>,
}

const RGB: File = File {
    kind: 2,
    depth: 24,
    alpha_bits: 0,
    map_depth: 0,
    origin: 0x20,
    is_packed: false,
    attributes: None,
};

/// The position of the first color of maps.
const FIRST: u16 = 3;
const MAP_COLORS: u16 = 90;

impl File {
    fn stored_bytes(bits: u8) -> usize {
        usize::from(bits.div_ceil(8))
    }

    /// The bytes of a pixel, of which some in turn are the same.
    fn pixel(self, i: usize) -> Vec<u8> {
        let seed = u32::try_from(i / 3).unwrap();
        if self.kind == 1 {
            let index = u16::try_from(seed % u32::from(MAP_COLORS)).unwrap() + FIRST;
            return index.to_le_bytes()[..Self::stored_bytes(self.depth)].to_vec();
        }
        let count = u32::try_from(Self::stored_bytes(self.depth)).unwrap();
        (0..count).map(|k| byte(seed * 4 + k)).collect()
    }

    fn map(self) -> Vec<Vec<u8>> {
        let count = u32::try_from(Self::stored_bytes(self.map_depth)).unwrap();
        let entry = |i: u16| (0..count).map(|k| byte(u32::from(i) * 5 + k)).collect();
        (0..MAP_COLORS).map(entry).collect()
    }

    fn bytes(self) -> Vec<u8> {
        let map_count = if self.kind == 1 { MAP_COLORS } else { 0 };
        let kind = self.kind + if self.is_packed { 8 } else { 0 };
        let mut bytes = vec![4, u8::from(map_count > 0), kind];
        bytes.extend(FIRST.to_le_bytes());
        bytes.extend(map_count.to_le_bytes());
        bytes.extend([self.map_depth, 0, 0, 0, 0]);
        bytes.extend(SIZE.map(|side| u16::try_from(side).unwrap().to_le_bytes()).concat());
        bytes.extend([self.depth, self.origin | self.alpha_bits]);
        bytes.extend(b"text");
        if map_count > 0 {
            bytes.extend(self.map().concat());
        }
        let pixels: Vec<Vec<u8>> = (0..SIZE[0] * SIZE[1]).map(|i| self.pixel(i)).collect();
        if self.is_packed {
            // Packets of repetitions and of other pixels go on into the next row.
            for run in pixels.chunks(12) {
                let count = u8::try_from(run.len() - 1).unwrap();
                if run.iter().all(|pixel| *pixel == run[0]) {
                    bytes.push(0x80 | count);
                    bytes.extend(&run[0]);
                    continue;
                }
                let (same, others) = run.split_at(3.min(run.len()));
                bytes.push(0x80 | u8::try_from(same.len() - 1).unwrap());
                bytes.extend(&same[0]);
                if !others.is_empty() {
                    bytes.push(u8::try_from(others.len() - 1).unwrap());
                    bytes.extend(others.concat());
                }
            }
        } else {
            bytes.extend(pixels.concat());
        }
        if let Some(attributes) = self.attributes {
            let at = u32::try_from(bytes.len()).unwrap();
            bytes.extend([0; 494]);
            bytes.push(attributes);
            bytes.extend(at.to_le_bytes());
            bytes.extend([0; 4]);
            bytes.extend(b"TRUEVISION-XFILE.\0");
        }
        bytes
    }

    /// Color and last sample of a stored pixel.
    fn expected(self, i: usize) -> ([f32; 3], Option<f32>) {
        let stored = self.pixel(i);
        let (stored, bits) = if self.kind == 1 {
            let index = stored.iter().rev().fold(0, |sum, b| sum * 256 + usize::from(*b));
            (self.map()[index - usize::from(FIRST)].clone(), self.map_depth)
        } else {
            (stored, self.depth)
        };
        let part = |k: usize| f32::from(stored[k]) / 255.0;
        match (self.kind, bits) {
            (3, 8) => ([part(0); 3], None),
            (3, _) => ([part(0); 3], Some(part(1))),
            (_, 24) => ([part(2), part(1), part(0)], None),
            (_, 32) => ([part(2), part(1), part(0)], Some(part(3))),
            _ => {
                let word = u32::from(stored[1]) << 8 | u32::from(stored[0]);
                let five = |at: u32| (word >> at & 31) as f32 / 31.0;
                ([five(10), five(5), five(0)], Some((word >> 15) as f32))
            }
        }
    }
}

type Read = (Vec<[f32; 3]>, Option<Vec<f32>>);

fn read(path: &Path, bytes: &[u8], declared: Option<DeclaredAlpha>) -> Result<Read, String> {
    std::fs::write(path, bytes).unwrap();
    let declared = Declared { alpha: declared, ..Declared::default() };
    let mut picture = Picture::open_as(path, &declared).map_err(|error| error.to_string())?;
    let (mut rgb, mut alpha) = (Vec::new(), Vec::new());
    for band in picture.bands(2) {
        let band = band.map_err(|error| error.to_string())?;
        rgb.extend(band.rgb);
        alpha.extend(band.alpha);
    }
    Ok((rgb, (!alpha.is_empty()).then(|| alpha.concat())))
}

/// Every kind of pixels and maps.
fn kinds() -> impl Iterator<Item = File> {
    let direct =
        [(2, 24, 0), (2, 32, 8), (2, 16, 1), (2, 16, 0), (2, 15, 0), (3, 8, 0), (3, 16, 8)];
    let direct = direct.map(|(kind, depth, alpha_bits)| File { kind, depth, alpha_bits, ..RGB });
    let maps = [(8, 24, 0), (16, 24, 0), (8, 32, 8), (8, 15, 0), (8, 16, 1)];
    let maps = maps.map(|(depth, map_depth, alpha_bits)| File {
        kind: 1,
        depth,
        alpha_bits,
        map_depth,
        ..RGB
    });
    direct.into_iter().chain(maps)
}

#[test]
fn every_kind_reads_as_it_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.tga");
    let [width, height] = SIZE;
    let mut count = 0;
    for kind in kinds() {
        for origin in [0, 0x10, 0x20, 0x30] {
            for is_packed in [false, true] {
                let file = File { origin, is_packed, ..kind };
                let (rgb, alpha) =
                    read(&path, &file.bytes(), Some(DeclaredAlpha::Straight)).unwrap();
                assert_eq!(alpha.is_some(), kind.alpha_bits > 0, "{file:?}");
                for (i, found) in rgb.iter().enumerate() {
                    let x = if origin & 0x10 == 0 { i % width } else { width - 1 - i % width };
                    let y = if origin & 0x20 == 0 { height - 1 - i / width } else { i / width };
                    let (color, last) = file.expected(y * width + x);
                    assert_eq!(*found, color, "pixel {i} of {file:?}");
                    if let Some(alpha) = &alpha {
                        assert_eq!(Some(alpha[i]), last, "alpha {i} of {file:?}");
                    }
                }
                count += 1;
            }
        }
    }
    println!("{count} kinds of TGA");
}

#[test]
fn what_the_extension_area_says_of_alpha_is_followed() {
    let folder = tempfile::tempdir().unwrap();
    // With the footer, the name of the file does not matter.
    let path = folder.path().join("x");
    let plain = File { depth: 32, alpha_bits: 8, ..RGB };
    let use_of = |attributes: u8| {
        let file = File { attributes: Some(attributes), ..plain };
        std::fs::write(&path, file.bytes()).unwrap();
        let picture = Picture::open(&path).map_err(|error| error.to_string())?;
        let declared = Declared {
            space: Some(upglow_color::RgbSpace::default()),
            encoding: Some(super::super::encoding::Encoding::Linear),
            ..Declared::default()
        };
        Ok::<_, String>(picture.chosen(&declared).unwrap().interpretation.alpha)
    };
    for (attributes, expected) in
        [(0, "none"), (1, "none"), (2, "none"), (3, "straight"), (4, "associated")]
    {
        assert_eq!(use_of(attributes), Ok(expected), "{attributes}");
    }
    assert!(use_of(9).unwrap_err().starts_with("a sample beside the colors"));
    let path = folder.path().join("x.tga");
    let message = read(&path, &plain.bytes(), None).unwrap_err();
    assert!(message.starts_with("a sample beside the colors"), "{message}");
    // A fourth byte of which the header says that it is no alpha.
    let (_, alpha) = read(&path, &File { alpha_bits: 0, ..plain }.bytes(), None).unwrap();
    assert_eq!(alpha, None);
}

#[test]
fn damaged_and_other_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.tga");
    for kind in kinds() {
        for is_packed in [false, true] {
            let whole = File { is_packed, ..kind }.bytes();
            for length in (0..whole.len()).step_by(7) {
                let found = read(&path, &whole[..length], Some(DeclaredAlpha::Straight));
                let message = found.unwrap_err();
                assert_eq!(message, "damaged: it ends too early, expected a whole TGA picture");
            }
        }
    }
    for (file, line) in [
        (File { kind: 0, ..RGB }, "damaged: a header of kind 0 with color map 0"),
        (File { kind: 2, depth: 8, ..RGB }, "colors of 8 bits, 0 of them"),
        (File { depth: 24, alpha_bits: 4, ..RGB }, "colors of 24 bits, 4 of them"),
        (File { kind: 3, depth: 16, ..RGB }, "pixels of 16 bits"),
        (File { origin: 0x60, ..RGB }, "interleaved rows"),
    ] {
        let message = read(&path, &file.bytes(), None).unwrap_err();
        assert!(message.starts_with(line), "{message}");
    }
    let mut file = File { kind: 1, depth: 8, map_depth: 24, ..RGB }.bytes();
    let end = file.len();
    file[end - 1] = 200;
    let message = read(&path, &file, None).unwrap_err();
    assert!(message.starts_with("damaged: color 200, which its map lacks"), "{message}");
    // Without its suffix, a file without the footer is not taken for TGA.
    let message = read(&folder.path().join("x"), &RGB.bytes(), None).unwrap_err();
    assert!(message.starts_with("the file begins with"), "{message}");
}
