//! The pictures that a command reads, and the files that it writes for them.

use std::collections::HashMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use upglow_terminal::Failure;

/// Suffixes of the pictures in a folder.
const SUFFIXES: [&str; 4] = ["exr", "tif", "tiff", "png"];

/// The pictures of a command.
#[derive(Debug, Default)]
pub(crate) struct Inputs {
    /// The given pictures, and those in the given folders, sorted by name within each folder.
    pub(crate) pictures: Vec<PathBuf>,
    /// What the folders hold beside them, without hidden files.
    pub(crate) left_out: Vec<PathBuf>,
}

/// The pictures among the inputs and in the folders among them.
pub(crate) fn find(inputs: &[PathBuf]) -> Result<Inputs, Failure> {
    let mut found = Inputs::default();
    for input in inputs {
        if !input.is_dir() {
            found.pictures.push(input.clone());
            continue;
        }
        let before = found.pictures.len();
        add_folder(input, &mut found)?;
        if found.pictures.len() == before {
            let suffixes = SUFFIXES.join(", ");
            return Err(Failure::file(
                input,
                format!("a folder without pictures, expected files that end in {suffixes}"),
            ));
        }
    }
    Ok(found)
}

/// Checks that a file can be read, before work on others starts.
pub(crate) fn check_there(path: &Path, expected: &str) -> Result<(), Failure> {
    match std::fs::File::open(path) {
        Ok(_) if path.is_dir() => {
            Err(Failure::file(path, format!("a folder, expected {expected}")))
        }
        Ok(_) => Ok(()),
        Err(error) => Err(Failure::system(path, &error, expected)),
    }
}

fn add_folder(folder: &Path, to: &mut Inputs) -> Result<(), Failure> {
    let unread = |error| Failure::system(folder, &error, "a folder of pictures");
    let mut paths = Vec::new();
    for entry in folder.read_dir().map_err(unread)? {
        paths.push(entry.map_err(unread)?.path());
    }
    paths.retain(|path| !is_hidden(path));
    paths.sort();
    for path in paths {
        let is_picture = !path.is_dir() && is_picture(&path);
        if is_picture { &mut to.pictures } else { &mut to.left_out }.push(path);
    }
    Ok(())
}

/// Whether a file is hidden, as the `._x` that some systems write beside each x.
fn is_hidden(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."))
}

fn is_picture(path: &Path) -> bool {
    let suffix = path.extension().and_then(OsStr::to_str).unwrap_or_default();
    SUFFIXES.iter().any(|known| known.eq_ignore_ascii_case(suffix))
}

/// The output file of each input: the file `output` for a single picture, if `output` ends in `exr`
/// and is not a folder; otherwise a file in the folder `output`, named after the picture and `form`,
/// with the tile number of a UDIM in its place.
pub(crate) fn outputs(
    inputs: &[PathBuf],
    output: &Path,
    form: &str,
) -> Result<Vec<PathBuf>, Failure> {
    let is_exr = output.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("exr"));
    if is_picture(output) && !output.is_dir() {
        return match inputs.len() {
            1 if is_exr => Ok(vec![output.to_owned()]),
            1 => Err(Failure::file(
                output,
                "not an EXR file, expected a name that ends in .exr, or a folder",
            )),
            count => Err(Failure::file(
                output,
                format!("one file for {count} pictures, expected a folder"),
            )),
        };
    }
    let mut outputs: Vec<PathBuf> = Vec::new();
    let mut taken: HashMap<PathBuf, &PathBuf> = HashMap::new();
    for input in inputs {
        let path = output.join(name_of(input, form));
        if let Some(twin) = taken.insert(path.clone(), input) {
            let twin = twin.display();
            return Err(Failure::file(
                input,
                format!("same name as {twin}, expected names that differ without their suffixes"),
            ));
        }
        outputs.push(path);
    }
    Ok(outputs)
}

/// `wall.1001.exr` becomes `wall.material.1001.exr`, which other programs still recognize as a tile.
fn name_of(input: &Path, form: &str) -> PathBuf {
    let stem = input.file_stem().unwrap_or_default().to_string_lossy();
    match stem.rsplit_once(['.', '_']) {
        Some((name, tile)) if is_udim(tile) => {
            let separator = &stem[name.len()..=name.len()];
            format!("{name}.{form}{separator}{tile}.exr").into()
        }
        _ => format!("{stem}.{form}.exr").into(),
    }
}

/// Whether a word is the number of a UDIM tile: four digits, 1001 or greater.
fn is_udim(word: &str) -> bool {
    word.len() == 4 && word.parse().is_ok_and(|tile: u32| tile >= 1001)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_keep_their_tile() {
        let name = |input: &str| name_of(Path::new(input), "material").display().to_string();
        assert_eq!(name("a/wall.png"), "wall.material.exr");
        assert_eq!(name("wall.1001.exr"), "wall.material.1001.exr");
        assert_eq!(name("wall_1002.tif"), "wall.material_1002.exr");
        assert_eq!(name("wall.0001.exr"), "wall.0001.material.exr");
    }

    #[test]
    fn one_picture_may_have_an_output_file_and_two_need_a_folder() {
        let one = [PathBuf::from("a.png")];
        let two = [PathBuf::from("a.png"), PathBuf::from("b.png")];
        let out = Path::new("out.exr");
        assert_eq!(outputs(&one, out, "material"), Ok(vec![PathBuf::from("out.exr")]));
        assert!(outputs(&two, out, "material").is_err());
        assert!(outputs(&one, Path::new("out.png"), "material").is_err());
        let names = outputs(&two, Path::new("out"), "radiance").unwrap();
        assert_eq!(names[1], PathBuf::from("out/b.radiance.exr"));
        let twins = [PathBuf::from("x/a.png"), PathBuf::from("y/a.tif")];
        assert!(outputs(&twins, Path::new("out"), "radiance").is_err());
    }

    #[test]
    fn pictures_of_a_folder_are_sorted() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b.EXR", "a.png", "notes.txt", "._a.png", ".hidden.exr"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let found = find(&[folder.path().to_owned()]).unwrap();
        let names = |paths: &[PathBuf]| -> Vec<String> {
            let name = |path: &PathBuf| path.file_name().map(|n| n.to_string_lossy().into_owned());
            paths.iter().filter_map(name).collect()
        };
        assert_eq!(names(&found.pictures), ["a.png", "b.EXR"]);
        assert_eq!(names(&found.left_out), ["notes.txt"]);
    }
}
