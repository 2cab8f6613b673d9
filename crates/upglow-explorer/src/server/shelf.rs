//! The cubes that the server keeps.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, OnceLock};

use axum::body::Bytes;
use upglow::Cube;

use super::answer::Refusal;
use super::explain::Explainer;
use super::locked::locked;
use crate::cube_data::{CubeData, ExplorerError};

/// How many of the cubes that were built are kept, besides the first: enough to compare. With five cubes of
/// 64 nodes along each axis the program takes 270 MB.
const KEPT: usize = 4;

/// A cube, with what the page has asked of it so far.
#[derive(Debug)]
pub(super) struct Held {
    pub(super) id: u32,
    pub(super) name: String,
    pub(super) cube: Cube,
    pub(super) arrays: Bytes,
    pub(super) script: Bytes,
    pub(super) shader: Bytes,
    borders: OnceLock<Result<Bytes, ExplorerError>>,
    explainer: OnceLock<Result<Explainer, String>>,
}

impl Held {
    pub(super) fn new(id: u32, cube: Cube, name: &str) -> Result<Self, ExplorerError> {
        let CubeData { script, shader, arrays } = CubeData::new(&cube, name)?;
        Ok(Self {
            id,
            name: name.into(),
            cube,
            arrays: arrays.into(),
            script: script.into(),
            shader: shader.into(),
            borders: OnceLock::new(),
            explainer: OnceLock::new(),
        })
    }

    /// [`CubeData::borders`], which takes long at the first call.
    pub(super) fn borders(&self) -> Result<Bytes, Refusal> {
        let new = || CubeData::borders(&self.cube).map(Bytes::from);
        self.borders.get_or_init(new).clone().map_err(Refusal::unusable)
    }

    /// What explains colors beside this cube; takes longer at the first call.
    pub(super) fn explainer(&self) -> Result<&Explainer, Refusal> {
        let explainer = self.explainer.get_or_init(|| Explainer::new(&self.cube));
        explainer.as_ref().map_err(Refusal::unusable)
    }
}

/// The first cube and the last ones that were built.
#[derive(Debug)]
pub(super) struct Shelf {
    first: Arc<Held>,
    built: Mutex<VecDeque<Arc<Held>>>,
}

impl Shelf {
    pub(super) fn new(first: Held) -> Self {
        Self { first: Arc::new(first), built: Mutex::default() }
    }

    /// All cubes, the newest last.
    pub(super) fn all(&self) -> Vec<Arc<Held>> {
        let built = locked(&self.built);
        std::iter::once(&self.first).chain(built.iter()).cloned().collect()
    }

    pub(super) fn get(&self, id: u32) -> Result<Arc<Held>, Refusal> {
        let found = self.all().into_iter().find(|held| held.id == id);
        found.ok_or_else(|| Refusal::not_found("cube; only the first and the last four are kept"))
    }

    pub(super) fn add(&self, held: Held) {
        let mut built = locked(&self.built);
        built.push_back(Arc::new(held));
        if built.len() > KEPT {
            built.pop_front();
        }
    }
}
