//! The pictures that a command reads, and the files that it writes for them.

use std::collections::HashMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use upglow_image::SUFFIXES;
use upglow_terminal::Failure;

use crate::files;
use crate::name_pattern::{NamePattern, is_udim};

/// The pictures of a command.
#[derive(Debug, Default)]
pub(crate) struct Inputs {
    /// The given pictures, and those in the given folders, sorted by name within each folder.
    pub(crate) pictures: Vec<Input>,
    /// What the folders hold beside them, without hidden files.
    pub(crate) left_out: Vec<PathBuf>,
}

/// A picture of a command.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Input {
    pub(crate) path: PathBuf,
    /// The folder of the picture inside the given one.
    subfolder: PathBuf,
    /// The number that a word in the given name replaces.
    number: Option<String>,
}

/// Whether the subfolders of a folder are searched too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Depth {
    Folder,
    Subfolders,
}

impl From<PathBuf> for Input {
    fn from(path: PathBuf) -> Self {
        Self { path, ..Self::default() }
    }
}

impl Inputs {
    /// The files of the pictures.
    pub(crate) fn paths(&self) -> Vec<PathBuf> {
        self.pictures.iter().map(|input| input.path.clone()).collect()
    }
}

/// The pictures among the inputs, those that a word for a number stands for, and those in the folders.
pub(crate) fn find(inputs: &[PathBuf], depth: Depth) -> Result<Inputs, Failure> {
    let mut found = Inputs::default();
    for input in inputs {
        if input.is_dir() {
            let before = found.pictures.len();
            add_folder(input, Path::new(""), depth, &mut found)?;
            if found.pictures.len() == before {
                let suffixes = SUFFIXES.join(", ");
                return Err(Failure::file(
                    input,
                    format!("a folder without pictures, expected files that end in {suffixes}"),
                ));
            }
            continue;
        }
        // A file of this very name has priority.
        let pattern = if input.exists() { None } else { NamePattern::of(input)? };
        match pattern {
            None => found.pictures.push(input.clone().into()),
            Some(pattern) => {
                let tile = |(number, path)| Input { number: Some(number), ..Input::from(path) };
                found.pictures.extend(pattern.files()?.into_iter().map(tile));
            }
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

/// Adds the pictures of a folder, or of one inside it.
fn add_folder(
    folder: &Path,
    subfolder: &Path,
    depth: Depth,
    to: &mut Inputs,
) -> Result<(), Failure> {
    let here = folder.join(subfolder);
    let unread = |error| Failure::system(&here, &error, "a folder of pictures");
    let mut entries = Vec::new();
    for entry in here.read_dir().map_err(unread)? {
        let entry = entry.map_err(unread)?;
        // A link to a folder is not followed: it may lead back.
        entries.push((entry.path(), entry.file_type().map_err(unread)?.is_dir()));
    }
    entries.retain(|(path, _)| !is_hidden(path));
    entries.sort();
    for (path, is_folder) in entries {
        if is_folder && depth == Depth::Subfolders {
            let inner = subfolder.join(path.file_name().unwrap_or_default());
            add_folder(folder, &inner, depth, to)?;
        } else if !path.is_dir() && is_picture(&path) {
            let subfolder = subfolder.to_owned();
            to.pictures.push(Input { path, subfolder, number: None });
        } else {
            to.left_out.push(path);
        }
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

/// Whether a name ends as those of files do, which a new folder would not.
fn is_named_as_file(path: &Path) -> bool {
    const OTHERS: &[&str] = &["pdf", "csv", "json", "txt", "gif", "webp", "psd", "bmp"];
    let known = [&SUFFIXES[..], files::CUBE, files::PAGE, files::SVG, OTHERS].concat();
    let suffix = path.extension().and_then(OsStr::to_str).unwrap_or_default();
    known.iter().any(|known| known.eq_ignore_ascii_case(suffix))
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
    /// The files of each input: `path`, if it ends in a suffix of files and is not a folder, for a
    /// single picture or with a word for the numbers of all; otherwise files in the folder `path`, in the
    /// subfolder of the picture and named after it and the form, with the tile number of a UDIM in its
    /// place.
    pub(crate) fn of(&self, inputs: &[Input]) -> Result<Vec<Vec<PathBuf>>, Failure> {
        let is_file = is_named_as_file(self.path) && !self.path.is_dir();
        let pattern = if is_file { NamePattern::of(self.path)? } else { None };
        if is_file {
            files::check_ending(self.path, &[self.ending])?;
        }
        if is_file && pattern.is_none() && inputs.len() != 1 {
            let message = format!(
                "one file for {} pictures, expected a folder, or a name with <UDIM> or %04d",
                inputs.len()
            );
            return Err(Failure::file(self.path, message));
        }
        let mut outputs = Vec::new();
        let mut taken: HashMap<PathBuf, &PathBuf> = HashMap::new();
        for input in inputs {
            let output = match &pattern {
                Some(pattern) => {
                    let number = input.number.as_ref().ok_or_else(|| {
                        let word = pattern.word();
                        let message = format!("no number for {word}, expected inputs with {word}");
                        Failure::file(self.path, message)
                    })?;
                    pattern.with(number)
                }
                None if is_file => self.path.to_owned(),
                None => {
                    let folder = self.path.join(&input.subfolder);
                    folder.join(name_of(&input.path, self.form, self.ending))
                }
            };
            let files = self.variants_of(&output);
            for path in &files {
                if let Some(twin) = taken.insert(path.clone(), &input.path) {
                    let twin = twin.display();
                    let message = format!(
                        "same name as {twin}, expected names that differ without their suffixes"
                    );
                    return Err(Failure::file(&input.path, message));
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
        let inputs = |paths: &[&str]| -> Vec<Input> {
            paths.iter().map(|path| PathBuf::from(path).into()).collect()
        };
        let (one, two) = (inputs(&["a.png"]), inputs(&["a.png", "b.png"]));
        let to = |path, form, inputs: &[Input]| {
            Outputs { path: Path::new(path), form, ending: "exr", variants: &[] }.of(inputs)
        };
        assert_eq!(to("out.exr", "material", &one), Ok(vec![vec![PathBuf::from("out.exr")]]));
        assert!(to("out.exr", "material", &two).is_err());
        assert!(to("out.png", "material", &one).is_err());
        let names = to("out", "radiance", &two).unwrap();
        assert_eq!(names[1], [PathBuf::from("out/b.radiance.exr")]);
        let twins = inputs(&["x/a.png", "y/a.tif"]);
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
            let files = outputs.of(&[PathBuf::from(input).into()]).unwrap().concat();
            files.iter().map(|path| path.display().to_string()).collect::<Vec<_>>()
        };
        assert_eq!(names("x.png", "a.exr"), ["x.A.png", "x.D65.png"]);
        let tiles = ["out/a.radiance.A.1001.png", "out/a.radiance.D65.1001.png"];
        assert_eq!(names("out", "a.1001.exr"), tiles);
    }

    #[test]
    fn pictures_of_a_folder_are_sorted_and_subfolders_kept() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(folder.path().join("c/d")).unwrap();
        std::fs::create_dir(folder.path().join(".hidden")).unwrap();
        let names =
            ["b.EXR", "a.png", "notes.txt", "._a.png", ".hidden/x.exr", "c/a.png", "c/d/a.jpg"];
        for name in names {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let find = |depth| {
            let found = find(&[folder.path().to_owned()], depth).unwrap();
            let inside = |paths: &[PathBuf]| -> Vec<String> {
                let name = |path: &PathBuf| {
                    path.strip_prefix(folder.path()).unwrap().display().to_string()
                };
                paths.iter().map(name).collect()
            };
            let to = Outputs { path: Path::new("o"), form: "f", ending: "exr", variants: &[] };
            let outputs = to.of(&found.pictures).unwrap().concat();
            let outputs: Vec<String> = outputs.iter().map(|p| p.display().to_string()).collect();
            (inside(&found.paths()), inside(&found.left_out), outputs)
        };
        let (pictures, left_out, _) = find(Depth::Folder);
        assert_eq!(
            (pictures, left_out),
            (
                ["a.png", "b.EXR"].map(String::from).to_vec(),
                ["c", "notes.txt"].map(String::from).to_vec(),
            )
        );
        let (pictures, left_out, outputs) = find(Depth::Subfolders);
        assert_eq!(pictures, ["a.png", "b.EXR", "c/a.png", "c/d/a.jpg"]);
        assert_eq!(left_out, ["notes.txt"]);
        assert_eq!(outputs, ["o/a.f.exr", "o/b.f.exr", "o/c/a.f.exr", "o/c/d/a.f.exr"]);
    }

    #[test]
    fn a_word_for_numbers_goes_from_the_inputs_to_the_outputs() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.1001.png", "a.1002.png", "b.<UDIM>.png", "b.1001.png"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let find = |name: &str| find(&[folder.path().join(name)], Depth::Folder);
        let tiles = find("a.<UDIM>.png").unwrap();
        let to = |path| Outputs { path: Path::new(path), form: "f", ending: "exr", variants: &[] };
        let names = |path| to(path).of(&tiles.pictures).map(|files| files.concat());
        let named = ["o/x_1001.exr", "o/x_1002.exr"].map(PathBuf::from);
        assert_eq!(names("o/x_<UDIM>.exr"), Ok(named.to_vec()));
        let in_folder = ["o/a.f.1001.exr", "o/a.f.1002.exr"].map(PathBuf::from);
        assert_eq!(names("o"), Ok(in_folder.to_vec()));
        assert!(names("x.exr").is_err());
        // A file of this very name has priority.
        let literal = find("b.<UDIM>.png").unwrap();
        assert_eq!(literal.pictures.len(), 1);
        assert!(to("x.<UDIM>.exr").of(&literal.pictures).is_err());
        assert!(find("c.<UDIM>.png").is_err());
    }
}
