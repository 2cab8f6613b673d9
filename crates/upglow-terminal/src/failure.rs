//! How the program ends without its result: one line on standard error and an exit status.

use std::error::Error;
use std::fmt::Display;
use std::io;
use std::path::Path;
use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use upglow_fit::Stopped;

/// Why a command has no result. A line says where something is wrong, what was found there and what
/// was expected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// What was given is not what it should be: a file, a color, a law that a cube breaks.
    Input(String),
    /// The command line asks for something that does not exist or does not fit together.
    Usage(String),
    /// The user stopped the work.
    Stopped,
    /// Nobody reads standard output any more.
    OutputClosed,
}

/// An error of a library, or text.
type Cause = Box<dyn Error + Send + Sync>;

const INPUT_STATUS: u8 = 1;
const USAGE_STATUS: u8 = 2;
/// What shells report for a program that was ended by Ctrl-C.
const STOPPED_STATUS: u8 = 130;

impl Failure {
    /// Something is wrong with the file at `path`.
    #[must_use]
    pub fn file(path: &Path, cause: impl Into<Cause>) -> Self {
        Self::input(path.display(), cause)
    }

    /// The system refuses to read or write the file at `path`.
    #[must_use]
    pub fn system(path: &Path, error: &io::Error, expected: impl Display) -> Self {
        Self::file(path, format!("{}, expected {expected}", io_message(error)))
    }

    /// Something is wrong with what `place` names.
    #[must_use]
    pub fn input(place: impl Display, cause: impl Into<Cause>) -> Self {
        Self::Input(format!("{place}: {}", chain(&*cause.into())))
    }

    /// Something is wrong with an option.
    #[must_use]
    pub fn option(option: &str, cause: impl Into<Cause>) -> Self {
        Self::Usage(format!("{option}: {}", chain(&*cause.into())))
    }

    /// The same line with more at its end.
    #[must_use]
    pub fn with(mut self, more: &str) -> Self {
        if let Self::Input(line) | Self::Usage(line) = &mut self {
            line.push_str(more);
        }
        self
    }

    /// Prints the line, and gives the status to exit with.
    pub(crate) fn report(&self, program: &str) -> ExitCode {
        let (line, status) = match self {
            Self::Input(line) => (line.as_str(), INPUT_STATUS),
            Self::Usage(line) => (line.as_str(), USAGE_STATUS),
            Self::Stopped => ("stopped, nothing was written", STOPPED_STATUS),
            Self::OutputClosed => return ExitCode::SUCCESS,
        };
        eprintln!("{program}: {}", one_line(line));
        ExitCode::from(status)
    }
}

impl From<Stopped> for Failure {
    fn from(Stopped: Stopped) -> Self {
        Self::Stopped
    }
}

/// An error and its causes, outermost first.
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

/// What the system says about a file, without its error number.
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

/// Prints what clap found as one line, or the help that was asked for.
pub(crate) fn report_usage(program: &str, error: &clap::Error) -> ExitCode {
    let kind = error.kind();
    let help = ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
    if !error.use_stderr() || kind == help {
        // Help that cannot be printed is nothing to report.
        let _ = error.print();
        return if kind == help { ExitCode::from(USAGE_STATUS) } else { ExitCode::SUCCESS };
    }
    Failure::Usage(usage_line(error)).report(program)
}

/// The option and what is wrong with its value; for other faults the first paragraph and the tips.
fn usage_line(error: &clap::Error) -> String {
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

/// File names may hold line breaks; the message stays one line all the same.
fn one_line(text: &str) -> String {
    text.replace(['\n', '\r'], " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_system_is_quoted_without_its_error_number() {
        let error = io::Error::from_raw_os_error(21);
        assert_eq!(io_message(&error), "a folder");
        let error = io::Error::other("Strange thing (os error 999)");
        assert_eq!(io_message(&error), "strange thing");
    }

    #[test]
    fn a_line_names_its_place() {
        let failure = Failure::file(Path::new("a.cube"), "x, expected y");
        assert_eq!(failure, Failure::Input("a.cube: x, expected y".into()));
    }
}
