//! Files that the programs read and write.
//!
//! No file of a run is both read and written, and none is written twice: a file that is read is noted by
//! [`note_input`], one that will be written by [`check_output`], and whichever comes second is refused.

use std::collections::HashSet;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash as _, Hasher as _};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

use upglow::{Aside, read_text_input};

use crate::failure::Failure;
use crate::output::keep_for_data;

/// The files of this run, by hashes of the paths that they really have: there may be millions.
#[derive(Debug, Default)]
struct Files {
    inputs: HashSet<u64>,
    outputs: HashSet<u64>,
}

fn files() -> MutexGuard<'static, Files> {
    static FILES: LazyLock<Mutex<Files>> = LazyLock::new(Mutex::default);
    FILES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The hash of a path, not the same for other builds of the program.
pub fn hash_of(path: &Path) -> u64 {
    let mut hasher = DefaultHasher::new();
    path.hash(&mut hasher);
    hasher.finish()
}

/// Notes a file that is read, and checks that it will not be written.
pub fn note_input(path: &Path) -> Result<(), Failure> {
    let Ok(real) = path.canonicalize() else { return Ok(()) };
    let (mut files, real) = (files(), hash_of(&real));
    if files.outputs.contains(&real) {
        return Err(is_input(path));
    }
    files.inputs.insert(real);
    Ok(())
}

/// Checks that a file, which another run will write, is neither read nor written by this one.
pub fn check_is_free(path: &Path) -> Result<(), Failure> {
    let Ok(real) = path.canonicalize() else { return Ok(()) };
    files().check(path, hash_of(&real))
}

impl Files {
    fn check(&self, path: &Path, real: u64) -> Result<(), Failure> {
        if self.inputs.contains(&real) {
            return Err(is_input(path));
        }
        if self.outputs.contains(&real) {
            let message = "the file of another output of this command, expected one for each";
            return Err(Failure::file(path, message));
        }
        Ok(())
    }
}

fn is_input(path: &Path) -> Failure {
    Failure::file(path, "an input of this command, expected another file to write")
}

/// Reads a text file; `expected` says in errors what it should be.
pub fn read_text(path: &Path, expected: &str) -> Result<String, Failure> {
    note_input(path)?;
    read_text_input(path).map_err(|error| Failure::system(path, &error, expected))
}

/// Checks that a file can be written at `path`, before long work starts, and that it is no input and no other output.
///
/// If it is standard output, reports then go to standard error.
pub fn check_output(path: &Path) -> Result<(), Failure> {
    check_is_free(path)?;
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
    let real = if aside.is_standard_output() {
        keep_for_data();
        Some(PathBuf::from("standard output"))
    } else {
        // The bytes of several outputs may go to one device.
        aside.path().and_then(real_path)
    };
    if let Some(real) = real {
        let (mut files, real) = (files(), hash_of(&real));
        files.check(path, real)?;
        files.outputs.insert(real);
    }
    Ok(())
}

/// The path that a file, which need not exist, really has.
fn real_path(path: &Path) -> Option<PathBuf> {
    Some(folder_of(path).canonicalize().ok()?.join(path.file_name()?))
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
