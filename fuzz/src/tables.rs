//! Tables as text and as numbers: lights, observers, dyes, measured matrices, coefficients.

use std::cell::OnceCell;
use std::fs;
use std::path::PathBuf;

use tempfile::TempDir;
use upglow::{CoefficientTable, DyeModel, DyeOptions, DyeSet};
use upglow_color::{BispectralUnit, Contract, DonaldsonMatrix, Ends, Grid, Illuminant, Observer};

/// A table of coefficients.
pub(crate) fn coefficients(bytes: &[u8]) {
    let table = match CoefficientTable::from_bytes(bytes) {
        Ok(table) => table,
        Err(error) => return crate::check_message(&error),
    };
    for rgb in [[0.0; 3], [1.0; 3], [0.9, 0.1, 0.2], [1e-9, 2e-9, 0.0], [f32::NAN; 3]] {
        let r = table.sigmoid(rgb).at(550.0);
        assert!((0.0..=1.0).contains(&r), "a reflectance of {r}");
    }
    let again = CoefficientTable::from_bytes(&table.to_bytes());
    assert!(
        again.is_ok_and(|again| again.to_bytes() == table.to_bytes()),
        "a table that is read back differs"
    );
}

/// Text that the first byte says to be a light, an observer or a matrix.
pub(crate) fn csv(bytes: &[u8]) {
    let Some((kind, rest)) = bytes.split_first() else { return };
    let Ok(text) = std::str::from_utf8(rest) else { return };
    match kind {
        b'l' => light(Illuminant::from_csv("x", text, None)),
        b'h' => light(Illuminant::from_csv("x", text, Some(Ends::Hold))),
        b'o' => match Observer::from_csv("x", text) {
            Ok(observer) => numbers_are_finite(Contract { observer, ..Contract::default() }),
            Err(error) => crate::check_message(&error),
        },
        b'm' => matrix(DonaldsonMatrix::from_csv(text)),
        _ => matrix(DonaldsonMatrix::from_bfc(text)),
    }
}

fn light<E: std::error::Error>(read: Result<Illuminant, E>) {
    match read {
        Ok(illuminant) => numbers_are_finite(Contract { illuminant, ..Contract::default() }),
        Err(error) => crate::check_message(&error),
    }
}

/// A contract that is accepted has a finite white and finite weights.
fn numbers_are_finite(contract: Contract) {
    if let Err(error) = contract.check() {
        return crate::check_message(&error);
    }
    let colorimetry = contract.on(Grid::FIT);
    assert!(colorimetry.white().0.iter().all(|v| v.is_finite()), "{:?}", colorimetry.white());
    assert!(colorimetry.weights().iter().flatten().all(|v| v.is_finite()));
}

fn matrix<E: std::error::Error>(read: Result<DonaldsonMatrix, E>) {
    let matrix = match read {
        Ok(matrix) => matrix,
        Err(error) => return crate::check_message(&error),
    };
    assert!(matrix.factors().iter().flatten().all(|v| v.is_finite()));
    let observer = Observer::default();
    for light in [Illuminant::default(), Illuminant::mineral_lamp()] {
        if let Ok(xyz) = matrix.color(&light, &observer) {
            assert!(xyz.0.iter().all(|v| v.is_finite()), "a color of {xyz:?}");
        }
    }
    assert!(matches!(matrix.unit(), BispectralUnit::PerBand | BispectralUnit::PerNm));
}

thread_local! {
    static FOLDER: OnceCell<TempDir> = const { OnceCell::new() };
}

/// A folder with one dye, or with two if there is a zero byte between them, and with quantum yields after another.
pub(crate) fn dyes(bytes: &[u8]) {
    let folder = FOLDER.with(|folder| -> PathBuf {
        folder.get_or_init(crate::pictures::folder).path().join("dyes")
    });
    // What was there is of the run before.
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir(&folder).expect("a folder of our own");
    for (name, part) in
        ["a.csv", "b.csv", "PROVENANCE.csv"].into_iter().zip(bytes.split(|b| *b == 0))
    {
        fs::write(folder.join(name), part).expect("room");
    }
    for set in [DyeSet::from_folder(&folder), DyeSet::from_folder_normalized(&folder)] {
        let set = match set {
            Ok(set) => set,
            Err(error) => {
                crate::check_message(&error);
                continue;
            }
        };
        for options in [DyeOptions::default()] {
            if let Ok(model) = DyeModel::new(set.clone(), options) {
                for curves in model.curves() {
                    let found = [curves.absorption.at(500.0), curves.emission.at(550.0)];
                    assert!(
                        found.iter().all(|v| v.is_finite() && *v >= 0.0),
                        "curves of {found:?}"
                    );
                    assert!(curves.mean_emission_nm.is_finite());
                }
            }
        }
    }
}
