//! Reading and writing cubes, and where paths lead.

use std::path::Path;

use upglow::{Cube, CubeFileError};
use upglow_image::{Hash, WriteExrError};
use upglow_terminal::Failure;

pub(crate) use upglow_terminal::files::{
    aside, check_ending, check_has_place, check_is_free, check_output, hash_of, make_folder,
    note_input, read_text, unwritten, write, write_together,
};

/// The ending of cube files.
pub(crate) const CUBE: &[&str] = &["safetensors"];
pub(crate) const CSV: &[&str] = &["csv"];
/// The endings of pages.
pub(crate) const PAGE: &[&str] = &["html", "htm"];
pub(crate) const PNG: &[&str] = &["png"];
pub(crate) const SVG: &[&str] = &["svg"];

const A_CUBE: &str = "a cube made by `upglow build`";

/// Reads a cube.
pub(crate) fn read_cube(path: &Path) -> Result<Cube, Failure> {
    note_input(path)?;
    Cube::read(path).map_err(|error| match error {
        CubeFileError::Io { cause, .. } => Failure::system(path, &cause, A_CUBE),
        CubeFileError::Content { cause, .. } => Failure::file(path, cause),
        error => Failure::file(path, error),
    })
}

/// Writes a cube.
pub(crate) fn write_cube(path: &Path, cube: &Cube) -> Result<(), Failure> {
    write(path, &cube.to_bytes())
}

/// The failure to write a picture.
pub(crate) fn unwritten_exr(path: &Path, error: WriteExrError) -> Failure {
    match error {
        WriteExrError::Io(error) => unwritten(path, &error),
        error => Failure::file(path, error),
    }
}

/// The hash of a file.
pub(crate) fn hash(path: &Path) -> Result<Hash, Failure> {
    Hash::of_file(path).map_err(|error| Failure::system(path, &error, "a file to read"))
}

/// The size of a file.
pub(crate) fn bytes(path: &Path) -> Result<u64, Failure> {
    path.metadata().map(|found| found.len()).map_err(|error| Failure::system(path, &error, A_CUBE))
}

/// Whether two paths lead to the same existing file or folder.
pub(crate) fn is_same(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// Whether a path, which need not exist, is inside a folder or the folder itself.
pub(crate) fn is_inside(path: &Path, folder: &Path) -> bool {
    let there = path.ancestors().find_map(|path| {
        let is_here = path.as_os_str().is_empty();
        if is_here { Path::new(".") } else { path }.canonicalize().ok()
    });
    matches!((there, folder.canonicalize()), (Some(a), Ok(b)) if a.starts_with(&b))
}
