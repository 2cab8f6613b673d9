//! The shell examples of `README.md` that say they are checked.
//!
//! The line `<!-- checked -->` marks the fenced block after it. A `sh` block is one script that
//! must succeed. In a `console` block each `$ ` line is a command that must succeed; the lines
//! after it, where there are any, are its standard output. There a line `...` stands for any
//! number of lines, and `[..]` for any part of a line.

use std::ffi::OsString;
use std::fmt;
use std::io;
use std::path::Path;
use std::process::Command;

/// The line that marks the next block.
const MARKER: &str = "<!-- checked -->";

/// One command and what it must print.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Example {
    /// Line of the command in the README, from 1.
    pub(crate) line: usize,
    /// The script, for `sh`.
    pub(crate) script: String,
    /// The expected lines of standard output; empty: anything goes.
    pub(crate) output: Vec<String>,
}

/// Why a README's examples cannot be read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum MarkerError {
    /// A marker is not followed by a `sh` or `console` block.
    NoBlock {
        /// Line of the marker, from 1.
        line: usize,
    },
    /// A marked block does not end.
    Unclosed {
        /// Line where the block starts, from 1.
        line: usize,
    },
    /// A `console` block does not start with a `$ ` line.
    NoCommand {
        /// Line where the block starts, from 1.
        line: usize,
    },
}

impl fmt::Display for MarkerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoBlock { line } => {
                write!(
                    f,
                    "line {line}: '{MARKER}' marks nothing, expected a ```sh or ```console block"
                )
            }
            Self::Unclosed { line } => write!(f, "line {line}: the block has no end, expected ```"),
            Self::NoCommand { line } => {
                write!(f, "line {line}: the block starts with output, expected a line '$ command'")
            }
        }
    }
}

impl std::error::Error for MarkerError {}

/// Why an example does not do what the README says.
#[derive(Debug)]
pub(crate) enum ExampleError {
    /// The shell could not be started.
    Shell(io::Error),
    /// The command failed.
    Failed {
        /// What it printed to standard output and standard error.
        printed: String,
    },
    /// The command printed something else.
    Output {
        /// What it printed to standard output.
        printed: String,
    },
}

impl fmt::Display for ExampleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Shell(source) => write!(f, "sh did not start: {source}"),
            Self::Failed { printed } => write!(f, "the command failed and printed\n{printed}"),
            Self::Output { printed } => {
                write!(f, "the README shows other output, the command printed\n{printed}")
            }
        }
    }
}

impl std::error::Error for ExampleError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Shell(source) => Some(source),
            Self::Failed { .. } | Self::Output { .. } => None,
        }
    }
}

/// The marked examples of a README, in order.
pub(crate) fn examples(readme: &str) -> Result<Vec<Example>, MarkerError> {
    let mut lines = readme.lines().enumerate().map(|(i, line)| (i + 1, line));
    let mut found = Vec::new();
    while let Some((line, text)) = lines.next() {
        if text.trim() != MARKER {
            continue;
        }
        let fence = lines.by_ref().find(|(_, text)| !text.trim().is_empty());
        let (start, language) = match fence {
            Some((start, "```sh")) => (start, "sh"),
            Some((start, "```console")) => (start, "console"),
            _ => return Err(MarkerError::NoBlock { line }),
        };
        let block = block(&mut lines).ok_or(MarkerError::Unclosed { line: start })?;
        if language == "sh" {
            found.push(Example { line: start + 1, script: block.join("\n"), output: Vec::new() });
        } else {
            found.extend(console_examples(start, &block)?);
        }
    }
    Ok(found)
}

/// The lines up to the closing fence, which is consumed.
fn block<'a>(lines: &mut impl Iterator<Item = (usize, &'a str)>) -> Option<Vec<&'a str>> {
    let mut block = Vec::new();
    for (_, text) in lines {
        if text.trim_end() == "```" {
            return Some(block);
        }
        block.push(text);
    }
    None
}

/// The commands of a console block whose fence is on line `start`.
fn console_examples(start: usize, block: &[&str]) -> Result<Vec<Example>, MarkerError> {
    let mut found: Vec<Example> = Vec::new();
    let mut continues = false;
    for (i, text) in block.iter().enumerate() {
        if let Some(command) = text.strip_prefix("$ ") {
            let script = command.to_owned();
            found.push(Example { line: start + 1 + i, script, output: Vec::new() });
            continues = command.ends_with('\\');
            continue;
        }
        let example = found.last_mut().ok_or(MarkerError::NoCommand { line: start })?;
        if continues {
            example.script.push('\n');
            example.script.push_str(text.strip_prefix("> ").unwrap_or(text));
            continues = text.ends_with('\\');
        } else {
            example.output.push((*text).to_owned());
        }
    }
    Ok(found)
}

/// Runs one example in `folder` with the programs of `bin_dir` first on the path.
pub(crate) fn run(example: &Example, folder: &Path, bin_dir: &Path) -> Result<(), ExampleError> {
    let output = Command::new("sh")
        .args(["-e", "-c", &example.script])
        .current_dir(folder)
        .env("PATH", path_with(bin_dir))
        .output()
        .map_err(ExampleError::Shell)?;
    let stdout = String::from_utf8_lossy(&output.stdout).into_owned();
    if !output.status.success() {
        let printed = stdout + &String::from_utf8_lossy(&output.stderr);
        return Err(ExampleError::Failed { printed });
    }
    let printed: Vec<&str> = stdout.lines().collect();
    let expected: Vec<&str> = example.output.iter().map(String::as_str).collect();
    if expected.is_empty() || lines_match(&expected, &printed) {
        Ok(())
    } else {
        Err(ExampleError::Output { printed: stdout })
    }
}

/// The path variable with `first` before all else.
fn path_with(first: &Path) -> OsString {
    let mut path = first.as_os_str().to_owned();
    if let Some(rest) = std::env::var_os("PATH") {
        path.push(":");
        path.push(rest);
    }
    path
}

/// Whether `printed` is what `expected` shows, where a line `...` is any number of lines.
fn lines_match(expected: &[&str], printed: &[&str]) -> bool {
    match expected {
        [] => printed.is_empty(),
        ["...", rest @ ..] => (0..=printed.len()).any(|skip| lines_match(rest, &printed[skip..])),
        [line, rest @ ..] => printed
            .split_first()
            .is_some_and(|(first, others)| line_matches(line, first) && lines_match(rest, others)),
    }
}

/// Whether `printed` is what `expected` shows, where `[..]` is any text.
fn line_matches(expected: &str, printed: &str) -> bool {
    match expected.split_once("[..]") {
        None => expected.trim_end() == printed.trim_end(),
        Some((head, tail)) => printed.strip_prefix(head).is_some_and(|rest| {
            rest.char_indices()
                .map(|(i, _)| i)
                .chain([rest.len()])
                .any(|skip| line_matches(tail, &rest[skip..]))
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_marked_blocks_are_examples() {
        let readme = "```sh\nrm x\n```\n\n<!-- checked -->\n\n```sh\ntrue\nfalse\n```\n";
        let expected = Example { line: 8, script: "true\nfalse".to_owned(), output: Vec::new() };
        assert_eq!(examples(readme), Ok(vec![expected]));
    }

    #[test]
    fn a_readme_without_markers_has_no_examples() {
        assert_eq!(examples("# upglow\n"), Ok(Vec::new()));
    }

    #[test]
    fn console_blocks_hold_commands_and_their_output() {
        let readme = "<!-- checked -->\n```console\n$ echo a \\\n    b\na b\n$ true\n```\n";
        let found = examples(readme).unwrap();
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].script, "echo a \\\n    b");
        assert_eq!(found[0].output, ["a b"]);
        assert_eq!((found[1].line, found[1].script.as_str()), (6, "true"));
    }

    #[test]
    fn a_marker_that_marks_nothing_is_an_error() {
        let error = MarkerError::NoBlock { line: 1 };
        assert_eq!(examples("<!-- checked -->\ntext\n"), Err(error));
        assert_eq!(examples("<!-- checked -->\n```text\n```\n"), Err(error));
    }

    #[test]
    fn a_block_without_end_or_command_is_an_error() {
        let unclosed = examples("<!-- checked -->\n```sh\ntrue\n");
        assert_eq!(unclosed, Err(MarkerError::Unclosed { line: 2 }));
        let no_command = examples("<!-- checked -->\n```console\nout\n```\n");
        assert_eq!(no_command, Err(MarkerError::NoCommand { line: 2 }));
    }

    #[test]
    fn dots_stand_for_lines_and_for_parts_of_lines() {
        assert!(lines_match(&["a", "...", "d"], &["a", "b", "c", "d"]));
        assert!(lines_match(&["...", "d"], &["d"]));
        assert!(!lines_match(&["a", "..."], &["b"]));
        assert!(!lines_match(&["a"], &["a", "b"]));
        assert!(line_matches("took [..] s, ΔE [..]", "took 1.2 s, ΔE 0.1"));
        assert!(!line_matches("took [..] s", "took 1.2 ms"));
    }

    #[test]
    fn an_example_must_succeed_and_print_what_is_shown() {
        let example = |script: &str, output: &[&str]| Example {
            line: 1,
            script: script.to_owned(),
            output: output.iter().map(|&line| line.to_owned()).collect(),
        };
        let here = Path::new(".");
        assert!(run(&example("echo yes", &["yes"]), here, here).is_ok());
        let other = run(&example("echo no", &["yes"]), here, here);
        assert!(matches!(other, Err(ExampleError::Output { .. })));
        let failed = run(&example("false; true", &[]), here, here);
        assert!(matches!(failed, Err(ExampleError::Failed { .. })));
    }
}
