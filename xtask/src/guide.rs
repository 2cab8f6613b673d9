//! The shell examples of docs/guide.md that are marked as checked.
//!
//! The line `<!-- checked -->` marks the fenced block after it. A `sh` block is one script that
//! must succeed. In a `console` block each `$ ` line is a command that must succeed; the lines
//! after it, where there are any, are its standard output. There a line `...` stands for any
//! number of lines, and `[..]` for any part of a line.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::step::{StepError, read, release_bin_dir};

/// The page, relative to the repository root.
const PAGE: &str = "docs/guide.md";

/// The line that marks the next block.
const MARKER: &str = "<!-- checked -->";

/// One command and what it must print.
#[derive(Clone, Debug, PartialEq)]
struct Example {
    /// Line of the command in the page, from 1.
    line: usize,
    /// The script, for `sh`.
    script: String,
    /// The expected lines of standard output; empty: anything goes.
    output: Vec<String>,
}

/// Runs the examples in order in one new folder, so that one may use the files of another.
pub(crate) fn check(root: &Path) -> Result<(), StepError> {
    let examples = examples(&read(&root.join(PAGE))?)?;
    if examples.is_empty() {
        return Err(StepError::Skipped("no checked example in docs/guide.md"));
    }
    let bin_dir = release_bin_dir(root)?;
    let folder = TemporaryFolder::create()?;
    examples.iter().try_for_each(|example| run(example, &folder.0, &bin_dir))
}

/// A new folder that is removed with its contents at the end.
#[derive(Debug)]
struct TemporaryFolder(PathBuf);

impl TemporaryFolder {
    fn create() -> Result<Self, StepError> {
        let path = std::env::temp_dir().join(format!("upglow-guide-{}", std::process::id()));
        fs::create_dir(&path).map_err(StepError::file(&path))?;
        Ok(Self(path))
    }
}

impl Drop for TemporaryFolder {
    fn drop(&mut self) {
        // What is left in the temporary folder is not worth failing a check that passed.
        fs::remove_dir_all(&self.0).ok();
    }
}

/// The marked examples of the page, in order.
fn examples(page: &str) -> Result<Vec<Example>, StepError> {
    let mut lines = page.lines().enumerate().map(|(i, line)| (i + 1, line));
    let mut found = Vec::new();
    while let Some((line, text)) = lines.next() {
        if text.trim() != MARKER {
            continue;
        }
        let fence = lines.by_ref().find(|(_, text)| !text.trim().is_empty());
        let (start, language) = match fence {
            Some((start, "```sh")) => (start, "sh"),
            Some((start, "```console")) => (start, "console"),
            _ => {
                let problem =
                    format!("'{MARKER}' marks nothing, expected a ```sh or ```console block");
                return Err(at(line, &problem));
            }
        };
        let block =
            block(&mut lines).ok_or_else(|| at(start, "the block has no end, expected ```"))?;
        if language == "sh" {
            found.push(Example { line: start + 1, script: block.join("\n"), output: Vec::new() });
        } else {
            found.extend(console_examples(start, &block)?);
        }
    }
    Ok(found)
}

/// A problem at a line of the page.
fn at(line: usize, problem: &str) -> StepError {
    StepError::found(format!("{PAGE}, line {line}: {problem}"))
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
fn console_examples(start: usize, block: &[&str]) -> Result<Vec<Example>, StepError> {
    let mut found: Vec<Example> = Vec::new();
    let mut continues = false;
    for (i, text) in block.iter().enumerate() {
        if let Some(command) = text.strip_prefix("$ ") {
            let script = command.to_owned();
            found.push(Example { line: start + 1 + i, script, output: Vec::new() });
            continues = command.ends_with('\\');
            continue;
        }
        let example = found.last_mut().ok_or_else(|| {
            at(start, "the block starts with output, expected a line '$ command'")
        })?;
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
fn run(example: &Example, folder: &Path, bin_dir: &Path) -> Result<(), StepError> {
    let Example { line, script, output } = example;
    let ran = Command::new("sh")
        .args(["-e", "-c", script])
        .current_dir(folder)
        .env("PATH", path_with(bin_dir))
        .output()
        .map_err(|source| StepError::Start { command: "sh".into(), source })?;
    let printed = String::from_utf8_lossy(&ran.stdout);
    let expected: Vec<&str> = output.iter().map(String::as_str).collect();
    let problem = if !ran.status.success() {
        "failed and printed"
    } else if expected.is_empty() || lines_match(&expected, &printed.lines().collect::<Vec<_>>()) {
        return Ok(());
    } else {
        "printed something else than the page shows"
    };
    let messages = String::from_utf8_lossy(&ran.stderr);
    Err(at(*line, &format!("the command\n$ {script}\n{problem}\n{printed}{messages}")))
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
        let page = "```sh\nrm x\n```\n\n<!-- checked -->\n\n```sh\ntrue\nfalse\n```\n";
        let expected = Example { line: 8, script: "true\nfalse".to_owned(), output: Vec::new() };
        assert_eq!(examples(page).unwrap(), [expected]);
    }

    #[test]
    fn a_page_without_markers_has_no_examples() {
        assert_eq!(examples("# upglow\n").unwrap(), []);
    }

    #[test]
    fn console_blocks_hold_commands_and_their_output() {
        let page = "<!-- checked -->\n```console\n$ echo a \\\n    b\na b\n$ true\n```\n";
        let found = examples(page).unwrap();
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].script, "echo a \\\n    b");
        assert_eq!(found[0].output, ["a b"]);
        assert_eq!((found[1].line, found[1].script.as_str()), (6, "true"));
    }

    fn error_of(page: &str) -> String {
        examples(page).unwrap_err().to_string()
    }

    #[test]
    fn a_marker_that_marks_nothing_is_an_error() {
        let error = "docs/guide.md, line 1: '<!-- checked -->' marks nothing";
        assert!(error_of("<!-- checked -->\ntext\n").starts_with(error));
        assert!(error_of("<!-- checked -->\n```text\n```\n").starts_with(error));
    }

    #[test]
    fn a_block_without_end_or_command_is_an_error() {
        let unclosed = error_of("<!-- checked -->\n```sh\ntrue\n");
        assert!(unclosed.starts_with("docs/guide.md, line 2: the block has no end"), "{unclosed}");
        let no_command = error_of("<!-- checked -->\n```console\nout\n```\n");
        assert!(no_command.starts_with("docs/guide.md, line 2: the block starts with output"));
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
        let other = run(&example("echo no", &["yes"]), here, here).unwrap_err().to_string();
        assert!(other.contains("something else than the page shows\nno\n"), "{other}");
        let failed = run(&example("false; true", &[]), here, here).unwrap_err().to_string();
        assert!(failed.contains("$ false; true\nfailed"), "{failed}");
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
