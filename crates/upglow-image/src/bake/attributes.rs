//! What baked files say of the cube they were made with.

use upglow::{Cube, Node};

use crate::exr::attribute::{Attribute, Attributes};
use crate::picture::chromaticities::chromaticities;

/// The header of the cube as JSON: contract, model, fit.
pub(crate) const HEADER: &str = "upglow.header";
/// A cube file of two empty nodes a side: the same contract, model and curves, for programs.
pub(crate) const MODEL: &str = "upglow.model";
/// Name of the form: material, spectral or radiance.
pub(crate) const FORM: &str = "upglow.form";
/// What the channels hold, in words.
pub(crate) const CHANNELS: &str = "upglow.channels";

const MODEL_KIND: &str = "upglowCube";

/// What every form says.
pub(crate) fn common(cube: &Cube, form: &str, channels: &str) -> Attributes {
    let text = |text: &str| Attribute::Text(text.into());
    Attributes::from([
        ("chromaticities".to_owned(), chromaticities(&cube.contract().space)),
        (HEADER.to_owned(), text(&cube.header_json())),
        (FORM.to_owned(), text(form)),
        (CHANNELS.to_owned(), text(channels)),
    ])
}

/// The contract, model and curves of a cube without its materials.
pub(crate) fn model(cube: &Cube) -> Attribute {
    let [least, _] = Cube::RESOLUTIONS;
    let nodes = vec![Node::default(); least.pow(3)];
    let (contract, model, fit) =
        (cube.contract().clone(), cube.model().clone(), cube.fit().clone());
    let empty = Cube::new(contract, model, fit, least, nodes).expect("empty nodes fit any model");
    let bytes = empty.to_bytes().expect("a valid cube has a file");
    Attribute::Other { kind: MODEL_KIND.into(), bytes }
}

/// The cube without materials that [`model`] stored; `None` where there is none or it is damaged.
pub(crate) fn read_model(attributes: &Attributes) -> Option<Cube> {
    match attributes.get(MODEL)? {
        Attribute::Other { kind, bytes } if kind == MODEL_KIND => Cube::from_bytes(bytes).ok(),
        _ => None,
    }
}
