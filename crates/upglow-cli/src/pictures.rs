//! The pictures that a command reads, and the files that it writes for them.

use std::collections::HashMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use upglow_image::SUFFIXES;
use upglow_terminal::Failure;

use crate::files;

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

/// Where the files of a command go.
#[derive(Clone, Debug)]
pub(crate) struct Outputs<'a> {
    /// A file for a single picture, or a folder.
    pub(crate) path: &'a Path,
    /// What the files hold, for their names in a folder.
    pub(crate) form: &'a str,
    /// The ending of the files.
    pub(crate) ending: &'a str,
    /// What tells the files of one picture apart, in their names; empty for one file of each picture.
    pub(crate) variants: &'a [String],
}

impl Outputs<'_> {
    /// The files of each input: for a single picture `path`, if it ends in a suffix of pictures and is
    /// not a folder; otherwise files in the folder `path`, named after the picture and the form, with
    /// the tile number of a UDIM in its place.
    pub(crate) fn of(&self, inputs: &[PathBuf]) -> Result<Vec<Vec<PathBuf>>, Failure> {
        if is_picture(self.path) && !self.path.is_dir() {
            return match inputs.len() {
                1 => {
                    files::check_ending(self.path, &[self.ending])?;
                    Ok(vec![self.variants_of(self.path)])
                }
                count => Err(Failure::file(
                    self.path,
                    format!("one file for {count} pictures, expected a folder"),
                )),
            };
        }
        let mut outputs = Vec::new();
        let mut taken: HashMap<PathBuf, &PathBuf> = HashMap::new();
        for input in inputs {
            let files = self.variants_of(&self.path.join(name_of(input, self.form, self.ending)));
            for path in &files {
                if let Some(twin) = taken.insert(path.clone(), input) {
                    let twin = twin.display();
                    let message = format!(
                        "same name as {twin}, expected names that differ without their suffixes"
                    );
                    return Err(Failure::file(input, message));
                }
            }
            outputs.push(files);
        }
        Ok(outputs)
    }

    /// `wall.png` becomes `wall.A.png` and `wall.D65.png`.
    fn variants_of(&self, path: &Path) -> Vec<PathBuf> {
        if self.variants.is_empty() {
            return vec![path.to_owned()];
        }
        self.variants
            .iter()
            .map(|word| path.with_file_name(name_of(path, word, self.ending)))
            .collect()
    }
}

/// `wall.1001.exr` becomes `wall.material.1001.exr`, which other programs still recognize as a tile.
fn name_of(input: &Path, word: &str, ending: &str) -> PathBuf {
    let stem = input.file_stem().unwrap_or_default().to_string_lossy();
    match stem.rsplit_once(['.', '_']) {
        Some((name, tile)) if is_udim(tile) => {
            let separator = &stem[name.len()..=name.len()];
            format!("{name}.{word}{separator}{tile}.{ending}").into()
        }
        _ => format!("{stem}.{word}.{ending}").into(),
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
        let name = |input: &str| name_of(Path::new(input), "material", "exr").display().to_string();
        assert_eq!(name("a/wall.png"), "wall.material.exr");
        assert_eq!(name("wall.1001.exr"), "wall.material.1001.exr");
        assert_eq!(name("wall_1002.tif"), "wall.material_1002.exr");
        assert_eq!(name("wall.0001.exr"), "wall.0001.material.exr");
    }

    #[test]
    fn one_picture_may_have_an_output_file_and_two_need_a_folder() {
        let one = [PathBuf::from("a.png")];
        let two = [PathBuf::from("a.png"), PathBuf::from("b.png")];
        let to = |path, form, inputs: &[PathBuf]| {
            Outputs { path: Path::new(path), form, ending: "exr", variants: &[] }.of(inputs)
        };
        assert_eq!(to("out.exr", "material", &one), Ok(vec![vec![PathBuf::from("out.exr")]]));
        assert!(to("out.exr", "material", &two).is_err());
        assert!(to("out.png", "material", &one).is_err());
        let names = to("out", "radiance", &two).unwrap();
        assert_eq!(names[1], [PathBuf::from("out/b.radiance.exr")]);
        let twins = [PathBuf::from("x/a.png"), PathBuf::from("y/a.tif")];
        assert!(to("out", "radiance", &twins).is_err());
    }

    #[test]
    fn files_of_several_lights_are_named_after_them() {
        let lights = ["A".to_owned(), "D65".to_owned()];
        let names = |path, input: &str| {
            let outputs = Outputs {
                path: Path::new(path),
                form: "radiance",
                ending: "png",
                variants: &lights,
            };
            let files = outputs.of(&[input.into()]).unwrap().concat();
            files.iter().map(|path| path.display().to_string()).collect::<Vec<_>>()
        };
        assert_eq!(names("x.png", "a.exr"), ["x.A.png", "x.D65.png"]);
        let tiles = ["out/a.radiance.A.1001.png", "out/a.radiance.D65.1001.png"];
        assert_eq!(names("out", "a.1001.exr"), tiles);
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
