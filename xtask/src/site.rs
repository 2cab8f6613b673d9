//! The site: this repository's pages as a book with search, by mdBook.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::links::{joined, links};
use crate::step::{Step, StepError, finish, output_of, read, target_dir, tracked_files};

/// The list of the site's pages, below the repository's root.
const SUMMARY: &str = "docs/SUMMARY.md";

/// The settings of mdBook.
const SETTINGS: &str = "docs/book.toml";

/// What `cargo xtask check` does about the site.
pub(crate) const STEPS: [Step; 2] = [
    Step { name: "site-pages", about: "docs/SUMMARY.md lists every page of docs/", run: lists_all },
    Step { name: "site", about: "the site builds, and its links lead somewhere", run: check },
];

fn lists_all(root: &Path) -> Result<(), StepError> {
    let listed = pages(root)?;
    let files = tracked_files(root)?;
    let is_page = |path: &&String| {
        path.starts_with("docs/") && path.ends_with(".md") && path.as_str() != SUMMARY
    };
    let missing = files.iter().filter(is_page).filter(|path| !listed.contains(Path::new(path)));
    StepError::none_of(missing.map(|path| format!("{path} is not in {SUMMARY}")).collect())
}

fn check(root: &Path) -> Result<(), StepError> {
    build(root).map(|_| ())
}

/// The pages that the summary lists, by their paths below the root.
fn pages(root: &Path) -> Result<BTreeSet<PathBuf>, StepError> {
    Ok(links(&read(&root.join(SUMMARY))?).iter().map(|link| joined(SUMMARY, &link.path)).collect())
}

/// Builds the site; its folder. Pages keep their places below the root, so that their links stay right.
pub(crate) fn build(root: &Path) -> Result<PathBuf, StepError> {
    let mut version = Command::new("mdbook");
    version.arg("--version");
    if output_of(version).is_err() {
        return Err(StepError::Skipped("mdbook not installed"));
    }
    let folder = target_dir(root)?.join("site");
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(StepError::file(&folder))?;
    }
    let source = folder.join("pages");
    let pages = pages(root)?;
    for page in &pages {
        copy(root, &source, page)?;
        let text = read(&root.join(page))?;
        let from = page.to_string_lossy();
        let linked = links(&text).into_iter().map(|link| joined(&from, &link.path));
        for file in linked.filter(|file| !pages.contains(file) && root.join(file).is_file()) {
            copy(root, &source, &file)?;
        }
    }
    let summary = read(&root.join(SUMMARY))?.replace("](", "](docs/").replace("](docs/../", "](");
    write(&source.join("SUMMARY.md"), summary.as_bytes())?;
    write(&folder.join("book.toml"), read(&root.join(SETTINGS))?.as_bytes())?;
    let mut mdbook = Command::new("mdbook");
    mdbook.arg("build").arg(&folder);
    finish(mdbook)?;
    let book = folder.join("book");
    // mdBook calls a README the index of its folder, but not in the links to it.
    for page in pages.iter().filter(|page| page.ends_with("README.md")) {
        let index = book.join(page).with_file_name("index.html");
        fs::copy(&index, index.with_file_name("README.html")).map_err(StepError::file(&index))?;
    }
    StepError::none_of(broken(&book, &book)?)?;
    Ok(book)
}

fn copy(root: &Path, source: &Path, file: &Path) -> Result<(), StepError> {
    let from = root.join(file);
    write(&source.join(file), &fs::read(&from).map_err(StepError::file(&from))?)
}

fn write(path: &Path, content: &[u8]) -> Result<(), StepError> {
    let folder = path.parent().unwrap_or(path);
    fs::create_dir_all(folder).map_err(StepError::file(folder))?;
    fs::write(path, content).map_err(StepError::file(path))
}

/// The links of built pages that lead nowhere, one line each.
fn broken(book: &Path, folder: &Path) -> Result<Vec<String>, StepError> {
    let mut problems = Vec::new();
    for entry in fs::read_dir(folder).map_err(StepError::file(folder))? {
        let path = entry.map_err(StepError::file(folder))?.path();
        let is_page = path.extension().is_some_and(|ending| ending == "html");
        if path.is_dir() {
            problems.extend(broken(book, &path)?);
        } else if is_page
            && path.file_name().is_some_and(|name| name != "404.html" && name != "print.html")
        {
            let shown = path.strip_prefix(book).unwrap_or(&path).display().to_string();
            let targets: BTreeSet<_> = targets(&read(&path)?).map(str::to_owned).collect();
            let lost = targets.iter().filter(|target| !path.with_file_name(target).is_file());
            problems.extend(lost.map(|target| format!("site: {shown}: no file {target}")));
        }
    }
    Ok(problems)
}

/// The files of the site that a built page refers to.
fn targets(html: &str) -> impl Iterator<Item = &str> {
    let values = ["href=\"", "src=\""].into_iter().flat_map(move |name| {
        html.match_indices(name)
            .filter_map(move |(at, _)| html[at + name.len()..].split('"').next())
    });
    values
        .filter_map(|value| value.split('#').next())
        .filter(|path| !path.is_empty() && !path.contains(':'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_page_refers_to_is_found() {
        let html =
            r##"<a href="../a.html#b"><img src="c.png"><a href="#d"><a href="https://e.org">"##;
        assert_eq!(targets(html).collect::<Vec<_>>(), ["../a.html", "c.png"]);
    }
}
