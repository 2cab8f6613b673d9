//! The words of texts: no phrase listed in `words.txt` appears, and the spelling is American.

use std::path::Path;
use std::process::Command;

use crate::python;
use crate::step::{Step, StepError, finish, read, tracked_files};

/// Phrases and suggestions, separated by `=>`.
const PHRASES: &str = include_str!("../words.txt");

/// Files with other people's words, with the phrases themselves, or with data.
const LEFT_OUT: [&str; 6] = [
    "LICENSE",
    "tables/",
    "xtask/words.txt",
    "xtask/src/words.rs",
    "docs/references.bib",
    "Cargo.lock",
];

/// What `cargo xtask check` does about words.
pub(crate) const STEPS: [Step; 2] = [
    Step { name: "words", about: "no phrase of xtask/words.txt appears", run: check },
    Step { name: "spelling", about: "typos finds nothing", run: spelling },
];

fn check(root: &Path) -> Result<(), StepError> {
    let mut problems = Vec::new();
    for path in tracked_files(root)? {
        let is_left_out = LEFT_OUT.iter().any(|left_out| path.starts_with(left_out));
        // Files that are not text are passed over.
        if let (false, Ok(text)) = (is_left_out, read(&root.join(&path))) {
            problems.extend(found(&path, &text));
        }
    }
    StepError::none_of(problems)
}

/// Where the phrases are in one file, a line for each.
fn found(path: &str, text: &str) -> Vec<String> {
    let kept = PHRASES.lines().filter_map(|line| line.strip_prefix("keep ")?.split_once(": "));
    let kept: Vec<&str> =
        kept.filter(|(below, _)| path.starts_with(below)).map(|(_, phrase)| phrase).collect();
    let phrases: Vec<(&str, &str)> =
        phrases().filter(|(phrase, _)| !kept.contains(phrase)).collect();
    let mut problems = Vec::new();
    for (line, text) in (1..).zip(text.lines()) {
        let text = text.to_lowercase();
        for (phrase, suggestion) in &phrases {
            if contains(&text, phrase) {
                problems.push(format!("{path}:{line}: “{phrase}”, write “{suggestion}”"));
            }
        }
    }
    problems
}

/// Each phrase of the list, and what to write.
fn phrases() -> impl Iterator<Item = (&'static str, &'static str)> {
    let lines = PHRASES.lines().filter(|line| !line.starts_with('#'));
    lines.filter_map(|line| line.split_once(" => "))
}

/// Whether a text contains a phrase as whole words.
fn contains(text: &str, phrase: &str) -> bool {
    text.match_indices(phrase).any(|(start, _)| {
        let before = text[..start].chars().next_back();
        let after = text[start + phrase.len()..].chars().next();
        [before, after].into_iter().flatten().all(|c| !c.is_alphanumeric())
    })
}

fn spelling(root: &Path) -> Result<(), StepError> {
    let interpreter = python::prepare(root)?;
    let mut typos = Command::new(interpreter.with_file_name("typos"));
    typos.args(["--format", "brief"]).current_dir(root);
    finish(typos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_phrase_is_found_with_its_place_and_what_to_write() {
        let text = "/// Good.\n/// Whence it came.\n";
        assert_eq!(found("a.rs", text), ["a.rs:2: “whence”, write “from where”"]);
        assert_eq!(found("a.rs", "/// Eye: CIE 1931\n"), ["a.rs:1: “/ eye:”, write “Observer:”"]);
    }

    #[test]
    fn parts_of_words_are_not_phrases() {
        assert!(contains("a hence b", "hence") && contains("hence", "hence"));
        assert!(!contains("henceforth whence", "hence"));
    }

    #[test]
    fn a_phrase_may_stand_where_it_is_part_of_a_product() {
        let text = "what is no number";
        assert_eq!(found("crates/upglow-shader/src/templates/a.wgsl", text), [""; 0]);
        assert_eq!(found("crates/upglow-shader/src/a.wgsl", text).len(), 1);
    }

    #[test]
    fn every_line_of_the_list_is_a_phrase_or_keeps_one() {
        let lines = PHRASES.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
        for line in lines {
            let keeps = line.strip_prefix("keep ").and_then(|rest| rest.split_once(": "));
            let phrase =
                keeps.map(|(_, phrase)| phrase).or_else(|| Some(line.split_once(" => ")?.0));
            let phrase = phrase.unwrap_or_default();
            assert!(phrases().any(|(known, _)| known == phrase.to_lowercase()), "{line}");
        }
    }
}
