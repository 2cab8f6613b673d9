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

/// A file with other chunks in place of one.
fn with(bytes: &[u8], name: &[u8; 4], chunks: &[u8]) -> Vec<u8> {
    let at = bytes.windows(4).position(|window| window == name).unwrap() - 4;
    let length = u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    [&bytes[..at], chunks, &bytes[at + 12 + length..]].concat()
}

/// A profile that is compressed as PNG asks, with these bytes before it.
fn packed(head: &[u8], profile: &[u8]) -> Vec<u8> {
    [head, &miniz_oxide::deflate::compress_to_vec_zlib(profile, 1)].concat()
}

#[test]
fn a_damaged_chunk_of_colors_is_refused_by_name_whatever_follows_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    let lengths = |right: usize| (0..40).filter(move |length| *length != right);
    let zeros = |right| lengths(right).map(|length| vec![1; length]);
    let mut damaged: Vec<(&[u8; 4], Vec<u8>)> = Vec::new();
    for (name, right) in [(b"cICP", 4), (b"sRGB", 1), (b"gAMA", 4), (b"cHRM", 32), (b"tRNS", 6)] {
        damaged.extend(zeros(right).map(|content| (name, content)));
    }
    damaged.extend((4..=255).map(|intent| (b"sRGB", vec![intent])));
    damaged.extend((2..=255).map(|flag| (b"cICP", vec![1, 13, 0, flag])));
    damaged.push((b"gAMA", vec![0; 4]));
    let whole = packed(b"a\0\0", &[7; 500]);
    damaged.extend((0..whole.len() - 4).map(|length| (b"iCCP", whole[..length].to_vec())));
    damaged.extend((1..=255).map(|method| (b"iCCP", packed(&[b'a', 0, method], &[7; 500]))));
    damaged.push((b"iCCP", packed(b"\0\0", &[7; 500])));
    damaged.push((b"iCCP", packed(&[b"a".repeat(81), vec![0, 0]].concat(), &[7; 500])));
    damaged.push((b"iCCP", packed(b"a\0\0", &vec![0; 65 << 20])));
    let srgb = chunk(b"sRGB", &[0]);
    for (name, content) in damaged {
        let bad = chunk(name, &content);
        let text = str::from_utf8(name).unwrap();
        let others = if name == b"sRGB" { chunk(b"gAMA", &[0, 0, 177, 143]) } else { srgb.clone() };
        for chunks in [[&bad[..], &others].concat(), [&others[..], &bad].concat(), bad.clone()] {
            let found = read(&path, &file(2, 3, 8, false, &chunks));
            let message = found.expect_err(&format!("{text}: {content:?}"));
            let begin = format!("damaged: its {text} chunk ");
            assert!(
                message.starts_with(&begin),
                "{message}: {:?}",
                &content[..content.len().min(9)]
            );
        }
    }
}

#[test]
fn a_chunk_of_colors_that_is_there_twice_or_after_the_palette_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    let contents: [(&[u8; 4], Vec<u8>); 6] = [
        (b"cICP", vec![1, 13, 0, 1]),
        (b"iCCP", packed(b"a\0\0", &[7; 500])),
        (b"sRGB", vec![0]),
        (b"gAMA", vec![0, 0, 177, 143]),
        (b"cHRM", vec![1; 32]),
        (b"tRNS", vec![0; 6]),
    ];
    for (name, content) in contents {
        let once = chunk(name, &content);
        let message = read(&path, &file(2, 3, 8, false, &once.repeat(2))).unwrap_err();
        assert!(
            message.starts_with(&format!("damaged: two {} chunks", str::from_utf8(name).unwrap()))
        );
    }
    let late = [chunk(b"PLTE", &[0; 3]), chunk(b"cICP", &[1, 13, 0, 1])].concat();
    let message = read(&path, &file(2, 3, 8, false, &late)).unwrap_err();
    assert!(
        message.starts_with("damaged: its cICP chunk is invalid or in a wrong place"),
        "{message}"
    );
}

#[test]
fn an_index_beyond_the_palette_is_refused_and_those_within_have_their_alpha() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    for bits in [1, 2, 4, 8] {
        for is_interlaced in [false, true] {
            let whole = file(3, 1, bits, is_interlaced, &[]);
            let pixels = (0..SIZE[0] * SIZE[1]).map(|i| code([i % SIZE[0], i / SIZE[0]], 0, bits));
            let indices: Vec<u64> = pixels.collect();
            let greatest = *indices.iter().max().unwrap();
            for colors in 1..=1 << bits {
                let map: Vec<u8> = (0..colors).flat_map(palette).collect();
                let alpha: Vec<u8> =
                    (0..colors.div_ceil(2)).map(|i| u8::try_from(i * 5 % 256).unwrap()).collect();
                let chunks = [chunk(b"PLTE", &map), chunk(b"tRNS", &alpha)].concat();
                let found = read(&path, &with(&whole, b"PLTE", &chunks));
                if colors <= greatest {
                    let message = found.unwrap_err();
                    let index = message.strip_prefix("damaged: color ").expect(&message);
                    let (index, _) = index.split_once(", which its map lacks").unwrap();
                    let index: u64 = index.parse().unwrap();
                    assert!(index >= colors && indices.contains(&index), "{message}");
                    continue;
                }
                let (rgb, alphas) = found.unwrap();
                for (i, &index) in indices.iter().enumerate() {
                    let opacity =
                        alpha.get(usize::try_from(index).unwrap()).copied().unwrap_or(255);
                    assert_eq!(rgb[i], palette(index).map(|v| f32::from(v) / 255.0));
                    assert_eq!(alphas[i], f32::from(opacity) / 255.0);
                }
            }
            for map in [vec![], vec![0; 4], vec![0; 5]] {
                let message =
                    read(&path, &with(&whole, b"PLTE", &chunk(b"PLTE", &map))).unwrap_err();
                assert!(message.starts_with("damaged: "), "{message}");
            }
            let chunks = [chunk(b"PLTE", &[0; 3]), chunk(b"tRNS", &[0; 2])].concat();
            let message = read(&path, &with(&whole, b"PLTE", &chunks)).unwrap_err();
            assert!(message.starts_with("damaged: 2 alphas for 1 colors"), "{message}");
        }
    }
}

#[test]
fn a_size_beyond_the_limit_is_told_as_a_size() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    let whole = file(2, 3, 8, false, &[]);
    let sides = [0, 1 << 17 | 1, 1 << 20, 1 << 30, i32::MAX.cast_unsigned(), u32::MAX];
    for [width, height] in sides.iter().flat_map(|&side| [[side, 9], [9, side], [side; 2]]) {
        let mut header = [width.to_be_bytes(), height.to_be_bytes()].concat();
        header.extend([16, 6, 0, 0, 0]);
        let message = read(&path, &with(&whole, b"IHDR", &chunk(b"IHDR", &header))).unwrap_err();
        assert_eq!(message, format!("{width} by {height} pixels, expected 1 to 131072 a side"));
    }
}
