//! Rings of measured dyes, built in or read from a folder.

use std::path::{Path, PathBuf};

use upglow_color::rounding::shown;
use upglow_color::{
    Grid, MeasuredDye, NameError, Observer, SampleRules, SamplesError, Spectrum, SpectrumCsvError,
    Xyz, read_columns,
};

/// A ring of measured dyes: neighbors can be mixed, the last is beside the first.
#[derive(Clone, Debug, PartialEq)]
pub struct DyeSet {
    name: String,
    dyes: Vec<MeasuredDye>,
}

/// Why a set of dyes is unknown or invalid.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DyeSetError {
    /// Neither a built-in set nor a folder.
    #[error(
        "unknown dye set {found:?}, expected {} or a folder of CSV files",
        MeasuredDye::set_names().collect::<Vec<_>>().join(", ")
    )]
    Unknown {
        /// The name given.
        found: String,
    },
    /// The folder or a file in it cannot be read.
    #[error("{}: {cause}", path.display())]
    Read {
        /// The file or folder.
        path: PathBuf,
        /// The system's error.
        cause: std::io::Error,
    },
    /// A file is not a dye.
    #[error("{}: {cause}", path.display())]
    Csv {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        cause: SpectrumCsvError,
    },
    /// A curve of a dye is negative, zero everywhere or above 1.
    #[error("dye {dye}: the {curve} {problem}")]
    Curve {
        /// The dye.
        dye: String,
        /// Which curve.
        curve: &'static str,
        /// What was found, and what is expected.
        problem: String,
    },
    /// The emission cannot be calculated with.
    #[error("dye {dye}: {cause}")]
    Emission {
        /// The dye.
        dye: String,
        /// What is wrong with it.
        cause: SamplesError,
    },
    /// A quantum yield is not in 0..=1.
    #[error("dye {dye}: quantum yield {found}, expected 0 to 1")]
    QuantumYield {
        /// The dye.
        dye: String,
        /// The number given.
        found: f64,
    },
    /// A dye emits at shorter wavelengths than it absorbs, against the law of Stokes.
    #[error(
        "dye {dye}: the emission's mean wavelength is {emission_nm:.1} nm, expected at least that of the \
         absorption, {absorption_nm:.1} nm; are the columns exchanged?"
    )]
    AntiStokes {
        /// The dye.
        dye: String,
        /// Mean wavelength of the absorption, nm.
        absorption_nm: f64,
        /// Mean wavelength of the emission, nm.
        emission_nm: f64,
    },
    /// Two dyes have one name.
    #[error("two dyes are called {name:?}, expected different names")]
    Twins {
        /// The name.
        name: String,
    },
    /// A dye or the set cannot have its name.
    #[error(transparent)]
    Name(#[from] NameError),
    /// The set has the name of a built-in set, but other dyes.
    #[error(
        "{name:?} is a built-in dye set of {}, found {}: expected these dyes in this order, or another name",
        expected.join(", "),
        found.join(", ")
    )]
    Set {
        /// The set's name.
        name: String,
        /// Names of the built-in dyes, in ring order.
        expected: Vec<String>,
        /// Names of the dyes given.
        found: Vec<String>,
    },
    /// The folder's list of quantum yields lacks a column, or holds one that is not in 0..=1.
    #[error("{}: {problem}", path.display())]
    List {
        /// The list.
        path: PathBuf,
        /// What was found, and what is expected.
        problem: String,
    },
    /// No dye, or too many.
    #[error("{found} dyes, expected 1 to {}", DyeSet::MOST)]
    Count {
        /// Dyes found.
        found: usize,
    },
}

impl DyeSet {
    /// Most dyes of a set: in a cube they are numbered by one byte.
    pub const MOST: usize = 255;

    /// A ring of these dyes, in this order.
    ///
    /// # Errors
    ///
    /// [`DyeSetError`] if there is no dye or more than 255; if an absorption is negative somewhere or
    /// peaks outside 0..1; if an emission is negative somewhere or peaks outside 1e-30 to 1e30, or its
    /// mean wavelength is below that of the absorption; if a quantum yield is not in 0..=1; if two dyes
    /// have one name; or if a set or dye has a built-in name and not the built-in dyes or numbers.
    pub fn new(name: &str, dyes: Vec<MeasuredDye>) -> Result<Self, DyeSetError> {
        if dyes.is_empty() || dyes.len() > Self::MOST {
            return Err(DyeSetError::Count { found: dyes.len() });
        }
        dyes.iter().try_for_each(check_dye)?;
        let twin = (1..dyes.len()).find(|&i| dyes[..i].iter().any(|d| d.name == dyes[i].name));
        if let Some(i) = twin {
            return Err(DyeSetError::Twins { name: dyes[i].name.clone() });
        }
        check_set_name(name, &dyes)?;
        Ok(Self { name: name.into(), dyes })
    }

    /// The built-in set of this name; `konig8` is known by its former name `seed8` too.
    ///
    /// # Errors
    ///
    /// [`DyeSetError::Unknown`] lists the known names.
    pub fn named(name: &str) -> Result<Self, DyeSetError> {
        let set = MeasuredDye::set(name).ok_or_else(|| DyeSetError::Unknown { found: name.into() });
        let (stored_name, dyes) = set?;
        Self::new(stored_name, dyes)
    }

    /// The dyes in a folder of CSV files, `wavelength_nm,absorption,emission` each, as a ring
    /// sorted by emission hue.
    ///
    /// Absorption is a fraction (1 is black at that wavelength); emission is relative. A file
    /// `PROVENANCE.csv` beside them, with columns `file` and `quantum_yield`, gives the yields. A dye is
    /// named after its file without `.csv`; where that is the name of a built-in dye with other numbers,
    /// with `.csv`.
    ///
    /// # Errors
    ///
    /// [`DyeSetError`] names the file, the line and what was expected there.
    pub fn from_folder(folder: &Path) -> Result<Self, DyeSetError> {
        Self::from_folder_with(folder, |dye| dye)
    }

    /// The same with every curve divided by its peak, as [`MeasuredDye::normalized`] does. An absorption
    /// that was given in other units, with a peak above 1, becomes a fraction.
    ///
    /// # Errors
    ///
    /// As [`DyeSet::from_folder`].
    pub fn from_folder_normalized(folder: &Path) -> Result<Self, DyeSetError> {
        Self::from_folder_with(folder, MeasuredDye::normalized)
    }

    fn from_folder_with(
        folder: &Path,
        scale: impl Fn(MeasuredDye) -> MeasuredDye,
    ) -> Result<Self, DyeSetError> {
        let mut files = csv_files(folder)?;
        let list = files.iter().position(|f| f.file_name().is_some_and(|n| n == PROVENANCE));
        let yields = match list {
            Some(index) => read_yields(&files.remove(index))?,
            None => Vec::new(),
        };
        let read = |file: &PathBuf| Ok(scale(read_dye(file, &yields)?).named_after(file));
        let mut dyes = files.iter().map(read).collect::<Result<Vec<_>, DyeSetError>>()?;
        let matching = Observer::cie_1931_2deg().on(Grid::FINE);
        let hue = |dye: &MeasuredDye| emission_hue(dye, &matching);
        dyes.sort_by(|a, b| hue(b).total_cmp(&hue(a)));
        let name = folder.file_name().map_or("dyes".into(), |n| n.to_string_lossy());
        Self::new(&name, dyes)
    }

    /// The name that files hold; for `konig8` it is `seed8`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The dyes in ring order; at least one.
    pub fn dyes(&self) -> &[MeasuredDye] {
        &self.dyes
    }
}

const PROVENANCE: &str = "PROVENANCE.csv";

fn check_dye(dye: &MeasuredDye) -> Result<(), DyeSetError> {
    let name = || dye.name.clone();
    check_curve(dye, "absorption", &dye.absorption, 1.0)?;
    check_curve(dye, "emission", &dye.emission, f64::INFINITY)?;
    dye.check_emission_peak().map_err(|cause| DyeSetError::Emission { dye: name(), cause })?;
    if let Some(found) = dye.quantum_yield.filter(|q| !(0.0..=1.0).contains(q)) {
        return Err(DyeSetError::QuantumYield { dye: name(), found });
    }
    // Means, not peaks: curves with several maxima, such as that of mKeima, have no one peak.
    let [absorption_nm, emission_nm] = [mean_nm(&dye.absorption), mean_nm(&dye.emission)];
    if emission_nm < absorption_nm {
        return Err(DyeSetError::AntiStokes { dye: name(), absorption_nm, emission_nm });
    }
    Ok(dye.check_name()?)
}

/// Mean wavelength of a curve with a positive sample, nm.
fn mean_nm(curve: &Spectrum) -> f64 {
    let peak = curve.peak();
    let samples = curve.grid().wavelengths_nm().zip(curve.values());
    let (moment, sum) = samples
        .fold((0.0, 0.0), |(moment, sum), (nm, v)| (moment + nm * (v / peak), sum + v / peak));
    moment / sum
}

/// Checks that a built-in name comes with the built-in dyes in their order. Their numbers are checked
/// with each dye.
fn check_set_name(name: &str, dyes: &[MeasuredDye]) -> Result<(), DyeSetError> {
    NameError::check_text(name)?;
    let names = |dyes: &[MeasuredDye]| dyes.iter().map(|d| d.name.clone()).collect::<Vec<_>>();
    match MeasuredDye::set(name).map(|(_, known)| names(&known)) {
        Some(expected) if expected != names(dyes) => {
            Err(DyeSetError::Set { name: name.into(), expected, found: names(dyes) })
        }
        _ => Ok(()),
    }
}

fn check_curve(
    dye: &MeasuredDye,
    curve: &'static str,
    samples: &Spectrum,
    limit: f64,
) -> Result<(), DyeSetError> {
    let mut sampled = samples.grid().wavelengths_nm().zip(samples.values());
    let peak = samples.peak();
    let problem = match sampled.find(|(_, sample)| **sample < 0.0) {
        Some((nm, found)) => format!("is {} at {nm} nm, expected 0 or more", shown(*found)),
        None if peak > 0.0 && peak <= limit => return Ok(()),
        None if peak > limit => {
            let peak = shown(peak);
            format!("peaks at {peak}, expected a peak in 0..1, 0 excluded, or a normalized curve")
        }
        None => format!("peaks at {peak}, expected a peak in 0..1, 0 excluded"),
    };
    Err(DyeSetError::Curve { dye: dye.name.clone(), curve, problem })
}

fn csv_files(folder: &Path) -> Result<Vec<PathBuf>, DyeSetError> {
    let failed = |cause| DyeSetError::Read { path: folder.into(), cause };
    let entries: Vec<_> = std::fs::read_dir(folder).and_then(Iterator::collect).map_err(failed)?;
    let mut files: Vec<PathBuf> = entries.iter().map(std::fs::DirEntry::path).collect();
    files.retain(|f| f.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")));
    files.sort();
    Ok(files)
}

fn read_text(path: &Path) -> Result<String, DyeSetError> {
    crate::input::read_text_input(path)
        .map_err(|cause| DyeSetError::Read { path: path.into(), cause })
}

fn read_dye(path: &Path, yields: &[(String, f64)]) -> Result<MeasuredDye, DyeSetError> {
    let text = read_text(path)?;
    let [absorption, emission] = read_columns(&text, ["absorption", "emission"], SampleRules::DYE)
        .map_err(|cause| DyeSetError::Csv { path: path.into(), cause })?;
    let file = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let quantum_yield = yields.iter().find(|(listed, _)| *listed == file).map(|(_, q)| *q);
    Ok(MeasuredDye { name: String::new(), absorption, emission, quantum_yield, provenance: file })
}

/// File and quantum yield of each line of the list that has a yield.
fn read_yields(path: &Path) -> Result<Vec<(String, f64)>, DyeSetError> {
    let text = read_text(path)?;
    let mut lines = text.lines().map(split_quoted);
    let header = lines.next().unwrap_or_default();
    let column = |name: &str| header.iter().position(|cell| cell == name);
    let (Some(file), Some(quantum_yield)) = (column("file"), column("quantum_yield")) else {
        let found: String = text.lines().next().unwrap_or_default().chars().take(80).collect();
        let problem = format!("header {found:?}, expected columns file and quantum_yield");
        return Err(DyeSetError::List { path: path.into(), problem });
    };
    let stated = lines.filter_map(|cells| {
        let cell = cells.get(quantum_yield)?.trim();
        (!cell.is_empty()).then(|| (cells[file.min(cells.len() - 1)].clone(), cell.to_owned()))
    });
    stated
        .map(|(dye, found)| match found.parse() {
            Ok(q) if (0.0..=1.0).contains(&q) => Ok((dye, q)),
            _ => {
                let expected = "expected a number from 0 to 1, or an empty cell";
                let problem = format!("quantum yield {found:?} of {dye}, {expected}");
                Err(DyeSetError::List { path: path.into(), problem })
            }
        })
        .collect()
}

/// The cells of one CSV line; commas inside double quotes do not separate.
fn split_quoted(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            _ => cells.last_mut().expect("it starts with one").push(c),
        }
    }
    cells
}

/// Hue angle of a dye's emission around equal-energy white in CIE 1976 u', v'; radians.
fn emission_hue(dye: &MeasuredDye, matching: &[[f64; 3]]) -> f64 {
    let mut sum = [0.0; 3];
    for (e, m) in dye.emission.values().iter().zip(matching) {
        (0..3).for_each(|k| sum[k] += e * m[k]);
    }
    let uv = |Xyz([x, y, z]): Xyz| {
        let denominator = x + 15.0 * y + 3.0 * z;
        [4.0 * x / denominator, 9.0 * y / denominator]
    };
    let (color, white) = (uv(Xyz(sum)), uv(Xyz([1.0; 3])));
    (color[1] - white[1]).atan2(color[0] - white[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn built_in_rings_are_in_the_order_of_their_hue() {
        let matching = Observer::cie_1931_2deg().on(Grid::FINE);
        for name in MeasuredDye::set_names() {
            let set = DyeSet::named(name).unwrap();
            let hues: Vec<f64> = set.dyes().iter().map(|d| emission_hue(d, &matching)).collect();
            let next = |i: usize| hues[(i + 1) % hues.len()];
            let rises = (0..hues.len()).filter(|&i| next(i) > hues[i]).count();
            assert_eq!(rises, 1, "{name}: {hues:?}");
        }
    }

    #[test]
    fn a_folder_is_a_ring_with_its_listed_yields() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, peak: usize| {
            let value = |nm: usize| if nm == peak { "1" } else { "0" };
            let rows: String = (300..=830)
                .step_by(5)
                .map(|nm| format!("{nm},{},{}\n", value(nm), value(nm - 10)))
                .collect();
            let text = format!("wavelength_nm,absorption,emission\n{rows}");
            std::fs::write(folder.path().join(name), text).unwrap();
        };
        write("red.csv", 640);
        write("green.csv", 520);
        write("violet.csv", 420);
        let list = "file,by,quantum_yield\nred.csv,\"me, myself\",0.5\ngreen.csv,me,\n";
        std::fs::write(folder.path().join(PROVENANCE), list).unwrap();
        let set = DyeSet::from_folder(folder.path()).unwrap();
        let facts: Vec<_> = set.dyes().iter().map(|d| (&d.name[..], d.quantum_yield)).collect();
        assert_eq!(facts, [("green", None), ("red", Some(0.5)), ("violet", None)]);
    }

    #[test]
    fn a_list_of_yields_without_its_columns_is_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let list = folder.path().join(PROVENANCE);
        std::fs::write(&list, "file,quantum yield\nred.csv,0.5\n").unwrap();
        let error = DyeSet::from_folder(folder.path()).unwrap_err().to_string();
        let expected = "header \"file,quantum yield\", expected columns file and quantum_yield";
        assert_eq!(error, format!("{}: {expected}", list.display()));
    }

    #[test]
    fn the_former_name_is_read_and_files_keep_it() {
        let set = DyeSet::named("seed8").unwrap();
        assert_eq!(set, DyeSet::named("konig8").unwrap());
        assert_eq!(set.name(), "seed8");
    }

    #[test]
    fn a_folder_without_dyes_or_with_a_broken_one_is_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let empty = DyeSet::from_folder(folder.path()).unwrap_err();
        assert_eq!(empty.to_string(), "0 dyes, expected 1 to 255");
        std::fs::write(folder.path().join("x.csv"), "nm,a,e\n").unwrap();
        let header = DyeSet::from_folder(folder.path()).unwrap_err().to_string();
        assert!(
            header.ends_with(
                "x.csv: header \"nm,a,e\", expected \"wavelength_nm,absorption,emission\""
            )
        );
    }
}
