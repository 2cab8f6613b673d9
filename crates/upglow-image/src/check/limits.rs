//! The colors that pictures are checked against.

use upglow::{ColorTable, Cube};
use upglow_color::Contract;
use upglow_fit::StandingTable;

/// The colors that materials match under a contract, and those of a cube's mixtures if there is one.
#[derive(Debug)]
pub(super) struct Limits {
    pub(super) contract: Contract,
    pub(super) table: StandingTable,
    pub(super) cube: Option<ColorTable>,
}

impl Limits {
    /// The limits of a contract, which is also that of `cube`.
    pub(super) fn new(contract: Contract, cube: Option<&Cube>) -> Self {
        let table = StandingTable::new(&contract);
        let cube = cube.map(|cube| cube.color_table(table.colorimetry()));
        Self { contract, table, cube }
    }
}
