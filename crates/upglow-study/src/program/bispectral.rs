//! Measured fluorescent materials, as the BFC-450 spectrofluorimeter writes them.

use std::path::{Path, PathBuf};

use upglow_color::DonaldsonMatrix;
use upglow_terminal::{Failure, files};

use crate::samples::Sample;

/// The material of every `.BFC` file of a folder, in the order of their names; none without a folder.
///
/// # Errors
///
/// [`Failure`] if the folder or a file cannot be read, a file is invalid, or there is none.
pub(crate) fn read_folder(folder: Option<&Path>) -> Result<Vec<Sample>, Failure> {
    let Some(folder) = folder else { return Ok(Vec::new()) };
    let unreadable = |error| Failure::system(folder, &error, "a folder of BFC-450 matrices (.BFC)");
    let entries = folder.read_dir().map_err(unreadable)?;
    let mut paths: Vec<PathBuf> = Vec::new();
    for entry in entries {
        let path = entry.map_err(unreadable)?.path();
        if path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("bfc")) {
            paths.push(path);
        }
    }
    if paths.is_empty() {
        return Err(Failure::file(folder, "no file .BFC, expected BFC-450 matrices"));
    }
    paths.sort();
    paths.iter().map(|path| read(path)).collect()
}

fn read(path: &Path) -> Result<Sample, Failure> {
    let text = files::read_text(path, "a BFC-450 matrix, a text file")?;
    let matrix = DonaldsonMatrix::from_bfc(&text).map_err(|error| Failure::file(path, error))?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Sample::try_new(name, matrix).map_err(|error| Failure::file(path, error))
}

/// The measured materials beside the repository; none where it is absent.
#[cfg(test)]
pub(crate) fn shared() -> Vec<Sample> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/bispectral");
    let found = folder.is_dir().then_some(folder.as_path());
    read_folder(found).unwrap_or_else(|failure| panic!("{failure:?}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_measured_materials_are_read() {
        let names: Vec<String> = shared().into_iter().map(|found| found.name).collect();
        if names.is_empty() {
            eprintln!("skipped: the_measured_materials_are_read (no ../shared/data/bispectral)");
            return;
        }
        assert_eq!(names, ["CIBA12", "HERPIORA", "POLGREE", "TEXTYELL"]);
    }
}
