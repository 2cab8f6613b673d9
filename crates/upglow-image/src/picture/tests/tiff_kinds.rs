//! Every kind of TIFF reads as the numbers that were written, or is refused by name.

use std::path::Path;

use super::super::Picture;
use super::super::band::Band;
use super::super::source::Alpha;
use super::super::stated::{Declared, DeclaredAlpha};
use super::tiff_file::{Chunk, Kind, TiffFile};

/// Reads a file that is written at `path`.
fn read(path: &Path, file: &TiffFile, declared: &Declared) -> Result<(Picture, Band), String> {
    std::fs::write(path, file.bytes()).unwrap();
    let mut picture = Picture::open_as(path, declared).map_err(|error| error.to_string())?;
    let bands = picture.bands(4).collect::<Result<Vec<_>, _>>().map_err(|e| e.to_string())?;
    let mut all = bands[0].clone();
    for band in &bands[1..] {
        all.rgb.extend(&band.rgb);
        if let (Some(all), Some(more)) = (&mut all.alpha, &band.alpha) {
            all.extend(more);
        }
    }
    Ok((picture, all))
}

/// Asserts that colors, and alpha if there is one, are those of the file.
fn assert_read(path: &Path, file: &TiffFile, colors: usize, alpha: Option<usize>) {
    let found = read(path, file, &Declared::default());
    let (picture, band) = found.unwrap_or_else(|error| panic!("{file:?}: {error}"));
    assert_eq!(picture.size(), file.size);
    let [width, _] = file.size;
    assert_eq!(band.alpha.is_some(), alpha.is_some(), "{file:?}");
    for (i, rgb) in band.rgb.iter().enumerate() {
        let at = [i % width, i / width];
        let expected = [0, 1, 2].map(|k| file.number(at, if colors == 1 { 0 } else { k }));
        assert_eq!(*rgb, expected, "{at:?} of {file:?}");
        if let (Some(sample), Some(found)) = (alpha, &band.alpha) {
            assert_eq!(found[i], file.number(at, sample), "alpha at {at:?} of {file:?}");
        }
    }
}

const KINDS: [Kind; 16] = [
    Kind::Integer(1),
    Kind::Integer(2),
    Kind::Integer(3),
    Kind::Integer(4),
    Kind::Integer(6),
    Kind::Integer(7),
    Kind::Integer(8),
    Kind::Integer(10),
    Kind::Integer(12),
    Kind::Integer(14),
    Kind::Integer(16),
    Kind::Integer(24),
    Kind::Integer(32),
    Kind::Float(16),
    Kind::Float(32),
    Kind::Float(64),
];
/// Photometric interpretation, samples a pixel, kinds of extra samples, and which one is alpha.
const LAYOUTS: [(u16, usize, &[u16], Option<usize>); 9] = [
    (1, 1, &[], None),
    (0, 1, &[], None),
    (1, 2, &[2], Some(1)),
    (1, 2, &[1], Some(1)),
    (2, 3, &[], None),
    (2, 4, &[2], Some(3)),
    (2, 4, &[0], None),
    (2, 5, &[0, 1], Some(4)),
    (2, 6, &[0, 0, 0], None),
];

#[test]
fn altered_tiffs_panic_nowhere() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.tif");
    for (i, (file, ..)) in readable().step_by(2003).enumerate() {
        let whole = file.bytes();
        // The directory is at the end; the data before it are altered more thinly.
        let start = whole.len().saturating_sub(400);
        for at in (0..start).step_by(211).chain((start..whole.len()).step_by(3)) {
            let mut altered = whole.clone();
            altered[at] = [0xff, 0, altered[at] ^ 0x11][(at + i) % 3];
            std::fs::write(&path, altered).unwrap();
            // A message is one line; anything but a panic is right.
            if let Ok(mut picture) = Picture::open(&path) {
                picture.bands(8).for_each(|band| {
                    let message = band.err().map(|error| error.to_string()).unwrap_or_default();
                    assert!(!message.contains('\n') && message.len() < 400, "{message}");
                });
            }
        }
    }
}

/// The predictors that a kind of sample can have with a compression.
fn predictors(kind: Kind, compression: u16) -> &'static [u16] {
    match (kind, compression) {
        (_, 1 | 32773) => &[1],
        (Kind::Float(_), _) => &[1, 2, 3],
        (Kind::Integer(8 | 16 | 32), _) => &[1, 2],
        _ => &[1],
    }
}

/// Every combination of the properties of files that must be read.
fn readable() -> impl Iterator<Item = (TiffFile, usize, Option<usize>)> {
    let chunks = [Chunk::Strips(21), Chunk::Strips(5), Chunk::Tiles([16, 16])];
    let mut files = Vec::new();
    for kind in KINDS {
        for (photometric, samples, extra, alpha) in LAYOUTS {
            if photometric == 0 && matches!(kind, Kind::Float(_)) {
                continue;
            }
            for compression in [1, 5, 8, 32946, 32773] {
                for &predictor in predictors(kind, compression) {
                    for chunk in chunks {
                        for bits in 0..8_u16 {
                            files.push((
                                TiffFile {
                                    kind,
                                    photometric,
                                    samples,
                                    extra: (!extra.is_empty()).then(|| extra.to_vec()),
                                    compression,
                                    predictor,
                                    chunk,
                                    is_big_endian: bits & 1 != 0,
                                    is_planar: bits & 2 != 0,
                                    fill_order: if bits & 4 != 0 { 2 } else { 1 },
                                    is_bigtiff: compression == 8,
                                    ..TiffFile::default()
                                },
                                if photometric == 2 { 3 } else { 1 },
                                alpha,
                            ));
                        }
                    }
                }
            }
        }
    }
    files.into_iter()
}

/// Reads every `step`th of the files; how many that are.
fn assert_all_read(step: usize) -> usize {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.tif");
    let files = readable().step_by(step);
    files.map(|(file, colors, alpha)| assert_read(&path, &file, colors, alpha)).count()
}

#[test]
fn every_kind_of_tiff_reads_as_it_was_written() {
    // The step has no divisor in common with the counts of the properties, so each pair of them occurs.
    let count = assert_all_read(13);
    assert!(count > 1_000, "{count}");
}

#[test]
#[ignore = "slow: a minute"]
fn slow_every_combination_of_tiff_reads_as_it_was_written() {
    let count = assert_all_read(1);
    assert!(count > 13_000, "{count}");
}

#[test]
fn narrow_and_large_tiffs_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.tif");
    for size in [[1, 1], [1, 40], [300, 1], [500, 300]] {
        for compression in [1, 5, 8, 32773] {
            for chunk in [Chunk::Strips(size[1]), Chunk::Strips(7), Chunk::Tiles([48, 32])] {
                for kind in [Kind::Integer(1), Kind::Integer(4), Kind::Integer(16)] {
                    let file = TiffFile { size, compression, chunk, kind, ..TiffFile::default() };
                    assert_read(&path, &file, 3, None);
                }
            }
        }
    }
}

#[test]
fn tiffs_are_turned_upright() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.tif");
    let [width, height] = TiffFile::default().size;
    // For each orientation, where the pixel of stored column x and row y is shown: TIFF 6.0, page 36.
    let (right, bottom) = (width - 1, height - 1);
    type Place = fn(usize, usize, usize, usize) -> [usize; 2];
    let shown: [(u16, Place); 8] = [
        (1, |x, y, _, _| [x, y]),
        (2, |x, y, right, _| [right - x, y]),
        (3, |x, y, right, bottom| [right - x, bottom - y]),
        (4, |x, y, _, bottom| [x, bottom - y]),
        (5, |x, y, _, _| [y, x]),
        (6, |x, y, _, bottom| [bottom - y, x]),
        (7, |x, y, right, bottom| [bottom - y, right - x]),
        (8, |x, y, right, _| [y, right - x]),
    ];
    for (orientation, place) in shown {
        for chunk in [Chunk::Strips(4), Chunk::Tiles([16, 16])] {
            let file = TiffFile { orientation, chunk, ..TiffFile::default() };
            let (picture, band) = read(&path, &file, &Declared::default()).unwrap();
            let size = if orientation < 5 { [width, height] } else { [height, width] };
            assert_eq!(picture.size(), size);
            for y in 0..height {
                for x in 0..width {
                    let [column, row] = place(x, y, right, bottom);
                    let expected = [0, 1, 2].map(|k| file.number([x, y], k));
                    assert_eq!(band.rgb[row * size[0] + column], expected, "{orientation} {x} {y}");
                }
            }
        }
    }
}

#[test]
fn the_use_of_a_further_sample_can_be_declared_and_must_be_if_nothing_states_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.tif");
    let with = |alpha| Declared { alpha, ..Declared::default() };
    let unstated = TiffFile { samples: 4, ..TiffFile::default() };
    let message = read(&path, &unstated, &with(None)).unwrap_err();
    assert!(message.starts_with("a sample beside the colors"), "{message}");
    let stated = TiffFile { extra: Some(vec![1]), ..unstated.clone() };
    for file in [&unstated, &stated] {
        for (declared, alpha) in [
            (DeclaredAlpha::Straight, Some(Alpha::Straight)),
            (DeclaredAlpha::Associated, Some(Alpha::Associated)),
            (DeclaredAlpha::None, None),
        ] {
            let (picture, band) = read(&path, file, &with(Some(declared))).unwrap();
            assert_eq!((picture.alpha(), band.alpha.is_some()), (alpha, alpha.is_some()));
        }
    }
    let (picture, _) = read(&path, &stated, &with(None)).unwrap();
    assert_eq!(picture.alpha(), Some(Alpha::Associated));
}

#[test]
fn kinds_of_tiff_that_are_not_read_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.tif");
    let plain = TiffFile::default;
    let predicted = |kind, predictor, compression| TiffFile {
        kind,
        predictor,
        compression,
        ..TiffFile::default()
    };
    let further = |tag, value: u16| TiffFile {
        further: vec![(tag, value.to_le_bytes().to_vec())],
        ..TiffFile::default()
    };
    let cases = [
        (TiffFile { compression: 7, ..plain() }, "JPEG compression, expected none, LZW"),
        (TiffFile { compression: 50000, ..plain() }, "Zstandard compression, expected"),
        (TiffFile { compression: 4, ..plain() }, "CCITT compression, expected"),
        (TiffFile { compression: 999, ..plain() }, "compression 999, expected"),
        (TiffFile { photometric: 3, samples: 1, ..plain() }, "palette pixels, expected gray"),
        (TiffFile { photometric: 5, samples: 4, ..plain() }, "CMYK pixels, expected gray or RGB"),
        (TiffFile { photometric: 6, ..plain() }, "YCbCr pixels, expected"),
        (TiffFile { photometric: 8, ..plain() }, "CIELAB pixels, expected"),
        (TiffFile { photometric: 77, ..plain() }, "pixels of kind 77, expected"),
        (TiffFile { samples: 2, ..plain() }, "2 samples a pixel, expected"),
        (predicted(Kind::Integer(12), 2, 5), "predictor 2 of samples of 12 bits, expected"),
        (predicted(Kind::Integer(32), 3, 5), "predictor 3 of samples of 32 bits, expected"),
        (predicted(Kind::Integer(8), 2, 1), "predictor 2 without LZW or deflate, expected"),
        (further(254, 1), "damaged: field 254 is of type 7"),
    ];
    for (file, line) in cases {
        let message = read(&path, &file, &Declared::default()).map(|_| ()).unwrap_err();
        assert!(message.starts_with(line) && message.contains("expected"), "{line}: {message}");
    }
}

#[test]
fn damaged_deflate_data_is_refused_by_its_checksum() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.tif");
    let size = [400, 60];
    let file = TiffFile { size, compression: 8, chunk: Chunk::Strips(60), ..TiffFile::default() };
    let whole = file.bytes();
    let mut refused = 0;
    let flips = (600..whole.len() - 600).step_by(997);
    for at in flips.clone() {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x10;
        std::fs::write(&path, bytes).unwrap();
        let mut picture = Picture::open(&path).unwrap();
        refused += usize::from(picture.bands(16).any(|band| band.is_err()));
    }
    assert_eq!(refused, flips.count());
}

/// A `BigTIFF` with these fields of one number each.
fn bigtiff_of(fields: &[(u16, u64)]) -> Vec<u8> {
    let mut bytes = b"II\x2b\0\x08\0\0\0".to_vec();
    bytes.extend([16, fields.len() as u64].iter().flat_map(|v| v.to_le_bytes()));
    for (tag, value) in fields {
        bytes.extend([*tag, 16].iter().flat_map(|v| v.to_le_bytes()));
        bytes.extend([1, *value].iter().flat_map(|v| v.to_le_bytes()));
    }
    bytes.extend([0; 64]);
    bytes
}

#[test]
fn fields_of_the_greatest_numbers_are_refused() {
    // Width, height, bits, photometric, tile width, tile height, offset: with each of them in turn at most.
    let fields = [(256, 20), (257, 20), (258, 8), (262, 1), (322, 16), (323, 16), (324, 100)];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.tif");
    for (i, (tag, _)) in fields.iter().enumerate() {
        for most in [u64::MAX, 1 << 63, 1 << 32] {
            let mut fields = fields;
            fields[i].1 = most;
            std::fs::write(&path, bigtiff_of(&fields)).unwrap();
            let found = Picture::open(&path);
            assert!(found.is_err(), "{tag} {most}");
        }
    }
    // One tile whose bytes are not counted: its rows times their bytes exceed every number.
    let one_tile =
        [(256, 16), (257, 16), (258, 8), (262, 1), (322, 16), (323, 1 << 63), (324, 100)];
    std::fs::write(&path, bigtiff_of(&one_tile)).unwrap();
    let found = Picture::open(&path).and_then(|mut picture| picture.read_band(1));
    assert!(found.unwrap_err().to_string().starts_with("damaged: a strip or tile of"));
}
