//! Names of dyes, lights and files: in whatever is exported they stay names.

use std::sync::OnceLock;

use upglow::{Accounting, Cube, DyeSet, FilmModel, FitRecord, Model, Node, QuantumYield};
use upglow_color::{Choice as _, Contract, Grid, Illuminant, MeasuredDye, Spectrum};
use upglow_shader::{ColorMap, Documents, Language, Lut, LutFormat, LutLattice, Shader};

/// A name that needs no care.
const PLAIN: &str = "plain";

/// The name of everything that may have one.
pub(crate) fn names(bytes: &[u8]) {
    let name: String = String::from_utf8_lossy(bytes).chars().take(200).collect();
    documents(&name);
    lut(&name);
    // Names of shaders are those of variables: others are refused.
    let Some(cube) = cube(&name) else { return };
    static EXPECTED: OnceLock<Vec<usize>> = OnceLock::new();
    let expected = EXPECTED.get_or_init(|| lines(&exports(&cube_of_plain_names())));
    let found = exports(&cube);
    for text in &found {
        let is_bad = |c: char| c.is_control() && !matches!(c, '\n' | '\t' | '\r');
        assert!(!text.contains(is_bad), "a control character in an export");
    }
    assert_eq!(&lines(&found), expected, "a name adds lines to an export");
}

fn lines(texts: &[String]) -> Vec<usize> {
    texts.iter().map(|text| text.lines().count()).collect()
}

/// Every text with names of the cube in it.
fn exports(cube: &Cube) -> Vec<String> {
    let shaders = Language::ALL.iter().map(|&language| Shader::new(cube, language, PLAIN));
    shaders.map(|shader| shader.expect("a small cube").source).collect()
}

fn documents(name: &str) {
    let map = ColorMap { file: name.into(), tiles: vec![1001], white: [1.0; 3] };
    for made in [
        Documents::of_cube(name, PLAIN, None),
        Documents::of_cube(PLAIN, name, Some(name)),
        Documents::of_maps(&[map.clone(), map], None),
    ] {
        match made {
            Ok(made) => {
                let text = made.materialx;
                let parsed = roxmltree::Document::parse(&text);
                let parsed = parsed.expect("a document is XML");
                let is_known = |tag: &str| !tag.contains("script");
                assert!(parsed.descendants().all(|node| is_known(node.tag_name().name())));
                assert!(!made.usd.contains('\u{1b}'));
            }
            Err(error) => crate::check_message(&error),
        }
    }
}

fn lut(name: &str) {
    for &format in LutFormat::ALL {
        let lattice = LutLattice::unit(format, 2).expect("two entries");
        let colors = lattice.colors();
        let lut = Lut::new(lattice, &colors);
        let text = lut.text(name, &[name.to_owned()]);
        if format == LutFormat::Clf {
            roxmltree::Document::parse(&text).expect("a CLF is XML");
        } else {
            let expected = lut.text(PLAIN, &[PLAIN.to_owned()]).lines().count();
            assert_eq!(text.lines().count(), expected, "a name adds lines to a LUT");
        }
    }
}

fn cube_of_plain_names() -> Cube {
    cube(PLAIN).expect("plain names are valid")
}

/// A small cube with a light, a set and a dye of this name; `None` if it is refused.
fn cube(name: &str) -> Option<Cube> {
    let bell = |center_nm: f64| {
        let value = |nm: f64| (-((nm - center_nm) / 40.0).powi(2)).exp();
        Spectrum::new(Grid::FINE, Grid::FINE.wavelengths_nm().map(value).collect())
    };
    let dye = |name: &str| {
        Some(MeasuredDye {
            name: name.into(),
            absorption: bell(450.0).ok()?,
            emission: bell(560.0).ok()?,
            quantum_yield: None,
            provenance: String::new(),
        })
    };
    let illuminant = Illuminant::line(name, 500.0, 200.0).ok()?;
    let contract = Contract { illuminant, ..Contract::default() };
    let other = dye(&format!("{name}2"))?;
    let set = DyeSet::new(name, vec![dye(name)?, other]).ok()?;
    let model = Model::Film(FilmModel::new(set, Accounting::Energy, QuantumYield::default()).ok()?);
    Cube::new(contract, model, FitRecord::default(), 2, vec![Node::default(); 8]).ok()
}
