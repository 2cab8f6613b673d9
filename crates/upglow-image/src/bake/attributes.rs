//! What baked files say of the cube they were made with.

use upglow::{Cube, Node};

use crate::exr::attribute::{Attribute, Attributes, chromaticities};
use crate::spectral::channel::{LAYOUT_VERSION, LAYOUT_VERSION_VALUE};

/// The header of the cube as JSON: contract, model, fit.
pub(super) const HEADER: &str = "upglow.header";
/// A cube file of two empty nodes a side: the same contract, model and curves, for programs.
pub(super) const MODEL: &str = "upglow.model";
/// Name of the form: material, spectral or radiance.
pub(super) const FORM: &str = "upglow.form";
/// What the channels hold, in words.
pub(super) const CHANNELS: &str = "upglow.channels";

const MODEL_KIND: &str = "upglowCube";

/// What every form says.
pub(super) fn common(cube: &Cube, form: &str, channels: &str) -> Attributes {
    Attributes::from([
        ("chromaticities".to_owned(), chromaticities(&cube.contract().space)),
        (HEADER.to_owned(), cube.header_json().into()),
        (FORM.to_owned(), form.into()),
        (CHANNELS.to_owned(), channels.into()),
    ])
}

/// What both spectral forms say.
pub(super) fn spectral(cube: &Cube, channels: &str) -> Attributes {
    let mut attributes = common(cube, "spectral", channels);
    attributes.insert(LAYOUT_VERSION.into(), LAYOUT_VERSION_VALUE.into());
    attributes
}

/// The contract, model and curves of a cube without its materials.
pub(super) fn model(cube: &Cube) -> Attribute {
    let [least, _] = Cube::RESOLUTIONS;
    let nodes = vec![Node::default(); least.pow(3)];
    let (contract, model, fit) =
        (cube.contract().clone(), cube.model().clone(), cube.fit().clone());
    let empty = Cube::new(contract, model, fit, least, nodes).expect("empty nodes fit any model");
    let bytes = empty.to_bytes();
    Attribute::Other { kind: MODEL_KIND.into(), bytes }
}

/// The cube without materials that [`model`] stored; `None` where there is none or it is damaged.
pub(super) fn read_model(attributes: &Attributes) -> Option<Cube> {
    match attributes.get(MODEL)? {
        Attribute::Other { kind, bytes } if kind == MODEL_KIND => Cube::from_bytes(bytes).ok(),
        _ => None,
    }
}
