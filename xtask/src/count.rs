//! `cargo xtask count`: how large the project is, by the numbers that a change can be held to.
//!
//! A source line is one of Rust, Python, C, C++, JavaScript, CSS, HTML, GLSL, HLSL, OSL or WGSL that
//! holds more than space and comment. Left out: tests (folders `tests`, files `tests.rs`, modules under `#[cfg(test)]`),
//! benches and examples, documentation (comments, docstrings), and what is generated (the measured
//! tables, the C header).

use std::fs;
use std::path::{Path, PathBuf};

use crate::step::{StepError, cargo, output_of, read, tracked_files};

/// Comments by line, and languages by the ends of their files' names.
const LANGUAGES: [(&str, &str, &[&str]); 5] = [
    ("Rust", "//", &["rs"]),
    ("Python", "#", &["py", "pyi"]),
    ("C, C++", "//", &["c", "h", "cpp"]),
    ("JavaScript, CSS, HTML", "//", &["js", "mjs", "css", "html"]),
    ("shaders", "//", &["wgsl", "glsl", "hlsl", "osl"]),
];

/// Folders whose files are not part of the product.
const LEFT_OUT_FOLDERS: [&str; 3] = ["tests", "benches", "examples"];

/// What is generated, below the workspace's root.
const GENERATED: [&str; 2] = ["crates/upglow-color/src/tables/", "bindings/c/include/upglow.h"];

/// The program whose tree of crates is counted.
const PROGRAM: &str = "upglow-cli";

/// The numbers of one workspace.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Count {
    /// Source lines of each language.
    lines: Vec<(&'static str, usize)>,
    /// Names that the library crates export from their roots.
    public_names: Vec<(String, usize)>,
    /// Crates that the program is built from, each version once.
    crates: usize,
}

impl std::fmt::Display for Count {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let total: usize = self.lines.iter().map(|(_, lines)| lines).sum();
        let parts: Vec<String> = self.lines.iter().map(|(name, n)| format!("{name} {n}")).collect();
        writeln!(f, "source lines: {total} ({})", parts.join(", "))?;
        let total: usize = self.public_names.iter().map(|(_, names)| names).sum();
        let parts: Vec<String> =
            self.public_names.iter().map(|(name, n)| format!("{name} {n}")).collect();
        writeln!(f, "public names: {total} ({})", parts.join(", "))?;
        write!(f, "crates in the tree of {PROGRAM}: {}", self.crates)
    }
}

/// Counts the workspace at `root`.
pub(crate) fn count(root: &Path) -> Result<Count, StepError> {
    let files = source_files(root)?;
    let mut lines = Vec::new();
    for (language, comment, endings) in LANGUAGES {
        let mut total = 0;
        for path in files.iter().filter(|path| has_ending(path, endings)) {
            total += source_lines(&read(path)?, comment);
        }
        lines.push((language, total));
    }
    Ok(Count { lines, public_names: public_names(root)?, crates: crates(root)? })
}

fn source_files(root: &Path) -> Result<Vec<PathBuf>, StepError> {
    let is_source = |path: &&String| {
        !GENERATED.iter().any(|generated| path.starts_with(generated))
            && !path.split('/').any(|part| LEFT_OUT_FOLDERS.contains(&part))
            && !path.ends_with("/tests.rs")
    };
    Ok(tracked_files(root)?.iter().filter(is_source).map(|path| root.join(path)).collect())
}

fn has_ending(path: &Path, endings: &[&str]) -> bool {
    path.extension().is_some_and(|ending| endings.iter().any(|known| ending == *known))
}

/// Lines of code in one file, which must be formatted by rustfmt.
fn source_lines(text: &str, comment: &str) -> usize {
    let mut lines = text.lines();
    let mut count = 0;
    while let Some(line) = lines.next() {
        let code = line.trim();
        if code == "#[cfg(test)]" {
            skip_item(line, &mut lines);
        } else if comment == "#" && (code.starts_with("\"\"\"") || code.starts_with("r\"\"\"")) {
            // A docstring: a string that starts a line is a statement of its own.
            if code.matches("\"\"\"").count() == 1 {
                lines.by_ref().find(|line| line.contains("\"\"\""));
            }
        } else if comment == "//" && code.starts_with("/*") {
            if !code.contains("*/") {
                lines.by_ref().find(|line| line.contains("*/"));
            }
        } else if !code.is_empty() && !code.starts_with(comment) {
            count += 1;
        }
    }
    count
}

/// Skips what an attribute on the line `attribute` belongs to: up to the line with the same
/// indentation that ends it.
fn skip_item<'a>(attribute: &str, lines: &mut impl Iterator<Item = &'a str>) {
    let indentation = attribute.len() - attribute.trim_start().len();
    for line in lines {
        let outer = line.len() - line.trim_start().len() == indentation;
        if outer && (line.ends_with('}') || line.ends_with(';')) {
            return;
        }
    }
}

/// How many names each library crate re-exports, by crate.
fn public_names(root: &Path) -> Result<Vec<(String, usize)>, StepError> {
    let folder = root.join("crates");
    let file = StepError::file(&folder);
    let mut counts = Vec::new();
    for entry in fs::read_dir(&folder).map_err(&file)? {
        let entry = entry.map_err(&file)?;
        let library = entry.path().join("src/lib.rs");
        if library.is_file() {
            let name = entry.file_name().to_string_lossy().into_owned();
            counts.push((name, exported(&read(&library)?)));
        }
    }
    counts.sort();
    Ok(counts)
}

/// The names in the `pub use` lines of a crate's root.
fn exported(library: &str) -> usize {
    let statements = library.split("pub use ").skip(1);
    let names = statements.filter_map(|rest| rest.split_once(';')).map(|(path, _)| path);
    names
        .map(|path| match path.split_once('{') {
            None => 1,
            Some((_, list)) => {
                list.trim_end_matches('}').split(',').filter(|n| !n.trim().is_empty()).count()
            }
        })
        .sum()
}

/// How many crates the program is built from.
fn crates(root: &Path) -> Result<usize, StepError> {
    let tree = output_of(cargo(root, &format!("tree -p {PROGRAM} -e normal --prefix none")))?;
    let mut crates: Vec<&str> = tree.lines().map(|line| line.trim_end_matches(" (*)")).collect();
    crates.sort_unstable();
    crates.dedup();
    Ok(crates.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_blanks_and_tests_are_no_source_lines() {
        let rust = "//! a\n\nfn f() {\n    // b\n    g(); // c\n}\n\n/* d\ne */\n\
                    #[cfg(test)]\nmod tests {\n    use super::*;\n}\n\nconst A: u8 = 1;\n";
        assert_eq!(source_lines(rust, "//"), 4);
    }

    #[test]
    fn docstrings_are_no_source_lines() {
        let python = "\"\"\"One line.\"\"\"\n\ndef f():\n    r\"\"\"Two\n    lines.\"\"\"\n    return 1  # a\n";
        assert_eq!(source_lines(python, "#"), 2);
    }

    #[test]
    fn every_re_exported_name_is_counted() {
        let library = "mod a;\npub use a::B;\npub use a::{\n    C,\n    D,\n};\nuse a::E;\n";
        assert_eq!(exported(library), 3);
    }
}
