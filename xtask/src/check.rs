//! The gate: every check, in order, the fast ones first.

use std::fmt;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::Instant;

use crate::python::{self, Python};
use crate::{c_library, layers, mitsuba, python_wheel, readme, tables};

/// Set for the tests under `--slow`, so that they may take larger samples.
const SLOW_VARIABLE: &str = "UPGLOW_SLOW";

/// The packages whose programs the README's examples and the tests of the bindings run.
const PROGRAM_PACKAGES: [&str; 2] = ["upglow-cli", "upglow-study"];

/// Which tests run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Tests {
    /// Every test that is not ignored.
    Quick,
    /// Those, and the ignored ones named `slow_*`.
    QuickAndSlow,
}

/// How a step ended that did not fail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Outcome {
    Passed,
    Skipped(&'static str),
}

/// Why a step failed.
#[derive(Debug)]
pub(crate) enum StepError {
    /// A command could not be started.
    Start { command: String, source: io::Error },
    /// A command failed.
    Failed { command: String, output: String },
    /// A command printed something else than expected.
    Json { command: String, source: serde_json::Error },
    /// A file could not be read or written.
    File { path: PathBuf, source: io::Error },
    /// The tables cannot be generated.
    Tables(tables::TableError),
    /// The README's markers are wrong.
    Readme(readme::MarkerError),
    /// What a check of our own found, one line each.
    Found(Vec<String>),
}

impl fmt::Display for StepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start { command, source } => write!(f, "$ {command}\ndid not start: {source}"),
            Self::Failed { command, output } => write!(f, "$ {command}\n{}", output.trim_end()),
            Self::Json { command, source } => write!(f, "$ {command}\nprinted no JSON: {source}"),
            Self::File { path, source } => write!(f, "{}: {source}", path.display()),
            Self::Tables(source) => write!(f, "{source}"),
            Self::Readme(source) => write!(f, "README.md, {source}"),
            Self::Found(problems) => f.write_str(&problems.join("\n")),
        }
    }
}

impl std::error::Error for StepError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Start { source, .. } | Self::File { source, .. } => Some(source),
            Self::Json { source, .. } => Some(source),
            Self::Tables(source) => Some(source),
            Self::Readme(source) => Some(source),
            Self::Failed { .. } | Self::Found(_) => None,
        }
    }
}

pub(crate) type Step = fn(&Path) -> Result<Outcome, StepError>;

const STEPS: [(&str, Step); 9] = [
    ("format", format),
    ("generated files", generated_files),
    ("layers", layers),
    ("clippy", clippy),
    ("docs", docs),
    ("Python for tests", python_for_tests),
    ("tests", quick_tests),
    ("README examples", readme_examples),
    ("licenses", licenses),
];

const SLOW_STEP: (&str, Step) = ("slow tests", slow_tests);

/// Runs the steps up to the first failure; prints a line for each and a summary.
pub(crate) fn run(root: &Path, tests: Tests) -> ExitCode {
    let slow = (tests == Tests::QuickAndSlow).then_some(SLOW_STEP);
    let bindings = c_library::STEPS.into_iter().chain(python_wheel::STEPS).chain(mitsuba::STEPS);
    run_steps(root, STEPS.into_iter().chain(bindings).chain(slow))
}

/// Runs some steps up to the first failure; prints a line for each and a summary.
pub(crate) fn run_steps(
    root: &Path,
    steps: impl IntoIterator<Item = (&'static str, Step)>,
) -> ExitCode {
    let mut outcomes = Vec::new();
    for (name, step) in steps {
        let start = Instant::now();
        let result = step(root);
        let time_s = start.elapsed().as_secs_f64();
        match result {
            Ok(outcome) => {
                println!("{}", step_line(name, outcome, time_s));
                outcomes.push(outcome);
            }
            Err(error) => {
                println!("{error}\ncheck: {name} failed after {time_s:.1} s");
                return ExitCode::FAILURE;
            }
        }
    }
    println!("{}", summary(&outcomes));
    ExitCode::SUCCESS
}

fn step_line(name: &str, outcome: Outcome, time_s: f64) -> String {
    match outcome {
        Outcome::Passed => format!("check: {name} ok, {time_s:.1} s"),
        Outcome::Skipped(reason) => format!("check: {name} skipped: {reason}"),
    }
}

fn summary(outcomes: &[Outcome]) -> String {
    let reason = |outcome: &Outcome| match outcome {
        Outcome::Passed => None,
        Outcome::Skipped(reason) => Some(*reason),
    };
    let reasons: Vec<&str> = outcomes.iter().filter_map(reason).collect();
    let passed = outcomes.len() - reasons.len();
    match reasons.len() {
        0 => format!("check: {passed} steps ok"),
        skipped => format!("check: {passed} steps ok, {skipped} skipped ({})", reasons.join("; ")),
    }
}

fn format(root: &Path) -> Result<Outcome, StepError> {
    finish(cargo(root, "fmt --all --check -- --color never"))
}

fn generated_files(root: &Path) -> Result<Outcome, StepError> {
    let files = tables::generate(root).map_err(StepError::Tables)?;
    let stale: Vec<String> = files
        .iter()
        .filter(|file| !tables::is_fresh(root, file))
        .map(|file| format!("{} is not what `cargo xtask tables` writes", file.path.display()))
        .collect();
    if stale.is_empty() { Ok(Outcome::Passed) } else { Err(StepError::Found(stale)) }
}

fn layers(root: &Path) -> Result<Outcome, StepError> {
    let problems = layers::violations(&metadata(root)?);
    if problems.is_empty() { Ok(Outcome::Passed) } else { Err(StepError::Found(problems)) }
}

fn clippy(root: &Path) -> Result<Outcome, StepError> {
    finish(cargo(root, "clippy --workspace --all-targets --all-features -- -D warnings"))
}

fn docs(root: &Path) -> Result<Outcome, StepError> {
    let mut command = cargo(root, "doc --workspace --no-deps");
    command.env("RUSTDOCFLAGS", "-D warnings");
    finish(command)
}

/// Tests that need it skip themselves, by name, where there is none.
fn python_for_tests(root: &Path) -> Result<Outcome, StepError> {
    Ok(match prepared_python(root)? {
        Python::Ready(_) => Outcome::Passed,
        Python::Missing(reason) => Outcome::Skipped(reason),
    })
}

fn prepared_python(root: &Path) -> Result<Python, StepError> {
    let path = root.join("target/python");
    python::prepare(root).map_err(|source| StepError::File { path, source })
}

fn quick_tests(root: &Path) -> Result<Outcome, StepError> {
    finish_aloud(tests(root, "test --workspace")?)
}

fn slow_tests(root: &Path) -> Result<Outcome, StepError> {
    let mut command = tests(root, "test --workspace -- --ignored slow_")?;
    command.env(SLOW_VARIABLE, "1");
    finish_aloud(command)
}

fn tests(root: &Path, args: &str) -> Result<Command, StepError> {
    let mut command = cargo(root, args);
    if let Python::Ready(interpreter) = prepared_python(root)? {
        command.env(python::VARIABLE, interpreter);
    }
    Ok(command)
}

fn readme_examples(root: &Path) -> Result<Outcome, StepError> {
    let path = root.join("README.md");
    let text = match fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Ok(Outcome::Skipped("no README.md"));
        }
        Err(source) => return Err(StepError::File { path, source }),
    };
    let examples = readme::examples(&text).map_err(StepError::Readme)?;
    if examples.is_empty() {
        return Ok(Outcome::Skipped("no checked example in README.md"));
    }
    run_examples(&examples, &release_bin_dir(root)?)
}

/// Runs the examples in order in one new folder, so that one may use the files of another.
fn run_examples(examples: &[readme::Example], bin_dir: &Path) -> Result<Outcome, StepError> {
    let folder = TemporaryFolder::create()?;
    for example in examples {
        readme::run(example, &folder.0, bin_dir).map_err(|error| {
            let readme::Example { line, script, .. } = example;
            StepError::Found(vec![format!("README.md, line {line}\n$ {script}\n{error}")])
        })?;
    }
    Ok(Outcome::Passed)
}

/// Builds the programs as a user would; the folder they lie in.
pub(crate) fn release_bin_dir(root: &Path) -> Result<PathBuf, StepError> {
    for package in PROGRAM_PACKAGES {
        let mut build = cargo(root, "build --release");
        build.args(["--package", package]);
        finish(build)?;
    }
    Ok(target_dir(root)?.join("release"))
}

/// Where cargo puts what it builds.
pub(crate) fn target_dir(root: &Path) -> Result<PathBuf, StepError> {
    let metadata = metadata(root)?;
    Ok(root.join(metadata["target_directory"].as_str().unwrap_or("target")))
}

fn licenses(root: &Path) -> Result<Outcome, StepError> {
    if output_of(cargo(root, "deny --version")).is_err() {
        return Ok(Outcome::Skipped("cargo-deny not installed"));
    }
    // The offline check reads the manifests of every platform's crates; a build fetches only ours.
    finish(cargo(root, "fetch --locked"))?;
    finish(cargo(root, "deny --offline check licenses bans sources"))
}

fn metadata(root: &Path) -> Result<serde_json::Value, StepError> {
    let command = cargo(root, "metadata --format-version 1 --no-deps --offline");
    let shown = shown(&command);
    let output = output_of(command)?;
    serde_json::from_str(&output).map_err(|source| StepError::Json { command: shown, source })
}

/// Cargo with arguments separated by spaces, in the workspace root.
pub(crate) fn cargo(root: &Path, args: &str) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(args.split(' ')).current_dir(root).stdin(Stdio::null());
    command
}

/// Runs a command silently; its output appears only if it fails.
fn finish(command: Command) -> Result<Outcome, StepError> {
    output_of(command).map(|_| Outcome::Passed)
}

/// Runs a command with its output passed on.
fn finish_aloud(mut command: Command) -> Result<Outcome, StepError> {
    let shown = shown(&command);
    // A failed flush loses a line of ours and nothing else.
    io::stdout().flush().ok();
    match command.status() {
        Ok(status) if status.success() => Ok(Outcome::Passed),
        Ok(status) => Err(StepError::Failed { command: shown, output: status.to_string() }),
        Err(source) => Err(StepError::Start { command: shown, source }),
    }
}

/// The standard output of a command that succeeds.
pub(crate) fn output_of(command: Command) -> Result<String, StepError> {
    output_and_messages_of(command).map(|(output, _)| output)
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

/// A new folder that is removed with its contents at the end.
#[derive(Debug)]
struct TemporaryFolder(PathBuf);

impl TemporaryFolder {
    fn create() -> Result<Self, StepError> {
        let path = std::env::temp_dir().join(format!("upglow-readme-{}", std::process::id()));
        fs::create_dir(&path).map_err(|source| StepError::File { path: path.clone(), source })?;
        Ok(Self(path))
    }
}

impl Drop for TemporaryFolder {
    fn drop(&mut self) {
        // What is left in the temporary folder is not worth failing a check that passed.
        fs::remove_dir_all(&self.0).ok();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_summary_counts_steps_and_names_what_was_skipped() {
        let skipped = Outcome::Skipped("cargo-deny not installed");
        assert_eq!(summary(&[Outcome::Passed, Outcome::Passed]), "check: 2 steps ok");
        assert_eq!(
            summary(&[Outcome::Passed, skipped]),
            "check: 1 steps ok, 1 skipped (cargo-deny not installed)"
        );
    }

    #[test]
    fn a_step_line_has_name_and_time() {
        assert_eq!(step_line("docs", Outcome::Passed, 1.25), "check: docs ok, 1.2 s");
    }

    #[test]
    fn a_command_is_shown_as_typed() {
        assert_eq!(shown(&cargo(Path::new("."), "fmt --check")), "cargo fmt --check");
    }

    #[test]
    fn a_command_that_fails_shows_itself_and_its_output() {
        let error = finish(cargo(Path::new("."), "no-such-command")).unwrap_err();
        assert!(error.to_string().starts_with("$ cargo no-such-command\n"), "{error}");
    }

    #[test]
    fn the_temporary_folder_goes_away() {
        let folder = TemporaryFolder::create().unwrap();
        let path = folder.0.clone();
        assert!(path.is_dir());
        drop(folder);
        assert!(!path.exists());
    }
}
