//! Colors of a Radiance picture.
//!
//! # Source
//!
//! `radiance`: `color.c` (`freadcolrs`), `resolu.c`, `header.c` and `color.h`.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::ops::{Range, RangeInclusive};
use std::path::Path;

use upglow::open_input;
use upglow_color::rounding::to_single;

use super::chromaticities::stated;
use super::encoding::Encoding;
use super::error::PictureError;
use super::source::{Facts, LastSample, Pixels, Source, check_size};
use super::stated::{Stated, StatedColor};

#[derive(Debug)]
pub(super) struct HdrPicture {
    file: BufReader<File>,
    /// Pixels of a stored row.
    width: usize,
    /// What stored colors are divided by.
    exposure: [f64; 3],
}

/// What the lines before the pixels state.
#[derive(Debug)]
struct Lines {
    has_format: bool,
    exposure: [f64; 3],
    space: Stated<upglow_color::RgbSpace>,
}

/// What EXPOSURE and COLORCORR may come to: far beyond any light, and colors are not lost to it.
const EXPOSURES: RangeInclusive<f64> = 1e-30..=1e30;
/// Most bytes of a line; comments hold the commands that made a picture.
const MAX_LINE: u64 = 64 << 10;
/// Most lines before the pixels.
const MAX_LINES: usize = 10_000;
/// A pixel: mantissas of red, green and blue, and their common exponent.
type Rgbe = [u8; 4];
/// Rows of other widths are not compressed by component.
const WIDTHS_BY_COMPONENT: Range<usize> = 8..0x8000;

impl HdrPicture {
    pub(super) fn open(path: &Path) -> Result<(Box<dyn Source>, Facts), PictureError> {
        let mut file = BufReader::new(open_input(path)?);
        let lines = Lines::read(&mut file)?;
        if !lines.has_format {
            return Err(damaged("no line FORMAT=32-bit_rle_rgbe"));
        }
        let (size, orientation) = resolution(&line(&mut file)?)?;
        check_size(size)?;
        let facts = Facts {
            size,
            color: StatedColor {
                space: lines.space,
                encoding: Stated::yes(Encoding::Linear, "Radiance"),
            },
            last_sample: LastSample::Absent,
            windows: None,
            orientation,
        };
        Ok((Box::new(Self { file, width: size[0], exposure: lines.exposure }), facts))
    }

    fn row(&mut self, row: &mut [Rgbe]) -> Result<(), PictureError> {
        let mut first = self.bytes()?;
        if let [2, 2, high @ 0..0x80, low] = first
            && WIDTHS_BY_COMPONENT.contains(&self.width)
        {
            if usize::from(high) << 8 | usize::from(low) != self.width {
                return Err(damaged("a row of another width"));
            }
            return (0..4).try_for_each(|k| self.component(row, k));
        }
        // A pixel 1, 1, 1, n repeats the last one n times; of several in turn each counts 256 times as much.
        let (mut at, mut shift) = (0, 0);
        loop {
            if let [1, 1, 1, count] = first {
                let count = usize::from(count) << shift;
                let end = at + count;
                let (Some(&last), true) = (row[..at].last(), end <= row.len()) else {
                    return Err(damaged("a repetition outside its row"));
                };
                row[at..end].fill(last);
                at = end;
                // Greater counts are outside any row.
                shift = (shift + 8).min(24);
            } else {
                row[at] = first;
                at += 1;
                shift = 0;
            }
            if at == row.len() {
                return Ok(());
            }
            first = self.bytes()?;
        }
    }

    /// One component of a row: runs, and bytes as they are.
    fn component(&mut self, row: &mut [Rgbe], k: usize) -> Result<(), PictureError> {
        let mut at = 0;
        while at < row.len() {
            let [code] = self.bytes()?;
            let is_run = code > 128;
            let count = usize::from(if is_run { code - 128 } else { code });
            let pixels = row.get_mut(at..at + count).filter(|_| count > 0);
            let pixels = pixels.ok_or_else(|| damaged("a repetition outside its row"))?;
            if is_run {
                let [value] = self.bytes()?;
                pixels.iter_mut().for_each(|pixel| pixel[k] = value);
            } else {
                for pixel in pixels {
                    [pixel[k]] = self.bytes()?;
                }
            }
            at += count;
        }
        Ok(())
    }

    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], PictureError> {
        let mut bytes = [0; N];
        let read = self.file.read_exact(&mut bytes);
        read.map_err(|error| PictureError::read(error, FORMAT))?;
        Ok(bytes)
    }
}

impl Source for HdrPicture {
    fn read(&mut self, rows: Range<usize>) -> Result<Pixels, PictureError> {
        let mut row = vec![[0; 4]; self.width];
        let mut rgb = Vec::with_capacity(rows.len() * self.width);
        for _ in rows {
            self.row(&mut row)?;
            rgb.extend(row.iter().map(|&pixel| color(pixel, self.exposure)));
        }
        Ok((rgb, None))
    }
}

/// Radiance itself adds half a step to each mantissa. We do not, as other readers: 1 stays 1.
fn color([red, green, blue, exponent]: Rgbe, exposure: [f64; 3]) -> [f32; 3] {
    if exponent == 0 {
        return [0.0; 3];
    }
    let scale = 2_f64.powi(i32::from(exponent) - 128 - 8);
    let stored = [red, green, blue];
    [0, 1, 2].map(|k| to_single(f64::from(stored[k]) * scale / exposure[k]))
}

impl Lines {
    /// Reads the lines up to the empty one.
    fn read(file: &mut BufReader<File>) -> Result<Self, PictureError> {
        let mut found = Self { has_format: false, exposure: [1.0; 3], space: Stated::No };
        for _ in 0..MAX_LINES {
            let line = line(file)?;
            if line.is_empty() {
                return found.checked();
            }
            if let Some((key, value)) = line.split_once('=') {
                found.add(key, value.trim())?;
            }
        }
        Err(damaged("no empty line before its pixels"))
    }

    fn checked(self) -> Result<Self, PictureError> {
        let wrong = self.exposure.iter().find(|v| !EXPOSURES.contains(v));
        wrong.map_or(Ok(()), |v| {
            let found = format!("EXPOSURE and COLORCORR that multiply to {v:e}");
            Err(PictureError::pixels(found, "1e-30 to 1e30"))
        })?;
        Ok(self)
    }

    fn add(&mut self, key: &str, value: &str) -> Result<(), PictureError> {
        let wrong = || damaged(&format!("{key}={:?}", crate::exr::error::shown(value)));
        match key {
            "FORMAT" if value == "32-bit_rle_rgbe" => self.has_format = true,
            "FORMAT" => {
                let found = format!("pixels {:?}", crate::exr::error::shown(value));
                return Err(PictureError::pixels(
                    found,
                    "32-bit_rle_rgbe: save the picture as this",
                ));
            }
            // Each program that changes the exposure adds its line.
            "EXPOSURE" => {
                let by = numbers::<1>(value).filter(positive).ok_or_else(wrong)?;
                self.exposure = self.exposure.map(|v| v * by[0]);
            }
            "COLORCORR" => {
                let by = numbers::<3>(value).filter(positive).ok_or_else(wrong)?;
                self.exposure = [0, 1, 2].map(|k| self.exposure[k] * by[k]);
            }
            "PRIMARIES" => {
                let [rx, ry, gx, gy, bx, by, wx, wy] = numbers(value).ok_or_else(wrong)?;
                self.space = stated("PRIMARIES", [[rx, ry], [gx, gy], [bx, by]], [wx, wy]);
            }
            _ => {}
        }
        Ok(())
    }
}

fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let found: Option<Vec<f64>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    found?.try_into().ok()
}

fn positive<const N: usize>(numbers: &[f64; N]) -> bool {
    numbers.iter().all(|v| v.is_finite() && *v > 0.0)
}

/// The next line without its end.
fn line(file: &mut BufReader<File>) -> Result<String, PictureError> {
    let mut bytes = Vec::new();
    file.take(MAX_LINE).read_until(b'\n', &mut bytes)?;
    match bytes.pop() {
        Some(b'\n') => Ok(String::from_utf8_lossy(&bytes).trim_end_matches('\r').to_owned()),
        _ => Err(damaged("it ends inside its first lines")),
    }
}

/// Width and height as stored, and the orientation as in TIFF, of a line such as `-Y 480 +X 640`: first the
/// axis along which rows follow each other, then that along a row. Y points up.
fn resolution(line: &str) -> Result<([usize; 2], u64), PictureError> {
    let wrong = || damaged(&format!("{:?} in place of its size", crate::exr::error::shown(line)));
    let words: Vec<&str> = line.split_whitespace().collect();
    let &[down, height, across, width] = &words[..] else { return Err(wrong()) };
    let orientation = match (down, across) {
        ("-Y", "+X") => 1,
        ("-Y", "-X") => 2,
        ("+Y", "-X") => 3,
        ("+Y", "+X") => 4,
        ("+X", "-Y") => 5,
        ("-X", "-Y") => 6,
        ("-X", "+Y") => 7,
        ("+X", "+Y") => 8,
        _ => return Err(wrong()),
    };
    let side = |text: &str| text.parse().map_err(|_| wrong());
    Ok(([side(width)?, side(height)?], orientation))
}

const FORMAT: &str = "Radiance";

fn damaged(found: &str) -> PictureError {
    PictureError::Damaged { found: found.into(), format: FORMAT }
}
