//! Files that were dropped on the page: pictures, lights and dyes.
//!
//! They are in a private folder, under names of our own making. The last few are kept.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};

use axum::body::Bytes;
use serde::Serialize;
use tempfile::{TempDir, TempPath};
use upglow::{DyeSet, DyeSetError};
use upglow_color::{Illuminant, MeasuredDye};
use upglow_image::SUFFIXES;

use super::answer::Refusal;
use super::locked::locked;
use super::spectral::SpectralDrop;

/// Pictures that are kept.
const PICTURES: usize = 4;
/// Lights that are kept.
const LIGHTS: usize = 16;
/// Dyes that can be dropped: two at a time are tried for each color of a film.
const DYES: usize = 16;
/// Letters of a name that are kept.
const NAME_LETTERS: usize = 48;

/// How options of builds name what was dropped: `dropped:NAME` for a light, and this alone for all dyes.
pub(super) const DROPPED: &str = "dropped";

/// A picture, or a file of spectra.
#[derive(Debug)]
pub(super) struct Dropped {
    pub(super) id: u32,
    /// Colors that a screen can show, as little-endian floats.
    pub(super) rgb: Bytes,
    pub(super) spectra: Option<SpectralDrop>,
}

/// A dropped file of a light.
#[derive(Debug)]
struct DroppedLight {
    name: String,
    file: PathBuf,
    /// Of this file alone; removed with the light.
    _folder: TempDir,
}

/// All that was dropped.
#[derive(Debug)]
pub(super) struct Drops {
    folder: PathBuf,
    last_id: AtomicU32,
    pictures: Mutex<VecDeque<Arc<Dropped>>>,
    lights: Mutex<VecDeque<DroppedLight>>,
    /// Held while the folder of dyes is read or written.
    dyes: Mutex<()>,
}

/// A dye that can be built with.
#[derive(Debug, Serialize)]
pub(super) struct DroppedDye {
    name: String,
    absorption: Vec<f64>,
    emission: Vec<f64>,
    quantum_yield: Option<f64>,
    /// The value of `--dyes` for all dyes that were dropped.
    option: &'static str,
    /// Whether `--normalize-dyes` is needed: a curve is in other units than fractions.
    normalize: bool,
    /// All dyes that were dropped, in the order of their emission.
    dyes: Vec<String>,
}

impl Drops {
    pub(super) fn new(folder: &Path) -> Self {
        Self {
            folder: folder.into(),
            last_id: AtomicU32::new(0),
            pictures: Mutex::default(),
            lights: Mutex::default(),
            dyes: Mutex::new(()),
        }
    }

    pub(super) fn new_id(&self) -> u32 {
        self.last_id.fetch_add(1, Ordering::Relaxed) + 1
    }

    /// Where to write a file that the page calls `name`. Of that only the ending of a picture counts, and
    /// only if it is known. The file is removed when the path is dropped.
    pub(super) fn path(&self, id: u32, name: &str) -> Result<TempPath, Refusal> {
        let has = |suffix: &&&str| {
            name.rsplit_once('.').is_some_and(|(_, found)| found.eq_ignore_ascii_case(suffix))
        };
        let suffix = SUFFIXES.iter().find(has).unwrap_or(&"file");
        TempPath::try_from_path(self.folder.join(format!("{id}.{suffix}"))).map_err(not_kept)
    }

    pub(super) fn add(&self, dropped: Dropped) {
        let mut pictures = locked(&self.pictures);
        pictures.push_back(Arc::new(dropped));
        if pictures.len() > PICTURES {
            pictures.pop_front();
        }
    }

    pub(super) fn get(&self, id: u32) -> Result<Arc<Dropped>, Refusal> {
        let pictures = locked(&self.pictures);
        let found = pictures.iter().find(|dropped| dropped.id == id);
        found.cloned().ok_or_else(|| Refusal::not_found("file; only the last four are kept"))
    }

    /// Keeps a light of this CSV text.
    pub(super) fn add_light(&self, name: &str, text: &str) -> Result<Illuminant, Refusal> {
        let file = table_name(name);
        let light = Illuminant::from_csv_file(Path::new(&file), text, None)
            .map_err(|error| Refusal::unusable(format!("{file}: {error}")))?;
        let folder = TempDir::new_in(&self.folder).map_err(not_kept)?;
        let path = folder.path().join(&file);
        std::fs::write(&path, text).map_err(not_kept)?;
        let mut lights = locked(&self.lights);
        lights.retain(|known| known.name != light.name());
        lights.push_back(DroppedLight { name: light.name().into(), file: path, _folder: folder });
        if lights.len() > LIGHTS {
            lights.pop_front();
        }
        Ok(light)
    }

    /// Adds a dye of this CSV text to those that were dropped.
    pub(super) fn add_dye(&self, name: &str, text: &str) -> Result<DroppedDye, Refusal> {
        let file = table_name(name);
        let alone = TempDir::new_in(&self.folder).map_err(not_kept)?;
        std::fs::write(alone.path().join(&file), text).map_err(not_kept)?;
        let (set, _) = read_dyes(alone.path(), &file)?;
        let [dye] = set.dyes() else { return Err(Refusal::unusable(format!("{file}: no dye"))) };

        let _only = locked(&self.dyes);
        let folder = self.dye_folder();
        std::fs::create_dir_all(&folder).map_err(not_kept)?;
        let path = folder.join(&file);
        let others = std::fs::read_dir(&folder).map_err(not_kept)?.flatten();
        if others.filter(|other| other.path() != path).count() >= DYES {
            return Err(Refusal::unusable(format!("{file}: more than {DYES} dyes")));
        }
        std::fs::write(&path, text).map_err(not_kept)?;
        let (all, normalize) = read_dyes(&folder, &file).or_else(|refusal| {
            std::fs::remove_file(&path).map_err(not_kept)?;
            Err(refusal)
        })?;
        let MeasuredDye { name, absorption, emission, quantum_yield, .. } = dye;
        Ok(DroppedDye {
            name: name.clone(),
            absorption: absorption.values().to_vec(),
            emission: emission.values().to_vec(),
            quantum_yield: *quantum_yield,
            option: DROPPED,
            normalize,
            dyes: all.dyes().iter().map(|dye| dye.name.clone()).collect(),
        })
    }

    fn dye_folder(&self) -> PathBuf {
        self.folder.join("my-dyes")
    }

    /// The path that stands for the value of an option of builds, if that names something dropped.
    pub(super) fn path_of(&self, option: &str, value: &str) -> Result<Option<String>, Refusal> {
        let Some(rest) = value.strip_prefix(DROPPED) else { return Ok(None) };
        let path = match (option, rest.strip_prefix(':')) {
            ("--illuminant", Some(name)) => {
                let lights = locked(&self.lights);
                let found = lights.iter().find(|light| light.name == name);
                found.map(|light| light.file.clone())
            }
            ("--dyes", None) if rest.is_empty() => {
                Some(self.dye_folder()).filter(|folder| folder.is_dir())
            }
            _ => None,
        };
        let path = path.and_then(|path| path.to_str().map(String::from));
        path.map(Some).ok_or_else(|| Refusal::bad(format!("{option}: {value} was not dropped")))
    }

    /// Keeps the dyes as they are while the result lives.
    pub(super) fn unchanged(&self) -> MutexGuard<'_, ()> {
        locked(&self.dyes)
    }

    /// The values of options that name the lights.
    pub(super) fn lights(&self) -> Vec<String> {
        locked(&self.lights).iter().map(|light| light_option(&light.name)).collect()
    }
}

/// The value of `--illuminant` for a dropped light.
pub(super) fn light_option(name: &str) -> String {
    format!("{DROPPED}:{name}")
}

/// The dyes in a folder, and whether their curves must be normalized. A refusal names `file`.
fn read_dyes(folder: &Path, file: &str) -> Result<(DyeSet, bool), Refusal> {
    let error = match DyeSet::from_folder(folder) {
        Ok(set) => return Ok((set, false)),
        Err(error) => error,
    };
    if let Ok(set) = DyeSet::from_folder_normalized(folder) {
        return Ok((set, true));
    }
    // Without the path, which is the server's own.
    let problem = match error {
        DyeSetError::Csv { cause, .. } => cause.to_string(),
        DyeSetError::Read { cause, .. } => cause.to_string(),
        DyeSetError::List { problem, .. } => problem,
        error => error.to_string(),
    };
    Err(Refusal::unusable(format!("{file}: {problem}")))
}

/// The name of a CSV file, of letters that every system allows: the last part of a path, shortened.
fn table_name(name: &str) -> String {
    let last = name.rsplit(['/', '\\']).next().unwrap_or_default();
    let stem = last.rsplit_once('.').map_or(last, |(stem, _)| stem);
    let plain = |c: char| if c.is_alphanumeric() || "-_ ".contains(c) { c } else { '_' };
    let stem: String = stem.chars().map(plain).take(NAME_LETTERS).collect();
    let stem = stem.trim();
    format!("{}.csv", if stem.is_empty() { "unnamed" } else { stem })
}

fn not_kept(error: std::io::Error) -> Refusal {
    use axum::http::StatusCode;
    Refusal::new(StatusCode::INSUFFICIENT_STORAGE, format!("the file is not kept: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_tables_stay_in_their_folder() {
        for (name, expected) in [
            ("lamp.csv", "lamp.csv"),
            ("../../etc/passwd", "passwd.csv"),
            ("C:\\x\\..\\my lamp.CSV", "my lamp.csv"),
            ("..", "_.csv"),
            ("", "unnamed.csv"),
            (".csv", "unnamed.csv"),
            ("a\0b\n.csv", "a_b_.csv"),
            ("dye's ü.csv", "dye_s ü.csv"),
        ] {
            assert_eq!(table_name(name), expected, "{name:?}");
        }
        assert_eq!(table_name(&"x".repeat(1000)).len(), NAME_LETTERS + 4);
    }

    #[test]
    fn names_of_pictures_are_numbers() {
        let drops = Drops::new(Path::new("folder"));
        for (name, expected) in [
            ("a.EXR", "7.exr"),
            ("../x/y", "7.file"),
            ("a.exr/../../b", "7.file"),
            ("x.tga", "7.tga"),
        ] {
            let path = drops.path(7, name).unwrap();
            assert!(path.ends_with(Path::new("folder").join(expected)), "{name}: {path:?}");
        }
    }
}
