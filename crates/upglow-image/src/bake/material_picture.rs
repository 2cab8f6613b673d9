//! Baked materials, read back.

use std::ops::Range;
use std::path::Path;

use upglow::{Cube, Material, Model};

use super::Form;
use super::attributes::read_model;
use super::material::{MATERIAL, MOST_CHANNELS, channel_names, node_of};
use crate::exr::reader::ExrReader;
use crate::spectral::error::FormError;

/// Reads a file of one material per texel, as `docs/material-exr.md` describes it.
#[derive(Debug)]
pub struct MaterialPicture {
    reader: ExrReader,
    /// Contract, model and curves, without materials.
    cube: Cube,
    channels: Vec<usize>,
}

impl MaterialPicture {
    /// Whether the attributes of a file say that it holds materials.
    pub fn is_stated(reader: &ExrReader) -> bool {
        Form::stated(reader) == Some(MATERIAL)
    }

    /// Opens a file.
    ///
    /// # Errors
    ///
    /// [`FormError`] if it cannot be read or holds no materials.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, FormError> {
        Self::open_level(path, 0)
    }

    /// Opens a level of a file: 0 is the full one.
    ///
    /// # Errors
    ///
    /// [`FormError`] if it cannot be read, has no such level or holds no materials.
    pub fn open_level(path: impl AsRef<Path>, level: usize) -> Result<Self, FormError> {
        let reader = ExrReader::open_level(path, level)?;
        let cube = read_model(reader.attributes())?;
        let names = channel_names(cube.model());
        let channels = names.map(|name| reader.channel(name)).collect::<Result<_, _>>()?;
        Ok(Self { reader, cube, channels })
    }

    /// Width and height, texels.
    pub fn size(&self) -> [usize; 2] {
        self.reader.size()
    }

    /// The model of the materials.
    pub fn model(&self) -> &Model {
        self.cube.model()
    }

    /// The materials of a row, from the left.
    ///
    /// # Errors
    ///
    /// [`FormError`] if there is no such row, or it is damaged.
    pub fn row(&mut self, y: usize) -> Result<Vec<Material>, FormError> {
        let [width, _] = self.size();
        self.region(0..width, y)
    }

    /// The material of a texel.
    ///
    /// # Errors
    ///
    /// [`FormError`] if there is no such texel, or it is damaged.
    pub fn at(&mut self, x: usize, y: usize) -> Result<Material, FormError> {
        Ok(self.region(x..x + 1, y)?[0])
    }

    fn region(&mut self, columns: Range<usize>, y: usize) -> Result<Vec<Material>, FormError> {
        let planes = self.reader.read_region(columns.clone(), y..y + 1, &self.channels)?;
        let each = columns.enumerate().map(|(i, x)| {
            let mut values = [0.0; MOST_CHANNELS];
            values.iter_mut().zip(&planes).for_each(|(value, plane)| *value = plane[i]);
            let node = node_of(values, self.model());
            let checked = node.check(self.model());
            checked.map_err(|source| FormError::Material { x, y, source })?;
            Ok(node.material(self.model()))
        });
        each.collect()
    }
}
