//! Files that the program reads and writes.

use std::path::Path;

use upglow::{Cube, ReadCubeError};
pub(crate) use upglow_terminal::files::{check_output, make_folder, read_text, size, write};
use upglow_terminal::{Failure, io_message};

const A_CUBE: &str = "a cube made by `upglow build`";

/// Reads a cube, or says in one line why the file is none.
pub(crate) fn read_cube(path: &Path) -> Result<Cube, Failure> {
    Cube::read(path).map_err(|error| match error {
        ReadCubeError::Io(error) => {
            Failure::file(path, format_args!("{}, expected {A_CUBE}", io_message(&error)))
        }
        error => Failure::file(path, error),
    })
}

/// Checks that writing `output` does not replace the cube that was read from `input`.
pub(crate) fn check_distinct(input: &Path, output: &Path) -> Result<(), Failure> {
    if is_same(input, output) {
        return Err(Failure::file(output, "the cube itself, expected another file to write"));
    }
    Ok(())
}

/// Whether two paths lead to one file or folder that is there.
pub(crate) fn is_same(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}
