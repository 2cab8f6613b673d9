//! Measured fluorescent materials, as the BFC-450 spectrofluorimeter writes them.

use std::path::{Path, PathBuf};

use upglow_color::{Colorimetry, DonaldsonMatrix, Grid, Xyz};
use upglow_terminal::{Failure, files};

/// A measured material: how much of the light of each band leaves in each band.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Measured {
    /// The name of its file without the suffix.
    pub(crate) name: String,
    /// Light arrives on [`Measured::GRID`], and leaves at the wavelengths of it from [`FIRST_OUT_NM`] on.
    matrix: DonaldsonMatrix,
}

/// The first wavelength at which light is measured on its way out, nm.
const FIRST_OUT_NM: f64 = 380.0;

impl Measured {
    /// The wavelengths of the excitation.
    pub(crate) const GRID: Grid = match Grid::try_new(300, 780, 10) {
        Ok(grid) => grid,
        Err(_) => panic!("the wavelengths ascend"),
    };

    /// Every `.BFC` file of a folder, in the order of their names.
    ///
    /// # Errors
    ///
    /// [`Failure`] if the folder or a file cannot be read, a file is invalid, or there is none.
    pub(crate) fn read_folder(folder: &Path) -> Result<Vec<Self>, Failure> {
        let unreadable =
            |error| Failure::system(folder, &error, "a folder of BFC-450 matrices (.BFC)");
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
        paths.iter().map(|path| Self::read(path)).collect()
    }

    fn read(path: &Path) -> Result<Self, Failure> {
        let text = files::read_text(path, "a BFC-450 matrix, a text file")?;
        let matrix =
            DonaldsonMatrix::from_bfc(&text).map_err(|error| Failure::file(path, error))?;
        let is_usual = Self::GRID.wavelengths_nm().eq(matrix.incident_nm().iter().copied())
            && Self::outgoing_nm().eq(matrix.outgoing_nm().iter().copied());
        if !is_usual {
            let expected =
                "another grid, expected 380 780 10 49 300 10, that of the other materials";
            return Err(Failure::file(path, expected));
        }
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { name, matrix })
    }

    fn outgoing_nm() -> impl Iterator<Item = f64> {
        Self::GRID.wavelengths_nm().filter(|nm| *nm >= FIRST_OUT_NM)
    }

    /// The color under the light of `colorimetry`, which must be on [`Measured::GRID`].
    pub(crate) fn color(&self, colorimetry: &Colorimetry) -> Xyz {
        let leaving = self.matrix.leaving(colorimetry.irradiance());
        let unmeasured = Self::GRID.len() - leaving.len();
        let seen = colorimetry.matching()[unmeasured..].iter();
        leaving.into_iter().zip(seen).map(|(power, m)| power * Xyz(*m)).sum()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use upglow_color::BispectralUnit;
    use upglow_study::konig2020;

    /// A material that reflects half of all light, and moves some of it from 400 nm to 500 nm.
    pub(crate) fn half(moved: f64) -> Measured {
        let factor = |o: f64, i: f64| match (i, o) {
            _ if i == o => 0.5,
            (400.0, 500.0) => moved,
            _ => 0.0,
        };
        let (incident, outgoing) = (Measured::GRID.wavelengths_nm(), Measured::outgoing_nm());
        let row = |o| incident.clone().map(|i| factor(o, i)).collect();
        let rows = Measured::outgoing_nm().map(row).collect();
        let unit = BispectralUnit::PerBand;
        let matrix =
            DonaldsonMatrix::try_new(incident.clone().collect(), outgoing.collect(), rows, unit);
        Measured { name: "half".into(), matrix: matrix.unwrap() }
    }

    /// The grid starts at 300 nm, where no light is measured on its way out: D65 sums there are of no
    /// color.
    const UNMEASURED: f64 = 1e-4;

    #[test]
    fn a_material_that_reflects_half_has_half_of_the_white() {
        let colorimetry = konig2020::contract().on(Measured::GRID);
        let (white, color) = (colorimetry.white(), half(0.0).color(&colorimetry));
        for k in 0..3 {
            assert!((color.0[k] - 0.5 * white.0[k]).abs() < UNMEASURED, "{color:?} of {white:?}");
        }
    }

    #[test]
    fn rows_are_emissions() {
        let colorimetry = konig2020::contract().on(Measured::GRID);
        let [without, with] = [0.0, 0.1].map(|moved| half(moved).color(&colorimetry));
        let (light, matching) = (colorimetry.irradiance(), colorimetry.matching());
        let expected = 0.1 * light[10] * matching[20][1];
        assert!((with.0[1] - without.0[1] - expected).abs() < 1e-12);
    }

    #[test]
    fn the_measured_materials_are_read() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/bispectral");
        if !folder.is_dir() {
            eprintln!("skipped: the_measured_materials_are_read (no ../shared/data/bispectral)");
            return;
        }
        let names: Vec<String> =
            Measured::read_folder(&folder).unwrap().into_iter().map(|found| found.name).collect();
        assert_eq!(names, ["CIBA12", "HERPIORA", "POLGREE", "TEXTYELL"]);
    }
}
