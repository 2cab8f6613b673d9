//! Files that the programs read and write.

use std::path::Path;

use upglow::{Aside, AsideError, write_whole};

use crate::failure::{Failure, io_message};

/// Reads text, which `expected` names.
pub fn read_text(path: &Path, expected: &str) -> Result<String, Failure> {
    std::fs::read_to_string(path).map_err(|error| {
        Failure::file(path, format_args!("{}, expected {expected}", io_message(&error)))
    })
}

/// Checks that a file can be written at `path`, before long work starts for it.
pub fn check_output(path: &Path) -> Result<(), Failure> {
    let kind = match path.metadata() {
        Ok(found) if found.is_file() => None,
        Ok(found) if found.is_dir() => Some("a folder"),
        Ok(_) => Some("a device, pipe or socket"),
        Err(_) if path.file_name().is_none() => Some("no file name"),
        Err(_) => None,
    };
    if let Some(kind) = kind {
        return Err(Failure::file(path, format_args!("{kind}, expected a file to write")));
    }
    let folder = folder_of(path);
    if !folder.is_dir() {
        let folder = folder.display();
        return Err(Failure::file(
            path,
            format_args!("no folder {folder}, expected an existing one"),
        ));
    }
    match Aside::create(path) {
        Ok(_) => Ok(()),
        Err(AsideError::Io(error)) => {
            let (found, folder) = (io_message(&error), folder.display());
            let message = format_args!("{found} in folder {folder}, expected one to write in");
            Err(Failure::file(path, message))
        }
        Err(error) => Err(Failure::file(path, error)),
    }
}

/// Writes a file that appears whole or not at all.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    write_whole(path, bytes).map_err(|error| match error {
        AsideError::Io(error) => Failure::file(
            path,
            format_args!(
                "{}, expected room for {} and the right to write",
                io_message(&error),
                size(bytes.len() as u64)
            ),
        ),
        error => Failure::file(path, error),
    })
}

/// Makes a folder and those above it, where they are not there.
pub fn make_folder(path: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(path).map_err(|error| {
        let found = io_message(&error);
        Failure::file(path, format_args!("{found}, expected a folder to write in"))
    })
}

/// A number of bytes for people: 1.23 MB.
pub fn size(bytes: u64) -> String {
    let bytes = bytes as f64;
    match bytes {
        b if b < 1e3 => format!("{b} bytes"),
        b if b < 1e6 => format!("{:.1} kB", b / 1e3),
        b if b < 1e9 => format!("{:.2} MB", b / 1e6),
        b => format!("{:.2} GB", b / 1e9),
    }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_readable() {
        assert_eq!([999, 12_345, 1_234_567].map(size), ["999 bytes", "12.3 kB", "1.23 MB"]);
    }

    #[test]
    fn checking_an_output_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(check_output(&folder.path().join("cube")), Ok(()));
        assert!(check_output(folder.path()).is_err());
        assert!(check_output(&folder.path().join("no/cube")).is_err());
        assert_eq!(folder.path().read_dir().unwrap().count(), 0);
    }
}
