//! Tables of colors for color management, as CLF and `.cube`.

use std::fmt::Write as _;

use upglow_color::rounding::to_single;
use upglow_color::{LinearRgb, choices, is_plain};

use crate::xml::{escaped, plain};

/// The format of a [`Lut`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LutFormat {
    /// The Common LUT Format 3.0 of the Academy.
    ///
    /// # Source
    ///
    /// `clf`.
    Clf,
    /// The 3D LUT of IRIDAS and Adobe, which most programs read.
    ///
    /// # Source
    ///
    /// `adobe_cube`.
    Cube,
}

choices!(LutFormat, "format of a LUT", Clf = "clf", Cube = "cube");

/// The colors that a LUT has entries for: the same values along red, green and blue, among them 0 and 1.
///
/// Programs clamp a color to the least and greatest of them, channel by channel.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct LutLattice {
    format: LutFormat,
    resolution: usize,
    /// Steps from the least value to 0.
    below: usize,
    /// Steps from 0 to 1.
    span: usize,
    shaper: Shaper,
}

/// How colors are spaced.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shaper {
    /// Evenly.
    None,
    /// Evenly in the square root, mirrored for negative numbers, which is undone after the table: what leaves a color
    /// as it is does so between entries too.
    SquareRoot,
}

/// Why there is no LUT.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LutError {
    /// Too few or too many entries along an axis.
    #[error("resolution {found}, expected {least} to {most}")]
    Resolution {
        /// Entries asked for.
        found: usize,
        /// Fewest.
        least: usize,
        /// Most.
        most: usize,
    },
}

impl LutLattice {
    /// Fewest and most entries along an axis. OpenColorIO reads no more.
    pub const RESOLUTIONS: [usize; 2] = [2, 129];

    /// Colors in 0..=1, evenly spaced, as the nodes of a cube are.
    ///
    /// # Errors
    ///
    /// [`LutError::Resolution`] if there are too few or too many entries.
    pub fn unit(format: LutFormat, resolution: usize) -> Result<Self, LutError> {
        let span = resolution.saturating_sub(1);
        check(resolution, Self::RESOLUTIONS[0])?;
        Ok(Self { format, resolution, below: 0, span, shaper: Shaper::None })
    }

    /// Colors whose channels are in 0..=1 and in a range that holds it, and at least one entry beyond on either side.
    /// CLF has more entries for dark colors; `.cube` cannot undo that, and has not.
    ///
    /// # Errors
    ///
    /// [`LutError::Resolution`] if there are too few or too many entries.
    pub fn around(
        format: LutFormat,
        resolution: usize,
        [least, most]: [f64; 2],
    ) -> Result<Self, LutError> {
        let shaper = match format {
            LutFormat::Clf => Shaper::SquareRoot,
            LutFormat::Cube => Shaper::None,
        };
        let steps = |span: usize| {
            let beyond = |part: f64| steps_beyond(span as f64 * part.max(0.0));
            [beyond(-shaper.encoded(least)), beyond(shaper.encoded(most) - 1.0)]
        };
        let needed = |span: usize| steps(span).into_iter().sum::<usize>() + span + 1;
        check(resolution, needed(1).max(Self::RESOLUTIONS[0]))?;
        let span = (1..resolution).rev().find(|&span| needed(span) <= resolution);
        let span = span.expect("one step from 0 to 1 was found to be possible");
        let [below, _] = steps(span);
        Ok(Self { format, resolution, below, span, shaper })
    }

    /// Entries along an axis.
    pub fn resolution(&self) -> usize {
        self.resolution
    }

    /// The least and the greatest value of a channel.
    pub fn range(&self) -> [f64; 2] {
        [0, self.resolution - 1].map(|i| self.shaper.decoded(self.position(i)))
    }

    /// The colors, red fastest.
    pub fn colors(&self) -> Vec<LinearRgb> {
        let n = self.resolution;
        let values: Vec<f64> = (0..n).map(|i| self.shaper.decoded(self.position(i))).collect();
        let color = |i: usize| LinearRgb([i % n, i / n % n, i / (n * n)].map(|k| values[k]));
        (0..n.pow(3)).map(color).collect()
    }

    /// Where entry `index` along an axis lies among those of 0 and 1, by the shaper.
    fn position(&self, index: usize) -> f64 {
        (index as f64 - self.below as f64) / self.span as f64
    }
}

fn check(found: usize, least: usize) -> Result<(), LutError> {
    let [_, most] = LutLattice::RESOLUTIONS;
    if (least..=most).contains(&found) {
        return Ok(());
    }
    Err(LutError::Resolution { found, least, most })
}

/// Whole steps that reach further than a number of steps ≥ 0; more than any LUT has, if it is so great.
#[expect(clippy::cast_possible_truncation, reason = "it is clamped first")]
#[expect(clippy::cast_sign_loss, reason = "the number is at least 0")]
fn steps_beyond(steps: f64) -> usize {
    let [_, most] = LutLattice::RESOLUTIONS;
    steps.floor().min(most as f64) as usize + 1
}

impl Shaper {
    fn encoded(self, value: f64) -> f64 {
        match self {
            Self::None => value,
            Self::SquareRoot => value.abs().sqrt().copysign(value),
        }
    }

    fn decoded(self, position: f64) -> f64 {
        match self {
            Self::None => position,
            Self::SquareRoot => position * position.abs(),
        }
    }
}

/// A color for each color of a [`LutLattice`], for programs that interpolate.
#[derive(Clone, Debug)]
#[must_use]
pub struct Lut {
    lattice: LutLattice,
    /// By the shaper, red fastest.
    entries: Vec<[f32; 3]>,
}

impl Lut {
    /// The table with these colors, in the order of [`LutLattice::colors`].
    ///
    /// # Panics
    ///
    /// If there are not as many.
    pub fn new(lattice: LutLattice, colors: &[LinearRgb]) -> Self {
        assert_eq!(colors.len(), lattice.resolution.pow(3), "one color for each entry");
        // Adding 0 makes −0 a 0, which has a sign in text.
        let entry = |rgb: &LinearRgb| rgb.0.map(|v| to_single(lattice.shaper.encoded(v)) + 0.0);
        Self { lattice, entries: colors.iter().map(entry).collect() }
    }

    /// The file, with a title and more lines about it.
    pub fn text(&self, title: &str, about: &[String]) -> String {
        let clean = |text: &str| text.replace(|c| !is_plain(c), "\u{fffd}");
        let title = clean(title);
        let about: Vec<String> = about.iter().map(|line| clean(line)).collect();
        match self.lattice.format {
            LutFormat::Clf => self.clf(&title, &about),
            LutFormat::Cube => self.cube(&ascii(&title), &about),
        }
    }

    fn clf(&self, title: &str, about: &[String]) -> String {
        let LutLattice { resolution: n, shaper, .. } = self.lattice;
        let [least, most] = [0, n - 1].map(|i| self.lattice.position(i));
        let about: String = about
            .iter()
            .map(|a| format!("  <Description>{}</Description>\n", escaped(a)))
            .collect();
        let exponent = |style: &str| match shaper {
            Shaper::None => String::new(),
            Shaper::SquareRoot => format!(
                r#"  <Exponent inBitDepth="32f" outBitDepth="32f" style="{style}">
    <ExponentParams exponent="2" />
  </Exponent>
"#
            ),
        };
        let mut text = format!(
            r#"<?xml version="1.0" encoding="UTF-8"?>
<ProcessList id="upglow_{id}" name="{title}" compCLFversion="3.0">
  <Description>Made by upglow {version}</Description>
{about}  <InputDescriptor>linear RGB of the cube</InputDescriptor>
  <OutputDescriptor>linear RGB of the cube</OutputDescriptor>
{before}  <Range inBitDepth="32f" outBitDepth="32f">
    <minInValue>{least}</minInValue>
    <maxInValue>{most}</maxInValue>
    <minOutValue>0</minOutValue>
    <maxOutValue>1</maxOutValue>
  </Range>
  <LUT3D inBitDepth="32f" outBitDepth="32f" interpolation="tetrahedral">
    <Array dim="{n} {n} {n} 3">
"#,
            id = plain(title),
            title = escaped(title),
            version = env!("CARGO_PKG_VERSION"),
            before = exponent("basicMirrorRev"),
        );
        // Blue fastest.
        for index in 0..n.pow(3) {
            let [red, green, blue] = [index / (n * n), index / n % n, index % n];
            self.add_entry(&mut text, (blue * n + green) * n + red);
        }
        text + "    </Array>\n  </LUT3D>\n" + &exponent("basicMirrorFwd") + "</ProcessList>\n"
    }

    fn cube(&self, title: &str, about: &[String]) -> String {
        let LutLattice { resolution: n, .. } = self.lattice;
        let mut text = format!("# Made by upglow {}\n", env!("CARGO_PKG_VERSION"));
        for line in about {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "# {}", ascii(line));
        }
        let _ = writeln!(text, "TITLE \"{}\"\nLUT_3D_SIZE {n}", title.replace('"', "'"));
        let [least, most] = self.lattice.range();
        // What the values are without these lines.
        if [least, most] != [0.0, 1.0] {
            let _ = writeln!(text, "DOMAIN_MIN {least} {least} {least}");
            let _ = writeln!(text, "DOMAIN_MAX {most} {most} {most}");
        }
        (0..self.entries.len()).for_each(|index| self.add_entry(&mut text, index));
        text
    }

    fn add_entry(&self, text: &mut String, index: usize) {
        let [red, green, blue] = self.entries[index];
        // Writing to a string cannot fail. Numbers have no exponents, which some readers do not know.
        let _ = writeln!(text, "{red} {green} {blue}");
    }
}

/// Text for a `.cube` file, which is in ASCII.
fn ascii(text: &str) -> String {
    text.replace(|c: char| !c.is_ascii(), "?")
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORMATS: [LutFormat; 2] = [LutFormat::Clf, LutFormat::Cube];

    #[test]
    fn zero_and_one_have_entries_and_the_range_is_surpassed() {
        for format in FORMATS {
            for (range, resolution) in
                [([0.0, 1.0], 4), ([-0.1, 1.2], 9), ([-0.25, 3.4], 33), ([-0.5, 1.0], 65)]
            {
                let lattice = LutLattice::around(format, resolution, range).unwrap();
                let [least, most] = lattice.range();
                assert!(least < range[0] && most > range[1], "{lattice:?}");
                let colors = lattice.colors();
                assert_eq!(colors.len(), resolution.pow(3));
                for value in [0.0, 1.0, least, most] {
                    assert!(colors.contains(&LinearRgb([value; 3])), "{value} {lattice:?}");
                }
            }
        }
    }

    #[test]
    fn a_resolution_that_cannot_be_is_refused() {
        let most = LutLattice::RESOLUTIONS[1];
        let refused = |found, least| LutError::Resolution { found, least, most };
        let unit = |resolution| LutLattice::unit(LutFormat::Cube, resolution).unwrap_err();
        assert_eq!([unit(0), unit(1), unit(130)], [0, 1, 130].map(|found| refused(found, 2)));
        let around = |range| LutLattice::around(LutFormat::Cube, 5, range).unwrap_err();
        // One step below, one from 0 to 1, three above: six entries.
        assert_eq!(around([-0.2, 3.4]), refused(5, 6));
        assert!(matches!(around([-1e300, 1e300]), LutError::Resolution { found: 5, .. }));
    }

    #[test]
    fn texts_are_lines_of_their_format_whatever_they_are_called() {
        for format in FORMATS {
            let lattice = LutLattice::unit(format, 2).unwrap();
            let lut = Lut::new(lattice, &lattice.colors());
            let text = lut.text("a \"<b>\"\n", &["LUT_3D_SIZE 3 & <x>\r\u{ffff}".into()]);
            let entries: Vec<&str> = match format {
                LutFormat::Clf => {
                    assert!(text.contains("name=\"a &quot;&lt;b&gt;&quot;\u{fffd}\""), "{text}");
                    assert!(text.contains("<Description>LUT_3D_SIZE 3 &amp; &lt;x&gt;"));
                    let array = text.split("<Array dim=\"2 2 2 3\">\n").nth(1).unwrap();
                    array.lines().take(8).collect()
                }
                LutFormat::Cube => {
                    assert!(text.contains("\n# LUT_3D_SIZE 3 & <x>??\n"), "{text}");
                    assert!(text.contains("\nTITLE \"a '<b>'?\"\nLUT_3D_SIZE 2\n0 0 0\n"));
                    text.lines().skip(4).collect()
                }
            };
            let fastest = if format == LutFormat::Clf { "0 0 1" } else { "1 0 0" };
            assert_eq!((entries[0], entries[1], entries.len()), ("0 0 0", fastest, 8));
        }
    }
}
