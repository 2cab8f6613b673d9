//! Baked materials, read back.

use std::path::Path;

use upglow::{Cube, Material, Model, Node, NodeError};
use upglow_color::Contract;

use crate::bake::attributes::{MODEL, read_model};
use crate::bake::material::{BELLS, DYES, REFLECTANCE, node_of};
use crate::exr::error::ExrError;
use crate::exr::reader::ExrReader;

/// Why a file gives no materials.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MaterialPictureError {
    /// The file cannot be read.
    #[error(transparent)]
    Exr(#[from] ExrError),
    /// It says nothing, or nothing sound, of the model behind its numbers.
    #[error(
        "attribute {MODEL} is absent or damaged, expected a file of `upglow bake --as material`"
    )]
    Model,
    /// A texel's numbers make no material of the model.
    #[error("texel {x},{y}")]
    Texel {
        /// Column, from 0 at the left.
        x: usize,
        /// Row, from 0 at the top.
        y: usize,
        /// What is wrong with it.
        source: NodeError,
    },
}

/// A file of one material a texel, as `docs/material-exr.md` describes it, opened for reading.
#[derive(Debug)]
pub struct MaterialPicture {
    reader: ExrReader,
    /// Contract, model and curves, without materials.
    cube: Cube,
    channels: Vec<usize>,
}

impl MaterialPicture {
    /// Whether a file claims to hold materials.
    pub fn is_stated(reader: &ExrReader) -> bool {
        reader.attributes().contains_key(MODEL)
    }

    /// Opens a file.
    ///
    /// # Errors
    ///
    /// [`MaterialPictureError`] if it cannot be read or holds no materials.
    pub fn open(path: &Path) -> Result<Self, MaterialPictureError> {
        let reader = ExrReader::open(path)?;
        let cube = read_model(reader.attributes()).ok_or(MaterialPictureError::Model)?;
        let fluorescence: &[&str] = match cube.model() {
            Model::Reflectance => &[],
            Model::Dyes(_) => &DYES,
            Model::Analytic(_) => &BELLS,
        };
        let names = REFLECTANCE.iter().chain(fluorescence);
        let channels = names.map(|name| reader.channel(name)).collect::<Result<_, _>>()?;
        Ok(Self { reader, cube, channels })
    }

    /// Width and height, texels.
    pub fn size(&self) -> [usize; 2] {
        self.reader.size()
    }

    /// What RGB meant when it was baked.
    pub fn contract(&self) -> &Contract {
        self.cube.contract()
    }

    /// What the fluorescence is made of.
    pub fn model(&self) -> &Model {
        self.cube.model()
    }

    /// The materials of a row, from the left.
    ///
    /// # Errors
    ///
    /// [`MaterialPictureError`] if there is no such row, or it is damaged.
    pub fn row(&mut self, y: usize) -> Result<Vec<Material>, MaterialPictureError> {
        let [width, _] = self.size();
        self.region(0..width, y)
    }

    /// The material of a texel.
    ///
    /// # Errors
    ///
    /// [`MaterialPictureError`] if there is no such texel, or it is damaged.
    pub fn at(&mut self, x: usize, y: usize) -> Result<Material, MaterialPictureError> {
        Ok(self.region(x..x + 1, y)?[0])
    }

    fn region(
        &mut self,
        columns: std::ops::Range<usize>,
        y: usize,
    ) -> Result<Vec<Material>, MaterialPictureError> {
        let planes = self.reader.read_region(columns.clone(), y..y + 1, &self.channels)?;
        let each = columns.enumerate().map(|(i, x)| {
            let mut values = [0.0; 6];
            values.iter_mut().zip(&planes).for_each(|(value, plane)| *value = plane[i]);
            let node = node_of(values, self.cube.model());
            self.material(node).map_err(|source| MaterialPictureError::Texel { x, y, source })
        });
        each.collect()
    }

    fn material(&self, node: Node) -> Result<Material, NodeError> {
        node.check(self.cube.model())?;
        Ok(node.material(self.cube.model()))
    }
}
