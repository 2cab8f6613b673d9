//! Measured fluorescent materials, as the BFC-450 spectrofluorimeter writes them.

use std::path::{Path, PathBuf};

use upglow_color::{Colorimetry, Grid, Xyz};
use upglow_terminal::{Failure, files};

/// First and last wavelength of the emission, nm; the excitation starts at that of [`Measured::GRID`].
const EMISSION_NM: [u32; 2] = [380, 780];

/// A measured material: how much of the light of each band leaves in each band.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Measured {
    /// The name of its file without the suffix.
    pub(crate) name: String,
    /// Power that leaves in a band of 10 nm per power that arrives in one, `[outgoing][incident]`, both on
    /// [`Measured::GRID`]; zero below 380 nm outgoing, which is not measured. Small negative numbers are
    /// noise and stay, as clipping them would add light.
    factors: Vec<Vec<f64>>,
}

/// Why a file is no measured material.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum MeasuredError {
    #[error("line {line} is missing, expected {expected}")]
    Missing { line: usize, expected: &'static str },
    #[error("line {line} is {found:?}, expected {expected}")]
    Line { line: usize, found: String, expected: &'static str },
    #[error("line {line} holds {found} numbers, expected {expected}")]
    Count { line: usize, found: usize, expected: usize },
    #[error("line {line} holds {found:?}, expected a number from -10 to 10")]
    Number { line: usize, found: String },
}

/// What the line of the grid must say: first and last emission and their step, number of excitations, the first of
/// them and their step.
const GRID_LINE: &str = "380 780 10 49 300 10";

/// No material gives back ten times the light that arrives in a band; more is a damaged file.
const GREATEST: f64 = 10.0;

impl Measured {
    /// The wavelengths of the excitation.
    pub(crate) const GRID: Grid = match Grid::try_new(300, 780, 10) {
        Ok(grid) => grid,
        Err(_) => panic!("the wavelengths ascend"),
    };

    /// Every `.BFC` file of a folder, in the order of their names.
    ///
    /// # Errors
    ///
    /// [`Failure`] if the folder or a file cannot be read, a file is invalid, or there is none.
    pub(crate) fn read_folder(folder: &Path) -> Result<Vec<Self>, Failure> {
        let unreadable =
            |error| Failure::system(folder, &error, "a folder of BFC-450 matrices (.BFC)");
        let entries = folder.read_dir().map_err(unreadable)?;
        let mut paths: Vec<PathBuf> = Vec::new();
        for entry in entries {
            let path = entry.map_err(unreadable)?.path();
            if path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("bfc")) {
                paths.push(path);
            }
        }
        if paths.is_empty() {
            return Err(Failure::file(folder, "no file .BFC, expected BFC-450 matrices"));
        }
        paths.sort();
        paths.iter().map(|path| Self::read(path)).collect()
    }

    fn read(path: &Path) -> Result<Self, Failure> {
        let text = files::read_text(path, "a BFC-450 matrix, a text file")?;
        let factors = parse(&text).map_err(|error| Failure::file(path, error))?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { name, factors })
    }

    /// The color under the light of `colorimetry`, which must be on [`Measured::GRID`].
    pub(crate) fn color(&self, colorimetry: &Colorimetry) -> Xyz {
        let light = colorimetry.irradiance();
        let leaving = self.factors.iter().map(|row| -> f64 {
            row.iter().zip(light).map(|(factor, power)| factor * power).sum()
        });
        leaving.zip(colorimetry.matching()).map(|(power, m)| power * Xyz(*m)).sum()
    }
}

/// The matrix of a file's text, `[outgoing][incident]` on [`Measured::GRID`].
fn parse(text: &str) -> Result<Vec<Vec<f64>>, MeasuredError> {
    /// The lines of the title, of the grid and of the first row, counted from 1.
    const TITLE: usize = 2;
    const AXES: usize = 11;
    const FIRST_ROW: usize = 13;
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    expect(&lines, TITLE, "BFC-450 Matrix File")?;
    expect(&lines, AXES, GRID_LINE)?;
    let [first, last] = EMISSION_NM;
    let emissions = (first..=last).step_by(10);
    let end = FIRST_ROW + emissions.clone().count();
    let unmeasured = Measured::GRID.wavelengths_nm().filter(|&nm| nm < f64::from(first));
    let mut factors: Vec<Vec<f64>> = unmeasured.map(|_| vec![0.0; Measured::GRID.len()]).collect();
    for (line, nm) in (FIRST_ROW..).zip(emissions) {
        factors.push(row(&lines, line, nm)?);
    }
    expect(&lines, end, "EOD")?;
    Ok(factors)
}

/// Checks the words of a line, counted from 1.
fn expect(lines: &[&str], line: usize, expected: &'static str) -> Result<(), MeasuredError> {
    let found = *lines.get(line - 1).ok_or(MeasuredError::Missing { line, expected })?;
    if found.split_whitespace().eq(expected.split_whitespace()) {
        Ok(())
    } else {
        Err(MeasuredError::Line { line, found: shortened(found), expected })
    }
}

/// The numbers of a row, which starts with its wavelength.
fn row(lines: &[&str], line: usize, nm: u32) -> Result<Vec<f64>, MeasuredError> {
    let expected = "a row of the matrix";
    let text = *lines.get(line - 1).ok_or(MeasuredError::Missing { line, expected })?;
    let mut words = text.split_whitespace();
    if words.next() != Some(nm.to_string().as_str()) {
        let expected = "its emission wavelength first, 380, 390 … 780";
        return Err(MeasuredError::Line { line, found: shortened(text), expected });
    }
    let numbers = words
        .map(|word| match word.parse::<f64>() {
            Ok(number) if number.abs() <= GREATEST => Ok(number),
            _ => Err(MeasuredError::Number { line, found: shortened(word) }),
        })
        .collect::<Result<Vec<f64>, _>>()?;
    if numbers.len() == Measured::GRID.len() {
        Ok(numbers)
    } else {
        let expected = Measured::GRID.len();
        Err(MeasuredError::Count { line, found: numbers.len(), expected })
    }
}

/// The start of a text, so that an error stays one short line.
fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use upglow_study::konig2020;

    /// A file whose matrix has this value on the diagonal, and this one from 400 nm to 500 nm.
    fn file(diagonal: f64, moved: f64) -> String {
        let mut text =
            "VEC_01 5167\nBFC-450 Matrix File\n;a\n;b\n;c\n;d\n;e\n;f\n;g\n;h\n".to_owned();
        text += &format!("{GRID_LINE}\nr:c:\n");
        for nm in (380..=780).step_by(10) {
            text += &nm.to_string();
            for from in (300..=780).step_by(10) {
                let value = match (from, nm) {
                    _ if from == nm => diagonal,
                    (400, 500) => moved,
                    _ => 0.0,
                };
                text += &format!("\t{value}");
            }
            text += "\n";
        }
        text + "EOD\n"
    }

    /// A material that reflects half of all light, and moves some of it.
    pub(crate) fn half(moved: f64) -> Measured {
        Measured { name: "half".into(), factors: parse(&file(0.5, moved)).unwrap() }
    }

    /// The grid starts at 300 nm, where no light is measured on its way out: D65 sums there are of no
    /// color.
    const UNMEASURED: f64 = 1e-4;

    #[test]
    fn a_material_that_reflects_half_has_half_of_the_white() {
        let colorimetry = konig2020::contract().on(Measured::GRID);
        let (white, color) = (colorimetry.white(), half(0.0).color(&colorimetry));
        for k in 0..3 {
            assert!((color.0[k] - 0.5 * white.0[k]).abs() < UNMEASURED, "{color:?} of {white:?}");
        }
    }

    #[test]
    fn rows_are_emissions() {
        let colorimetry = konig2020::contract().on(Measured::GRID);
        let [without, with] = [0.0, 0.1].map(|moved| half(moved).color(&colorimetry));
        let (light, matching) = (colorimetry.irradiance(), colorimetry.matching());
        let expected = 0.1 * light[10] * matching[20][1];
        assert!((with.0[1] - without.0[1] - expected).abs() < 1e-12);
    }

    #[test]
    fn damaged_files_are_refused_with_their_line() {
        let whole = file(0.5, 0.0);
        let known = [
            ("", "line 2 is missing, expected BFC-450 Matrix File"),
            (
                &whole.replace("49 300", "48 310"),
                "line 11 is \"380 780 10 48 310 10\", expected 380 780 10 49 300 10",
            ),
            (&whole.replace("\n390", "\n395"), "line 14 is \"395\\t"),
            (&whole.replace("EOD", ""), "line 54 is \"\", expected EOD"),
            (&whole.replacen("\t0.5", "\tNaN", 1), "line 13 holds \"NaN\", expected a number"),
            (&whole.replacen("\t0.5", "", 1), "line 13 holds 48 numbers, expected 49"),
            (&whole[..whole.len() / 2], "line 3"),
        ];
        for (text, expected) in known {
            let error = parse(text).unwrap_err().to_string();
            assert!(error.starts_with(expected) && !error.contains('\n'), "{error}");
        }
    }

    #[test]
    fn the_measured_materials_are_read() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/bispectral");
        if !folder.is_dir() {
            eprintln!("skipped: the_measured_materials_are_read (no ../shared/data/bispectral)");
            return;
        }
        let names: Vec<String> =
            Measured::read_folder(&folder).unwrap().into_iter().map(|found| found.name).collect();
        assert_eq!(names, ["CIBA12", "HERPIORA", "POLGREE", "TEXTYELL"]);
    }
}
