//! Reports on standard output, as text or JSON.

use std::cell::Cell;
use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use serde::Serialize;
use upglow_color::is_plain;

use crate::failure::Failure;

/// The result of a command.
pub trait Report: Serialize {
    /// The text for people, with a final line break.
    fn text(&self) -> String;
}

/// How results are printed, and whether progress is shown.
#[derive(Clone, Debug, clap::Args)]
pub struct Console {
    /// Print the result as JSON, one document per line
    #[arg(long, global = true)]
    pub json: bool,
    /// Do not show progress
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
    /// Whether a report has been printed.
    #[arg(skip)]
    printed: Cell<bool>,
}

impl Console {
    /// Prints a report on standard output; blank lines separate reports that are text.
    ///
    /// # Errors
    ///
    /// [`Failure`] if standard output cannot be written.
    pub fn print(&self, report: &impl Report) -> Result<(), Failure> {
        let text = if self.json {
            serde_json::to_string(report).map(|json| escaped(&json) + "\n").map_err(io::Error::from)
        } else {
            let blank = if self.printed.replace(true) { "\n" } else { "" };
            let text = report.text();
            let lines: Vec<String> = text.split('\n').map(one_line).collect();
            Ok(blank.to_owned() + &lines.join("\n"))
        };
        let printed = text.and_then(|text| {
            if IS_FOR_DATA.load(Ordering::Relaxed) {
                let _ = io::stderr().write_all(text.as_bytes());
                return Ok(());
            }
            let mut stdout = io::stdout().lock();
            stdout.write_all(text.as_bytes())?;
            stdout.flush()
        });
        printed.map_err(|error| match error.kind() {
            io::ErrorKind::BrokenPipe => Failure::OutputClosed,
            _ => Failure::system(Path::new("standard output"), &error, "room"),
        })
    }
}

/// Whether a file is written to standard output.
static IS_FOR_DATA: AtomicBool = AtomicBool::new(false);

/// Lets reports go to standard error, because a file is written to standard output.
pub(crate) fn keep_for_data() {
    IS_FOR_DATA.store(true, Ordering::Relaxed);
}

/// Prints a line on standard error. If nobody can read it there, the work goes on.
pub fn say(line: &str) {
    let _ = io::stderr().write_all((one_line(line) + "\n").as_bytes());
}

/// Text as one line that a terminal shows and does not obey: names of files may hold any characters.
pub(crate) fn one_line(text: &str) -> String {
    let shown = |c: char| match c {
        '\n' | '\r' | '\t' => ' ',
        c if is_plain(c) => c,
        _ => char::REPLACEMENT_CHARACTER,
    };
    text.chars().map(shown).collect()
}

/// JSON with the same characters as escapes: outside texts it has none of them.
pub fn escaped(json: &str) -> String {
    json.chars().fold(String::with_capacity(json.len()), |mut text, c| {
        if is_plain(c) {
            text.push(c);
        } else {
            // Writing to a string cannot fail. None of them needs two numbers.
            let _ = write!(text, "\\u{:04x}", u32::from(c));
        }
        text
    })
}

/// A number of bytes with a unit: 1.23 MB.
pub fn size(bytes: u64) -> String {
    let bytes = bytes as f64;
    match bytes {
        b if b < 1e3 => format!("{b} bytes"),
        b if b < 1e6 => format!("{:.1} kB", b / 1e3),
        b if b < 1e9 => format!("{:.2} MB", b / 1e6),
        b => format!("{:.2} GB", b / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_from_elsewhere_is_shown_and_not_obeyed() {
        let odd = "a\u{1b}[2J\nb\u{9b}\u{202e}c";
        assert_eq!(one_line(odd), "a\u{fffd}[2J b\u{fffd}\u{fffd}c");
        let json = serde_json::to_string(odd).unwrap();
        let safe = escaped(&json);
        assert!(safe.chars().all(is_plain), "{safe:?}");
        assert_eq!(serde_json::from_str::<String>(&safe).unwrap(), odd);
    }

    #[test]
    fn sizes_are_readable() {
        assert_eq!([999, 12_345, 1_234_567].map(size), ["999 bytes", "12.3 kB", "1.23 MB"]);
    }
}
