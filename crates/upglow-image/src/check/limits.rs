//! What pictures are checked against.

use upglow::{ColorTable, Cube};
use upglow_color::Contract;
use upglow_fit::StandingTable;

/// What materials show under a contract, and, if there is a cube, what its materials show.
#[derive(Debug)]
pub(super) struct Limits {
    pub(super) contract: Contract,
    pub(super) table: StandingTable,
    pub(super) cube: Option<ColorTable>,
}

impl Limits {
    /// The limits of a contract; `cube`, if there is one, was built for it.
    pub(super) fn new(contract: Contract, cube: Option<&Cube>) -> Self {
        let table = StandingTable::new(&contract);
        let cube = cube.map(|cube| cube.color_table(table.colorimetry()));
        Self { contract, table, cube }
    }
}
