//! The colors that pictures are checked against.

use upglow::{ColorTable, Cube};
use upglow_color::Contract;
use upglow_fit::{BlendKinds, StandingTable};

/// The colors that materials match under a contract, and the blends of a cube if there is one.
#[derive(Debug)]
pub(super) struct Limits<'c> {
    pub(super) contract: Contract,
    pub(super) table: StandingTable,
    pub(super) cube: Option<Blends<'c>>,
}

/// The blends of a cube.
#[derive(Debug)]
pub(super) struct Blends<'c> {
    pub(super) colors: ColorTable,
    pub(super) kinds: BlendKinds<'c>,
}

impl<'c> Limits<'c> {
    /// The limits of a contract, which is also that of `cube`.
    pub(super) fn new(contract: Contract, cube: Option<&'c Cube>) -> Self {
        let table = StandingTable::new(&contract);
        let cube = cube.map(|cube| Blends {
            colors: cube.color_table(table.colorimetry()),
            kinds: BlendKinds::new(cube),
        });
        Self { contract, table, cube }
    }
}
