//! The pictures that a command reads, and the files that it writes for them.

use std::collections::HashSet;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use upglow::open_input;
use upglow_image::SUFFIXES;
use upglow_terminal::Failure;

use crate::files;
use crate::name_pattern::{NamePattern, UDIM, is_udim};

/// The pictures of a command.
#[derive(Debug, Default)]
pub(crate) struct Inputs {
    /// The given pictures, and those in the given folders, sorted by name within each folder.
    pub(crate) pictures: Vec<Input>,
    /// What the folders hold beside them, without hidden files.
    pub(crate) left_out: Vec<PathBuf>,
}

/// A picture of a command. A million of them take some 100 MB, because those of a folder share its name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Input {
    folder: Arc<Folder>,
    /// The name in the folder.
    name: OsString,
    /// The number that a word in the given name replaces.
    number: Option<Box<str>>,
    /// Whether that is the number of a tile of a UDIM.
    is_tile: bool,
}

/// A folder with pictures of a command.
#[derive(Debug, Default, PartialEq, Eq)]
struct Folder {
    path: PathBuf,
    /// The same folder inside the given one.
    inside: PathBuf,
}

/// Whether the subfolders of a folder are searched too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Depth {
    Folder,
    Subfolders,
}

impl From<PathBuf> for Input {
    fn from(path: PathBuf) -> Self {
        let folder = Folder { path, inside: PathBuf::new() };
        Self { folder: folder.into(), ..Self::default() }
    }
}

impl Input {
    /// The path of the picture.
    pub(crate) fn path(&self) -> PathBuf {
        // Joining an empty name would add a separator.
        if self.name.as_os_str().is_empty() {
            self.folder.path.clone()
        } else {
            self.folder.path.join(&self.name)
        }
    }

    /// The number of the tile of a UDIM that the picture is, if it is one.
    pub(crate) fn tile(&self) -> Option<String> {
        match &self.number {
            Some(number) => self.is_tile.then(|| number.to_string()),
            None => Some(tile_of(self.path().file_stem()?.to_str()?)?.1.to_owned()),
        }
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
                let is_tile = pattern.word() == UDIM;
                let tile = |(number, path): (String, PathBuf)| Input {
                    number: Some(number.into()),
                    is_tile,
                    ..Input::from(path)
                };
                found.pictures.extend(pattern.files()?.into_iter().map(tile));
            }
        }
    }
    found.pictures.iter().try_for_each(|picture| files::note_input(&picture.path()))?;
    Ok(found)
}

/// Checks that a file can be read, before work on others starts.
pub(crate) fn check_there(path: &Path, expected: &str) -> Result<(), Failure> {
    files::note_input(path)?;
    open_input(path).map(drop).map_err(|error| Failure::system(path, &error, expected))
}

/// Adds the pictures of a folder, or of one inside it.
fn add_folder(folder: &Path, inside: &Path, depth: Depth, to: &mut Inputs) -> Result<(), Failure> {
    let here = Arc::new(Folder { path: folder.join(inside), inside: inside.to_owned() });
    let unread = |error| Failure::system(&here.path, &error, "a folder of pictures");
    let mut entries = Vec::new();
    for entry in here.path.read_dir().map_err(unread)? {
        let entry = entry.map_err(unread)?;
        // A link to a folder is not followed: it may lead back.
        entries.push((entry.file_name(), entry.file_type().map_err(unread)?.is_dir()));
    }
    entries.retain(|(name, _)| !is_hidden(name));
    entries.sort();
    for (name, is_folder) in entries {
        if is_folder && depth == Depth::Subfolders {
            add_folder(folder, &inside.join(name), depth, to)?;
        } else if is_picture(Path::new(&name)) && !here.path.join(&name).is_dir() {
            to.pictures.push(Input { folder: Arc::clone(&here), name, ..Input::default() });
        } else {
            to.left_out.push(here.path.join(name));
        }
    }
    Ok(())
}

/// Whether a file is hidden, as the `._x` that some systems write beside each x.
fn is_hidden(name: &OsStr) -> bool {
    name.as_encoded_bytes().starts_with(b".")
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

/// The names of the files of each picture, no two of which are the same.
#[derive(Clone, Debug)]
pub(crate) struct Named<'a> {
    outputs: Outputs<'a>,
    /// Whether the path is that of a file.
    is_file: bool,
    /// The word for numbers in the path.
    pattern: Option<NamePattern>,
}

impl<'a> Outputs<'a> {
    /// The files of each input: `path`, if it ends in a suffix of files and is not a folder, for a
    /// single picture or with a word for the numbers of all; otherwise files in the folder `path`, in the
    /// subfolder of the picture and named after it and the form, with the tile number of a UDIM in its
    /// place.
    pub(crate) fn of(self, inputs: &[Input]) -> Result<Named<'a>, Failure> {
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
        let named = Named { outputs: self, is_file, pattern };
        named.refuse_twins(inputs)?;
        Ok(named)
    }
}

impl Named<'_> {
    /// The path of the files, if it is not that of a folder.
    pub(crate) fn file(&self) -> Option<&Path> {
        self.is_file.then_some(self.outputs.path)
    }

    /// The files of a picture.
    pub(crate) fn files(&self, input: &Input) -> Result<Vec<PathBuf>, Failure> {
        let outputs = &self.outputs;
        let output = match &self.pattern {
            Some(pattern) => {
                let number = input.number.as_ref().ok_or_else(|| {
                    let word = pattern.word();
                    let message = format!("no number for {word}, expected inputs with {word}");
                    Failure::file(outputs.path, message)
                })?;
                pattern.with(number)
            }
            None if self.is_file => outputs.path.to_owned(),
            None => {
                let folder = outputs.path.join(&input.folder.inside);
                folder.join(name_of(&input.path(), outputs.form, outputs.ending))
            }
        };
        Ok(outputs.variants_of(&output))
    }

    /// Only hashes of the names are kept, since there may be millions; where two are the same, all are gone
    /// through for the twin.
    fn refuse_twins(&self, inputs: &[Input]) -> Result<(), Failure> {
        let mut taken = HashSet::new();
        for (i, input) in inputs.iter().enumerate() {
            let files = self.files(input)?;
            // Not `all`, which would stop at the first.
            let fresh = files.iter().filter(|path| taken.insert(files::hash_of(path))).count();
            if fresh == files.len() {
                continue;
            }
            if files.iter().enumerate().any(|(j, path)| files[..j].contains(path)) {
                return Err(twins(input, input));
            }
            for twin in &inputs[..i] {
                if self.files(twin)?.iter().any(|path| files.contains(path)) {
                    return Err(twins(input, twin));
                }
            }
        }
        Ok(())
    }
}

fn twins(input: &Input, twin: &Input) -> Failure {
    let twin = twin.path();
    let twin = twin.display();
    let message = format!("same name as {twin}, expected names that differ without their suffixes");
    Failure::file(&input.path(), message)
}

impl Outputs<'_> {
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
    match tile_of(&stem) {
        Some((name, tile)) => {
            let separator = &stem[name.len()..=name.len()];
            format!("{name}.{word}{separator}{tile}.{ending}").into()
        }
        None => format!("{stem}.{word}.{ending}").into(),
    }
}

/// What stands before the number of a tile that a name ends in, and that number.
fn tile_of(stem: &str) -> Option<(&str, &str)> {
    stem.rsplit_once(['.', '_']).filter(|(_, tile)| is_udim(tile))
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
            let to = Outputs { path: Path::new(path), form, ending: "exr", variants: &[] };
            let named = to.of(inputs)?;
            inputs.iter().map(|input| named.files(input)).collect::<Result<Vec<_>, Failure>>()
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
            let input = Input::from(PathBuf::from(input));
            let files = outputs.of(std::slice::from_ref(&input)).unwrap().files(&input).unwrap();
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
            let named = to.of(&found.pictures).unwrap();
            let outputs = found.pictures.iter().flat_map(|input| named.files(input).unwrap());
            let outputs: Vec<String> = outputs.map(|path| path.display().to_string()).collect();
            let pictures: Vec<PathBuf> = found.pictures.iter().map(Input::path).collect();
            (inside(&pictures), inside(&found.left_out), outputs)
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
        let names = |path| -> Result<Vec<PathBuf>, Failure> {
            let named = to(path).of(&tiles.pictures)?;
            tiles.pictures.iter().map(|tile| Ok(named.files(tile)?.remove(0))).collect()
        };
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
