//! Standard observers.

use crate::tables::observer::{CIE_1931_2DEG, CIE_1931_2DEG_FIRST_NM};
use crate::{Grid, Spectrum};

/// A set of color-matching functions.
#[derive(Clone, Debug, PartialEq)]
pub struct Observer {
    name: &'static str,
    /// x̄, ȳ, z̄ on [`Grid::FINE`].
    matching: [Spectrum; 3],
}

impl Observer {
    /// The CIE 1931 2° standard observer: measured from 360 to 830 nm, zero below.
    pub fn cie_1931_2deg() -> Self {
        let lead = (CIE_1931_2DEG_FIRST_NM - Grid::FINE.first_nm()) as usize;
        let matching = [0, 1, 2].map(|channel| {
            let mut values = vec![0.0; Grid::FINE.len()];
            for (value, row) in values[lead..].iter_mut().zip(&CIE_1931_2DEG) {
                *value = row[channel];
            }
            Spectrum::new(Grid::FINE, values).expect("the table is finite and fills the grid")
        });
        Self { name: "CIE 1931 2°", matching }
    }

    /// The name that files state.
    pub fn name(&self) -> &str {
        self.name
    }

    /// x̄, ȳ, z̄ at every wavelength of `grid`, `[wavelength][x̄ ȳ z̄]`.
    pub fn on(&self, grid: Grid) -> Vec<[f64; 3]> {
        grid.wavelengths_nm().map(|nm| [0, 1, 2].map(|k| self.matching[k].at(nm))).collect()
    }
}

impl Default for Observer {
    fn default() -> Self {
        Self::cie_1931_2deg()
    }
}
