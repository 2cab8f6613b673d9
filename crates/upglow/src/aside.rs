//! Files that appear whole or not at all.

use std::collections::BTreeSet;
use std::fs::{File, Metadata, OpenOptions, TryLockError};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::thread::sleep;
use std::time::Duration;

use tempfile::TempPath;

/// A file that is written under a temporary name beside its path and renamed when it is complete.
/// Dropped before that, it leaves nothing behind, and a file already at the path stays.
///
/// A new file has the permissions that the system gives to new files; one that replaces another keeps the mode
/// of that one, and its owner and group where the system allows it. Symbolic links stay, and the file that they
/// lead to is replaced. A device or a pipe is not replaced: it receives the bytes when they are complete.
///
/// A process that is killed leaves its temporary file; the next one that writes in the same folder removes it.
#[must_use = "a file that is not committed is not written"]
#[derive(Debug)]
pub struct Aside {
    file: BufWriter<File>,
    place: Place,
}

/// Where the bytes go when they are complete.
#[derive(Debug)]
enum Place {
    /// Under a temporary name, to be renamed to the path, which is no symbolic link.
    Path { temporary: TempPath, path: PathBuf },
    /// In a file without a name, to be copied.
    Stream(Stream),
}

/// What is written to and never replaced.
#[derive(Debug)]
enum Stream {
    /// Standard output of this process.
    Output(File),
    /// A device, or standard error of this process.
    Open(File),
    /// A pipe with a name. It is opened last, because that waits for its reader.
    Pipe(PathBuf),
}

/// Writers bring tens of kilobytes at a time; fewer, larger writes save system calls.
const BUFFER_BYTES: usize = 1 << 20;
/// What the names of temporary files begin with.
const PREFIX: &str = ".upglow-";
/// As many symbolic links as Linux follows; more are a circle.
const MOST_LINKS: usize = 40;
/// How often a temporary file is made anew because another process took it for one left behind, which can happen
/// only between its creation and its lock.
const MOST_TRIES: usize = 10;
/// How often, and at what distance, a lock of a folder is asked for. Renaming takes milliseconds: whoever holds
/// it for longer than all tries is no writer of ours.
const TURN: (usize, Duration) = (500, Duration::from_millis(10));

impl Aside {
    /// Starts the file that [`Aside::commit`] will put at `path`.
    ///
    /// # Errors
    ///
    /// [`io::ErrorKind::InvalidInput`] if nothing can be written at the path whatever the rights: a folder, a
    /// socket, a path without a file name, or symbolic links in a circle; the system's error if its folder or the
    /// device cannot be written to.
    pub fn create(path: &Path) -> io::Result<Self> {
        if path.as_os_str().as_encoded_bytes().ends_with(b"/") {
            return Err(refused("a path that ends in /"));
        }
        let (file, place) = match path.metadata() {
            Ok(found) => match stream(path, &found)? {
                Some(stream) => (without_name()?, Place::Stream(stream)),
                None => beside(path)?,
            },
            // A temporary name is shorter.
            Err(error) if error.kind() == io::ErrorKind::InvalidFilename => return Err(error),
            Err(_) => beside(path)?,
        };
        Ok(Self { file: BufWriter::with_capacity(BUFFER_BYTES, file), place })
    }

    /// Whether the bytes go to standard output of this process, which then should receive nothing else.
    #[must_use]
    pub fn is_standard_output(&self) -> bool {
        matches!(self.place, Place::Stream(Stream::Output(_)))
    }

    /// The path of the file that will appear, behind symbolic links; `None` if the bytes go to a device or a pipe.
    #[must_use]
    pub fn path(&self) -> Option<&Path> {
        match &self.place {
            Place::Path { path, .. } => Some(path),
            Place::Stream(_) => None,
        }
    }

    /// How many bytes it has so far.
    ///
    /// # Errors
    ///
    /// The system's error, such as that of a full disk.
    pub fn bytes(&mut self) -> io::Result<u64> {
        self.file.flush()?;
        self.file.get_ref().metadata().map(|found| found.len())
    }

    /// Gives the file its name; returns its size in bytes.
    ///
    /// # Errors
    ///
    /// The system's error; nothing is left behind.
    pub fn commit(self) -> io::Result<u64> {
        self.complete()?.appear()
    }

    /// Gives several files their names, in this order, after all are complete.
    ///
    /// Processes that do so at the same time in the same folder take turns, so that the files that stay are all
    /// from the same one.
    ///
    /// # Errors
    ///
    /// As [`Aside::commit`]; if not all files can be completed, none appears.
    pub fn commit_together(files: impl IntoIterator<Item = Self>) -> io::Result<()> {
        let files = files.into_iter().map(Self::complete).collect::<io::Result<Vec<_>>>()?;
        let _turn = turn(&files);
        files.into_iter().try_for_each(|file| file.appear().map(drop))
    }

    /// Starts a file whose whole content is at hand.
    ///
    /// # Errors
    ///
    /// As [`Aside::create`].
    pub fn with_content(path: &Path, bytes: &[u8]) -> io::Result<Self> {
        let mut aside = Self::create(path)?;
        aside.write_all(bytes)?;
        Ok(aside)
    }

    /// Writes a file whose whole content is at hand.
    ///
    /// # Errors
    ///
    /// As [`Aside::create`] and [`Aside::commit`]; nothing is left behind.
    pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
        Self::with_content(path, bytes)?.commit().map(drop)
    }

    /// All bytes on the disk.
    fn complete(self) -> io::Result<Complete> {
        let file = self.file.into_inner().map_err(io::IntoInnerError::into_error)?;
        if matches!(self.place, Place::Path { .. }) {
            file.sync_all()?;
        }
        Ok(Complete { file, place: self.place })
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

/// A file that only lacks its name.
struct Complete {
    file: File,
    place: Place,
}

impl Complete {
    fn appear(mut self) -> io::Result<u64> {
        let bytes = self.file.metadata()?.len();
        match self.place {
            Place::Path { temporary, path } => {
                keep_rights(&self.file, &path);
                temporary.persist(path).map_err(|error| error.error)?;
            }
            Place::Stream(stream) => {
                let mut stream = match stream {
                    Stream::Output(file) | Stream::Open(file) => file,
                    Stream::Pipe(path) => OpenOptions::new().write(true).open(path)?,
                };
                self.file.rewind()?;
                io::copy(&mut self.file, &mut stream)?;
            }
        }
        Ok(bytes)
    }

    fn folder(&self) -> Option<&Path> {
        match &self.place {
            Place::Path { path, .. } => Some(folder_of(path)),
            Place::Stream(_) => None,
        }
    }
}

/// Locks of the folders of these files, each once and always in the same order. Where folders cannot be locked,
/// nobody waits.
fn turn(files: &[Complete]) -> Vec<File> {
    let folders: BTreeSet<PathBuf> =
        files.iter().filter_map(|file| file.folder()?.canonicalize().ok()).collect();
    let locked = |folder: PathBuf| {
        let folder = File::open(folder).ok()?;
        let (tries, distance) = TURN;
        for _ in 0..tries {
            match folder.try_lock() {
                Err(TryLockError::WouldBlock) => sleep(distance),
                Ok(()) | Err(TryLockError::Error(_)) => break,
            }
        }
        Some(folder)
    };
    folders.into_iter().filter_map(locked).collect()
}

/// A temporary file that has no name.
fn without_name() -> io::Result<File> {
    tempfile::tempfile().map_err(|error| match error.kind() {
        io::ErrorKind::StorageFull => error,
        _ => {
            let folder = std::env::temp_dir();
            let message = format!(
                "no temporary file in {}, expected TMPDIR to name a folder to write in",
                folder.display()
            );
            io::Error::new(io::ErrorKind::InvalidInput, message)
        }
    })
}

/// A temporary file beside what a path leads to.
fn beside(path: &Path) -> io::Result<(File, Place)> {
    let path = followed(path)?;
    if path.file_name().is_none() {
        return Err(refused("no file name"));
    }
    let folder = folder_of(&path);
    remove_abandoned(folder);
    let (file, temporary) = temporary(folder)?;
    Ok((file, Place::Path { temporary, path }))
}

/// A file under a temporary name, locked for as long as it is open where the system has locks.
fn temporary(folder: &Path) -> io::Result<(File, TempPath)> {
    let mut tries = 0;
    loop {
        let mut builder = tempfile::Builder::new();
        builder.prefix(PREFIX);
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let (file, temporary) = builder.tempfile_in(folder)?.into_parts();
        // Without locks nobody removes it either.
        let _ = file.lock();
        tries += 1;
        if is_at(&file, &temporary) || tries == MOST_TRIES {
            return Ok((file, temporary));
        }
    }
}

/// Removes the temporary files of processes that have ended, once for each folder: nobody holds their locks.
fn remove_abandoned(folder: &Path) {
    static DONE: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let Ok(known) = folder.canonicalize() else { return };
    if !DONE.lock().unwrap_or_else(PoisonError::into_inner).insert(known) {
        return;
    }
    let Ok(entries) = folder.read_dir() else { return };
    for entry in entries.flatten() {
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if !is_file || !entry.file_name().as_encoded_bytes().starts_with(PREFIX.as_bytes()) {
            continue;
        }
        let path = entry.path();
        let Ok(file) = OpenOptions::new().write(true).open(&path) else { continue };
        if file.try_lock().is_ok() && is_at(&file, &path) {
            // What cannot be removed belongs to somebody else.
            let _ = std::fs::remove_file(&path);
        }
    }
}

/// The path behind symbolic links, which need not lead to anything.
fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        match path.read_link() {
            Ok(to) => path = path.parent().unwrap_or(Path::new("")).join(to),
            Err(_) => return Ok(path),
        }
    }
    Err(refused("symbolic links in a circle"))
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn refused(found: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, format!("{found}, expected a file to write"))
}

/// The stream that an existing path leads to, or `None` for a file.
#[cfg(unix)]
fn stream(path: &Path, found: &Metadata) -> io::Result<Option<Stream>> {
    use std::os::fd::AsFd as _;
    use std::os::unix::fs::FileTypeExt as _;
    let is_found = |stream: &File| stream.metadata().is_ok_and(|own| is_same(&own, found));
    if let Some(output) = duplicate(io::stdout().as_fd()).filter(is_found) {
        return Ok(Some(Stream::Output(output)));
    }
    if let Some(error) = duplicate(io::stderr().as_fd()).filter(is_found) {
        return Ok(Some(Stream::Open(error)));
    }
    let kind = found.file_type();
    if kind.is_file() {
        Ok(None)
    } else if kind.is_dir() {
        Err(refused("a folder"))
    } else if kind.is_socket() {
        Err(refused("a socket"))
    } else if kind.is_fifo() {
        Ok(Some(Stream::Pipe(path.to_owned())))
    } else {
        Ok(Some(Stream::Open(OpenOptions::new().write(true).open(path)?)))
    }
}

#[cfg(unix)]
fn duplicate(stream: std::os::fd::BorrowedFd<'_>) -> Option<File> {
    stream.try_clone_to_owned().ok().map(File::from)
}

#[cfg(not(unix))]
fn stream(_path: &Path, found: &Metadata) -> io::Result<Option<Stream>> {
    if found.is_file() { Ok(None) } else { Err(refused("a folder")) }
}

/// Whether an open file is what is at this path now.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    match (file.metadata(), path.symlink_metadata()) {
        (Ok(file), Ok(found)) => is_same(&file, &found),
        _ => false,
    }
}

#[cfg(unix)]
fn is_same(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    (a.dev(), a.ino()) == (b.dev(), b.ino())
}

/// Elsewhere a file that is open cannot be removed.
#[cfg(not(unix))]
fn is_at(_file: &File, _path: &Path) -> bool {
    true
}

/// Gives a file mode, owner and group of the one that it will replace, as far as the system allows it.
#[cfg(unix)]
fn keep_rights(file: &File, path: &Path) {
    use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _, fchown};
    /// Rights to read, write and execute; those to act as the owner are not passed on.
    const RIGHTS: u32 = 0o777;
    let (Ok(old), Ok(new)) = (path.metadata(), file.metadata()) else { return };
    if new.gid() != old.gid() {
        let _ = fchown(file, None, Some(old.gid()));
    }
    if new.uid() != old.uid() {
        let _ = fchown(file, Some(old.uid()), None);
    }
    let _ = file.set_permissions(std::fs::Permissions::from_mode(old.mode() & RIGHTS));
}

#[cfg(not(unix))]
fn keep_rights(_file: &File, _path: &Path) {}

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
        assert_eq!(error, "a folder, expected a file to write");
        let error = Aside::write_whole(Path::new("x/.."), b"x").unwrap_err().to_string();
        assert_eq!(error, "no file name, expected a file to write");
        assert!(Aside::write_whole(&folder.path().join("no/such/folder/x"), b"x").is_err());
        assert_eq!(folder.path().read_dir().unwrap().count(), 0);
    }

    #[test]
    fn files_that_belong_together_appear_together_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a", "b"].map(|name| folder.path().join(name));
        let both = |text: &[u8]| [&a, &b].map(|path| Aside::with_content(path, text).unwrap());
        Aside::commit_together(both(b"1")).unwrap();
        drop(both(b"2"));
        // As many writers at once as there are threads, each with a content of its own.
        std::thread::scope(|scope| {
            for content in "abcdefgh".chars() {
                let files = both(content.to_string().as_bytes());
                scope.spawn(|| Aside::commit_together(files).unwrap());
            }
        });
        assert_eq!(std::fs::read(&a).unwrap(), std::fs::read(&b).unwrap());
        assert_eq!(folder.path().read_dir().unwrap().count(), 2);
    }

    #[cfg(unix)]
    mod unix {
        use std::os::unix::fs::{PermissionsExt, symlink};

        use super::*;

        fn mode(path: &Path) -> u32 {
            path.metadata().unwrap().permissions().mode() & 0o7777
        }

        #[test]
        fn a_replaced_file_keeps_its_mode_and_a_new_one_has_that_of_any_new_file() {
            let folder = tempfile::tempdir().unwrap();
            let [path, other] = ["x", "other"].map(|name| folder.path().join(name));
            File::create(&other).unwrap();
            Aside::write_whole(&path, b"new").unwrap();
            assert_eq!(mode(&path), mode(&other));
            for rights in [0o600, 0o644, 0o660, 0o777, 0o400] {
                std::fs::set_permissions(&path, PermissionsExt::from_mode(rights)).unwrap();
                Aside::write_whole(&path, b"again").unwrap();
                assert_eq!(mode(&path), rights);
            }
        }

        #[test]
        fn links_stay_and_what_they_lead_to_is_replaced() {
            let folder = tempfile::tempdir().unwrap();
            let at = |name: &str| folder.path().join(name);
            std::fs::create_dir(at("deep")).unwrap();
            symlink("deep/file", at("relative")).unwrap();
            symlink(at("relative"), at("chain")).unwrap();
            symlink("deep", at("folder")).unwrap();
            for (text, name) in [("1", "relative"), ("2", "chain"), ("3", "folder/file")] {
                // At first the links lead to nothing.
                Aside::write_whole(&at(name), text.as_bytes()).unwrap();
                assert_eq!(std::fs::read_to_string(at("deep/file")).unwrap(), text);
            }
            assert!(at("relative").is_symlink() && at("chain").is_symlink());
            assert_eq!(at("deep").read_dir().unwrap().count(), 1);
            symlink("circle", at("circle")).unwrap();
            let error = Aside::create(&at("circle")).unwrap_err().to_string();
            assert_eq!(error, "symbolic links in a circle, expected a file to write");
        }

        #[test]
        fn devices_and_pipes_are_written_to_and_stay() {
            let folder = tempfile::tempdir().unwrap();
            let null = folder.path().join("null");
            symlink("/dev/null", &null).unwrap();
            Aside::write_whole(&null, b"x").unwrap();
            assert!(null.is_symlink() && !Path::new("/dev/null").metadata().unwrap().is_file());
            let pipe = folder.path().join("pipe");
            let made = std::process::Command::new("mkfifo").arg(&pipe).status();
            assert!(made.unwrap().success());
            // To check it must not wait for a reader.
            drop(Aside::create(&pipe).unwrap());
            let from = pipe.clone();
            let reader = std::thread::spawn(move || std::fs::read(from).unwrap());
            let content = vec![7; 3 * BUFFER_BYTES / 2];
            Aside::write_whole(&pipe, &content).unwrap();
            assert!(reader.join().unwrap() == content);
            assert!(!pipe.metadata().unwrap().is_file());
        }

        #[test]
        fn what_ended_processes_left_is_removed_and_nothing_else() {
            let folder = tempfile::tempdir().unwrap();
            let at = |name: &str| folder.path().join(name);
            let left = ["a", "b"].map(|name| at(&format!("{PREFIX}{name}")));
            let other = [".upglow", "x", ".upglowing"].map(at);
            left.iter().chain(&other).for_each(|path| std::fs::write(path, "half").unwrap());
            std::fs::create_dir(at(".upglow-folder")).unwrap();
            symlink("x", at(".upglow-link")).unwrap();
            // Another process that is still writing.
            let alive = at(".upglow-alive");
            let writer = File::create(&alive).unwrap();
            writer.lock().unwrap();
            let aside = Aside::create(&at("new")).unwrap();
            assert!(!left.iter().any(|path| path.exists()));
            assert!(other.iter().all(|path| path.exists()) && alive.exists());
            assert!(at(".upglow-folder").exists() && at(".upglow-link").is_symlink());
            let Place::Path { temporary, .. } = &aside.place else { panic!("a file") };
            let again = File::open(temporary).unwrap();
            assert!(matches!(again.try_lock(), Err(TryLockError::WouldBlock)));
        }
    }
}
