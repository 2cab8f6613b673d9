//! The built-in measured dyes. A new one is two columns of `tables/dyes.csv`.

use std::path::Path;

use crate::grid::Grid;
use crate::names::{NameError, name_after_file};
use crate::samples::{SampleRules, SamplesError, check_peak, curves_from_samples};
use crate::spectrum::Spectrum;
use crate::tables::dyes::{DYE_SETS, DYES, DYES_FIRST_NM, DYES_STEP_NM, DyeRow};

/// A measured dye.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredDye {
    /// The dye's name, without spaces.
    pub name: String,
    /// Absorption or excitation spectrum, dimensionless, on [`Grid::FINE`]; as published, 1 at its peak.
    pub absorption: Spectrum,
    /// Emission spectrum, relative, on [`Grid::FINE`]; as published, 1 at its peak.
    pub emission: Spectrum,
    /// Emitted photons per absorbed photon, 0..=1; `None` if unpublished.
    pub quantum_yield: Option<f64>,
    /// Who measured it, where it was published, and under what terms.
    pub provenance: String,
}

impl MeasuredDye {
    /// A dye from samples: ascending wavelengths (nm) from 300 to 830 nm in steps of at most 5 nm, and
    /// for each the absorption, 0 to 1, and the relative emission, 0 or more. NaN at either end of a
    /// curve means "not measured there" and counts as zero.
    ///
    /// Quantum yield and provenance are empty: set what is known.
    ///
    /// # Errors
    ///
    /// [`SamplesError`] names the index of the sample, and what was expected there.
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

    /// The dye with both curves divided by their peaks, as most spectra are published.
    #[must_use]
    pub fn normalized(self) -> Self {
        let to_one = |curve: Spectrum| {
            let peak = curve.peak();
            let values = curve.values().iter().map(|v| v / peak).collect();
            Spectrum::new(curve.grid(), values).unwrap_or(curve)
        };
        Self { absorption: to_one(self.absorption), emission: to_one(self.emission), ..self }
    }

    /// The dye named after a file: by its stem, or by its whole name where the stem is that of a
    /// built-in dye with other numbers.
    #[must_use]
    pub fn named_after(self, path: &Path) -> Self {
        let is_taken = |name: &str| {
            let dye = Self { name: name.into(), ..self.clone() };
            matches!(dye.check_name(), Err(NameError::Taken { .. }))
        };
        Self { name: name_after_file(path, is_taken), ..self }
    }

    /// Checks that name and provenance are lines of text, and that a built-in name comes with the
    /// built-in curves and quantum yield.
    ///
    /// # Errors
    ///
    /// [`NameError`] says which number differs.
    pub fn check_name(&self) -> Result<(), NameError> {
        NameError::check_text(&self.name)?;
        NameError::check_text(&self.provenance)?;
        let Some(known) = Self::named(&self.name) else { return Ok(()) };
        let check = |column, found: &Spectrum, known: &Spectrum| {
            NameError::check_curve("dye", &self.name, column, found, known, 0.0)
        };
        check("absorption", &self.absorption.resampled(Grid::FINE), &known.absorption)?;
        check("emission", &self.emission.resampled(Grid::FINE), &known.emission)?;
        if self.quantum_yield == known.quantum_yield {
            return Ok(());
        }
        let text = |q: Option<f64>| q.map_or("unpublished".into(), |q| q.to_string());
        Err(NameError::Taken {
            kind: "dye",
            name: self.name.clone(),
            number: "quantum yield".into(),
            expected: text(known.quantum_yield),
            found: text(self.quantum_yield),
        })
    }

    /// Checks that the greatest sample of the emission can be calculated with: 1e-30 to 1e30.
    ///
    /// # Errors
    ///
    /// [`SamplesError::Peak`] holds it.
    pub fn check_emission_peak(&self) -> Result<(), SamplesError> {
        check_peak("emission", &self.emission)
    }

    /// Every built-in dye, in order of their names.
    pub fn all() -> impl Iterator<Item = Self> {
        DYES.iter().map(Self::from)
    }

    /// The built-in dye of this name.
    pub fn named(name: &str) -> Option<Self> {
        DYES.iter().find(|row| row.name == name).map(Self::from)
    }

    /// The names of the built-in sets.
    pub fn set_names() -> impl Iterator<Item = &'static str> {
        DYE_SETS.iter().map(|(stored, _)| {
            RENAMED.iter().find(|(_, old)| old == stored).map_or(*stored, |(name, _)| *name)
        })
    }

    /// The name of a built-in set in files, and its dyes in ring order: by emission hue, the last next
    /// to the first.
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
            provenance: joined([row.measured_by, row.published_at, row.terms]),
        }
    }
}

/// The facts that are known, in one line.
fn joined(facts: [&str; 3]) -> String {
    facts.into_iter().filter(|fact| !fact.is_empty()).collect::<Vec<_>>().join("; ")
}

/// Sets that were renamed, with the former names; files keep these.
const RENAMED: [(&str, &str); 1] = [("konig8", "seed8")];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_provenance_of_every_built_in_dye_has_only_what_is_known() {
        for dye in MeasuredDye::all() {
            assert!(dye.provenance.split("; ").all(|fact| !fact.is_empty()), "{}", dye.provenance);
        }
        assert_eq!(joined(["", "paper", "CC0"]), "paper; CC0");
    }

    #[test]
    fn a_dye_from_samples_has_their_curves() {
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
    fn a_built_in_name_is_for_the_built_in_numbers_only() {
        let known = MeasuredDye::named("ATTO_390").unwrap();
        assert_eq!(known.check_name(), Ok(()));
        let brighter = MeasuredDye { quantum_yield: Some(1.0), ..known.clone() };
        let expected = "\"ATTO_390\" is a built-in dye whose quantum yield is 0.9, found 1: \
                        expected the built-in numbers, or another name";
        assert_eq!(brighter.check_name().unwrap_err().to_string(), expected);
        let swapped = MeasuredDye { name: "ATTO_425".into(), ..known.clone() };
        assert!(swapped.check_name().is_err());
        assert_eq!(brighter.named_after(Path::new("my/ATTO_390.csv")).name, "ATTO_390.csv");
        assert_eq!(known.named_after(Path::new("my/ATTO_390.csv")).name, "ATTO_390");
    }

    #[test]
    fn normalized_curves_peak_at_one() {
        let known = MeasuredDye::named("ATTO_390").unwrap();
        let emission = known.emission.clone().scaled(4.0);
        let absorption = known.absorption.clone().scaled(0.25);
        let dye = MeasuredDye { absorption, emission, ..known.clone() }.normalized();
        assert_eq!(dye, known.normalized());
        assert_eq!((dye.absorption.peak(), dye.emission.peak()), (1.0, 1.0));
    }

    #[test]
    fn every_set_is_complete_and_every_curve_is_a_fraction() {
        let sizes: Vec<usize> =
            MeasuredDye::set_names().map(|n| MeasuredDye::set(n).unwrap().1.len()).collect();
        assert_eq!(sizes, [8, 8, 14, 8]);
        for dye in MeasuredDye::all() {
            for curve in [&dye.absorption, &dye.emission] {
                assert!(curve.values().iter().all(|v| (0.0..=1.0).contains(v)), "{}", dye.name);
                assert!(curve.integral() > 1.0, "{}", dye.name);
            }
        }
    }
}
