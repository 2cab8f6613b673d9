//! The measured dyes that come with the program. A new one is a column of `tables/dyes.csv`.

use crate::tables::dyes::{DYE_SETS, DYES, DYES_FIRST_NM, DYES_STEP_NM, DyeRow};
use crate::{Grid, Spectrum};

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

/// Every measured dye in the tables, in the order of their names.
pub fn measured_dyes() -> impl Iterator<Item = MeasuredDye> {
    DYES.iter().map(MeasuredDye::from)
}

/// The measured dye of this name.
pub fn measured_dye(name: &str) -> Option<MeasuredDye> {
    DYES.iter().find(|row| row.name == name).map(MeasuredDye::from)
}

/// The names of the built-in sets.
pub fn dye_set_names() -> impl Iterator<Item = &'static str> {
    DYE_SETS.iter().map(|(name, _)| *name)
}

/// The dyes of a built-in set in ring order: sorted by emission hue, the last beside the first.
pub fn dye_set(name: &str) -> Option<Vec<MeasuredDye>> {
    let (_, dyes) = DYE_SETS.iter().find(|(known, _)| *known == name)?;
    dyes.iter().map(|dye| measured_dye(dye)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_set_is_complete_and_every_curve_is_a_fraction() {
        let sizes: Vec<usize> = dye_set_names().map(|n| dye_set(n).unwrap().len()).collect();
        assert_eq!(sizes, [8, 8, 14]);
        for dye in measured_dyes() {
            for curve in [&dye.absorption, &dye.emission] {
                assert!(curve.values().iter().all(|v| (0.0..=1.0).contains(v)), "{}", dye.name);
                assert!(curve.integral() > 1.0, "{}", dye.name);
            }
        }
    }
}
