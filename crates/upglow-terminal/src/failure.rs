//! Failures of a program: one line on standard error and an exit status.

use std::error::Error;
use std::ffi::OsString;
use std::fmt::{self, Display};
use std::io;
use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use upglow_fit::Stopped;

use crate::output::{one_line, say};

/// Why a command failed. The line names the place of the fault, what was found and what was expected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// A file, a color or a cube is invalid.
    Input(String),
    /// An option has an invalid value, or options contradict each other.
    Usage(String),
    /// The user stopped the work.
    Stopped,
    /// The reader of standard output, or of another pipe, has closed it.
    OutputClosed,
    /// The help was printed, because words are missing on the command line.
    Shown,
}

/// An error of a library, or a text.
type Cause = Box<dyn Error + Send + Sync>;

const INPUT_STATUS: u8 = 1;
const USAGE_STATUS: u8 = 2;
/// What shells report for a program ended by Ctrl-C.
const STOPPED_STATUS: u8 = 130;

impl Failure {
    /// The file at `path` is invalid.
    #[must_use]
    pub fn file(path: &Path, cause: impl Into<Cause>) -> Self {
        Self::input(path.display(), cause)
    }

    /// The file at `path` cannot be read or written.
    #[must_use]
    pub fn system(path: &Path, error: &io::Error, expected: impl Display) -> Self {
        Self::file(path, format!("{}, expected {expected}", io_message(error)))
    }

    /// The input named by `place` is invalid.
    #[must_use]
    pub fn input(place: impl Display, cause: impl Into<Cause>) -> Self {
        Self::Input(format!("{place}: {}", chain(&*cause.into())))
    }

    /// The value of an option is invalid.
    #[must_use]
    pub fn option(option: &str, cause: impl Into<Cause>) -> Self {
        Self::Usage(format!("{option}: {}", chain(&*cause.into())))
    }

    /// Appends text to the line.
    #[must_use]
    pub fn with(mut self, more: &str) -> Self {
        if let Self::Input(line) | Self::Usage(line) = &mut self {
            line.push_str(more);
        }
        self
    }

    /// Prints the line and returns the exit status.
    pub(crate) fn report(&self, program: &str) -> u8 {
        let status = match self {
            Self::Input(_) => INPUT_STATUS,
            Self::Usage(_) => USAGE_STATUS,
            Self::Stopped => STOPPED_STATUS,
            Self::OutputClosed => return 0,
            Self::Shown => return USAGE_STATUS,
        };
        say(&format!("{program}: {self}"));
        status
    }
}

/// The line that programs print, without their name.
impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(line) | Self::Usage(line) => f.write_str(&shortened(one_line(line))),
            Self::Stopped => f.write_str("stopped; files are whole or as before"),
            Self::Shown => f.write_str("no command"),
            Self::OutputClosed => f.write_str("the reader of the output has closed it"),
        }
    }
}

impl From<Stopped> for Failure {
    fn from(Stopped: Stopped) -> Self {
        Self::Stopped
    }
}

/// The texts of an error and its causes, outermost first, without repetitions.
fn chain(error: &(dyn Error + 'static)) -> String {
    let causes = std::iter::successors(Some(error), |&error| error.source());
    let texts = causes.map(|cause| match cause.downcast_ref() {
        Some(error) => io_message(error),
        None => cause.to_string(),
    });
    let join = |told: String, text: String| {
        if told.contains(&text) { told } else { format!("{told}: {text}") }
    };
    texts.reduce(join).unwrap_or_default()
}

/// The system's message about a file, without its error number.
fn io_message(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "no such file or folder".into(),
        io::ErrorKind::PermissionDenied => "permission denied".into(),
        io::ErrorKind::StorageFull => "no space left on the disk".into(),
        io::ErrorKind::IsADirectory => "a folder".into(),
        _ => {
            let text = error.to_string();
            let end = text.find(" (os error").unwrap_or(text.len());
            let mut letters = text[..end].chars();
            letters
                .next()
                .map_or(text.clone(), |first| first.to_lowercase().chain(letters).collect())
        }
    }
}

/// Prints the help that was asked for, or else returns clap's error as one line.
pub(crate) fn of_usage(error: &clap::Error, words: &[OsString]) -> Result<(), Failure> {
    let is_help_in_place_of_work =
        error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
    if is_help_in_place_of_work {
        // There is nothing else to report.
        let _ = error.print();
        return Err(Failure::Shown);
    }
    if !error.use_stderr() {
        return match error.print() {
            Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
                let expected = "room for the help and the right to write";
                Err(Failure::system(Path::new("standard output"), &error, expected))
            }
            _ => Ok(()),
        };
    }
    if error.kind() == ErrorKind::InvalidUtf8
        && let Some(word) = words.iter().find(|word| word.to_str().is_none())
    {
        let found = word.to_string_lossy();
        return Err(Failure::Usage(format!("{found}: not UTF-8, expected a word or name that is")));
    }
    Err(Failure::Usage(usage_line(error)))
}

/// The option and the cause of its error; for other errors the first paragraph and the tips.
pub(crate) fn usage_line(error: &clap::Error) -> String {
    if !error.use_stderr() {
        return "a question for help, expected words to work with".to_owned();
    }
    if let (Some(ContextValue::String(option)), Some(cause)) =
        (error.get(ContextKind::InvalidArg), error.source())
    {
        let name = option.split([' ', '=']).next().unwrap_or(option);
        return format!("{name}: {}", chain(cause));
    }
    let text = error.to_string();
    let told = text.lines().map(str::trim).filter(|line| {
        !line.is_empty() && !line.starts_with("Usage:") && !line.starts_with("For more information")
    });
    let joined = told.collect::<Vec<_>>().join(" ");
    joined.trim_start_matches("error: ").replace(" tip: ", "; tip: ")
}

/// Keeps the start and the end of a long line: what is wrong is at the start, what to do at the end.
fn shortened(line: String) -> String {
    let length = line.chars().count();
    if length <= MOST_CHARACTERS {
        return line;
    }
    let start = line.chars().take(MOST_CHARACTERS - END_CHARACTERS);
    start.chain(['…']).chain(line.chars().skip(length - END_CHARACTERS)).collect()
}

/// Most characters of an error: a path of several folders, a list of names and what is expected.
const MOST_CHARACTERS: usize = 1000;
/// Of which so many are those of its end.
const END_CHARACTERS: usize = 300;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_of_the_system_have_no_error_number() {
        let error = io::Error::from_raw_os_error(21);
        assert_eq!(io_message(&error), "a folder");
        let error = io::Error::other("Strange thing (os error 999)");
        assert_eq!(io_message(&error), "strange thing");
    }

    #[test]
    fn a_long_message_keeps_its_start_and_its_end() {
        let failure = Failure::Input(format!("a.csv: {}, expected x", "é".repeat(100_000)));
        let line = failure.to_string();
        assert_eq!(line.chars().count(), MOST_CHARACTERS + 1);
        assert!(line.starts_with("a.csv: ééé") && line.ends_with("é, expected x"), "{line}");
        let short = Failure::Usage("x".repeat(MOST_CHARACTERS));
        assert_eq!(short.to_string().len(), MOST_CHARACTERS);
    }

    #[test]
    fn a_message_starts_with_the_file() {
        let failure = Failure::file(Path::new("a.cube"), "x, expected y");
        assert_eq!(failure, Failure::Input("a.cube: x, expected y".into()));
    }
}
