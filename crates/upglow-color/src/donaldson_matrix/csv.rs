//! Matrices as CSV with named axes.

use super::{BispectralUnit, DonaldsonError, DonaldsonMatrix};

/// Why a CSV text is no matrix. Lines count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MatrixCsvError {
    /// The first cell does not name both axes and the unit.
    #[error("line {line} starts with {found:?}, expected {}", expected_heads())]
    Head {
        /// Line number.
        line: usize,
        /// The first cell.
        found: String,
    },
    /// There is no line that is not a comment.
    #[error("no line, expected a first cell {}", expected_heads())]
    Empty,
    /// A line has another number of cells than the first.
    #[error("line {line}: {found} cells, expected {expected} as in the first line")]
    Cells {
        /// Line number.
        line: usize,
        /// Cells in it.
        found: usize,
        /// Cells in the first line.
        expected: usize,
    },
    /// A cell does not hold a number.
    #[error("line {line}, cell {cell}: {found:?}, expected a number")]
    Number {
        /// Line number.
        line: usize,
        /// Cell, counted from 1.
        cell: usize,
        /// What is there.
        found: String,
    },
    /// There are more lines than wavelengths can be.
    #[error(
        "line {line}: more than {MOST_CELLS} lines or cells, expected a matrix of at most that many wavelengths"
    )]
    TooLong {
        /// Line number.
        line: usize,
    },
    /// The numbers are no matrix.
    #[error(transparent)]
    Matrix(#[from] DonaldsonError),
}

/// Which wavelength names a line of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rows {
    Outgoing,
    Incident,
}

/// The first cell: the axis of the lines, that of the columns, and the unit.
const HEADS: [(&str, Rows, BispectralUnit); 4] = [
    ("outgoing_nm\\incident_nm per_band", Rows::Outgoing, BispectralUnit::PerBand),
    ("outgoing_nm\\incident_nm per_nm", Rows::Outgoing, BispectralUnit::PerNm),
    ("incident_nm\\outgoing_nm per_band", Rows::Incident, BispectralUnit::PerBand),
    ("incident_nm\\outgoing_nm per_nm", Rows::Incident, BispectralUnit::PerNm),
];

/// Longer files are refused before they fill the memory.
const MOST_CELLS: usize = 1002;

fn expected_heads() -> String {
    let names: Vec<&str> = HEADS.iter().map(|(name, ..)| *name).collect();
    names.join(", ").replacen(names[3], &format!("or {}", names[3]), 1)
}

impl DonaldsonMatrix {
    /// The matrix in CSV text. The first cell names the axis of the lines, that of the columns and the
    /// unit: `outgoing_nm\incident_nm per_band`, or transposed `incident_nm\outgoing_nm per_band`, or
    /// either with `per_nm`. The first line continues with the wavelengths of the columns; each other
    /// line is a wavelength and its values. Lines that start with `#` are comments.
    ///
    /// # Errors
    ///
    /// [`MatrixCsvError`] names the line and what was expected there.
    pub fn from_csv(text: &str) -> Result<Self, MatrixCsvError> {
        let text = text.trim_start_matches('\u{feff}');
        let is_content =
            |(_, line): &(usize, &str)| !line.starts_with('#') && !line.trim().is_empty();
        let mut lines = (1..).zip(text.lines()).filter(is_content);
        let (line, first) = lines.next().ok_or(MatrixCsvError::Empty)?;
        let (head, columns) = first.split_once(',').unwrap_or((first, ""));
        let is_head = |(name, ..): &&(&str, Rows, BispectralUnit)| {
            head.split_whitespace().eq(name.split_whitespace())
        };
        let &(_, axis, unit) = HEADS.iter().find(is_head).ok_or_else(|| MatrixCsvError::Head {
            line,
            found: head.trim().chars().take(60).collect(),
        })?;
        let column_nm = numbers(line, 2, columns)?;
        let (mut row_nm, mut rows) = (Vec::new(), Vec::new());
        for (line, text) in lines {
            let mut cells = numbers(line, 1, text)?;
            let (found, expected) = (cells.len(), column_nm.len() + 1);
            if found != expected {
                return Err(MatrixCsvError::Cells { line, found, expected });
            }
            if rows.len() == MOST_CELLS {
                return Err(MatrixCsvError::TooLong { line });
            }
            row_nm.push(cells.remove(0));
            rows.push(cells);
        }
        let (incident, outgoing, values) = match axis {
            Rows::Outgoing => (column_nm, row_nm, rows),
            Rows::Incident => {
                let column = |k: usize| rows.iter().map(|row: &Vec<f64>| row[k]).collect();
                let values = (0..column_nm.len()).map(column).collect();
                (row_nm, column_nm, values)
            }
        };
        Ok(Self::try_new(incident, outgoing, values, unit)?)
    }
}

/// The cells of a line from number `first` on.
fn numbers(line: usize, first: usize, text: &str) -> Result<Vec<f64>, MatrixCsvError> {
    let mut found = Vec::new();
    for (cell, text) in (first..).zip(text.split(',')) {
        if found.len() > MOST_CELLS {
            return Err(MatrixCsvError::TooLong { line });
        }
        let number = text.trim().parse().ok().filter(|value: &f64| value.is_finite());
        found.push(number.ok_or_else(|| MatrixCsvError::Number {
            line,
            cell,
            found: text.trim().chars().take(40).collect(),
        })?);
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# mine\noutgoing_nm\\incident_nm per_band,350,400\n400,0.1,0.5\n\
                        550,0.2,0.25\n700,-0.001,0\n";

    #[test]
    fn lines_are_the_first_axis_that_the_head_names() {
        let found = DonaldsonMatrix::from_csv(TEXT).unwrap();
        assert_eq!(
            (found.incident_nm(), found.outgoing_nm()),
            (&[350.0, 400.0][..], &[400.0, 550.0, 700.0][..])
        );
        assert_eq!(found.factors()[1], [0.2, 0.25]);
        let transposed =
            "incident_nm\\outgoing_nm per_band,400,550,700\n350,0.1,0.2,-0.001\n400,0.5,0.25,0";
        assert_eq!(DonaldsonMatrix::from_csv(transposed).unwrap(), found);
    }

    #[test]
    fn a_density_is_times_the_width_of_its_band() {
        let text = "outgoing_nm\\incident_nm per_nm,350,400\n400,0,0\n550,0.002,0\n700,0,0\n";
        let found = DonaldsonMatrix::from_csv(text).unwrap();
        assert_eq!((found.factors()[1][0], found.unit()), (0.3, BispectralUnit::PerNm));
    }

    #[test]
    fn errors_name_the_line() {
        let known = [
            ("", "no line, expected a first cell outgoing_nm\\incident_nm per_band, "),
            ("a,b", "line 1 starts with \"a\", expected outgoing_nm\\incident_nm per_band, "),
            (&TEXT.replace("550,", "550,1,"), "line 4: 4 cells, expected 3 as in the first line"),
            (&TEXT.replace("0.25", "x"), "line 4, cell 3: \"x\", expected a number"),
            (&TEXT.replace("0.25", "inf"), "line 4, cell 3: \"inf\", expected a number"),
            (&TEXT.replace("350,", "450,"), "incident wavelength 400 nm, expected ascending"),
            (&TEXT.replace(",350,400", ""), "line 2, cell 2: \"\", expected a number"),
        ];
        for (text, expected) in known {
            let error = DonaldsonMatrix::from_csv(text).unwrap_err().to_string();
            assert!(error.starts_with(expected) && !error.contains('\n'), "{error}");
        }
        let long = TEXT.to_owned() + &"700,0,0\n".repeat(2000);
        let error = DonaldsonMatrix::from_csv(&long).unwrap_err().to_string();
        assert!(error.starts_with("line 1005: more than 1002 lines"), "{error}");
    }

    proptest::proptest! {
        #[test]
        fn no_text_causes_a_panic(
            cells in proptest::collection::vec("[0-9.,eE+\\-#naif]{0,24}", 0..40),
        ) {
            let text = format!("incident_nm\\outgoing_nm per_nm,{}", cells.join("\n"));
            if let Err(error) = DonaldsonMatrix::from_csv(&text) {
                proptest::prop_assert!(!error.to_string().contains('\n'));
            }
        }
    }
}
