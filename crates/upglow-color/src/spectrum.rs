//! Sampled curves, and the CSV files they come in.

use crate::Grid;

/// A curve over wavelength: samples on a grid, straight lines between them, zero outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    grid: Grid,
    values: Vec<f64>,
}

/// Why samples are no spectrum.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpectrumError {
    /// The number of samples is not the number of wavelengths.
    #[error("{found} samples, expected {expected}, one for each wavelength of the grid")]
    Length {
        /// Samples given.
        found: usize,
        /// Wavelengths of the grid.
        expected: usize,
    },
    /// A sample is not a finite number.
    #[error("{value} at {wavelength_nm} nm, expected a finite number")]
    NotFinite {
        /// Where, nm.
        wavelength_nm: f64,
        /// The sample given.
        value: f64,
    },
}

impl Spectrum {
    /// The curve with these samples on `grid`.
    ///
    /// # Errors
    ///
    /// [`SpectrumError`] if the count differs from the grid's or a sample is not finite.
    pub fn new(grid: Grid, values: Vec<f64>) -> Result<Self, SpectrumError> {
        if values.len() != grid.len() {
            return Err(SpectrumError::Length { found: values.len(), expected: grid.len() });
        }
        match grid.wavelengths_nm().zip(&values).find(|(_, v)| !v.is_finite()) {
            Some((wavelength_nm, &value)) => Err(SpectrumError::NotFinite { wavelength_nm, value }),
            None => Ok(Self { grid, values }),
        }
    }

    /// The wavelengths of the samples.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// The samples, one for each wavelength of [`Spectrum::grid`].
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The value at `wavelength_nm`; zero outside the grid.
    pub fn at(&self, wavelength_nm: f64) -> f64 {
        let position =
            (wavelength_nm - f64::from(self.grid.first_nm())) / f64::from(self.grid.step_nm());
        if !(position >= 0.0 && position <= (self.values.len() - 1) as f64) {
            return 0.0;
        }
        let below = floor_index(position).min(self.values.len() - 2);
        let fraction = position - below as f64;
        self.values[below] * (1.0 - fraction) + self.values[below + 1] * fraction
    }

    /// The curve sampled on another grid.
    pub fn resampled(&self, grid: Grid) -> Self {
        Self { grid, values: grid.wavelengths_nm().map(|nm| self.at(nm)).collect() }
    }

    /// The sum of the samples times the step, in units of the curve times nm.
    pub fn integral(&self) -> f64 {
        self.values.iter().sum::<f64>() * f64::from(self.grid.step_nm())
    }

    /// The area under the curve between two wavelengths, in units of the curve times nm.
    pub fn area(&self, from_nm: f64, to_nm: f64) -> f64 {
        let (first_nm, step_nm) = (f64::from(self.grid.first_nm()), f64::from(self.grid.step_nm()));
        let last = (self.values.len() - 1) as f64;
        let [from, to] = [from_nm, to_nm].map(|nm| ((nm - first_nm) / step_nm).clamp(0.0, last));
        let mut area = 0.0;
        let mut low = from;
        while low < to {
            let high = (low.floor() + 1.0).min(to);
            area += (self.at(first_nm + step_nm * low) + self.at(first_nm + step_nm * high)) / 2.0
                * (high - low);
            low = high;
        }
        area * step_nm
    }

    /// Every sample times `factor`.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        self.values.iter_mut().for_each(|v| *v *= factor);
        self
    }
}

/// The whole part of a position that is not negative and far below 2⁵².
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "callers have checked the range; the fraction is meant to go"
)]
fn floor_index(position: f64) -> usize {
    position as usize
}

/// Why a CSV file of curves over wavelength was refused. Lines count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpectrumCsvError {
    /// There is no header line with the names asked for.
    #[error("header {found:?}, expected {expected:?}")]
    Header {
        /// The first line that is not a comment.
        found: String,
        /// The names asked for.
        expected: String,
    },
    /// A line has the wrong number of cells.
    #[error("line {line}: {found} cells, expected {expected}")]
    Cells {
        /// Line number.
        line: usize,
        /// Cells in it.
        found: usize,
        /// Cells in the header.
        expected: usize,
    },
    /// A cell is not a number.
    #[error("line {line}: {found:?} in column {column:?}, expected a finite number")]
    Number {
        /// Line number.
        line: usize,
        /// Header of the column.
        column: String,
        /// What the cell holds.
        found: String,
    },
    /// A sample is below zero.
    #[error("line {line}: {found} in column {column:?}, expected a value of 0 or more")]
    Negative {
        /// Line number.
        line: usize,
        /// Header of the column.
        column: String,
        /// What the cell holds.
        found: f64,
    },
    /// Wavelengths do not rise.
    #[error("line {line}: {found_nm} nm after {previous_nm} nm, expected ascending wavelengths")]
    Order {
        /// Line number.
        line: usize,
        /// Wavelength there, nm.
        found_nm: f64,
        /// Wavelength before it, nm.
        previous_nm: f64,
    },
    /// Two neighbors are further apart than the measurement can stand for.
    #[error(
        "line {line}: {found_nm} nm after {previous_nm} nm leaves a gap, expected steps of at most {limit_nm} nm"
    )]
    Gap {
        /// Line number.
        line: usize,
        /// Wavelength there, nm.
        found_nm: f64,
        /// Wavelength before it, nm.
        previous_nm: f64,
        /// The widest step allowed, nm.
        limit_nm: f64,
    },
    /// A cell is empty although there are samples before and after it.
    #[error("line {line}: empty cell in column {column:?} between measured ones, expected a value")]
    Hole {
        /// Line number.
        line: usize,
        /// Header of the column.
        column: String,
    },
    /// The file does not reach over the range asked for.
    #[error("covers {first_nm} to {last_nm} nm, expected at least {from_nm} to {to_nm} nm{hint}")]
    Range {
        /// First wavelength in the file, nm.
        first_nm: f64,
        /// Last wavelength in the file, nm.
        last_nm: f64,
        /// First wavelength needed, nm.
        from_nm: f64,
        /// Last wavelength needed, nm.
        to_nm: f64,
        /// What to do about it, or nothing.
        hint: &'static str,
    },
    /// There are no samples.
    #[error("no samples, expected a line for each wavelength")]
    Empty,
}

/// How a CSV file of curves is to be read.
#[derive(Clone, Copy, Debug)]
struct Rules {
    /// Widest step between neighbors, nm. Larger accepts files in which a peak can hide between
    /// two samples; smaller refuses the 10 nm in which lamps, or 5 nm in which dyes, are published.
    gap_limit_nm: f64,
    /// What an empty cell means.
    empty_is_zero: bool,
    /// What to say where the range is too short.
    range_hint: &'static str,
}

const CURVE_RULES: Rules = Rules { gap_limit_nm: 10.0, empty_is_zero: false, range_hint: "" };
const MEASURED_RULES: Rules = Rules {
    gap_limit_nm: 5.0,
    empty_is_zero: true,
    range_hint: ": leave cells empty where it was not measured",
};

/// Reads the curves named `columns` from CSV text whose header is `wavelength_nm,<columns>`.
///
/// Lines that start with `#` are comments. Wavelengths are nm, ascend, cover 300 to 830 nm and are
/// at most 10 nm apart; samples are 0 or more. With `empty_is_zero` steps are at most 5 nm, and
/// empty cells at either end of a column mean "not measured there" and count as zero. The curves
/// come back on [`Grid::FINE`].
///
/// # Errors
///
/// [`SpectrumCsvError`] names the line and what was expected there.
pub fn read_columns<const N: usize>(
    text: &str,
    columns: [&str; N],
    empty_is_zero: bool,
) -> Result<[Spectrum; N], SpectrumCsvError> {
    let rules = if empty_is_zero { MEASURED_RULES } else { CURVE_RULES };
    let mut lines = (1..).zip(text.lines()).filter(|(_, l)| !l.starts_with('#') && !l.is_empty());
    let header = lines.next().map_or("", |(_, l)| l).trim_start_matches('\u{feff}').trim();
    let expected = format!("wavelength_nm,{}", columns.join(","));
    if header != expected {
        return Err(SpectrumCsvError::Header {
            found: header.chars().take(80).collect(),
            expected,
        });
    }
    let mut rows: Vec<Row<N>> = Vec::new();
    for (line, text) in lines {
        let row = read_row(line, text, columns, rules)?;
        if let Some(previous) = rows.last() {
            check_step(line, previous.nm, row.nm, rules.gap_limit_nm)?;
        }
        rows.push(row);
    }
    check_range(&rows, rules)?;
    for (k, column) in columns.into_iter().enumerate() {
        check_holes(&rows, k, column)?;
    }
    Ok(std::array::from_fn(|k| sample_fine(&rows, k)))
}

/// One line of a file; `None` where a cell is empty.
struct Row<const N: usize> {
    line: usize,
    nm: f64,
    cells: [Option<f64>; N],
}

fn read_row<const N: usize>(
    line: usize,
    text: &str,
    columns: [&str; N],
    rules: Rules,
) -> Result<Row<N>, SpectrumCsvError> {
    let texts: Vec<&str> = text.split(',').map(str::trim).collect();
    if texts.len() != N + 1 {
        return Err(SpectrumCsvError::Cells { line, found: texts.len(), expected: N + 1 });
    }
    let nm = read_number(line, "wavelength_nm", texts[0])?;
    let mut cells = [None; N];
    for ((cell, text), column) in cells.iter_mut().zip(&texts[1..]).zip(columns) {
        if text.is_empty() && rules.empty_is_zero {
            continue;
        }
        let found = read_number(line, column, text)?;
        if found < 0.0 {
            return Err(SpectrumCsvError::Negative { line, column: column.into(), found });
        }
        *cell = Some(found);
    }
    Ok(Row { line, nm, cells })
}

fn read_number(line: usize, column: &str, cell: &str) -> Result<f64, SpectrumCsvError> {
    cell.parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(|| SpectrumCsvError::Number {
        line,
        column: column.into(),
        found: cell.chars().take(40).collect(),
    })
}

fn check_step(
    line: usize,
    previous_nm: f64,
    found_nm: f64,
    limit_nm: f64,
) -> Result<(), SpectrumCsvError> {
    if found_nm <= previous_nm {
        return Err(SpectrumCsvError::Order { line, found_nm, previous_nm });
    }
    if found_nm - previous_nm > limit_nm {
        return Err(SpectrumCsvError::Gap { line, found_nm, previous_nm, limit_nm });
    }
    Ok(())
}

fn check_range<const N: usize>(rows: &[Row<N>], rules: Rules) -> Result<(), SpectrumCsvError> {
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
        return Err(SpectrumCsvError::Empty);
    };
    let (first_nm, last_nm) = (first.nm, last.nm);
    let (from_nm, to_nm) = (f64::from(Grid::FINE.first_nm()), f64::from(Grid::FINE.last_nm()));
    if first_nm > from_nm || last_nm < to_nm {
        let hint = rules.range_hint;
        return Err(SpectrumCsvError::Range { first_nm, last_nm, from_nm, to_nm, hint });
    }
    Ok(())
}

fn check_holes<const N: usize>(
    rows: &[Row<N>],
    k: usize,
    column: &str,
) -> Result<(), SpectrumCsvError> {
    let measured = |row: &Row<N>| row.cells[k].is_some();
    let first = rows.iter().position(measured).unwrap_or(0);
    let last = rows.iter().rposition(measured).unwrap_or(0);
    match rows[first..=last].iter().find(|row| !measured(row)) {
        Some(row) if first < last => {
            Err(SpectrumCsvError::Hole { line: row.line, column: column.into() })
        }
        _ => Ok(()),
    }
}

/// Column `k` at every wavelength of [`Grid::FINE`], which the rows cover.
fn sample_fine<const N: usize>(rows: &[Row<N>], k: usize) -> Spectrum {
    let mut above = 1;
    let values = Grid::FINE.wavelengths_nm().map(|nm| {
        while above + 1 < rows.len() && rows[above].nm < nm {
            above += 1;
        }
        let (low, high) = (&rows[above - 1], &rows[above]);
        let fraction = (nm - low.nm) / (high.nm - low.nm);
        low.cells[k].unwrap_or(0.0) * (1.0 - fraction) + high.cells[k].unwrap_or(0.0) * fraction
    });
    Spectrum { grid: Grid::FINE, values: values.collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn csv(step: usize, value: impl Fn(usize) -> String) -> String {
        let rows = (300..=830).step_by(step).map(|nm| format!("{nm},{}\n", value(nm)));
        "# a comment\nwavelength_nm,power\n".to_owned() + &rows.collect::<String>()
    }

    fn read(text: &str) -> Result<Spectrum, SpectrumCsvError> {
        read_columns(text, ["power"], false).map(|[s]| s)
    }

    #[test]
    fn a_straight_line_survives_any_step() {
        for step in [1, 2, 5, 10] {
            let line = read(&csv(step, |nm| nm.to_string())).unwrap();
            for nm in Grid::FINE.wavelengths_nm() {
                assert!((line.at(nm) - nm).abs() < 1e-9, "{nm}");
            }
        }
    }

    #[test]
    fn areas_of_neighboring_ranges_add_up() {
        let line = read(&csv(5, |nm| (nm - 300).to_string())).unwrap();
        let (left, right) = (line.area(310.2, 450.7), line.area(450.7, 790.0));
        let whole = (490.0 * 490.0 - 10.2 * 10.2) / 2.0;
        assert!((left + right - whole).abs() < 1e-9);
        assert!((line.area(0.0, 1000.0) - 530.0 * 530.0 / 2.0).abs() < 1e-9);
    }

    #[test]
    fn outside_its_grid_a_spectrum_is_zero() {
        let flat = read(&csv(5, |_| "1".into())).unwrap();
        assert_eq!((flat.at(299.9), flat.at(300.0), flat.at(830.0)), (0.0, 1.0, 1.0));
        assert_eq!((flat.at(830.1), flat.at(f64::NAN)), (0.0, 0.0));
    }

    proptest::proptest! {
        #[test]
        fn no_text_makes_the_reader_panic(
            cells in proptest::collection::vec("[0-9.,eE+# \\-naif]{0,12}", 0..40),
        ) {
            let text = format!("wavelength_nm,power\n{}", cells.join("\n"));
            // Whatever comes back: an error, or a spectrum of finite samples.
            if let Ok(spectrum) = read(&text) {
                proptest::prop_assert!(spectrum.values().iter().all(|v| v.is_finite()));
            }
        }
    }

    #[test]
    fn each_fault_is_named_with_its_line() {
        let good = csv(5, |_| "1".into());
        let message = |text: &str| read(text).unwrap_err().to_string();
        assert_eq!(
            message(&good.replace("400,1\n", "400,-0.5\n")),
            "line 23: -0.5 in column \"power\", expected a value of 0 or more"
        );
        assert_eq!(
            message(&good.replace("400,1\n", "390,1\n")),
            "line 23: 390 nm after 395 nm, expected ascending wavelengths"
        );
        assert_eq!(
            message(&good.replace("400,1\n405,1\n", "")),
            "line 23: 410 nm after 395 nm leaves a gap, expected steps of at most 10 nm"
        );
        assert_eq!(
            message(&good.replace("400,1\n", "400,one\n")),
            "line 23: \"one\" in column \"power\", expected a finite number"
        );
        assert_eq!(
            message(&good.replace("830,1\n", "")),
            "covers 300 to 825 nm, expected at least 300 to 830 nm"
        );
        assert_eq!(message(""), "header \"\", expected \"wavelength_nm,power\"");
        assert_eq!(
            message("wavelength_nm,power\n"),
            "no samples, expected a line for each wavelength"
        );
        assert_eq!(message("wavelength_nm,power\n300\n"), "line 2: 1 cells, expected 2");
    }
}
