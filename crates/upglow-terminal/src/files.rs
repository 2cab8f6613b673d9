//! Files that the programs read and write.

use std::io::{self, ErrorKind};
use std::path::Path;

use upglow::{Aside, read_text_input};

use crate::failure::Failure;
use crate::output::keep_for_data;

/// Reads a text file; `expected` says in errors what it should be.
pub fn read_text(path: &Path, expected: &str) -> Result<String, Failure> {
    read_text_input(path).map_err(|error| Failure::system(path, &error, expected))
}

/// Checks that a file can be written at `path`, before long work starts.
///
/// If it is standard output, reports then go to standard error.
pub fn check_output(path: &Path) -> Result<(), Failure> {
    let folder = folder_of(path);
    if !folder.is_dir() {
        let message = format!("no folder {}, expected an existing one", folder.display());
        return Err(Failure::file(path, message));
    }
    let aside = Aside::create(path).map_err(|error| match error.kind() {
        ErrorKind::InvalidInput => Failure::file(path, error),
        _ => {
            let expected = format!("a folder to write in, other than {}", folder.display());
            Failure::system(path, &error, expected)
        }
    })?;
    if aside.is_standard_output() {
        keep_for_data();
    }
    Ok(())
}

/// Checks that files can be written beside an output: that it is no device or pipe.
pub fn check_has_place(path: &Path) -> Result<(), Failure> {
    match path.metadata() {
        Ok(found) if !found.is_file() => {
            let message = "a device or pipe, expected a file, beside which others are written";
            Err(Failure::file(path, message))
        }
        _ => Ok(()),
    }
}

/// Checks that the name of an output does not promise another kind of file: it ends in one of
/// `endings`, or has no ending.
pub fn check_ending(path: &Path, endings: &[&str]) -> Result<(), Failure> {
    let Some(found) = path.extension() else { return Ok(()) };
    if endings.iter().any(|ending| found.eq_ignore_ascii_case(ending)) {
        return Ok(());
    }
    let message = format!(
        "a name that ends in .{}, expected one that ends in .{}",
        found.display(),
        endings.join(" or .")
    );
    Err(Failure::file(path, message))
}

/// Writes a file, as a whole or not at all.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    Aside::write_whole(path, bytes).map_err(|error| unwritten(path, &error))
}

/// Starts a file that [`write_together`] completes.
pub fn aside(path: &Path, bytes: &[u8]) -> Result<Aside, Failure> {
    Aside::with_content(path, bytes).map_err(|error| unwritten(path, &error))
}

/// Gives files that belong together their names, in this order; the last is `path`, which refers to the others.
pub fn write_together(path: &Path, files: Vec<Aside>) -> Result<(), Failure> {
    Aside::commit_together(files).map_err(|error| unwritten(path, &error))
}

/// The failure to write a file.
pub fn unwritten(path: &Path, error: &io::Error) -> Failure {
    match error.kind() {
        ErrorKind::InvalidInput => Failure::file(path, error.to_string()),
        ErrorKind::BrokenPipe => Failure::OutputClosed,
        _ => Failure::system(path, error, "room for the file and the right to write"),
    }
}

/// Creates a folder, and missing ones above it.
pub fn make_folder(path: &Path) -> Result<(), Failure> {
    if path.exists() && !path.is_dir() {
        return Err(Failure::file(
            path,
            "no folder, expected one to write in, or a name that is free",
        ));
    }
    std::fs::create_dir_all(path)
        .map_err(|error| Failure::system(path, &error, "a folder to write in"))
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ending_that_lies_is_refused() {
        let check = |name: &str| check_ending(Path::new(name), &["html", "htm"]);
        for name in ["a.html", "a.HTM", "page", "a.b/page", "/dev/stdout"] {
            assert_eq!(check(name), Ok(()), "{name}");
        }
        let line = "a.pdf: a name that ends in .pdf, expected one that ends in .html or .htm";
        assert_eq!(check("a.pdf"), Err(Failure::Input(line.into())));
        assert!(check("page.").is_err());
    }

    #[test]
    fn checking_an_output_creates_no_file() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(check_output(&folder.path().join("cube")), Ok(()));
        assert!(check_output(folder.path()).is_err());
        assert!(check_output(&folder.path().join("no/cube")).is_err());
        assert_eq!(folder.path().read_dir().unwrap().count(), 0);
    }
}
