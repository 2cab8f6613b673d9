//! A large file that appears whole or not at all.

use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// A file written aside and renamed when it is whole; dropped before, it leaves nothing.
#[derive(Debug)]
pub(crate) struct Aside {
    file: BufWriter<NamedTempFile>,
    path: PathBuf,
}

/// Blocks are tens of kilobytes; fewer, larger writes save system calls.
const BUFFER_BYTES: usize = 1 << 20;

impl Aside {
    /// Starts the file that will stand at `path`.
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        if path.file_name().is_none() || path.metadata().is_ok_and(|found| !found.is_file()) {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                "not a file, expected a path to write a file at",
            ));
        }
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let aside = tempfile::Builder::new().prefix(".upglow-").tempfile_in(folder)?;
        Ok(Self { file: BufWriter::with_capacity(BUFFER_BYTES, aside), path: path.into() })
    }

    /// Gives the file its name; returns its size in bytes.
    pub(crate) fn commit(self) -> io::Result<u64> {
        let aside = self.file.into_inner().map_err(io::IntoInnerError::into_error)?;
        aside.as_file().sync_all()?;
        make_readable(aside.path())?;
        let bytes = aside.as_file().metadata()?.len();
        aside.persist(self.path).map_err(|e| e.error)?;
        Ok(bytes)
    }
}

impl Write for Aside {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for Aside {
    fn seek(&mut self, to: io::SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// Gives a file the permissions that any new file has; temporary ones are private.
#[cfg(unix)]
fn make_readable(path: &Path) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn make_readable(_path: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_was_not_finished_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x");
        let mut aside = Aside::create(&path).unwrap();
        aside.write_all(b"half").unwrap();
        drop(aside);
        assert_eq!(folder.path().read_dir().unwrap().count(), 0);
        let mut aside = Aside::create(&path).unwrap();
        aside.write_all(b"whole").unwrap();
        assert!(!path.exists());
        assert_eq!(aside.commit().unwrap(), 5);
        assert_eq!(std::fs::read(&path).unwrap(), b"whole");
        assert_eq!(folder.path().read_dir().unwrap().count(), 1);
    }

    #[test]
    fn a_folder_is_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let error = Aside::create(folder.path()).unwrap_err().to_string();
        assert_eq!(error, "not a file, expected a path to write a file at");
    }
}
