//! Links between the pages of this repository: each leads to a file, and to a heading of it if it names one.

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

use crate::step::{Step, StepError, read, tracked_files};

/// What `cargo xtask check` does about links.
pub(crate) const STEPS: [Step; 1] =
    [Step { name: "links", about: "links between pages lead somewhere", run: check }];

/// A link of a page to a file here.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Link {
    /// Line in the page, from 1.
    pub(crate) line: usize,
    /// The path as written; empty for a heading of the same page.
    pub(crate) path: String,
    /// The heading, without `#`.
    pub(crate) heading: Option<String>,
}

fn check(root: &Path) -> Result<(), StepError> {
    let mut problems = Vec::new();
    for page in tracked_files(root)?.iter().filter(|path| path.ends_with(".md")) {
        for link in links(&read(&root.join(page))?) {
            problems.extend(problem(root, page, &link)?);
        }
    }
    StepError::none_of(problems)
}

/// What is wrong with a link of a page.
fn problem(
    root: &Path,
    page: &str,
    Link { line, path, heading }: &Link,
) -> Result<Option<String>, StepError> {
    let target = if path.is_empty() { PathBuf::from(page) } else { joined(page, path) };
    let place = format!("{page}:{line}");
    let file = root.join(&target);
    if !file.is_file() {
        return Ok(Some(format!("{place}: no file {}, expected one to link to", target.display())));
    }
    let Some(heading) = heading else { return Ok(None) };
    let is_there = headings(&read(&file)?).contains(heading);
    Ok((!is_there).then(|| format!("{place}: no heading #{heading} in {}", target.display())))
}

/// The path from the repository's root of what a page links to.
pub(crate) fn joined(page: &str, path: &str) -> PathBuf {
    let mut found = Path::new(page).parent().unwrap_or(Path::new("")).to_owned();
    for part in Path::new(path).components() {
        match part {
            Component::ParentDir if found.pop() => {}
            part => found.push(part),
        }
    }
    found
}

/// The lines of a page that are not code, with their numbers from 1.
fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_code = false;
    (1..).zip(text.lines()).filter(move |(_, line)| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    })
}

/// The links of a page to files here.
pub(crate) fn links(text: &str) -> Vec<Link> {
    let mut found = Vec::new();
    for (line, text) in prose(text) {
        for (start, _) in text.match_indices("](") {
            let Some((target, _)) = text[start + 2..].split_once(')') else { continue };
            if target.contains(':') || target.contains(' ') {
                continue;
            }
            let (path, heading) = match target.split_once('#') {
                Some((path, heading)) => (path, Some(heading.to_owned())),
                None => (target, None),
            };
            found.push(Link { line, path: path.to_owned(), heading });
        }
    }
    found
}

/// The names under which headings are linked to.
fn headings(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (_, line) in prose(text) {
        let title = line.trim_start_matches('#');
        if title.len() == line.len() || !title.starts_with(' ') {
            continue;
        }
        let name = name(title.trim());
        let names = std::iter::once(name.clone()).chain((1..).map(|n| format!("{name}-{n}")));
        let free = names.into_iter().find(|name| !found.contains(name));
        found.extend(free);
    }
    found
}

/// The name of a heading: small letters, digits, hyphens and underscores, with hyphens for blanks.
fn name(title: &str) -> String {
    let kept = title.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.flat_map(|c| if c == ' ' { '-' } else { c }.to_lowercase()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_outside_of_code_are_found() {
        let text =
            "See [a](b.md#c d), [e](../f.md#g) and [h](https://i.org).\n```\n[j](k)\n```\n[l](#m)";
        let expected = [
            Link { line: 1, path: "../f.md".into(), heading: Some("g".into()) },
            Link { line: 5, path: String::new(), heading: Some("m".into()) },
        ];
        assert_eq!(links(text), expected);
        assert_eq!(joined("docs/a.md", "../b/c.md"), Path::new("b/c.md"));
    }

    #[test]
    fn headings_have_the_names_that_pages_link_to() {
        let text = "# A `b`: c\n## Where does a new … go\n## Go\n## Go\n```\n# not one\n```\n#no";
        let names = headings(text);
        let expected = ["a-b-c", "go", "go-1", "where-does-a-new--go"];
        assert_eq!(names.iter().collect::<Vec<_>>(), expected);
    }
}
