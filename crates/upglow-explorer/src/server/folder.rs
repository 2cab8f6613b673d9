//! The folder of dropped files.

use std::fs::File;
use std::io;
use std::path::Path;

use tempfile::TempDir;

/// What the names of such folders begin with.
const PREFIX: &str = "upglow-explore-";

/// A folder for this user alone. It is removed at the end; where the server is killed, by the next one.
#[derive(Debug)]
pub(super) struct PrivateFolder {
    folder: TempDir,
    /// Its lock says that the server runs, where the system can lock folders.
    _lock: Option<File>,
}

impl PrivateFolder {
    /// A new folder in the system's temporary one.
    pub(super) fn new() -> io::Result<Self> {
        Self::new_in(&std::env::temp_dir())
    }

    fn new_in(parent: &Path) -> io::Result<Self> {
        remove_abandoned(parent);
        loop {
            let folder = named(parent)?;
            let lock = File::open(folder.path()).ok();
            if let Some(lock) = &lock {
                lock.lock()?;
            }
            // Another server may have taken it for an abandoned one before it was locked.
            if folder.path().is_dir() {
                return Ok(Self { folder, _lock: lock });
            }
        }
    }

    pub(super) fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Removes it.
    pub(super) fn close(self) -> io::Result<()> {
        self.folder.close()
    }
}

fn named(parent: &Path) -> io::Result<TempDir> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    let builder = {
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(std::fs::Permissions::from_mode(0o700))
    };
    builder.prefix(PREFIX).tempdir_in(parent)
}

/// Removes the folders of servers that were killed: those that nobody has locked.
fn remove_abandoned(parent: &Path) {
    let entries = parent.read_dir().into_iter().flatten().flatten();
    for entry in entries {
        let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
        if !is_folder || !entry.file_name().as_encoded_bytes().starts_with(PREFIX.as_bytes()) {
            continue;
        }
        let Ok(folder) = File::open(entry.path()) else { continue };
        if folder.try_lock().is_ok() {
            // What cannot be removed belongs to somebody else.
            let _ = std::fs::remove_dir_all(entry.path());
        }
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn folders_of_killed_servers_are_removed_and_those_of_others_stay() {
        let parent = tempfile::tempdir().unwrap();
        let at = |name: &str| parent.path().join(name);
        for name in ["upglow-explore-killed", "upglow-explore-empty", "other"] {
            std::fs::create_dir(at(name)).unwrap();
        }
        std::fs::write(at("upglow-explore-killed/1.exr"), "pixels").unwrap();
        std::fs::write(at("upglow-explore-file"), "text").unwrap();
        std::os::unix::fs::symlink(at("other"), at("upglow-explore-link")).unwrap();
        let running = PrivateFolder::new_in(parent.path()).unwrap();
        let second = PrivateFolder::new_in(parent.path()).unwrap();
        assert!(running.path().is_dir() && second.path().is_dir());
        for name in ["other", "upglow-explore-file", "upglow-explore-link"] {
            assert!(at(name).exists(), "{name}");
        }
        for name in ["upglow-explore-killed", "upglow-explore-empty"] {
            assert!(!at(name).exists(), "{name}");
        }
    }
}
