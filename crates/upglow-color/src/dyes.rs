//! The measured dyes that come with the program. A new one is a column of `tables/dyes.csv`.

use crate::grid::Grid;
use crate::samples::{SampleRules, SamplesError, curves_from_samples};
use crate::spectrum::Spectrum;
use crate::tables::dyes::{DYE_SETS, DYES, DYES_FIRST_NM, DYES_STEP_NM, DyeRow};

/// A dye as somebody measured it.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredDye {
    /// The dye's name, without blanks.
    pub name: String,
    /// Absorption or excitation spectrum, dimensionless, on [`Grid::FINE`]; as published, 1 at its peak.
    pub absorption: Spectrum,
    /// Emission spectrum, relative, on [`Grid::FINE`]; as published, 1 at its peak.
    pub emission: Spectrum,
    /// Emitted photons per absorbed photon, 0..=1; `None` where nobody published it.
    pub quantum_yield: Option<f64>,
    /// Who measured it, where it was published and on what terms.
    pub provenance: String,
}

impl MeasuredDye {
    /// A dye from samples: wavelengths (nm) that ascend from 300 to 830 nm in steps of at most 5 nm, and
    /// for each the absorption, 0 to 1, and the emission, relative, 0 or more. Not-a-number at either
    /// end of a curve means "not measured there" and counts as zero.
    ///
    /// Its quantum yield is `None`, and its provenance empty: set what is known.
    ///
    /// # Errors
    ///
    /// [`SamplesError`] names the index, from 0, and what was expected there.
    pub fn from_samples(
        name: &str,
        wavelengths_nm: &[f64],
        absorption: &[f64],
        emission: &[f64],
    ) -> Result<Self, SamplesError> {
        let columns = [("absorption", absorption), ("emission", emission)];
        let [absorption, emission] =
            curves_from_samples(wavelengths_nm, columns, SampleRules::DYE)?;
        let (name, provenance) = (name.to_owned(), String::new());
        Ok(Self { name, absorption, emission, quantum_yield: None, provenance })
    }

    /// Every measured dye in the tables, in the order of their names.
    pub fn all() -> impl Iterator<Item = Self> {
        DYES.iter().map(Self::from)
    }

    /// The measured dye of this name.
    pub fn named(name: &str) -> Option<Self> {
        DYES.iter().find(|row| row.name == name).map(Self::from)
    }

    /// The names of the built-in sets.
    pub fn set_names() -> impl Iterator<Item = &'static str> {
        DYE_SETS.iter().map(|(stored, _)| {
            RENAMED.iter().find(|(_, old)| old == stored).map_or(*stored, |(name, _)| *name)
        })
    }

    /// The dyes of a built-in set in ring order: sorted by emission hue, the last beside the first.
    /// With them comes the name of the set in files.
    pub fn set(name: &str) -> Option<(&'static str, Vec<Self>)> {
        let stored = RENAMED.iter().find(|(new, _)| *new == name).map_or(name, |(_, old)| *old);
        let (stored, dyes) = DYE_SETS.iter().find(|(known, _)| *known == stored)?;
        let dyes: Option<Vec<_>> = dyes.iter().map(|dye| Self::named(dye)).collect();
        Some((*stored, dyes?))
    }
}

impl From<&DyeRow> for MeasuredDye {
    fn from(row: &DyeRow) -> Self {
        let grid = Grid::try_new(DYES_FIRST_NM, Grid::FINE.last_nm(), DYES_STEP_NM)
            .expect("the table is on a grid");
        let curve = |values: &[f64]| {
            Spectrum::new(grid, values.to_vec()).expect("the table is finite").resampled(Grid::FINE)
        };
        Self {
            name: row.name.into(),
            absorption: curve(&row.absorption),
            emission: curve(&row.emission),
            quantum_yield: row.quantum_yield,
            provenance: format!("{}; {}; {}", row.measured_by, row.published_at, row.terms),
        }
    }
}

/// Sets whose word is not the name that cubes were first written with; files keep that name.
const RENAMED: [(&str, &str); 1] = [("konig8", "seed8")];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dye_is_what_its_samples_are() {
        let known = MeasuredDye::named("ATTO_390").unwrap();
        let nm: Vec<f64> = Grid::FINE.wavelengths_nm().collect();
        let (absorption, emission) = (known.absorption.values(), known.emission.values());
        let sampled = MeasuredDye::from_samples("ATTO_390", &nm, absorption, emission).unwrap();
        assert_eq!(sampled.absorption, known.absorption);
        assert_eq!((&sampled.emission, sampled.quantum_yield), (&known.emission, None));
        let refused =
            MeasuredDye::from_samples("x", &nm[100..], &absorption[100..], &emission[100..]);
        assert!(refused.unwrap_err().to_string().starts_with("covers 400 to 830 nm, expected at"));
    }

    #[test]
    fn every_set_is_complete_and_every_curve_is_a_fraction() {
        let sizes: Vec<usize> =
            MeasuredDye::set_names().map(|n| MeasuredDye::set(n).unwrap().1.len()).collect();
        assert_eq!(sizes, [8, 8, 14]);
        for dye in MeasuredDye::all() {
            for curve in [&dye.absorption, &dye.emission] {
                assert!(curve.values().iter().all(|v| (0.0..=1.0).contains(v)), "{}", dye.name);
                assert!(curve.integral() > 1.0, "{}", dye.name);
            }
        }
    }
}
