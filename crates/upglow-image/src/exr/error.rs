//! Why an OpenEXR file cannot be read.

use std::io;

/// Why an OpenEXR file cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExrError {
    /// The file cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The file begins with other bytes.
    #[error("the file begins with {found:02x?}, expected an OpenEXR file: [76, 2f, 31, 01]")]
    NotExr {
        /// The first four bytes.
        found: [u8; 4],
    },
    /// The file is of another version of the format.
    #[error("OpenEXR version {found}, expected 2")]
    Version {
        /// The version.
        found: u8,
    },
    /// The file ends early.
    #[error("the file ends inside {what}, expected a whole file")]
    Truncated {
        /// What is cut.
        what: String,
    },
    /// The file is of a kind that is not read.
    #[error("{found}, expected {expected}")]
    Unsupported {
        /// The kind.
        found: &'static str,
        /// What is read.
        expected: &'static str,
    },
    /// A field of the header has a value that makes no sense.
    #[error("{field} is {found}, expected {expected}")]
    Header {
        /// The field.
        field: String,
        /// Its value, or what is wrong with it.
        found: String,
        /// What it should be.
        expected: String,
    },
    /// One block takes more memory than is given to it.
    #[error("a block of {found} bytes, expected at most {expected}")]
    BlockSize {
        /// Bytes of a block once unpacked.
        found: u64,
        /// The most that is unpacked at once.
        expected: u64,
    },
    /// A block is not where the table of blocks says, or cannot be unpacked.
    #[error("block {index} of {count} is damaged: {found}, expected {expected}")]
    Block {
        /// Its number, from 0.
        index: usize,
        /// How many blocks there are.
        count: usize,
        /// What is wrong.
        found: String,
        /// What it should be.
        expected: String,
    },
    /// The file has no channel of this name.
    #[error("no channel {name:?}, expected {expected}")]
    NoChannel {
        /// The name asked for.
        name: String,
        /// What there is.
        expected: String,
    },
    /// Pixels were asked for that the image does not have.
    #[error("columns {columns:?} of rows {rows:?}, expected some inside {width} by {height}")]
    Outside {
        /// First column, and the column after the last.
        columns: [usize; 2],
        /// First row, and the row after the last.
        rows: [usize; 2],
        /// Columns of the image.
        width: usize,
        /// Rows of the image.
        height: usize,
    },
}

impl ExrError {
    pub(crate) fn header(
        field: &str,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        let [field, found, expected] = [field.into(), found.into(), expected.into()].map(shown);
        Self::Header { field, found, expected }
    }

    pub(crate) fn truncated(what: impl Into<String>) -> Self {
        Self::Truncated { what: shown(what.into()) }
    }

    /// What a failed read of `what` means.
    pub(crate) fn read(error: io::Error, what: &str) -> Self {
        match error.kind() {
            io::ErrorKind::UnexpectedEof => Self::truncated(what),
            _ => Self::Io(error),
        }
    }
}

/// Text of a file as a part of one line that a person reads.
pub(crate) fn shown(text: impl AsRef<str>) -> String {
    /// A quarter of a line's 400 characters, with room for escapes.
    const MOST: usize = 60;
    let text = text.as_ref();
    let start: String = text.chars().take(MOST).collect();
    let more = if start.len() < text.len() { "…" } else { "" };
    // Control characters only: quotes and accents are legible.
    let escape =
        |c: char| if c.is_control() { c.escape_default().collect() } else { c.to_string() };
    start.chars().map(escape).collect::<String>() + more
}
