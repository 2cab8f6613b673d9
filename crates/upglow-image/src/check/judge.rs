//! What pictures are checked against.

use upglow::{ColorTable, Cube};
use upglow_color::{Contract, Grid};
use upglow_fit::StandingTable;

/// A contract's limits of physics, and, if asked, what a cube's materials show.
#[derive(Debug)]
pub struct Judge {
    table: StandingTable,
    cube: Option<ColorTable>,
}

/// A cube cannot judge pictures of this contract.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum JudgeError {
    /// It was built for another one.
    #[error("the cube was built for another RGB space, light, observer or adaptation")]
    Contract,
}

impl Judge {
    /// Judges by physics alone.
    pub fn new(contract: &Contract) -> Self {
        Self { table: StandingTable::new(contract), cube: None }
    }

    /// Also asks `cube` how well its blend shows each texel.
    ///
    /// # Errors
    ///
    /// [`JudgeError::Contract`] if it was built for another contract.
    pub fn with_cube(self, cube: &Cube) -> Result<Self, JudgeError> {
        let colorimetry = self.table.colorimetry();
        if cube.contract().on(Grid::FIT) != *colorimetry {
            return Err(JudgeError::Contract);
        }
        let colors = cube.color_table(colorimetry);
        Ok(Self { cube: Some(colors), ..self })
    }

    /// Which kind of material each color needs.
    pub fn table(&self) -> &StandingTable {
        &self.table
    }

    pub(super) fn cube(&self) -> Option<&ColorTable> {
        self.cube.as_ref()
    }

    pub(super) fn has_cube(&self) -> bool {
        self.cube.is_some()
    }
}
