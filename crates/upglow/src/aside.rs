//! Files that appear whole or not at all.

use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// A file that is written under a temporary name beside its path and renamed when it is complete.
/// Dropped before that, it leaves nothing behind, and a file already at the path stays.
#[must_use = "a file that is not committed is not written"]
#[derive(Debug)]
pub struct Aside {
    file: BufWriter<NamedTempFile>,
    path: PathBuf,
}

/// Writers bring tens of kilobytes at a time; fewer, larger writes save system calls.
const BUFFER_BYTES: usize = 1 << 20;

impl Aside {
    /// Starts the file that [`Aside::commit`] will put at `path`.
    ///
    /// # Errors
    ///
    /// [`io::ErrorKind::InvalidInput`] if the path ends without a file name or names something
    /// other than a file; the system's error if its folder cannot be written to.
    pub fn create(path: &Path) -> io::Result<Self> {
        if path.file_name().is_none() || path.metadata().is_ok_and(|found| !found.is_file()) {
            let message = "not a file, expected a path to write a file at";
            return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
        }
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let aside = tempfile::Builder::new().prefix(".upglow-").tempfile_in(folder)?;
        Ok(Self { file: BufWriter::with_capacity(BUFFER_BYTES, aside), path: path.into() })
    }

    /// Gives the file its name; returns its size in bytes.
    ///
    /// # Errors
    ///
    /// The system's error; nothing is left behind.
    pub fn commit(self) -> io::Result<u64> {
        let aside = self.file.into_inner().map_err(io::IntoInnerError::into_error)?;
        aside.as_file().sync_all()?;
        make_readable(aside.path())?;
        let bytes = aside.as_file().metadata()?.len();
        aside.persist(self.path).map_err(|e| e.error)?;
        Ok(bytes)
    }

    /// Writes a file whose whole content is at hand.
    ///
    /// # Errors
    ///
    /// As [`Aside::create`] and [`Aside::commit`]; nothing is left behind.
    pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
        let mut aside = Self::create(path)?;
        aside.write_all(bytes)?;
        aside.commit().map(drop)
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
    fn a_failed_write_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let error = Aside::write_whole(folder.path(), b"x").unwrap_err().to_string();
        assert_eq!(error, "not a file, expected a path to write a file at");
        assert!(Aside::write_whole(&folder.path().join("no/such/folder/x"), b"x").is_err());
        assert_eq!(folder.path().read_dir().unwrap().count(), 0);
    }
}
