//! The form of 4×4 matrices: what becomes of one of the four numbers of light.

use std::sync::Arc;

use upglow::{Cube, ReducedTable};
use upglow_color::{Choice as _, Grid, ReducedBasis, RgbSpace, choices};
use upglow_fit::BlendKinds;

use super::BakeError;
use super::attributes;
use super::blends::kinds;
use super::maker::{Filled, Maker};
use super::radiance::NAMES;
use crate::exr::attribute::Attributes;

/// One of the four numbers of the light that arrives, in an engine that keeps light as linear red, green and blue
/// and ultraviolet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Incident {
    /// Red.
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
    /// Ultraviolet, as [`ReducedBasis::ultraviolet_at`] weighs it.
    Ultraviolet,
}

choices!(
    Incident,
    "incident light",
    Red = "red",
    Green = "green",
    Blue = "blue",
    Ultraviolet = "ultraviolet",
);

/// For each texel a column of its blend's matrix: how much red, green, blue and ultraviolet leaves of one of
/// these that arrives.
#[derive(Debug)]
pub(super) struct MatrixMaker<'c> {
    cube: &'c Cube,
    matrices: EngineMatrices,
    incident: Incident,
    kinds: BlendKinds<'c>,
}

/// The matrices of a cube for an engine, which makers share.
#[derive(Clone, Debug)]
pub(super) struct EngineMatrices {
    /// The RGB space that the engine keeps light in.
    engine: RgbSpace,
    table: Arc<ReducedTable>,
}

impl EngineMatrices {
    /// The `latest` ones if they are for this engine; else new ones, which are then the latest.
    fn of(
        cube: &Cube,
        engine: Option<RgbSpace>,
        latest: &mut Option<Self>,
    ) -> Result<Self, BakeError> {
        let engine = engine.unwrap_or_else(|| cube.contract().space.clone());
        if let Some(known) = latest.as_ref().filter(|known| known.engine == engine) {
            return Ok(known.clone());
        }
        let basis = ReducedBasis::try_new(cube.contract(), Grid::FIT)?;
        let table = cube.reduced_table(&basis).in_engine(&basis.engine_space(&engine)?);
        Ok(latest.insert(Self { engine, table: table.into() }).clone())
    }
}

/// The name of the form.
const RGBU: &str = "rgbu";

/// What the four channels hold.
const CHANNELS: &str = "R, G, B, U: how much linear red, green, blue and ultraviolet of upglow.engine leaves of \
                        upglow.incident light of 1, as docs/rgb-engines.md of upglow describes; the \
                        values may be negative, and may be filtered";

impl<'c> MatrixMaker<'c> {
    pub(super) fn new(
        cube: &'c Cube,
        engine: Option<RgbSpace>,
        incident: Incident,
        latest: &mut Option<EngineMatrices>,
    ) -> Result<Self, BakeError> {
        let matrices = EngineMatrices::of(cube, engine, latest)?;
        Ok(Self { cube, matrices, incident, kinds: BlendKinds::new(cube) })
    }
}

impl Maker for MatrixMaker<'_> {
    fn channels(&self) -> Vec<String> {
        NAMES.into_iter().chain(["U"]).map(str::to_owned).collect()
    }

    fn attributes(&self) -> Attributes {
        let mut attributes = attributes::data(self.cube, RGBU, CHANNELS);
        attributes.insert("upglow.engine".into(), self.matrices.engine.name().into());
        attributes.insert("upglow.incident".into(), self.incident.name().into());
        attributes
    }

    fn fill(&self, rgb: &[[f32; 3]], planes: &mut [&mut [f32]]) -> Filled {
        for (texel, rgb) in rgb.iter().enumerate() {
            let matrix = self.matrices.table.matrix(*rgb);
            let matrix = matrix.expect("texels outside were repaired or refused");
            for (plane, row) in planes.iter_mut().zip(matrix) {
                plane[texel] = row[self.incident as usize];
            }
        }
        kinds(&self.kinds, rgb).into()
    }
}
