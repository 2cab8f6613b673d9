//! Matrices as the BFC-450 spectrofluorimeter writes them.

use super::{BispectralUnit, DonaldsonError, DonaldsonMatrix};

/// Why a text is no matrix of a BFC-450. Lines count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BfcError {
    /// The file ends too early.
    #[error("line {line} is missing, expected {expected}")]
    Missing {
        /// Line number.
        line: usize,
        /// What should be there.
        expected: String,
    },
    /// A line says something else.
    #[error("line {line} is {found:?}, expected {expected}")]
    Line {
        /// Line number.
        line: usize,
        /// Its beginning.
        found: String,
        /// What should be there.
        expected: String,
    },
    /// A row has too few or too many numbers.
    #[error("line {line} holds {found} numbers, expected {expected}")]
    Count {
        /// Line number.
        line: usize,
        /// Numbers in it.
        found: usize,
        /// Incident wavelengths.
        expected: usize,
    },
    /// A cell does not hold a number.
    #[error("line {line} holds {found:?}, expected a number")]
    Number {
        /// Line number.
        line: usize,
        /// The cell.
        found: String,
    },
    /// The numbers are no matrix.
    #[error(transparent)]
    Matrix(#[from] DonaldsonError),
}

/// The lines of the title, of the grid and of the first row, counted from 1.
const TITLE: usize = 2;
const GRID: usize = 11;
const FIRST_ROW: usize = 13;

/// What the line of the grid must say.
const GRID_LINE: &str = "the grid: first and last outgoing wavelength and their step, number of incident \
                         wavelengths, the first of them and their step, such as 380 780 10 49 300 10";

/// More wavelengths than any axis may have end in an error of the matrix.
const MOST_WAVELENGTHS: u32 = 1002;

impl DonaldsonMatrix {
    /// The matrix in the text of a BFC-450's file (`.BFC`): power that leaves in a band per power that
    /// arrives in one, rows by outgoing wavelength, reflected and re-emitted light together on the
    /// diagonal.
    ///
    /// # Errors
    ///
    /// [`BfcError`] names the line and what was expected there.
    pub fn from_bfc(text: &str) -> Result<Self, BfcError> {
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        expect(&lines, TITLE, "BFC-450 Matrix File")?;
        let [outgoing_nm, incident_nm] = axes(&lines)?;
        let mut rows = Vec::with_capacity(outgoing_nm.len());
        for (line, nm) in (FIRST_ROW..).zip(&outgoing_nm) {
            rows.push(row(&lines, line, *nm, incident_nm.len())?);
        }
        expect(&lines, FIRST_ROW + rows.len(), "EOD")?;
        Ok(Self::try_new(incident_nm, outgoing_nm, rows, BispectralUnit::PerBand)?)
    }
}

fn line<'t>(lines: &[&'t str], line: usize, expected: &str) -> Result<&'t str, BfcError> {
    let missing = || BfcError::Missing { line, expected: expected.into() };
    lines.get(line - 1).copied().ok_or_else(missing)
}

/// Checks the words of a line.
fn expect(lines: &[&str], number: usize, expected: &str) -> Result<(), BfcError> {
    let found = line(lines, number, expected)?;
    if found.split_whitespace().eq(expected.split_whitespace()) {
        return Ok(());
    }
    Err(BfcError::Line { line: number, found: shortened(found), expected: expected.into() })
}

/// Outgoing and incident wavelengths, nm.
fn axes(lines: &[&str]) -> Result<[Vec<f64>; 2], BfcError> {
    let text = line(lines, GRID, GRID_LINE)?;
    let fault =
        || BfcError::Line { line: GRID, found: shortened(text), expected: GRID_LINE.into() };
    let numbers: Option<Vec<u32>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    let Some(&[first, last, step, count, start, distance]) = numbers.as_deref() else {
        return Err(fault());
    };
    let is_whole = step > 0 && last > first && (last - first).is_multiple_of(step);
    if !is_whole || (last - first) / step > MOST_WAVELENGTHS || count > MOST_WAVELENGTHS {
        return Err(fault());
    }
    let wavelength =
        |first: u32, step: u32, k: u32| f64::from(first) + f64::from(step) * f64::from(k);
    let outgoing = (0..=(last - first) / step).map(|k| wavelength(first, step, k)).collect();
    Ok([outgoing, (0..count).map(|k| wavelength(start, distance, k)).collect()])
}

/// The numbers of a row, which starts with its wavelength.
fn row(lines: &[&str], number: usize, nm: f64, count: usize) -> Result<Vec<f64>, BfcError> {
    let expected = format!("a row of the matrix that starts with {nm}, its outgoing wavelength");
    let text = line(lines, number, &expected)?;
    let mut words = text.split_whitespace();
    if words.next().and_then(|word| word.parse::<f64>().ok()) != Some(nm) {
        return Err(BfcError::Line { line: number, found: shortened(text), expected });
    }
    let numbers = words
        .map(|word| match word.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(BfcError::Number { line: number, found: shortened(word) }),
        })
        .collect::<Result<Vec<f64>, _>>()?;
    if numbers.len() == count {
        return Ok(numbers);
    }
    Err(BfcError::Count { line: number, found: numbers.len(), expected: count })
}

/// The start of a text, so that an error stays one short line.
fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file whose matrix has this value on the diagonal, and this one from 400 nm to 500 nm.
    fn file(diagonal: f64, moved: f64) -> String {
        let mut text =
            "VEC_01 5167\nBFC-450 Matrix File\n;a\n;b\n;c\n;d\n;e\n;f\n;g\n;h\n".to_owned();
        text += "380 780 10 49 300 10\nr:c:\n";
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

    #[test]
    fn rows_are_where_light_leaves() {
        let found = DonaldsonMatrix::from_bfc(&file(0.5, 0.1)).unwrap();
        assert_eq!([found.incident_nm().len(), found.outgoing_nm().len()], [49, 41]);
        assert_eq!((found.factors()[12][10], found.factors()[0][8]), (0.1, 0.5));
    }

    #[test]
    fn other_grids_are_read() {
        let mut text = "\nBFC-450 Matrix File\n".to_owned() + &"\n".repeat(8);
        text += "400 700 100 2 350 50\n\n";
        for nm in [400, 500, 600, 700] {
            text += &format!("{nm} 0.1 {}\n", nm / 1000);
        }
        let found = DonaldsonMatrix::from_bfc(&(text + "EOD")).unwrap();
        assert_eq!(found.incident_nm(), [350.0, 400.0]);
        assert_eq!(found.outgoing_nm(), [400.0, 500.0, 600.0, 700.0]);
    }

    #[test]
    fn damaged_files_are_refused_with_their_line() {
        let whole = file(0.5, 0.0);
        let known = [
            ("", "line 2 is missing, expected BFC-450 Matrix File"),
            (&whole.replace("49 300", "48 310"), "line 13 holds 49 numbers, expected 48"),
            (
                &whole.replace("49 300", "4000000000 300"),
                "line 11 is \"380 780 10 4000000000 300 10\",",
            ),
            (
                &whole.replace("380 780 10 49", "380 780 0 49"),
                "line 11 is \"380 780 0 49 300 10\",",
            ),
            (
                &whole.replace("300 10\n", "300\n"),
                "line 11 is \"380 780 10 49 300\", expected the grid: ",
            ),
            (&whole.replace("\n390", "\n395"), "line 14 is \"395\\t"),
            (&whole.replace("EOD", ""), "line 54 is \"\", expected EOD"),
            (&whole.replacen("\t0.5", "\tNaN", 1), "line 13 holds \"NaN\", expected a number"),
            (&whole.replacen("\t0.5", "\t50", 1), "50 from 380 to 380 nm, expected a share of -10"),
            (&whole.replacen("\t0.5", "", 1), "line 13 holds 48 numbers, expected 49"),
            (&whole[..whole.len() / 2], "line 3"),
        ];
        for (text, expected) in known {
            let error = DonaldsonMatrix::from_bfc(text).unwrap_err().to_string();
            assert!(error.starts_with(expected) && !error.contains('\n'), "{error}");
        }
    }

    proptest::proptest! {
        #[test]
        fn no_text_causes_a_panic(
            cells in proptest::collection::vec("[0-9.eE+\\- \\tnaif]{0,24}", 0..40),
            grid in "[0-9]{1,10}( [0-9]{1,10}){5}",
        ) {
            let start = "\nBFC-450 Matrix File\n".to_owned() + &"\n".repeat(8);
            let text = format!("{start}{grid}\n\n{}", cells.join("\n"));
            if let Err(error) = DonaldsonMatrix::from_bfc(&text) {
                proptest::prop_assert!(!error.to_string().contains('\n'));
            }
        }
    }
}
