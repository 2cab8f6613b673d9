//! Measured samples: what they must be to stand for curves, and the curves.

use std::fmt;

use crate::grid::Grid;
use crate::spectrum::Spectrum;

/// What samples must be to stand for curves.
///
/// For all of them wavelengths are nm and ascend, and samples are 0 or more. Between samples curves
/// are straight lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleRules {
    /// Widest step between neighbors, nm. Larger accepts samples that a peak can hide between;
    /// smaller refuses the steps in which such curves are published.
    gap_limit_nm: f64,
    /// The range that the samples must cover, nm; beyond them curves are zero.
    covered_nm: [f64; 2],
    /// Below this wavelength, nm, every sample must be zero.
    dark_below_nm: f64,
    /// Whether a sample may be absent at either end of a curve, which counts as zero.
    has_blank_ends: bool,
    /// What to say where the range is too short.
    range_hint: &'static str,
}

/// First and last wavelength of the tables, nm.
const TABLES_NM: [f64; 2] = [300.0, 830.0];

impl SampleRules {
    /// Lights: 300 to 830 nm in steps of at most 10 nm, which is how lamps are published.
    pub const LIGHT: Self = Self {
        gap_limit_nm: 10.0,
        covered_nm: TABLES_NM,
        dark_below_nm: 0.0,
        has_blank_ends: false,
        range_hint: "",
    };

    /// Dyes: 300 to 830 nm in steps of at most 5 nm. Absent samples at either end of a curve mean "not
    /// measured there" and count as zero.
    pub const DYE: Self = Self {
        gap_limit_nm: 5.0,
        covered_nm: TABLES_NM,
        dark_below_nm: 0.0,
        has_blank_ends: true,
        range_hint: ": leave cells empty where it was not measured",
    };

    /// Color-matching functions: steps of at most 5 nm, zero beyond the samples, as their tables begin
    /// at 360 to 400 nm and end at 700 to 830 nm. A table that is shorter would leave out light that
    /// counts, more than a hundredth of the peak; below 360 nm nobody has measured any.
    pub const OBSERVER: Self = Self {
        gap_limit_nm: 5.0,
        covered_nm: [400.0, 700.0],
        dark_below_nm: Self::FIRST_SEEN_NM,
        has_blank_ends: true,
        range_hint: "",
    };

    /// Where the CIE's tables of observers begin, nm.
    pub(crate) const FIRST_SEEN_NM: f64 = 360.0;
}

/// Where a fault was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A line of a file, counted from 1.
    Line(usize),
    /// An index of an array, counted from 0.
    Sample(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Sample(index) => write!(f, "sample {index}"),
        }
    }
}

/// Why samples are no curves.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SamplesError {
    /// A column has another length than the wavelengths.
    #[error("{found} samples in column {column:?}, expected {expected}, one for each wavelength")]
    Length {
        /// Name of the column.
        column: String,
        /// Samples in it.
        found: usize,
        /// Wavelengths.
        expected: usize,
    },
    /// A sample or wavelength is not a finite number.
    #[error("{place}: {found} in column {column:?}, expected a finite number")]
    NotFinite {
        /// Where.
        place: Place,
        /// Name of the column.
        column: String,
        /// What is there.
        found: f64,
    },
    /// A sample is below zero.
    #[error("{place}: {found} in column {column:?}, expected a value of 0 or more")]
    Negative {
        /// Where.
        place: Place,
        /// Name of the column.
        column: String,
        /// What is there.
        found: f64,
    },
    /// A sample is not zero where the curve must be.
    #[error(
        "{place}: {found} in column {column:?} at {wavelength_nm} nm, expected 0 below {limit_nm} nm"
    )]
    Beyond {
        /// Where.
        place: Place,
        /// Name of the column.
        column: String,
        /// What is there.
        found: f64,
        /// Its wavelength, nm.
        wavelength_nm: f64,
        /// Where the curve may begin, nm.
        limit_nm: f64,
    },
    /// Wavelengths do not rise.
    #[error("{place}: {found_nm} nm after {previous_nm} nm, expected ascending wavelengths")]
    Order {
        /// Where.
        place: Place,
        /// Wavelength there, nm.
        found_nm: f64,
        /// Wavelength before it, nm.
        previous_nm: f64,
    },
    /// Two neighbors are further apart than the measurement can stand for.
    #[error(
        "{place}: {found_nm} nm after {previous_nm} nm leaves a gap, expected steps of at most {limit_nm} nm"
    )]
    Gap {
        /// Where.
        place: Place,
        /// Wavelength there, nm.
        found_nm: f64,
        /// Wavelength before it, nm.
        previous_nm: f64,
        /// The widest step allowed, nm.
        limit_nm: f64,
    },
    /// A sample is absent although there are some before and after it.
    #[error("{place}: empty cell in column {column:?} between measured ones, expected a value")]
    Hole {
        /// Where.
        place: Place,
        /// Name of the column.
        column: String,
    },
    /// The samples do not reach over the range asked for.
    #[error("covers {first_nm} to {last_nm} nm, expected at least {from_nm} to {to_nm} nm{hint}")]
    Range {
        /// First wavelength given, nm.
        first_nm: f64,
        /// Last wavelength given, nm.
        last_nm: f64,
        /// First wavelength needed, nm.
        from_nm: f64,
        /// Last wavelength needed, nm.
        to_nm: f64,
        /// What to do about it, or nothing.
        hint: &'static str,
    },
    /// There are no samples.
    #[error("no samples, expected one for each wavelength")]
    Empty,
}

/// The curves with these samples, each column of a name and one sample for each wavelength (nm); where
/// the rules allow blank ends, not-a-number is an absent sample.
///
/// The curves come back on [`Grid::FINE`].
///
/// # Errors
///
/// [`SamplesError`] names the index, from 0, and what was expected there.
pub(crate) fn curves_from_samples<const N: usize>(
    wavelengths_nm: &[f64],
    columns: [(&str, &[f64]); N],
    rules: SampleRules,
) -> Result<[Spectrum; N], SamplesError> {
    let expected = wavelengths_nm.len();
    if let Some((column, samples)) = columns.iter().find(|(_, s)| s.len() != expected) {
        let (column, found) = ((*column).into(), samples.len());
        return Err(SamplesError::Length { column, found, expected });
    }
    let mut rows = Rows::new(columns.map(|(name, _)| name), rules);
    for (i, &nm) in wavelengths_nm.iter().enumerate() {
        let absent = |value: &f64| rules.has_blank_ends && value.is_nan();
        let cells = columns.map(|(_, samples)| Some(samples[i]).filter(|v| !absent(v)));
        rows.push(Row { place: Place::Sample(i), nm, cells })?;
    }
    rows.into_curves()
}

/// The samples at one wavelength; `None` where there is none.
pub(crate) struct Row<const N: usize> {
    pub(crate) place: Place,
    pub(crate) nm: f64,
    pub(crate) cells: [Option<f64>; N],
}

/// Samples that are checked as they come.
pub(crate) struct Rows<'n, const N: usize> {
    columns: [&'n str; N],
    rules: SampleRules,
    rows: Vec<Row<N>>,
}

impl<'n, const N: usize> Rows<'n, N> {
    pub(crate) fn new(columns: [&'n str; N], rules: SampleRules) -> Self {
        Self { columns, rules, rows: Vec::new() }
    }

    /// Whether a sample may be absent.
    pub(crate) fn has_blank_ends(&self) -> bool {
        self.rules.has_blank_ends
    }

    pub(crate) fn push(&mut self, row: Row<N>) -> Result<(), SamplesError> {
        let Row { place, nm, .. } = row;
        self.check_number(place, "wavelength_nm", nm)?;
        for (cell, column) in row.cells.iter().zip(self.columns) {
            if let Some(found) = *cell {
                self.check_number(place, column, found)?;
                self.check_sample(place, column, nm, found)?;
            }
        }
        if let Some(previous) = self.rows.last() {
            check_step(place, previous.nm, nm, self.rules.gap_limit_nm)?;
        }
        self.rows.push(row);
        Ok(())
    }

    fn check_number(&self, place: Place, column: &str, found: f64) -> Result<(), SamplesError> {
        if found.is_finite() {
            return Ok(());
        }
        Err(SamplesError::NotFinite { place, column: column.into(), found })
    }

    fn check_sample(
        &self,
        place: Place,
        column: &str,
        wavelength_nm: f64,
        found: f64,
    ) -> Result<(), SamplesError> {
        let column = column.to_owned();
        let limit_nm = self.rules.dark_below_nm;
        if found < 0.0 {
            return Err(SamplesError::Negative { place, column, found });
        }
        if found > 0.0 && wavelength_nm < limit_nm {
            return Err(SamplesError::Beyond { place, column, found, wavelength_nm, limit_nm });
        }
        Ok(())
    }

    pub(crate) fn into_curves(self) -> Result<[Spectrum; N], SamplesError> {
        self.check_range()?;
        for (k, column) in self.columns.into_iter().enumerate() {
            self.check_holes(k, column)?;
        }
        Ok(std::array::from_fn(|k| self.sample_fine(k)))
    }

    fn check_range(&self) -> Result<(), SamplesError> {
        let (Some(first), Some(last)) = (self.rows.first(), self.rows.last()) else {
            return Err(SamplesError::Empty);
        };
        let (first_nm, last_nm) = (first.nm, last.nm);
        let SampleRules { covered_nm: [from_nm, to_nm], range_hint: hint, .. } = self.rules;
        if first_nm > from_nm || last_nm < to_nm {
            return Err(SamplesError::Range { first_nm, last_nm, from_nm, to_nm, hint });
        }
        Ok(())
    }

    fn check_holes(&self, k: usize, column: &str) -> Result<(), SamplesError> {
        let measured = |row: &Row<N>| row.cells[k].is_some();
        let first = self.rows.iter().position(measured).unwrap_or(0);
        let last = self.rows.iter().rposition(measured).unwrap_or(0);
        match self.rows[first..=last].iter().find(|row| !measured(row)) {
            Some(row) if first < last => {
                Err(SamplesError::Hole { place: row.place, column: column.into() })
            }
            _ => Ok(()),
        }
    }

    /// Column `k` at every wavelength of [`Grid::FINE`]; zero beyond the rows.
    fn sample_fine(&self, k: usize) -> Spectrum {
        let rows = &self.rows;
        let (first_nm, last_nm) = (rows[0].nm, rows[rows.len() - 1].nm);
        let mut above = 1;
        let values = Grid::FINE.wavelengths_nm().map(|nm| {
            if nm < first_nm.max(self.rules.dark_below_nm) || nm > last_nm {
                return 0.0;
            }
            while above + 1 < rows.len() && rows[above].nm < nm {
                above += 1;
            }
            let (low, high) = (&rows[above - 1], &rows[above]);
            let fraction = (nm - low.nm) / (high.nm - low.nm);
            low.cells[k].unwrap_or(0.0) * (1.0 - fraction) + high.cells[k].unwrap_or(0.0) * fraction
        });
        Spectrum::new(Grid::FINE, values.collect()).expect("between finite samples all is finite")
    }
}

fn check_step(
    place: Place,
    previous_nm: f64,
    found_nm: f64,
    limit_nm: f64,
) -> Result<(), SamplesError> {
    if found_nm <= previous_nm {
        return Err(SamplesError::Order { place, found_nm, previous_nm });
    }
    if found_nm - previous_nm > limit_nm {
        return Err(SamplesError::Gap { place, found_nm, previous_nm, limit_nm });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(nm: &[f64], power: &[f64]) -> Result<Spectrum, SamplesError> {
        curves_from_samples(nm, [("power", power)], SampleRules::LIGHT).map(|[curve]| curve)
    }

    fn every_10_nm() -> Vec<f64> {
        (30..=83).map(|i| 10.0 * f64::from(i)).collect()
    }

    #[test]
    fn a_straight_line_survives_uneven_steps() {
        let nm: Vec<f64> = every_10_nm().into_iter().chain([831.5]).collect();
        let line = light(&nm, &nm).unwrap();
        for at in Grid::FINE.wavelengths_nm() {
            assert!((line.at(at) - at).abs() < 1e-9, "{at}");
        }
    }

    #[test]
    fn each_fault_is_named_with_its_index() {
        let message = |at: usize, nm: f64, power: f64| {
            let mut samples = every_10_nm();
            let mut powers = vec![1.0; samples.len()];
            (samples[at], powers[at]) = (nm, power);
            light(&samples, &powers).unwrap_err().to_string()
        };
        let known = [
            (
                message(3, 330.0, -0.5),
                "sample 3: -0.5 in column \"power\", expected a value of 0 or more",
            ),
            (
                message(3, 330.0, f64::NAN),
                "sample 3: NaN in column \"power\", expected a finite number",
            ),
            (
                message(3, f64::NAN, 1.0),
                "sample 3: NaN in column \"wavelength_nm\", expected a finite number",
            ),
            (
                message(3, 320.0, 1.0),
                "sample 3: 320 nm after 320 nm, expected ascending wavelengths",
            ),
            (
                message(3, 331.0, 1.0),
                "sample 3: 331 nm after 320 nm leaves a gap, expected steps of at most 10 nm",
            ),
            (message(0, 305.0, 1.0), "covers 305 to 830 nm, expected at least 300 to 830 nm"),
        ];
        for (found, expected) in known {
            assert_eq!(found, expected);
        }
        assert_eq!(light(&[], &[]), Err(SamplesError::Empty));
        let short = light(&every_10_nm(), &[1.0]).unwrap_err();
        assert_eq!(
            short.to_string(),
            "1 samples in column \"power\", expected 54, one for each wavelength"
        );
    }

    #[test]
    fn a_dye_may_be_blank_at_its_ends_and_not_between() {
        let nm: Vec<f64> = (60..=166).map(|i| 5.0 * f64::from(i)).collect();
        let mut absorption = vec![0.5; nm.len()];
        absorption[0] = f64::NAN;
        let curve = |samples: &[f64]| {
            curves_from_samples(&nm, [("absorption", samples)], SampleRules::DYE).map(|[c]| c)
        };
        assert_eq!(curve(&absorption).unwrap().at(300.0), 0.0);
        absorption[7] = f64::NAN;
        let hole = curve(&absorption).unwrap_err().to_string();
        assert!(
            hole.starts_with("sample 7: empty cell in column \"absorption\" between"),
            "{hole}"
        );
    }

    proptest::proptest! {
        #[test]
        fn no_samples_make_a_panic(
            rows in proptest::collection::vec(proptest::num::f64::ANY, 0..200),
            step in 0.0..10.0_f64,
        ) {
            let nm: Vec<f64> = (0..rows.len()).map(|i| 290.0 + step * i as f64).collect();
            for rules in [SampleRules::LIGHT, SampleRules::DYE, SampleRules::OBSERVER] {
                let _ = curves_from_samples(&nm, [("a", &rows)], rules);
                let _ = curves_from_samples(&rows, [("a", &nm)], rules);
            }
        }
    }
}
