//! Every kind of PNG reads as it was written; damaged ones are refused.

use std::path::Path;

use super::super::Picture;

/// A chunk with its checksum.
fn chunk(name: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let length = u32::try_from(data.len()).unwrap().to_be_bytes();
    let checked = [&name[..], data].concat();
    [&length[..], &checked, &crc(&checked).to_be_bytes()].concat()
}

/// The checksum of PNG, bit by bit as in its annex D.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| {
            if sum & 1 == 1 { 0xedb8_8320 ^ sum >> 1 } else { sum >> 1 }
        })
    })
}

const SIZE: [usize; 2] = [13, 11];
/// The code of each color type, its samples, and its bit depths.
const TYPES: [(u8, usize, &[usize]); 5] = [
    (0, 1, &[1, 2, 4, 8, 16]),
    (2, 3, &[8, 16]),
    (3, 1, &[1, 2, 4, 8]),
    (4, 2, &[8, 16]),
    (6, 4, &[8, 16]),
];

fn code([x, y]: [usize; 2], sample: usize, bits: usize) -> u64 {
    (x as u64 * 7919 + y as u64 * 104_729 + sample as u64 * 1_299_709) >> 3 & ((1 << bits) - 1)
}

fn palette(index: u64) -> [u8; 3] {
    [1, 3, 7].map(|k| u8::try_from(index * k % 256).unwrap())
}

/// A row of some columns, with filter 0.
fn row(columns: &[usize], y: usize, samples: usize, bits: usize) -> Vec<u8> {
    let codes = columns.iter().flat_map(|&x| (0..samples).map(move |s| code([x, y], s, bits)));
    let codes: Vec<u64> = codes.collect();
    let mut bytes = vec![0; (codes.len() * bits).div_ceil(8)];
    for (i, code) in codes.iter().enumerate() {
        for bit in 0..bits {
            let at = i * bits + bit;
            bytes[at / 8] |= u8::try_from(code >> (bits - 1 - bit) & 1).unwrap() << (7 - at % 8);
        }
    }
    bytes.insert(0, 0);
    bytes
}

fn file(color: u8, samples: usize, bits: usize, is_interlaced: bool, further: &[u8]) -> Vec<u8> {
    let [width, height] = SIZE.map(|side| u32::try_from(side).unwrap());
    let depth = u8::try_from(bits).unwrap();
    let mut header = [width.to_be_bytes(), height.to_be_bytes()].concat();
    header.extend([depth, color, 0, 0, u8::from(is_interlaced)]);
    // First column and row and the steps of each pass.
    let passes: &[[usize; 4]] = if is_interlaced {
        &[
            [0, 0, 8, 8],
            [4, 0, 8, 8],
            [0, 4, 4, 8],
            [2, 0, 4, 4],
            [0, 2, 2, 4],
            [1, 0, 2, 2],
            [0, 1, 1, 2],
        ]
    } else {
        &[[0, 0, 1, 1]]
    };
    let mut data = Vec::new();
    for &[left, top, right, down] in passes {
        let columns: Vec<usize> = (left..SIZE[0]).step_by(right).collect();
        for y in (top..SIZE[1]).step_by(down).filter(|_| !columns.is_empty()) {
            data.extend(row(&columns, y, samples, bits));
        }
    }
    let packed = miniz_oxide::deflate::compress_to_vec_zlib(&data, 6);
    let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
    bytes.extend(chunk(b"IHDR", &header));
    bytes.extend(further);
    if color == 3 {
        let colors: Vec<u8> = (0..1 << bits).flat_map(palette).collect();
        bytes.extend(chunk(b"PLTE", &colors));
    }
    // Two chunks of data, as encoders write large pictures.
    let (first, second) = packed.split_at(packed.len() / 2);
    bytes.extend(chunk(b"IDAT", first));
    bytes.extend(chunk(b"IDAT", second));
    bytes.extend(chunk(b"IEND", &[]));
    bytes
}

/// Colors and alpha of the whole picture.
fn read(path: &Path, bytes: &[u8]) -> Result<(Vec<[f32; 3]>, Vec<f32>), String> {
    std::fs::write(path, bytes).unwrap();
    let mut picture = Picture::open(path).map_err(|error| error.to_string())?;
    let (mut rgb, mut alpha) = (Vec::new(), Vec::new());
    for band in picture.bands(4) {
        let band = band.map_err(|error| error.to_string())?;
        rgb.extend(band.rgb);
        alpha.extend(band.alpha.unwrap_or_default());
    }
    Ok((rgb, alpha))
}

#[test]
fn every_type_and_depth_reads_as_it_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    for (color, samples, depths) in TYPES {
        for &bits in depths {
            for is_interlaced in [false, true] {
                let kind = format!("type {color}, {bits} bits, interlaced {is_interlaced}");
                let (rgb, alpha) =
                    read(&path, &file(color, samples, bits, is_interlaced, &[])).unwrap();
                let greatest = ((1_u64 << bits) - 1) as f32;
                assert_eq!(alpha.is_empty(), samples % 2 == 1, "{kind}");
                for (i, found) in rgb.iter().enumerate() {
                    let at = [i % SIZE[0], i / SIZE[0]];
                    let number = |sample| code(at, sample, bits) as f32 / greatest;
                    let expected = match (color, samples) {
                        (3, _) => palette(code(at, 0, bits)).map(|v| f32::from(v) / 255.0),
                        (_, 1 | 2) => [number(0); 3],
                        _ => [0, 1, 2].map(number),
                    };
                    assert_eq!(*found, expected, "{at:?} of {kind}");
                    if let Some(alpha) = alpha.get(i) {
                        assert_eq!(*alpha, number(samples - 1), "alpha at {at:?} of {kind}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_flipped_bit_anywhere_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    let srgb = chunk(b"sRGB", &[0]);
    for is_interlaced in [false, true] {
        let whole = file(2, 3, 8, is_interlaced, &srgb);
        for at in 8..whole.len() {
            let mut damaged = whole.clone();
            damaged[at] ^= 0x04;
            assert!(read(&path, &damaged).is_err(), "byte {at} of {}", whole.len());
        }
    }
}

#[test]
fn the_orientation_in_exif_is_followed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    for is_big in [false, true] {
        let order = if is_big { *b"MM" } else { *b"II" };
        let numbers = |values: &[(u32, usize)]| -> Vec<u8> {
            let bytes = |&(value, size): &(u32, usize)| {
                let mut bytes = value.to_le_bytes()[..size].to_vec();
                if is_big {
                    bytes.reverse();
                }
                bytes
            };
            values.iter().flat_map(bytes).collect()
        };
        // One field: orientation 6, a short.
        let fields = [(42, 2), (8, 4), (1, 2), (274, 2), (3, 2), (1, 4), (6, 2), (0, 2), (0, 4)];
        let exif = chunk(b"eXIf", &[&order[..], &numbers(&fields)].concat());
        let bytes = file(2, 3, 8, false, &exif);
        let (rgb, _) = read(&path, &bytes).unwrap();
        assert_eq!(Picture::open(&path).unwrap().size(), [SIZE[1], SIZE[0]]);
        // The first stored pixel is shown at the top right.
        let first = [0, 1, 2].map(|s| code([0, 0], s, 8) as f32 / 255.0);
        assert_eq!(rgb[SIZE[1] - 1], first);
    }
}
