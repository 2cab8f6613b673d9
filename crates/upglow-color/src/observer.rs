//! Observers: sets of color-matching functions.

use std::path::Path;

use crate::grid::Grid;
use crate::matrix::Matrix3;
use crate::names::{NameError, name_after_file};
use crate::samples::{SampleRules, SamplesError, curves_from_samples};
use crate::spectrum::{Spectrum, SpectrumCsvError, read_columns};
use crate::tables::observers::{OBSERVERS, ObserverTable};

/// A set of color-matching functions x̄, ȳ, z̄: 0 or more, zero below 360 nm and where they were not
/// measured, and linearly independent.
///
/// Only their ratios matter, as Y = 1 is always the perfect diffuser.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(transparent))]
#[must_use]
pub struct Observer {
    name: String,
    /// x̄, ȳ, z̄ on [`Grid::FINE`].
    #[cfg_attr(feature = "serde", serde(skip))]
    matching: [Spectrum; 3],
}

/// Why color-matching functions are rejected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ObserverError {
    /// No built-in observer has this name.
    #[error("unknown observer {found:?}, expected {}, or a CSV file", Observer::NAMES.join(", "))]
    Unknown {
        /// The name given.
        found: String,
    },
    /// The CSV text does not define color-matching functions.
    #[error(transparent)]
    Csv(#[from] SpectrumCsvError),
    /// The samples do not define color-matching functions.
    #[error(transparent)]
    Samples(#[from] SamplesError),
    /// The name cannot be that of this observer.
    #[error(transparent)]
    Name(#[from] NameError),
    /// One function is zero or a linear combination of the others.
    #[error("x, y and z are linearly dependent, expected three independent functions")]
    Dependent,
}

/// The names of the functions in files and messages.
const COLUMNS: [&str; 3] = ["x", "y", "z"];

/// The least volume that the three functions, scaled to unit length, must span. The CIE's 2° and 10°
/// observers span 0.6. Smaller allows matrices that amplify rounding to visible differences; larger
/// might refuse a measured observer.
const LEAST_VOLUME: f64 = 1e-3;

impl Observer {
    /// The built-in observers: the CIE's standard observers of 1931 and 1964, and those of 2015, which
    /// follow from cone fundamentals.
    ///
    /// # Source
    ///
    /// `iso11664_1` and `cie170_2`.
    pub const NAMES: [&str; OBSERVERS.len()] = {
        let mut names = [""; OBSERVERS.len()];
        let mut i = 0;
        while i < names.len() {
            names[i] = OBSERVERS[i].word;
            i += 1;
        }
        names
    };

    /// The built-in observer of this name, in any case; [`Observer::name`] is accepted too.
    ///
    /// # Errors
    ///
    /// [`ObserverError::Unknown`] lists the known names.
    pub fn named(name: &str) -> Result<Self, ObserverError> {
        let is_known = |table: &&ObserverTable| {
            [table.word, table.name].iter().any(|spelling| name.eq_ignore_ascii_case(spelling))
        };
        OBSERVERS
            .iter()
            .find(is_known)
            .map(Self::built_in)
            .ok_or_else(|| ObserverError::Unknown { found: name.into() })
    }

    /// The CIE 1931 2° standard observer: measured from 360 to 830 nm, zero below.
    pub fn cie_1931_2deg() -> Self {
        Self::built_in(&OBSERVERS[0])
    }

    fn built_in(table: &ObserverTable) -> Self {
        let lead = (table.first_nm - Grid::FINE.first_nm()) as usize;
        let matching = [0, 1, 2].map(|channel| {
            let mut values = vec![0.0; Grid::FINE.len()];
            for (value, row) in values[lead..].iter_mut().zip(table.rows) {
                *value = row[channel];
            }
            Spectrum::new(Grid::FINE, values).expect("the table is finite and fills the grid")
        });
        Self { name: table.name.into(), matching }
    }

    /// The observer in CSV text with the header `wavelength_nm,x,y,z`: at least 400 to 700 nm in steps
    /// of at most 5 nm. It is zero beyond them; cells at either end of a column may be empty and count
    /// as zero.
    ///
    /// # Errors
    ///
    /// [`ObserverError`] if the text does not define color-matching functions.
    pub fn from_csv(name: &str, text: &str) -> Result<Self, ObserverError> {
        Self::from_spectra(name, read_columns(text, COLUMNS, SampleRules::OBSERVER)?)
    }

    /// The observer in the CSV text of a file, named after the file: by its stem, or by its whole name
    /// where the stem is that of a built-in observer with other numbers.
    ///
    /// # Errors
    ///
    /// As [`Observer::from_csv`].
    pub fn from_csv_file(path: &Path, text: &str) -> Result<Self, ObserverError> {
        let is_taken = |name: &str| {
            matches!(Self::from_csv(name, text), Err(ObserverError::Name(NameError::Taken { .. })))
        };
        Self::from_csv(&name_after_file(path, is_taken), text)
    }

    /// An observer from samples: ascending wavelengths (nm) over at least 400 to 700 nm in steps of at
    /// most 5 nm, and x̄, ȳ, z̄ of 0 or more for each, `[wavelength][x̄ ȳ z̄]`. It is zero beyond them;
    /// NaN at either end of a function counts as zero.
    ///
    /// # Errors
    ///
    /// [`ObserverError`] if the samples do not define color-matching functions.
    pub fn from_samples(
        name: &str,
        wavelengths_nm: &[f64],
        matching: &[[f64; 3]],
    ) -> Result<Self, ObserverError> {
        let [x, y, z] = [0, 1, 2].map(|k| matching.iter().map(|v| v[k]).collect::<Vec<_>>());
        let columns = [(COLUMNS[0], &x[..]), (COLUMNS[1], &y), (COLUMNS[2], &z)];
        let curves = curves_from_samples(wavelengths_nm, columns, SampleRules::OBSERVER)?;
        Self::from_spectra(name, curves)
    }

    /// An observer from its three functions.
    ///
    /// # Errors
    ///
    /// [`ObserverError`] if a function is negative or not zero below 360 nm, if the functions are
    /// linearly dependent, or if the name is that of a built-in observer with other functions.
    pub fn from_spectra(name: &str, matching: [Spectrum; 3]) -> Result<Self, ObserverError> {
        let matching = matching.map(|curve| curve.resampled(Grid::FINE));
        for (column, curve) in COLUMNS.into_iter().zip(&matching) {
            SampleRules::OBSERVER.check_curve(column, curve)?;
        }
        let volume = volume(&matching);
        // NaN where a function is zero.
        if volume.is_nan() || volume < LEAST_VOLUME {
            return Err(ObserverError::Dependent);
        }
        NameError::check_text(name)?;
        if let Ok(known) = Self::named(name) {
            for ((column, found), known) in COLUMNS.into_iter().zip(&matching).zip(&known.matching)
            {
                NameError::check_curve("observer", name, column, found, known, 0.0)?;
            }
        }
        Ok(Self { name: name.into(), matching })
    }

    /// The name that files state.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// x̄, ȳ, z̄ on [`Grid::FINE`].
    pub fn matching(&self) -> &[Spectrum; 3] {
        &self.matching
    }

    /// x̄, ȳ, z̄ at every wavelength of `grid`, `[wavelength][x̄ ȳ z̄]`.
    pub fn on(&self, grid: Grid) -> Vec<[f64; 3]> {
        grid.wavelengths_nm().map(|nm| [0, 1, 2].map(|k| self.matching[k].at(nm))).collect()
    }
}

impl Default for Observer {
    fn default() -> Self {
        Self::cie_1931_2deg()
    }
}

/// Volume of the parallelepiped of the functions scaled to unit length: 1 if they do not overlap, 0 if
/// they are linearly dependent.
fn volume(matching: &[Spectrum; 3]) -> f64 {
    let dot = |a: &Spectrum, b: &Spectrum| -> f64 {
        a.values().iter().zip(b.values()).map(|(a, b)| a * b).sum()
    };
    let lengths = matching.each_ref().map(|curve| dot(curve, curve).sqrt());
    let cosine = |i: usize, j: usize| dot(&matching[i], &matching[j]) / (lengths[i] * lengths[j]);
    let gram = Matrix3([0, 1, 2].map(|i| [0, 1, 2].map(|j| cosine(i, j))));
    gram.determinant().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The built-in table from `first_nm` to `last_nm` by `step`.
    fn table(first_nm: u32, last_nm: u32, step: usize) -> (Vec<f64>, Vec<[f64; 3]>) {
        let known = Observer::default();
        let nm: Vec<f64> = (first_nm..=last_nm).step_by(step).map(f64::from).collect();
        let rows = nm.iter().map(|&nm| known.matching.each_ref().map(|m| m.at(nm))).collect();
        (nm, rows)
    }

    #[test]
    fn samples_and_csv_text_give_the_published_observer() {
        let (nm, rows) = table(360, 830, 1);
        let sampled = Observer::from_samples("CIE 1931 2°", &nm, &rows).unwrap();
        assert_eq!(sampled, Observer::default());
        let lines = nm.iter().zip(&rows).map(|(nm, [x, y, z])| format!("{nm},{x},{y},{z}\n"));
        let text = "wavelength_nm,x,y,z\n".to_owned() + &lines.collect::<String>();
        assert_eq!(Observer::from_csv("CIE 1931 2°", &text).unwrap(), Observer::default());
    }

    #[test]
    fn a_built_in_name_is_for_the_built_in_functions_only() {
        let (nm, mut rows) = table(360, 830, 1);
        rows[100][1] *= 1.01;
        for name in ["CIE 1931 2°", Observer::NAMES[0]] {
            let refused = Observer::from_samples(name, &nm, &rows).unwrap_err();
            assert!(matches!(refused, ObserverError::Name(NameError::Taken { .. })));
        }
        let lines = nm.iter().zip(&rows).map(|(nm, [x, y, z])| format!("{nm},{x},{y},{z}\n"));
        let text = "wavelength_nm,x,y,z\n".to_owned() + &lines.collect::<String>();
        let path = Path::new("eyes/cie-1931-2deg.csv");
        assert_eq!(Observer::from_csv_file(path, &text).unwrap().name(), "cie-1931-2deg.csv");
    }

    #[test]
    fn an_observer_is_zero_beyond_its_samples() {
        let (nm, rows) = table(380, 780, 5);
        let short = Observer::from_samples("short", &nm, &rows).unwrap();
        let seen = short.on(Grid::FINE);
        let zero = |nm: usize| seen[nm - 300] == [0.0; 3];
        assert!(zero(379) && zero(781) && !zero(380) && !zero(780));
    }

    #[test]
    fn functions_stay_zero_below_360_nm_when_interpolated() {
        let (nm, rows) = table(300, 830, 5);
        let from_300 = Observer::from_samples("from 300", &nm, &rows).unwrap();
        assert!(from_300.on(Grid::FINE)[..60].iter().all(|v| *v == [0.0; 3]));
        assert_eq!(from_300.on(Grid::FIT), Observer::default().on(Grid::FIT));
    }

    #[test]
    fn names_are_accepted_in_any_case_and_errors_list_them() {
        for name in ["CIE-1931-2deg", "cie 1931 2°"] {
            assert_eq!(Observer::named(name), Ok(Observer::default()));
        }
        assert_eq!(
            Observer::named("hawk").unwrap_err().to_string(),
            "unknown observer \"hawk\", expected cie-1931-2deg, cie-1964-10deg, cie-2015-2deg, \
             cie-2015-10deg, or a CSV file"
        );
    }

    #[test]
    fn errors_name_the_sample_or_the_reason() {
        let message = |edit: fn(&mut Vec<f64>, &mut Vec<[f64; 3]>)| {
            let (mut nm, mut rows) = table(350, 830, 5);
            edit(&mut nm, &mut rows);
            Observer::from_samples("mine", &nm, &rows).unwrap_err().to_string()
        };
        let known: [(String, &str); 7] = [
            (
                message(|_, rows| rows[20][1] = -0.1),
                "sample 20: -0.1 in column \"y\", expected a value of 0 or more",
            ),
            (
                message(|_, rows| rows[1][2] = 0.1),
                "sample 1: 0.1 in column \"z\", expected 0 below 360 nm",
            ),
            (
                message(|nm, _| nm[8] = 384.0),
                "sample 8: 384 nm after 385 nm, expected ascending wavelengths",
            ),
            (
                message(|nm, rows| (nm.truncate(70), rows.truncate(70)).1),
                "covers 350 to 695 nm, expected at least 400 to 700 nm",
            ),
            (
                message(|_, rows| rows.truncate(9)),
                "9 samples in column \"x\", expected 97, one for each wavelength",
            ),
            (
                message(|_, rows| rows.iter_mut().for_each(|v| v[2] = 0.0)),
                "x, y and z are linearly dependent, expected three independent functions",
            ),
            (
                message(|_, rows| rows.iter_mut().for_each(|v| v[2] = v[0] + v[1])),
                "x, y and z are linearly dependent, expected three independent functions",
            ),
        ];
        for (found, expected) in known {
            assert!(found.starts_with(expected), "{found}");
        }
        let flat = Spectrum::new(Grid::FINE, vec![-1.0; Grid::FINE.len()]).unwrap();
        let refused = Observer::from_spectra("mine", [flat.clone(), flat.clone(), flat]);
        assert_eq!(
            refused.unwrap_err().to_string(),
            "300 nm: -1 in column \"x\", expected a value of 0 or more"
        );
    }

    #[test]
    fn the_standard_observer_spans_the_documented_volume() {
        let found = volume(&Observer::default().matching);
        assert!((0.55..0.65).contains(&found), "{found}");
    }
}
