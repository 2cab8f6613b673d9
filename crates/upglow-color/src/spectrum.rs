//! Sampled curves, and how they are read from CSV.

use crate::grid::Grid;
use crate::rounding::whole;
use crate::samples::{Row, Rows, SampleRules, SamplesError};

/// A curve over wavelength: samples on a grid, linear between them, zero outside.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct Spectrum {
    grid: Grid,
    values: Vec<f64>,
}

/// Why samples do not define a spectrum.
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
        let below = whole(position).min(self.values.len() - 2);
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

    /// The greatest sample.
    pub fn peak(&self) -> f64 {
        self.values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Every sample times `factor`.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.values.iter_mut().for_each(|v| *v *= factor);
        self
    }
}

/// Why a CSV file of curves over wavelength is refused. Lines count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpectrumCsvError {
    /// The header does not have the required names.
    #[error("header {found:?}, expected {expected:?}")]
    Header {
        /// The first line that is not a comment.
        found: String,
        /// The required header.
        expected: String,
    },
    /// A line has another number of cells than the header.
    #[error("line {line}: {found} cells, expected {expected}")]
    Cells {
        /// Line number.
        line: usize,
        /// Cells in it.
        found: usize,
        /// Cells in the header.
        expected: usize,
    },
    /// The cells do not define curves.
    #[error(transparent)]
    Samples(#[from] SamplesError),
}

/// Reads the curves named `columns` from CSV text whose header is `wavelength_nm,<columns>`.
///
/// Lines that start with `#` are comments. An empty cell is an absent sample, where the rules allow
/// that. Returns the curves on [`Grid::FINE`](crate::Grid::FINE).
///
/// # Errors
///
/// [`SpectrumCsvError`] names the line and what was expected there.
pub fn read_columns<const N: usize>(
    text: &str,
    columns: [&str; N],
    rules: SampleRules,
) -> Result<[Spectrum; N], SpectrumCsvError> {
    let text = text.trim_start_matches('\u{feff}');
    let mut lines = (1..).zip(text.lines()).filter(|(_, l)| !l.starts_with('#') && !l.is_empty());
    let header = lines.next().map_or("", |(_, l)| l).trim();
    let expected = format!("wavelength_nm,{}", columns.join(","));
    if header != expected {
        return Err(SpectrumCsvError::Header {
            found: header.chars().take(80).collect(),
            expected,
        });
    }
    let mut rows = Rows::new(columns, rules, "line");
    for (line, text) in lines {
        let texts: Vec<&str> = text.split(',').map(str::trim).collect();
        if texts.len() != N + 1 {
            return Err(SpectrumCsvError::Cells { line, found: texts.len(), expected: N + 1 });
        }
        let nm = read_number(line, "wavelength_nm", texts[0])?;
        let mut cells = [None; N];
        for ((cell, text), column) in cells.iter_mut().zip(&texts[1..]).zip(columns) {
            if !(text.is_empty() && rules.has_blank_ends) {
                *cell = Some(read_number(line, column, text)?);
            }
        }
        rows.push(Row { place: line, nm, cells })?;
    }
    Ok(rows.into_curves()?)
}

fn read_number(line: usize, column: &str, cell: &str) -> Result<f64, SamplesError> {
    cell.parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(|| {
        let found = format!("{:?}", cell.chars().take(40).collect::<String>());
        SamplesError::value(format!("line {line}"), column, found, "a finite number")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn csv(step: usize, value: impl Fn(usize) -> String) -> String {
        let rows = (300..=830).step_by(step).map(|nm| format!("{nm},{}\n", value(nm)));
        "# a comment\nwavelength_nm,power\n".to_owned() + &rows.collect::<String>()
    }

    fn read(text: &str) -> Result<Spectrum, SpectrumCsvError> {
        read_columns(text, ["power"], SampleRules::LIGHT).map(|[s]| s)
    }

    #[test]
    fn a_linear_curve_is_reproduced_from_any_step() {
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
        fn no_text_causes_a_panic(
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
    fn errors_name_the_line() {
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
            "line 23: 410 nm after 395 nm, expected steps of at most 10 nm"
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
            "no samples, expected one for each wavelength"
        );
        assert_eq!(message("wavelength_nm,power\n300\n"), "line 2: 1 cells, expected 2");
    }
}
