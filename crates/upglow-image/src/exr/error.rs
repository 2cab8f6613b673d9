//! Why an OpenEXR file cannot be read.

use std::io;

/// Why an OpenEXR file cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExrError {
    /// The file cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The file ends early.
    #[error("the file ends inside {what}, expected a whole file")]
    Truncated {
        /// What is cut.
        what: String,
    },
    /// The file is not OpenEXR, is damaged, or is of a kind or size that is not read.
    #[error("{found}, expected {expected}")]
    Invalid {
        /// The invalid part of the file.
        found: String,
        /// What would be valid.
        expected: String,
    },
    /// The file has no channel of this name.
    #[error("no channel {name:?}, expected {expected}")]
    NoChannel {
        /// The requested name.
        name: String,
        /// Some of the names that exist.
        expected: String,
    },
    /// A region that is empty or extends beyond the image.
    #[error("columns {columns:?} of rows {rows:?}, expected some inside {} by {}", .size[0], .size[1])]
    Outside {
        /// First column, and the column after the last.
        columns: [usize; 2],
        /// First row, and the row after the last.
        rows: [usize; 2],
        /// Width and height of the image.
        size: [usize; 2],
    },
}

impl ExrError {
    pub(crate) fn invalid(found: impl Into<String>, expected: impl ToString) -> Self {
        Self::Invalid { found: found.into(), expected: expected.to_string() }
    }

    /// The error of a field of the header, with texts that may come from the file.
    pub(crate) fn header(field: &str, found: impl ToString, expected: impl ToString) -> Self {
        let found = format!("{} is {}", shown(field), shown(found.to_string()));
        Self::invalid(found, shown(expected.to_string()))
    }

    pub(crate) fn truncated(what: impl Into<String>) -> Self {
        Self::Truncated { what: shown(what.into()) }
    }

    /// The error of a failed read of `what`.
    pub(crate) fn read(error: io::Error, what: &str) -> Self {
        match error.kind() {
            io::ErrorKind::UnexpectedEof => Self::truncated(what),
            _ => Self::Io(error),
        }
    }
}

/// Text from a file, shortened and with control characters escaped, for a message of one line.
pub(crate) fn shown(text: impl AsRef<str>) -> String {
    /// Messages stay below 400 characters even if each of these is escaped.
    const MOST: usize = 60;
    let text = text.as_ref();
    let start: String = text.chars().take(MOST).collect();
    let more = if start.len() < text.len() { "…" } else { "" };
    // Control characters only: quotes and accents are legible.
    let escape =
        |c: char| if c.is_control() { c.escape_default().collect() } else { c.to_string() };
    start.chars().map(escape).collect::<String>() + more
}

/// Some names from a file, for a message of one line.
pub(crate) fn listed(names: impl Iterator<Item = impl AsRef<str>>) -> String {
    /// Most names that are listed.
    const NAMES: usize = 12;
    /// Most characters of a name, which usually is a word or two.
    const CHARACTERS: usize = 20;
    let plain = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let start = |name: &str| name.chars().take(CHARACTERS).map(plain).collect::<String>();
    let mut names: Vec<String> = names.take(NAMES + 1).map(|name| start(name.as_ref())).collect();
    if names.len() > NAMES {
        names[NAMES] = "…".into();
    }
    names.join(", ")
}
