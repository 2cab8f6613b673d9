//! Measured samples: the rules they must follow, and the curves through them.

use crate::choices;
use crate::grid::Grid;
use crate::rounding::{shown, whole};
use crate::spectrum::Spectrum;

/// What samples of a curve must be.
///
/// Wavelengths are in nm and ascend, and samples are 0 or more. Curves are linear between samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleRules {
    /// Widest step between neighbors, nm. Larger accepts samples that a peak can hide between;
    /// smaller refuses the steps in which such curves are published.
    gap_limit_nm: f64,
    /// The range that the samples must cover, nm.
    covered_nm: [f64; 2],
    /// What curves are beyond the samples, if these may end within the range of the tables.
    ends: Option<Ends>,
    /// Below this wavelength, nm, every sample must be zero.
    dark_below_nm: f64,
    /// Whether samples may be absent at either end of a curve, where they count as zero.
    pub(crate) has_blank_ends: bool,
    /// Whether samples between whole nanometers are averaged, so that narrow lines keep their area.
    keeps_areas: bool,
    /// What to suggest when the range is too short.
    range_hint: &'static str,
}

/// What a measured curve is beyond its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// Zero.
    Zero,
    /// The same as at the nearest sample.
    Hold,
}

choices!(Ends, "ends", Zero = "zero", Hold = "hold");

/// Range of the greatest sample of a relative curve: a light, a color-matching function, an emission.
/// Beyond it, sums of products leave the range of single or double precision.
pub(crate) const RELATIVE_PEAKS: [f64; 2] = [1e-30, 1e30];

/// First and last wavelength of the tables, nm.
const TABLES_NM: [f64; 2] = [300.0, 830.0];

/// What samples must cover, nm, where ends say what is beyond: a shorter observer would leave out more
/// than a hundredth of its peak, a shorter light visible power.
const VISIBLE_NM: [f64; 2] = [400.0, 700.0];

impl SampleRules {
    /// Lights: 300 to 830 nm in steps of at most 10 nm, which is how lamps are published. Lines keep
    /// their power, however finely they are sampled.
    pub const LIGHT: Self = Self {
        gap_limit_nm: 10.0,
        covered_nm: TABLES_NM,
        ends: None,
        dark_below_nm: 0.0,
        has_blank_ends: false,
        keeps_areas: true,
        range_hint: "",
    };

    /// Dyes: 300 to 830 nm in steps of at most 5 nm. Absent samples at either end of a curve mean "not
    /// measured there" and count as zero.
    pub const DYE: Self = Self {
        gap_limit_nm: 5.0,
        has_blank_ends: true,
        keeps_areas: false,
        range_hint: ": leave cells empty, or NaN in arrays, where it was not measured",
        ..Self::LIGHT
    };

    /// Color-matching functions: steps of at most 5 nm, and zero beyond the samples. Published tables
    /// begin at 360 to 400 nm and end at 700 to 830 nm; below 360 nm there are no measurements.
    pub const OBSERVER: Self = Self {
        gap_limit_nm: 5.0,
        covered_nm: VISIBLE_NM,
        ends: Some(Ends::Zero),
        dark_below_nm: 360.0,
        has_blank_ends: true,
        keeps_areas: false,
        range_hint: "",
    };

    /// The same rules for samples that may end at 400 to 700 nm, if `ends` says what is beyond.
    #[must_use]
    pub fn ending(self, ends: Option<Ends>) -> Self {
        match ends {
            Some(_) => Self { covered_nm: VISIBLE_NM, ends, ..self },
            None => self,
        }
    }

    /// Checks one sample of a column, at `nm`; `place` says where it is.
    pub(crate) fn check(
        &self,
        place: impl Fn() -> String,
        column: &str,
        nm: f64,
        found: f64,
    ) -> Result<(), SamplesError> {
        let limit_nm = self.dark_below_nm;
        let expected = match found {
            _ if !found.is_finite() => "a finite number".into(),
            _ if found < 0.0 => "a value of 0 or more".into(),
            _ if found > 0.0 && nm < limit_nm => format!("0 below {limit_nm} nm"),
            _ => return Ok(()),
        };
        Err(SamplesError::value(place(), column, shown(found), expected))
    }

    /// Checks every sample of a curve that was not read from samples.
    pub(crate) fn check_curve(&self, column: &str, curve: &Spectrum) -> Result<(), SamplesError> {
        let mut samples = curve.grid().wavelengths_nm().zip(curve.values());
        samples
            .try_for_each(|(nm, &found)| self.check(|| format!("{nm} nm"), column, nm, found))?;
        check_peak(column, curve)
    }
}

/// Checks that the greatest sample of a relative curve is zero or in [`RELATIVE_PEAKS`].
pub(crate) fn check_peak(column: &str, curve: &Spectrum) -> Result<(), SamplesError> {
    let ([least, most], found) = (RELATIVE_PEAKS, curve.peak());
    if found == 0.0 || (least..=most).contains(&found) {
        return Ok(());
    }
    Err(SamplesError::Peak { column: column.into(), found })
}

/// Why samples do not define curves.
///
/// A `place` is a line of a file, counted from 1, the index of a sample, counted from 0, or a
/// wavelength.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SamplesError {
    /// A column and the wavelengths differ in length.
    #[error("{found} samples in column {column:?}, expected {expected}, one for each wavelength")]
    Length {
        /// Name of the column.
        column: String,
        /// Samples in it.
        found: usize,
        /// Wavelengths.
        expected: usize,
    },
    /// A sample or wavelength is not a number, out of range, or missing.
    #[error("{place}: {found} in column {column:?}, expected {expected}")]
    Value {
        /// Where.
        place: String,
        /// Name of the column.
        column: String,
        /// What is there.
        found: String,
        /// What may be there.
        expected: String,
    },
    /// Wavelengths do not ascend, or ascend by too much.
    #[error("{place}: {found_nm} nm after {previous_nm} nm, expected {expected}")]
    Step {
        /// Where.
        place: String,
        /// Wavelength there, nm.
        found_nm: f64,
        /// Wavelength before it, nm.
        previous_nm: f64,
        /// Which steps are allowed.
        expected: String,
    },
    /// The samples do not cover the required range.
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
        /// A suggestion, or empty.
        hint: &'static str,
    },
    /// The greatest sample of a relative curve is too small or too great to calculate with.
    #[error(
        "the greatest value in column {column:?} is {found:e}, expected {:e} to {:e}",
        RELATIVE_PEAKS[0],
        RELATIVE_PEAKS[1]
    )]
    Peak {
        /// Name of the column.
        column: String,
        /// The greatest sample.
        found: f64,
    },
    /// There are no samples.
    #[error("no samples, expected one for each wavelength")]
    Empty,
}

impl SamplesError {
    pub(crate) fn value(
        place: String,
        column: &str,
        found: String,
        expected: impl Into<String>,
    ) -> Self {
        Self::Value { place, column: column.into(), found, expected: expected.into() }
    }
}

/// The curves through samples, on [`Grid::FINE`], or on the part of it that the samples cover if the
/// curves are zero beyond. Each column has a name and one sample for each
/// wavelength (nm); where the rules allow blank ends, NaN is an absent sample.
///
/// # Errors
///
/// [`SamplesError`] names the index of the sample, and what was expected there.
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
    let mut rows = Rows::new(columns.map(|(name, _)| name), rules, "sample");
    for (place, &nm) in wavelengths_nm.iter().enumerate() {
        let absent = |value: &f64| rules.has_blank_ends && value.is_nan();
        let cells = columns.map(|(_, samples)| Some(samples[place]).filter(|v| !absent(v)));
        rows.push(Row { place, nm, cells })?;
    }
    rows.into_curves()
}

/// The samples at one wavelength; `None` where one is absent.
pub(crate) struct Row<const N: usize> {
    /// Number of the line or sample.
    pub(crate) place: usize,
    pub(crate) nm: f64,
    pub(crate) cells: [Option<f64>; N],
}

/// Samples that are checked as they are added.
pub(crate) struct Rows<'n, const N: usize> {
    columns: [&'n str; N],
    rules: SampleRules,
    /// What places number: lines or samples.
    unit: &'static str,
    rows: Vec<Row<N>>,
}

impl<'n, const N: usize> Rows<'n, N> {
    pub(crate) fn new(columns: [&'n str; N], rules: SampleRules, unit: &'static str) -> Self {
        Self { columns, rules, unit, rows: Vec::new() }
    }

    pub(crate) fn push(&mut self, row: Row<N>) -> Result<(), SamplesError> {
        let found_nm = row.nm;
        let place = || format!("{} {}", self.unit, row.place);
        if !found_nm.is_finite() {
            let (column, found) = ("wavelength_nm", found_nm.to_string());
            return Err(SamplesError::value(place(), column, found, "a finite number"));
        }
        for (cell, column) in row.cells.iter().zip(self.columns) {
            cell.map_or(Ok(()), |found| self.rules.check(place, column, found_nm, found))?;
        }
        if let Some(&Row { nm: previous_nm, .. }) = self.rows.last() {
            let limit_nm = self.rules.gap_limit_nm;
            let expected = match found_nm - previous_nm {
                step_nm if step_nm <= 0.0 => Some("ascending wavelengths".into()),
                step_nm if step_nm > limit_nm => Some(format!("steps of at most {limit_nm} nm")),
                _ => None,
            };
            if let Some(expected) = expected {
                return Err(SamplesError::Step { place: place(), found_nm, previous_nm, expected });
            }
        }
        self.rows.push(row);
        Ok(())
    }

    pub(crate) fn into_curves(self) -> Result<[Spectrum; N], SamplesError> {
        self.check_range()?;
        for (k, column) in self.columns.into_iter().enumerate() {
            self.check_holes(k, column)?;
        }
        Ok(std::array::from_fn(|k| self.on_fine(k)))
    }

    /// Column `k` at the wavelengths of [`Grid::FINE`], without ends where it is zero.
    fn on_fine(&self, k: usize) -> Spectrum {
        let [first_nm, last_nm] = TABLES_NM;
        let is_between = |nm: f64| first_nm < nm && nm < last_nm && nm.fract() != 0.0;
        // Otherwise the samples of the grid define the same lines.
        let curve = if self.rules.keeps_areas && self.rows.iter().any(|row| is_between(row.nm)) {
            self.means(k)
        } else {
            self.sample_fine(k)
        };
        if self.rules.ends == Some(Ends::Zero) { curve.resampled(self.covered()) } else { curve }
    }

    /// The wavelengths of [`Grid::FINE`] that the samples cover, and those around their ends.
    fn covered(&self) -> Grid {
        let [low_nm, high_nm] = TABLES_NM;
        let [first_nm, last_nm] = self.range_nm();
        let [first_nm, last_nm] = [first_nm.floor(), last_nm.ceil()].map(|nm| {
            u32::try_from(whole(nm.clamp(low_nm, high_nm))).expect("wavelengths are small")
        });
        Grid::try_new(first_nm, last_nm, 1).expect("the samples cover a range")
    }

    /// First and last wavelength of the samples, nm.
    fn range_nm(&self) -> [f64; 2] {
        [self.rows[0].nm, self.rows[self.rows.len() - 1].nm]
    }

    /// Column `k` at the first and last sample, and what it is beyond.
    fn ends(&self, k: usize) -> [[f64; 2]; 2] {
        let [first, last] = [&self.rows[0], &self.rows[self.rows.len() - 1]];
        [first, last].map(|row| {
            let value = row.cells[k].unwrap_or(0.0);
            [value, if self.rules.ends == Some(Ends::Hold) { value } else { 0.0 }]
        })
    }

    /// Column `k` as the means around the wavelengths of [`Grid::FINE`].
    fn means(&self, k: usize) -> Spectrum {
        let [first_nm, last_nm] = self.range_nm();
        let [[_, before], [_, after]] = self.ends(k);
        let [low_nm, high_nm] = [TABLES_NM[0] - 1.0, TABLES_NM[1] + 1.0];
        // Two samples at one wavelength are a step.
        let start = [(low_nm, before), (first_nm, before)];
        let start = start.into_iter().filter(|_| first_nm > TABLES_NM[0]);
        let end = [(last_nm, after), (high_nm, after)];
        let end = end.into_iter().filter(|_| last_nm < TABLES_NM[1]);
        let samples = self.rows.iter().map(|row| (row.nm, row.cells[k].unwrap_or(0.0)));
        fine_means(start.chain(samples).chain(end))
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
                let place = format!("{} {}", self.unit, row.place);
                let expected = "a value between measured ones";
                Err(SamplesError::value(place, column, "empty cell".into(), expected))
            }
            _ => Ok(()),
        }
    }

    /// Column `k` at every wavelength of [`Grid::FINE`].
    fn sample_fine(&self, k: usize) -> Spectrum {
        let rows = &self.rows;
        let [first_nm, last_nm] = self.range_nm();
        let [[_, before], [_, after]] = self.ends(k);
        let mut above = 1;
        let values = Grid::FINE.wavelengths_nm().map(|nm| {
            match nm {
                _ if nm < self.rules.dark_below_nm => return 0.0,
                _ if nm < first_nm => return before,
                _ if nm > last_nm => return after,
                _ => {}
            }
            while above + 1 < rows.len() && rows[above].nm < nm {
                above += 1;
            }
            let (low, high) = (&rows[above - 1], &rows[above]);
            let fraction = (nm - low.nm) / (high.nm - low.nm);
            low.cells[k].unwrap_or(0.0) * (1.0 - fraction) + high.cells[k].unwrap_or(0.0) * fraction
        });
        Spectrum::new(Grid::FINE, values.collect()).expect("interpolated samples are finite")
    }
}

/// The means around the wavelengths of [`Grid::FINE`] of the straight lines between samples, of
/// ascending wavelength (nm) and value. The weight falls linearly to zero at the neighboring wavelengths,
/// so that areas and centers of narrow lines are kept. Each wavelength must be between two samples or at
/// one.
pub(crate) fn fine_means(samples: impl Iterator<Item = (f64, f64)> + Clone) -> Spectrum {
    let first_nm = f64::from(Grid::FINE.first_nm());
    // Area below the lines and weight, with one more wavelength at either end.
    let mut sums = vec![[0.0; 2]; Grid::FINE.len() + 2];
    let last = (sums.len() - 1) as f64;
    let positions = samples.map(|(nm, value)| (nm - first_nm + 1.0, value));
    for ((start, first), (end, second)) in positions.clone().zip(positions.skip(1)) {
        let mut low = start.clamp(0.0, last);
        while low < end.min(last) {
            let below = low.floor();
            let high = end.min(below + 1.0);
            let middle = (low + high) / 2.0;
            // Simpson's rule is exact for the product of two lines.
            for (at, share) in [(low, 1.0), (middle, 4.0), (high, 1.0)] {
                let fraction = ((at - start) / (end - start)).clamp(0.0, 1.0);
                let value = first * (1.0 - fraction) + second * fraction;
                let weight = share * (high - low) / 6.0;
                for (band, near) in [(below, 1.0 - (at - below)), (below + 1.0, at - below)] {
                    let [area, all] = &mut sums[whole(band)];
                    *area += weight * near * value;
                    *all += weight * near;
                }
            }
            low = high;
        }
    }
    // Rounding must not make a mean of the largest numbers infinite.
    let mean = |[area, all]: &[f64; 2]| (area / all).min(f64::MAX);
    let means = sums[1..=Grid::FINE.len()].iter().map(mean).collect();
    Spectrum::new(Grid::FINE, means).expect("means of finite samples are finite")
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
    fn a_linear_curve_is_reproduced_from_uneven_steps() {
        let nm: Vec<f64> = every_10_nm().into_iter().chain([831.5]).collect();
        let line = light(&nm, &nm).unwrap();
        for at in Grid::FINE.wavelengths_nm() {
            assert!((line.at(at) - at).abs() < 1e-9, "{at}");
        }
    }

    #[test]
    fn narrow_lines_keep_their_area_and_place() {
        // Rounding only.
        const ROUNDING: f64 = 1e-9;
        for (step_nm, peak_nm, fwhm_nm) in
            [(0.1, 546.07, 0.3), (0.37, 435.8, 1.0), (0.05, 577.5, 0.1)]
        {
            let nm: Vec<f64> = (0..)
                .map(|i| 299.9 + step_nm * f64::from(i))
                .take_while(|nm| *nm < 830.5)
                .collect();
            let power: Vec<f64> =
                nm.iter().map(|nm| (-((nm - peak_nm) / fwhm_nm).powi(2)).exp()).collect();
            // Sums over equal steps, whose lines begin and end at zero.
            let (area, moment) = (
                power.iter().sum::<f64>() * step_nm,
                nm.iter().zip(&power).map(|(nm, p)| nm * p).sum::<f64>() * step_nm,
            );
            let line = light(&nm, &power).unwrap();
            let found = Grid::FINE.wavelengths_nm().zip(line.values());
            assert!((line.values().iter().sum::<f64>() - area).abs() < ROUNDING, "{step_nm}");
            assert!(
                (found.map(|(nm, p)| nm * p).sum::<f64>() - moment).abs() < ROUNDING * moment,
                "{step_nm}"
            );
        }
    }

    #[test]
    fn errors_name_the_index_of_the_sample() {
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
                "sample 3: 331 nm after 320 nm, expected steps of at most 10 nm",
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
    fn samples_of_a_dye_may_be_absent_only_at_the_ends() {
        let nm: Vec<f64> = (60..=166).map(|i| 5.0 * f64::from(i)).collect();
        let mut absorption = vec![0.5; nm.len()];
        absorption[0] = f64::NAN;
        let curve = |samples: &[f64]| {
            curves_from_samples(&nm, [("absorption", samples)], SampleRules::DYE).map(|[c]| c)
        };
        assert_eq!(curve(&absorption).unwrap().at(300.0), 0.0);
        absorption[7] = f64::NAN;
        let hole = curve(&absorption).unwrap_err().to_string();
        assert_eq!(
            hole,
            "sample 7: empty cell in column \"absorption\", expected a value between measured ones"
        );
    }

    proptest::proptest! {
        #[test]
        fn no_samples_cause_a_panic(
            rows in proptest::collection::vec(proptest::num::f64::ANY, 0..200),
            step in 0.0..10.0_f64,
            powers in proptest::collection::vec(0.0..f64::MAX, 200..700),
        ) {
            let nm: Vec<f64> = (0..powers.len()).map(|i| 299.5 + 2.7 * i as f64).collect();
            let _ = curves_from_samples(&nm, [("a", &powers)], SampleRules::LIGHT);
            let nm: Vec<f64> = (0..rows.len()).map(|i| 290.0 + step * i as f64).collect();
            for rules in [SampleRules::LIGHT, SampleRules::DYE, SampleRules::OBSERVER] {
                let _ = curves_from_samples(&nm, [("a", &rows)], rules);
                let _ = curves_from_samples(&rows, [("a", &nm)], rules);
            }
        }
    }
}
