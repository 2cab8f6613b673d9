//! Results on standard output: text for people, or one JSON document.

use std::io::{self, Write as _};

use serde::Serialize;

use crate::failure::{Failure, io_message};

/// What a command has found.
pub trait Report: Serialize {
    /// The text for people, with a final line break.
    fn text(&self) -> String;
}

/// How results are printed. JSON takes one line, so that the results of many runs are JSON Lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// For people.
    Text,
    /// One document, on one line.
    Json,
}

impl Format {
    /// Prints a report on standard output.
    pub fn print(self, report: &impl Report) -> Result<(), Failure> {
        let text = match self {
            Self::Text => report.text(),
            Self::Json => serde_json::to_string(report)
                .map(|json| json + "\n")
                .map_err(|error| Failure::input("standard output", error))?,
        };
        print(&text)
    }

    /// A blank line before report `number`, from 0, of several for people.
    pub fn separate(self, number: usize) -> Result<(), Failure> {
        if self == Self::Text && number > 0 { print("\n") } else { Ok(()) }
    }
}

fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()).map_err(|error| {
        if error.kind() == io::ErrorKind::BrokenPipe {
            return Failure::OutputClosed;
        }
        let found = io_message(&error);
        Failure::input("standard output", format_args!("{found}, expected room"))
    })
}
