//! `--cube FILE` in place of the first argument, in every command that takes a cube there.

use std::ffi::OsString;
use std::path::PathBuf;

/// Commands whose first argument is a cube. In `check` a cube is an option, because it may be absent.
const COMMANDS: [&str; 7] = ["inspect", "verify", "color", "relight", "export", "bake", "explore"];

const OPTION: &str = "--cube";

/// The option as help, completions and manual pages list it. It is moved before it is read, so what is read is
/// a second one.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct NamedCube {
    /// The cube, in place of the first argument
    #[arg(long = "cube", value_name = "FILE", value_parser = second_cube)]
    _cube: Option<PathBuf>,
}

fn second_cube(_: &str) -> Result<PathBuf, String> {
    Err("a cube was given before, expected one".to_owned())
}

/// The words of a command line, with a cube that an option names moved to the place of the argument.
pub(crate) fn with_cube_first(words: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let mut words: Vec<OsString> = words.into_iter().collect();
    let is_option = |word: &OsString| word.to_str().is_some_and(|word| word.starts_with('-'));
    let command = words.iter().skip(1).position(|word| !is_option(word)).map(|at| at + 1);
    let end = words.iter().position(|word| word == "--").unwrap_or(words.len());
    let Some(command) = command.filter(|&at| COMMANDS.iter().any(|known| words[at] == *known))
    else {
        return words;
    };
    let found = (command + 1..end).find_map(|at| Some((at, cube_at(&words[at..end])?)));
    if let Some((at, (count, cube))) = found {
        words.drain(at..at + count);
        words.insert(command + 1, cube);
    }
    words
}

/// The cube that an option names at the start of these words, and how many words that takes.
fn cube_at(words: &[OsString]) -> Option<(usize, OsString)> {
    match words {
        [option, cube, ..] if option == OPTION => Some((2, cube.clone())),
        [word, ..] => {
            let cube = word.to_str()?.strip_prefix(OPTION)?.strip_prefix('=')?;
            Some((1, cube.into()))
        }
        [] => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moved(line: &str) -> String {
        let words = with_cube_first(line.split(' ').map(OsString::from));
        words.iter().map(|word| word.to_str().unwrap()).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn a_cube_may_be_named_by_an_option_in_any_place() {
        assert_eq!(moved("upglow color 0.9 0 0.9 --cube c"), "upglow color c 0.9 0 0.9");
        assert_eq!(
            moved("upglow --json export -o a.csv --cube=c"),
            "upglow --json export c -o a.csv"
        );
        assert_eq!(moved("upglow bake --cube c in -o out"), "upglow bake c in -o out");
    }

    #[test]
    fn other_words_stay_where_they_are() {
        let lines = ["upglow check a.exr --cube c", "upglow inspect c", "upglow", "upglow -q"];
        for line in lines.into_iter().chain(["upglow inspect --cube", "upglow inspect -- --cube c"])
        {
            assert_eq!(moved(line), line);
        }
    }
}
