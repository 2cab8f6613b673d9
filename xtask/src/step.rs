//! What a step of the check is, how it ends, and the commands that steps run.

use std::fmt;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The packages whose programs the examples of docs/guide.md and the tests of the bindings run, with every
/// command.
const PROGRAMS: [&str; 2] = ["upglow-cli --features explore", "upglow-study"];

/// One step of the check.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    /// What `--only` and `--from` call it.
    pub(crate) name: &'static str,
    /// What it checks, for `--list`.
    pub(crate) about: &'static str,
    /// Runs it in the workspace's root.
    pub(crate) run: fn(&Path) -> Result<(), StepError>,
}

/// Why a step or command failed or was skipped.
#[derive(Debug)]
pub(crate) enum StepError {
    /// The machine lacks what it needs; the check goes on.
    Skipped(&'static str),
    /// The command line is wrong.
    Usage(String),
    /// A command could not be started.
    Start { command: String, source: io::Error },
    /// A command failed.
    Failed { command: String, output: String },
    /// A command did not print JSON.
    Json { command: String, source: serde_json::Error },
    /// A file could not be read or written.
    File { path: PathBuf, source: io::Error },
    /// Problems found by a check, one line each.
    Found(Vec<String>),
}

impl StepError {
    /// Turns the failure to read or write a file into this error.
    pub(crate) fn file(path: &Path) -> impl Fn(io::Error) -> Self + '_ {
        |source| Self::File { path: path.to_owned(), source }
    }

    /// One problem.
    pub(crate) fn found(problem: impl Into<String>) -> Self {
        Self::Found(vec![problem.into()])
    }

    /// Success if there are no problems.
    pub(crate) fn none_of(problems: Vec<String>) -> Result<(), Self> {
        if problems.is_empty() { Ok(()) } else { Err(Self::Found(problems)) }
    }
}

impl fmt::Display for StepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Skipped(reason) => f.write_str(reason),
            Self::Usage(problem) => f.write_str(problem),
            Self::Start { command, source } => write!(f, "$ {command}\ndid not start: {source}"),
            Self::Failed { command, output } => write!(f, "$ {command}\n{}", output.trim_end()),
            Self::Json { command, source } => {
                write!(f, "$ {command}\ndid not print JSON: {source}")
            }
            Self::File { path, source } => write!(f, "{}: {source}", path.display()),
            Self::Found(problems) => f.write_str(&problems.join("\n")),
        }
    }
}

impl std::error::Error for StepError {}

/// The text of a file.
pub(crate) fn read(path: &Path) -> Result<String, StepError> {
    fs::read_to_string(path).map_err(StepError::file(path))
}

/// Cargo with arguments separated by spaces, in the workspace root.
pub(crate) fn cargo(root: &Path, args: &str) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(args.split(' ')).current_dir(root).stdin(Stdio::null());
    command
}

/// Cargo of a nightly compiler, whatever compiler runs this; `args` begin with the command that need not be installed.
pub(crate) fn nightly_cargo(root: &Path, args: &str) -> Command {
    let mut command = Command::new("cargo");
    command.arg("+nightly").args(args.split(' ')).env_remove("CARGO");
    command.env_remove("RUSTUP_TOOLCHAIN").current_dir(root).stdin(Stdio::null());
    command
}

/// Runs a command silently; its output appears only if it fails.
pub(crate) fn finish(command: Command) -> Result<(), StepError> {
    output_of(command).map(|_| ())
}

/// Runs a command with its output passed on.
pub(crate) fn finish_aloud(mut command: Command) -> Result<(), StepError> {
    let shown = shown(&command);
    // A failed flush loses one printed line at most.
    io::stdout().flush().ok();
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(StepError::Failed { command: shown, output: status.to_string() }),
        Err(source) => Err(StepError::Start { command: shown, source }),
    }
}

/// The standard output of a command that succeeds.
pub(crate) fn output_of(command: Command) -> Result<String, StepError> {
    output_and_messages_of(command).map(|(output, _)| output)
}

/// The JSON document that a command prints.
pub(crate) fn json_of(command: Command) -> Result<serde_json::Value, StepError> {
    let shown = shown(&command);
    let output = output_of(command)?;
    serde_json::from_str(&output).map_err(|source| StepError::Json { command: shown, source })
}

/// The standard output and the standard error of a command that succeeds.
pub(crate) fn output_and_messages_of(mut command: Command) -> Result<(String, String), StepError> {
    let shown = shown(&command);
    let output =
        command.output().map_err(|source| StepError::Start { command: shown.clone(), source })?;
    let [stdout, stderr] =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    if output.status.success() {
        return Ok((stdout, stderr));
    }
    Err(StepError::Failed { command: shown, output: stdout + &stderr })
}

/// The command as one would type it.
fn shown(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_stem().unwrap_or_default();
    let words = std::iter::once(program).chain(command.get_args());
    words.map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
}

/// Files of the workspace at `root` that Git knows or would add, by their paths below it; a link is another name of
/// one of them.
pub(crate) fn tracked_files(root: &Path) -> Result<Vec<String>, StepError> {
    let mut git = Command::new("git");
    git.args(["ls-files", "--cached", "--others", "--exclude-standard"]).current_dir(root);
    // One that was deleted, and is not yet committed, is listed as well.
    let listed = output_of(git)?;
    let paths = listed.lines().filter(|path| {
        let path = root.join(path);
        path.is_file() && !path.is_symlink()
    });
    Ok(paths.map(str::to_owned).collect())
}

/// The output of `cargo metadata` for the crates of the workspace.
pub(crate) fn metadata(root: &Path) -> Result<serde_json::Value, StepError> {
    json_of(cargo(root, "metadata --format-version 1 --no-deps --offline"))
}

/// Where cargo puts what it builds.
pub(crate) fn target_dir(root: &Path) -> Result<PathBuf, StepError> {
    let metadata = metadata(root)?;
    Ok(root.join(metadata["target_directory"].as_str().unwrap_or("target")))
}

/// Builds the programs as a user would, with every command; the folder they lie in.
pub(crate) fn release_bin_dir(root: &Path) -> Result<PathBuf, StepError> {
    for program in PROGRAMS {
        finish(cargo(root, &format!("build --release --package {program}")))?;
    }
    Ok(target_dir(root)?.join("release"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_shown_as_typed() {
        assert_eq!(shown(&cargo(Path::new("."), "fmt --check")), "cargo fmt --check");
    }

    #[test]
    fn a_command_that_fails_shows_itself_and_its_output() {
        let error = finish(cargo(Path::new("."), "no-such-command")).unwrap_err();
        assert!(error.to_string().starts_with("$ cargo no-such-command\n"), "{error}");
    }
}
