//! Attributes of baked files that describe the cube they were made with.

use upglow::{Cube, Node};

use crate::exr::attribute::{Attribute, Attributes, chromaticities};
use crate::spectral::channel::{LAYOUT_VERSION, LAYOUT_VERSION_VALUE};

/// The header of the cube as JSON: contract, model, fit.
pub(super) const HEADER: &str = "upglow.header";
/// A cube file of two empty nodes per side: the same contract, model and curves, for programs.
pub(super) const MODEL: &str = "upglow.model";
/// Name of the form: material, spectral or radiance.
pub(super) const FORM: &str = "upglow.form";
/// What the channels hold, in words.
pub(super) const CHANNELS: &str = "upglow.channels";

/// A hash of everything that made the file.
pub(super) const MADE: &str = "upglow.made";

const MODEL_KIND: &str = "upglowCube";

/// The attributes of every form.
pub(super) fn common(cube: &Cube, form: &str, channels: &str) -> Attributes {
    Attributes::from([
        ("chromaticities".to_owned(), chromaticities(&cube.contract().space)),
        (HEADER.to_owned(), cube.header_json().into()),
        (FORM.to_owned(), form.into()),
        (CHANNELS.to_owned(), channels.into()),
    ])
}

/// The attributes of both spectral forms.
pub(super) fn spectral(cube: &Cube, channels: &str) -> Attributes {
    let mut attributes = common(cube, "spectral", channels);
    attributes.insert(LAYOUT_VERSION.into(), LAYOUT_VERSION_VALUE.into());
    attributes
}

/// The contract, model and curves of a cube without its materials.
pub(super) fn model(cube: &Cube) -> Attribute {
    let [least, _] = Cube::RESOLUTIONS;
    let nodes = vec![Node::default(); least.pow(3)];
    let (contract, model) = (cube.contract().clone(), cube.model().clone());
    let empty = Cube::new(contract, model, cube.fit().clone(), least, nodes);
    Attribute::new(MODEL_KIND, empty.expect("empty nodes fit any model").to_bytes())
}

/// The cube without materials that [`model`] stored; `None` if it is absent or damaged.
pub(super) fn read_model(attributes: &Attributes) -> Option<Cube> {
    Cube::from_bytes(attributes.get(MODEL)?.of_kind(MODEL_KIND)?).ok()
}
