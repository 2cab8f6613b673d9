//! Attributes of baked files that describe the cube they were made with.

use upglow::{Cube, CubeCurves, ReadCubeError};
use upglow_color::Grid;

use crate::exr::attribute::{Attribute, Attributes, INTEROP_ID, stated_space};
use crate::picture::interop::InteropSpace;
use crate::spectral::attribute_spectrum::{parse_spectrum, print_spectrum};
use crate::spectral::channel::{LAYOUT_VERSION, LAYOUT_VERSION_VALUE};
use crate::spectral::error::FormError;
use crate::spectral::stated::stated;

/// The header of the cube as JSON: contract, model, fit.
pub(super) const HEADER: &str = "upglow.header";
/// Name of the form: material, spectral, radiance or rgbu.
pub(super) const FORM: &str = "upglow.form";
/// What the channels hold, in words.
pub(super) const CHANNELS: &str = "upglow.channels";

/// A hash of everything that made the file.
pub(super) const MADE: &str = "upglow.made";

/// The attribute of earlier versions in place of the curves: a cube file without materials.
const MODEL: &str = "upglow.model";
const MODEL_KIND: &str = "upglowCube";

/// The attributes of every form.
fn common(cube: &Cube, form: &str, channels: &str) -> Attributes {
    Attributes::from([
        (HEADER.to_owned(), cube.header_json().into()),
        (FORM.to_owned(), form.into()),
        (CHANNELS.to_owned(), channels.into()),
    ])
}

/// The attributes of a file whose channels are no colors.
pub(super) fn data(cube: &Cube, form: &str, channels: &str) -> Attributes {
    let mut attributes = common(cube, form, channels);
    attributes.insert(INTEROP_ID.into(), InteropSpace::DATA.into());
    attributes
}

/// The attributes of a file with colors in the cube's space, linear.
pub(super) fn colors(cube: &Cube, form: &str, channels: &str) -> Attributes {
    let mut attributes = common(cube, form, channels);
    attributes.extend([stated_space(&cube.contract().space)]);
    attributes
}

/// The attributes of both spectral forms, which have a preview in color.
pub(super) fn spectral(cube: &Cube, channels: &str) -> Attributes {
    let mut attributes = colors(cube, "spectral", channels);
    attributes.insert(LAYOUT_VERSION.into(), LAYOUT_VERSION_VALUE.into());
    attributes
}

/// The light's curve, in [`curves`].
const LIGHT: &str = "upglow.curve.light";

/// The observer's curves, in [`curves`].
const OBSERVER: [&str; 3] =
    ["upglow.curve.observer.x", "upglow.curve.observer.y", "upglow.curve.observer.z"];

/// The names of a dye's curves, in [`curves`], by its index as in the channels.
fn dye_curves(dye: usize) -> [String; 2] {
    ["absorption", "emission"].map(|what| format!("upglow.curve.dye.{dye}.{what}"))
}

/// The curves that the header names, as text, because programs that copy a file drop attributes of types
/// that they do not know.
pub(super) fn curves(cube: &Cube) -> Attributes {
    let nm: Vec<f64> = Grid::FINE.wavelengths_nm().collect();
    let text = |values: &[f64]| Attribute::from(print_spectrum(&nm, values));
    let CubeCurves { illuminant, observer, dyes } = cube.curves();
    let mut curves = Attributes::from([(LIGHT.to_owned(), text(&illuminant))]);
    for (name, values) in OBSERVER.iter().zip(observer.iter().flatten()) {
        curves.insert((*name).into(), text(values));
    }
    for (i, dye) in dyes.iter().enumerate() {
        curves.extend(dye_curves(i).into_iter().zip(dye.iter().map(|values| text(values))));
    }
    curves
}

/// The contract and model of the cube that a file was made with, without its materials.
///
/// # Errors
///
/// [`FormError`] if they are absent or damaged.
pub(super) fn read_model(attributes: &Attributes) -> Result<Cube, FormError> {
    let damaged = |name: &str, error: &ReadCubeError| FormError::Attribute {
        name: name.into(),
        found: format!("damaged: {error}"),
        expected: EXPECTED.into(),
    };
    if let Some(file) = attributes.get(MODEL).and_then(|model| model.of_kind(MODEL_KIND)) {
        return Cube::from_bytes(file).map_err(|error| damaged(MODEL, &error));
    }
    let header = stated(attributes, HEADER, EXPECTED, |text| Some(text.to_owned()))?;
    let curve = |name: &str| {
        const EXPECTED: &str = "531 numbers as 300nm:0.5;301nm:0.6;";
        stated(attributes, name, EXPECTED, |text| {
            let (nm, values) = parse_spectrum(text)?;
            nm.into_iter().eq(Grid::FINE.wavelengths_nm()).then_some(values)
        })
    };
    let [x, y, z] = OBSERVER.map(curve);
    let mut curves =
        CubeCurves { illuminant: curve(LIGHT)?, observer: Some([x?, y?, z?]), dyes: Vec::new() };
    loop {
        let [absorption, emission] = dye_curves(curves.dyes.len());
        if !attributes.contains_key(&absorption) {
            break;
        }
        curves.dyes.push([curve(&absorption)?, curve(&emission)?]);
    }
    Cube::without_materials(&header, curves).map_err(|error| damaged(HEADER, &error))
}

/// Where the attributes of materials come from.
const EXPECTED: &str = "a file of `upglow bake --as material`";

#[cfg(test)]
mod tests {
    use super::*;
    use upglow::{FitRecord, Node};
    use upglow_color::Contract;
    use upglow_fit::Preset;

    #[test]
    fn the_model_comes_back_from_its_curves_and_from_files_that_hold_a_cube() {
        for preset in [Preset::Natural, Preset::Konig2020, Preset::Jung2019, Preset::Jakob2019] {
            let (model, nodes) = (preset.model(), vec![Node::default(); 8]);
            let cube = Cube::new(Contract::default(), model, FitRecord::default(), 2, nodes);
            let cube = cube.unwrap();
            let mut of_curves = curves(&cube);
            of_curves.insert(HEADER.into(), cube.header_json().into());
            let whole = Attribute::new(MODEL_KIND, cube.to_bytes());
            for attributes in [of_curves, Attributes::from([(MODEL.into(), whole)])] {
                let found = read_model(&attributes).unwrap();
                assert_eq!((found.contract(), found.model()), (cube.contract(), cube.model()));
            }
        }
        let damaged = Attribute::new(MODEL_KIND, b"no cube".to_vec());
        let refused = read_model(&Attributes::from([(MODEL.into(), damaged)])).unwrap_err();
        assert!(refused.to_string().contains(MODEL), "{refused}");
    }
}
