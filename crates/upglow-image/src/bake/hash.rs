//! What a baked file was made from, as hashes.

use std::fmt;
use std::io::{self, Read};
use std::path::Path;

use sha2::{Digest, Sha256};
use upglow::open_input;

use super::attributes;
use super::png;
use crate::exr::reader::ExrReader;

/// A SHA-256 as 64 hexadecimal digits.
///
/// What makes a baked file is its picture, and the [`Baker`](crate::Baker): the cube, the form, the options and the
/// version of this library. Each has a hash, and the file states the hash of both.
///
/// # Examples
///
/// ```
/// use upglow_image::Hash;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("a.png");
/// std::fs::write(&path, b"abc")?;
/// assert_eq!(Hash::of_file(&path)?, Hash::of(b"abc"));
/// assert_eq!(Hash::of(b"abc").to_string().len(), 64);
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
pub struct Hash(String);

impl Hash {
    /// The hash of some bytes.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Self {
        Self::finished(Sha256::new_with_prefix(bytes))
    }

    /// The hash of all bytes of a file, which is not held in memory.
    ///
    /// # Errors
    ///
    /// The system's error if the file cannot be read.
    pub fn of_file(path: impl AsRef<Path>) -> io::Result<Self> {
        /// Bytes that are read at a time.
        const PIECE: usize = 1 << 16;
        let (mut file, mut piece) = (open_input(path.as_ref())?, vec![0; PIECE]);
        let mut hash = Sha256::new();
        loop {
            match file.read(&mut piece)? {
                0 => return Ok(Self::finished(hash)),
                count => hash.update(&piece[..count]),
            }
        }
    }

    /// What the file of a picture states that was made by the baker with this hash; see
    /// [`Baker::hash`](crate::Baker::hash).
    #[must_use]
    pub fn with_picture(&self, picture: &Self) -> Self {
        Self::of(format!("{self} {picture}").as_bytes())
    }

    /// What the file at `path` states; `None` if it is not there or states nothing.
    pub fn stated(path: impl AsRef<Path>) -> Option<Self> {
        let path = path.as_ref();
        let Ok(reader) = ExrReader::open(path) else { return png::made(path).map(Self) };
        Some(Self(reader.attributes().get(attributes::MADE)?.as_text()?.to_owned()))
    }

    fn finished(hash: Sha256) -> Self {
        Self(hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
    }
}

impl fmt::Display for Hash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}
