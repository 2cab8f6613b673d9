//! Every kind of Radiance picture reads as it was written.

use std::path::Path;

use super::super::Picture;
use super::super::encoding::Encoding;

const SIZE: [usize; 2] = [11, 6];
type Rgbe = [u8; 4];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Coding {
    Plain,
    /// Repetitions of pixels.
    Old,
    /// Repetitions in each component.
    New,
}

/// A pixel, many of which repeat the one to their left.
fn pixel(i: usize) -> Rgbe {
    let v = u8::try_from(i / 4 * 37 % 256).unwrap();
    match i % 13 {
        0 => [0; 4],
        // A first mantissa of 128 or more cannot be taken for the head of a repetition or row.
        _ => [v | 128, v / 2, v / 3, 120 + v % 16],
    }
}

/// A row in one of the codings.
fn row(pixels: &[Rgbe], coding: Coding) -> Vec<u8> {
    match coding {
        Coding::Plain => pixels.concat(),
        Coding::Old => pixels
            .chunk_by(|a, b| a == b)
            .flat_map(|run| {
                let repeated = u8::try_from(run.len() - 1).unwrap();
                let more = (repeated > 0).then_some([1, 1, 1, repeated]);
                std::iter::once(run[0]).chain(more).flatten()
            })
            .collect(),
        Coding::New => {
            let width = u16::try_from(pixels.len()).unwrap().to_be_bytes();
            let mut bytes = vec![2, 2, width[0], width[1]];
            for k in 0..4 {
                for run in pixels.chunk_by(|a, b| a[k] == b[k]) {
                    let length = u8::try_from(run.len()).unwrap();
                    let code = if length > 2 { vec![128 + length, run[0][k]] } else { Vec::new() };
                    let plain = [vec![length], run.iter().map(|p| p[k]).collect()].concat();
                    bytes.extend(if code.is_empty() { plain } else { code });
                }
            }
            bytes
        }
    }
}

fn file(lines: &str, resolution: &str, stored: [usize; 2], coding: Coding) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\n{lines}\n{resolution}\n").into_bytes();
    for y in 0..stored[1] {
        let pixels: Vec<Rgbe> = (0..stored[0]).map(|x| pixel(y * stored[0] + x)).collect();
        bytes.extend(row(&pixels, coding));
    }
    bytes
}

const FORMAT: &str = "FORMAT=32-bit_rle_rgbe\n";

fn read(path: &Path, bytes: &[u8]) -> Result<Vec<[f32; 3]>, String> {
    std::fs::write(path, bytes).unwrap();
    let mut picture = Picture::open(path).map_err(|error| error.to_string())?;
    let mut rgb = Vec::new();
    for band in picture.bands(4) {
        rgb.extend(band.map_err(|error| error.to_string())?.rgb);
    }
    Ok(rgb)
}

fn color([r, g, b, e]: Rgbe) -> [f32; 3] {
    let scale = if e == 0 { 0.0 } else { (f32::from(e) - 136.0).exp2() };
    [r, g, b].map(|v| f32::from(v) * scale)
}

#[test]
fn every_coding_and_orientation_reads_as_it_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.hdr");
    // Stored column and row of a shown pixel, by whether each counts backwards.
    type At = fn([usize; 2], [usize; 2]) -> [usize; 2];
    let orientations: [(&str, bool, At); 8] = [
        ("-Y H +X W", false, |[x, y], _| [x, y]),
        ("-Y H -X W", false, |[x, y], [w, _]| [w - 1 - x, y]),
        ("+Y H -X W", false, |[x, y], [w, h]| [w - 1 - x, h - 1 - y]),
        ("+Y H +X W", false, |[x, y], [_, h]| [x, h - 1 - y]),
        ("+X W -Y H", true, |[x, y], _| [y, x]),
        ("-X W -Y H", true, |[x, y], [w, _]| [y, w - 1 - x]),
        ("-X W +Y H", true, |[x, y], [w, h]| [h - 1 - y, w - 1 - x]),
        ("+X W +Y H", true, |[x, y], [_, h]| [h - 1 - y, x]),
    ];
    let mut count = 0;
    for coding in [Coding::Plain, Coding::Old, Coding::New] {
        for [width, height] in [SIZE, [8, 9], [300, 8]] {
            for (words, exchanged, at) in orientations {
                let line = words.replace('W', &width.to_string()).replace('H', &height.to_string());
                let stored = if exchanged { [height, width] } else { [width, height] };
                // Rows of other widths have no such coding, and our runs are of 127 at most.
                if coding == Coding::New && !(8..128).contains(&stored[0]) {
                    continue;
                }
                let rgb = read(&path, &file(FORMAT, &line, stored, coding)).unwrap();
                assert_eq!(Picture::open(&path).unwrap().size(), [width, height]);
                for (i, found) in rgb.iter().enumerate() {
                    let [x, y] = at([i % width, i / width], [width, height]);
                    let expected = color(pixel(y * stored[0] + x));
                    assert_eq!(*found, expected, "pixel {i} of {line}, {coding:?}");
                }
                count += 1;
            }
        }
    }
    println!("{count} kinds of Radiance pictures");
}

#[test]
fn long_repetitions_count_in_steps_of_256() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.hdr");
    let mut bytes = format!("#?RGBE\n{FORMAT}\n-Y 1 +X 600\n").into_bytes();
    // 1 + 87 + 2 · 256 pixels.
    bytes.extend([128, 64, 32, 129, 1, 1, 1, 87, 1, 1, 1, 2]);
    assert_eq!(read(&path, &bytes).unwrap(), [[1.0, 0.5, 0.25]; 600]);
}

#[test]
fn exposure_is_undone_and_primaries_are_followed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.hdr");
    let of = |lines: &str| {
        let lines = format!("{FORMAT}{lines}");
        read(&path, &file(&lines, "-Y 6 +X 11", SIZE, Coding::Plain)).map(|rgb| rgb[5])
    };
    let plain = of("").unwrap();
    let picture = Picture::open(&path).unwrap();
    assert_eq!((picture.space(), picture.encoding()), (None, Some(Encoding::Linear)));
    assert_eq!(of("EXPOSURE=2\nEXPOSURE= 2.0\n").unwrap(), plain.map(|v| v / 4.0));
    let [r, g, b] = plain;
    assert_eq!(of("COLORCORR= 2 1 0.5\n").unwrap(), [r / 2.0, g, b * 2.0]);
    of("PRIMARIES=0.708 0.292 0.17 0.797 0.131 0.046 0.3127 0.329\n").unwrap();
    let picture = Picture::open(&path).unwrap();
    assert_eq!(picture.space().map(|space| space.name()), Some("rec2020"));
    for lines in [
        "EXPOSURE=0\n",
        "EXPOSURE=1e999\n",
        "EXPOSURE=1e-999\n",
        "EXPOSURE=x\n",
        "COLORCORR=1 1\n",
        "PRIMARIES=0 0\n",
    ] {
        let message = of(lines).unwrap_err();
        let key = lines.split('=').next().unwrap();
        assert!(message.starts_with(&format!("damaged: {key}=")), "{message}");
    }
}

#[test]
fn damaged_and_other_pictures_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.hdr");
    let xyz = file("FORMAT=32-bit_rle_xyze\n", "-Y 6 +X 11", SIZE, Coding::Plain);
    let message = read(&path, &xyz).unwrap_err();
    assert!(
        message.starts_with("pixels \"32-bit_rle_xyze\", expected 32-bit_rle_rgbe"),
        "{message}"
    );
    let without = file("", "-Y 6 +X 11", SIZE, Coding::Plain);
    assert!(read(&path, &without).unwrap_err().contains("no line FORMAT"));
    for resolution in ["", "-Y 6", "-Y 6 +Y 11", "-Y -6 +X 11", "6 11"] {
        let message = read(&path, &file(FORMAT, resolution, SIZE, Coding::Plain)).unwrap_err();
        assert!(message.contains("in place of its size"), "{message}");
    }
    for coding in [Coding::Plain, Coding::Old, Coding::New] {
        let whole = file(FORMAT, "-Y 6 +X 11", SIZE, coding);
        for length in 2..whole.len() {
            assert!(read(&path, &whole[..length]).is_err(), "{coding:?}, {length} bytes");
        }
    }
    let head = format!("#?RADIANCE\n{FORMAT}\n-Y 1 +X 8\n").into_bytes();
    for row in [
        // A width that differs, runs that end outside the row, a run of nothing, no pixel to repeat.
        &[2, 2, 0, 9][..],
        &[2, 2, 0, 8, 137, 0],
        &[2, 2, 0, 8, 9, 0, 0, 0, 0, 0, 0, 0, 0, 0],
        &[2, 2, 0, 8, 0],
        &[1, 1, 1, 8],
        &[200, 2, 2, 129, 1, 1, 1, 8],
    ] {
        let message = read(&path, &[&head, row].concat()).unwrap_err();
        assert!(message.starts_with("damaged: a r"), "{message}");
    }
}

#[test]
fn exposures_whose_product_is_no_exposure_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.hdr");
    let plain = read(&path, &file(FORMAT, "-Y 6 +X 11", SIZE, Coding::Plain)).unwrap();
    let powers = [-300, -200, -100, -31, -29, 0, 29, 31, 100, 200, 300];
    let pairs = powers.iter().flat_map(|first| powers.map(|second| (*first, second)));
    for (first, second) in pairs {
        for (line, count) in [("EXPOSURE=1e", 1), ("EXPOSURE=1e", 3), ("COLORCORR=1 1 1e", 2)] {
            let more = format!("{line}{second}\n").repeat(count);
            let lines = format!("{FORMAT}EXPOSURE=1e{first}\n{more}");
            let found = read(&path, &file(&lines, "-Y 6 +X 11", SIZE, Coding::Plain));
            let blue = first + second * i32::try_from(count).unwrap();
            let red = if line.starts_with("COLORCORR") { first } else { blue };
            let is_good = [red, blue].iter().all(|power| power.abs() < 30);
            match found {
                Ok(rgb) => {
                    assert!(is_good, "{lines}");
                    for (found, plain) in rgb.as_flattened().iter().zip(plain.as_flattened()) {
                        assert!(found.is_finite() && (*found == 0.0) == (*plain == 0.0), "{lines}");
                    }
                }
                Err(message) => {
                    let expected = "EXPOSURE and COLORCORR that multiply to ";
                    assert!(!is_good && message.starts_with(expected), "{lines} {message}");
                    assert!(message.ends_with(", expected 1e-30 to 1e30"), "{message}");
                }
            }
        }
    }
}
