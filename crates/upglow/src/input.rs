//! Files that are read: of what has no end, or nobody who writes it, nothing is waited for.

use std::fs::{File, Metadata};
use std::io::{self, ErrorKind, Read as _};
use std::path::Path;

/// Opens a file to read parts of it in any order.
///
/// # Errors
///
/// [`ErrorKind::InvalidInput`] for a device, a pipe or a socket, of which reading may never begin or end;
/// [`ErrorKind::IsADirectory`] for a folder; otherwise the system's error.
pub fn open_input(path: &Path) -> io::Result<File> {
    let found = path.metadata()?;
    if !found.is_file() {
        return Err(refusal(&found));
    }
    File::open(path)
}

/// Reads the content of a file, or of a pipe that a shell made for this program, as of `<(…)`.
///
/// # Errors
///
/// [`ErrorKind::FileTooLarge`] if there are more than `most` bytes; otherwise as [`open_input`].
pub fn read_input(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let found = path.metadata()?;
    if !found.is_file() && !is_unnamed_pipe(path, &found) {
        return Err(refusal(&found));
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let message = format!("more than {} MiB", most >> 20);
        return Err(io::Error::new(ErrorKind::FileTooLarge, message));
    }
    Ok(bytes)
}

/// Reads a text file of at most 32 MiB: a hundred times what a measured light takes, and a list of 100,000
/// colors with as many digits as there are.
///
/// # Errors
///
/// [`ErrorKind::InvalidData`] if it is not UTF-8; otherwise as [`read_input`].
pub fn read_text_input(path: &Path) -> io::Result<String> {
    String::from_utf8(read_input(path, MOST_TEXT_BYTES)?).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        io::Error::new(ErrorKind::InvalidData, format!("not UTF-8 at byte {at}"))
    })
}

const MOST_TEXT_BYTES: u64 = 32 << 20;

fn refusal(found: &Metadata) -> io::Error {
    if found.is_dir() {
        return ErrorKind::IsADirectory.into();
    }
    io::Error::new(ErrorKind::InvalidInput, "a device, pipe or socket")
}

/// Whether this is a pipe without a path: somebody has both its ends. One with a path may wait for a writer
/// forever.
#[cfg(unix)]
fn is_unnamed_pipe(path: &Path, found: &Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt as _;
    found.file_type().is_fifo() && path.canonicalize().is_err()
}

#[cfg(not(unix))]
fn is_unnamed_pipe(_: &Path, _: &Metadata) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIB: u64 = 1 << 20;

    /// The kinds of the errors of opening and of reading.
    fn refused(path: &Path) -> [ErrorKind; 2] {
        [open_input(path).unwrap_err().kind(), read_input(path, MIB).unwrap_err().kind()]
    }

    #[test]
    fn a_file_is_read_up_to_a_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x");
        let size = |bytes| File::create(&path).unwrap().set_len(bytes).unwrap();
        size(MIB);
        assert_eq!(read_input(&path, MIB).unwrap().len() as u64, MIB);
        size(MIB + 1);
        assert_eq!(read_input(&path, MIB).unwrap_err().to_string(), "more than 1 MiB");
        size(MOST_TEXT_BYTES + 1);
        assert_eq!(read_text_input(&path).unwrap_err().to_string(), "more than 32 MiB");
        std::fs::write(&path, b"ab\xff").unwrap();
        assert_eq!(read_text_input(&path).unwrap_err().to_string(), "not UTF-8 at byte 2");
        assert_eq!(refused(folder.path()), [ErrorKind::IsADirectory; 2]);
        assert_eq!(refused(&folder.path().join("no")), [ErrorKind::NotFound; 2]);
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_pipes_are_refused_and_not_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.unwrap().success());
        for path in [pipe.as_path(), Path::new("/dev/zero"), Path::new("/dev/null")] {
            assert_eq!(refused(path), [ErrorKind::InvalidInput; 2], "{}", path.display());
        }
    }
}
