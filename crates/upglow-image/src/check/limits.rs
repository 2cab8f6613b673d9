//! The colors that pictures are checked against.

use std::sync::OnceLock;

use upglow::{ColorTable, Cube};
use upglow_color::Contract;
use upglow_fit::{BlendKinds, StandingTable};

use super::alternatives::Alternatives;
use super::dye_use::Doses;
use super::palette::{Ramp, dose_ramp};

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
    cube: &'c Cube,
    /// The name of the cube's file.
    pub(super) file: String,
    pub(super) colors: ColorTable,
    pub(super) kinds: BlendKinds<'c>,
    pub(super) doses: Doses<'c>,
    alternatives: OnceLock<Alternatives<'c>>,
}

impl<'c> Limits<'c> {
    /// The limits of a contract, which is also that of the cube, given with the name of its file.
    pub(super) fn new(contract: Contract, cube: Option<(&'c Cube, &str)>) -> Self {
        let table = StandingTable::new(&contract);
        let cube = cube.map(|(cube, file)| Blends {
            cube,
            file: file.into(),
            colors: cube.color_table(table.colorimetry()),
            kinds: BlendKinds::new(cube),
            doses: Doses::new(cube),
            alternatives: OnceLock::new(),
        });
        Self { contract, table, cube }
    }
}

impl<'c> Blends<'c> {
    /// What explains misses; made when it is first needed.
    pub(super) fn alternatives(&self) -> &Alternatives<'c> {
        self.alternatives.get_or_init(|| Alternatives::new(self.cube))
    }

    /// The ramp for the doses of the cube.
    pub(super) fn dose_ramp(&self) -> Ramp {
        dose_ramp(self.cube.model())
    }
}
