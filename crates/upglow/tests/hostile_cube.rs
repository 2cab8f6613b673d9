//! Files of cubes in which anything is altered, with the checksum made right again: each is refused
//! with a message, or is a cube whose names are true and whose materials obey the laws of energy.
//!
//! Every field of the header and every tensor is altered, in the ways below; no list of cases.

#![expect(clippy::unwrap_used, reason = "a test fails where its files cannot be made")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use upglow::{
    Accounting, AnalyticModel, Bispectral, Cube, DyeModel, DyeOptions, DyeSet, Edge, FilmModel,
    FitRecord, Fluorescence, Interpolation, Mixing, Model, Node, QuantumYield, ReadCubeError,
};
use upglow_color::{
    Contract, Grid, Illuminant, LinearRgb, MeasuredDye, Observer, RgbSpace, Spectrum,
};

/// A file in its parts, as docs/cube-format.md describes them.
#[derive(Clone)]
struct Parts {
    header: String,
    tensors: BTreeMap<String, Tensor>,
}

#[derive(Clone, PartialEq)]
struct Tensor {
    kind: String,
    shape: Vec<usize>,
    bytes: Vec<u8>,
}

impl Parts {
    fn of(bytes: &[u8]) -> Self {
        let length = usize::try_from(u64::from_le_bytes(bytes[..8].try_into().unwrap())).unwrap();
        let mut json: Value = serde_json::from_slice(&bytes[8..8 + length]).unwrap();
        let data = &bytes[8 + length..];
        let header = json["__metadata__"]["upglow"].as_str().unwrap().to_owned();
        let fields = json.as_object_mut().unwrap();
        fields.remove("__metadata__");
        let index = |v: &Value| usize::try_from(v.as_u64().unwrap()).unwrap();
        let tensors = fields.iter().filter(|(name, _)| *name != "sha256").map(|(name, entry)| {
            let offsets = &entry["data_offsets"];
            let tensor = Tensor {
                kind: entry["dtype"].as_str().unwrap().into(),
                shape: entry["shape"].as_array().unwrap().iter().map(index).collect(),
                bytes: data[index(&offsets[0])..index(&offsets[1])].to_vec(),
            };
            (name.clone(), tensor)
        });
        Self { header, tensors: tensors.collect() }
    }

    fn checksum(&self) -> Tensor {
        let mut hash = Sha256::new();
        hash.update(&self.header);
        for (name, tensor) in &self.tensors {
            let shape: Vec<String> = tensor.shape.iter().map(usize::to_string).collect();
            hash.update(format!("\n{name} {} {}\n", tensor.kind, shape.join(",")));
            hash.update(&tensor.bytes);
        }
        Tensor { kind: "U8".into(), shape: vec![32], bytes: hash.finalize().to_vec() }
    }

    /// The file with its checksum, and with these further fields in the container's JSON.
    fn to_bytes_with(&self, metadata: &str, fields: &str) -> Vec<u8> {
        let mut tensors = self.tensors.clone();
        tensors.insert("sha256".into(), self.checksum());
        let (mut json, mut data) = (String::new(), Vec::new());
        // Larger elements first, as the container demands alignment.
        for kind in ["F64", "F32", "I32", "U8"] {
            for (name, tensor) in tensors.iter().filter(|(_, tensor)| tensor.kind == kind) {
                let ends = [data.len(), data.len() + tensor.bytes.len()];
                let entry = json!({"dtype": kind, "shape": tensor.shape, "data_offsets": ends});
                json += &format!(",{}:{entry}", json!(name));
                data.extend_from_slice(&tensor.bytes);
            }
        }
        let entry = json!(self.header);
        let json = format!("{{\"__metadata__\":{{\"upglow\":{entry}{metadata}}}{json}{fields}}}");
        [&(json.len() as u64).to_le_bytes()[..], json.as_bytes(), &data].concat()
    }

    fn to_bytes(&self) -> Vec<u8> {
        self.to_bytes_with("", "")
    }

    fn with_header(&self, header: &Value) -> Self {
        Self { header: header.to_string(), ..self.clone() }
    }

    fn with_tensor(&self, name: &str, tensor: Tensor) -> Self {
        let mut parts = self.clone();
        parts.tensors.insert(name.into(), tensor);
        parts
    }
}

fn bell(center_nm: f64) -> Spectrum {
    let value = |nm: f64| (-((nm - center_nm) / 40.0).powi(2)).exp();
    Spectrum::new(Grid::FINE, Grid::FINE.wavelengths_nm().map(value).collect()).unwrap()
}

/// Two dyes of our own between two built-in ones.
fn mixed_set() -> DyeSet {
    let own = |name: &str, nm: f64, quantum_yield| MeasuredDye {
        name: name.into(),
        absorption: bell(nm),
        emission: bell(nm + 60.0).scaled(1.0 / 3.7),
        quantum_yield,
        provenance: "measured here".into(),
    };
    let built_in = |name| MeasuredDye::named(name).unwrap();
    let blue = own("blue", 400.0, Some(0.5));
    let red = own("red", 560.0, None);
    DyeSet::new("mixed", vec![blue, built_in("BODIPY_FL"), red, built_in("ATTO_390")]).unwrap()
}

/// One cube of each model and form of the file, by name.
fn cubes() -> Vec<(&'static str, Cube)> {
    let dyes = |set, quantum_yield, mixing, accounting, optical_density| {
        let options = DyeOptions { mixing, accounting, quantum_yield, optical_density };
        Model::Dyes(DyeModel::new(set, options).unwrap())
    };
    let (fixed, measured) = (QuantumYield::Fixed(1.0), QuantumYield::Measured);
    let konig8 = DyeSet::named("konig8").unwrap();
    let built_in = dyes(konig8, fixed, Mixing::Pooled, Accounting::Energy, None);
    let own = dyes(mixed_set(), measured, Mixing::Separate, Accounting::Photon, Some(2.0));
    let film = FilmModel::new(DyeSet::named("wide14").unwrap(), Accounting::Photon, fixed).unwrap();
    let analytic = Model::Analytic(AnalyticModel::default());
    let standard = Contract::default;
    let matching = Observer::default().matching().clone().map(|curve| curve.scaled(1.25));
    let triangle = [[0.7, 0.3], [0.2, 0.75], [0.14, 0.05]];
    let custom = Contract {
        space: RgbSpace::custom("triangle", triangle, [0.3127, 0.329]).unwrap(),
        illuminant: Illuminant::from_spectrum("lamp", &bell(560.0)).unwrap(),
        observer: Observer::from_spectra("glasses", matching).unwrap(),
        ..standard()
    };
    let cube = |contract, model: Model| {
        let fit = FitRecord {
            metric: "de2000".into(),
            slope_max_per_nm: Some(0.01),
            method: "search".into(),
            ..FitRecord::default()
        };
        let nodes = (0..8).map(|i| node(i, &model)).collect();
        Cube::new(contract, model.clone(), fit, 2, nodes).unwrap()
    };
    vec![
        ("reflectance", cube(standard(), Model::Reflectance)),
        ("dyes", cube(standard(), built_in)),
        ("own dyes, light, observer and space", cube(custom, own)),
        ("film", cube(standard(), Model::Film(film))),
        ("analytic", cube(standard(), analytic)),
    ]
}

/// Nodes 0 and 7 have no fluorescence.
fn node(i: u16, model: &Model) -> Node {
    let share = f64::from(i) / 8.0;
    let concentration = if i.is_multiple_of(7) { 0.0 } else { 1.0 - share / 2.0 };
    let fluorescence = match model {
        Model::Reflectance => Fluorescence::None,
        Model::Dyes(_) => {
            Fluorescence::Dyes { first: usize::from(i % 4), weight: share, concentration }
        }
        Model::Film(_) => {
            let dye = usize::from(i);
            Fluorescence::film((dye, 3.0 * concentration), (dye + 1, concentration))
        }
        Model::Analytic(_) => Fluorescence::Analytic {
            emission_peak_nm: 450.0 + 200.0 * share,
            stokes_shift_nm: 10.0 + 100.0 * share,
            concentration,
        },
    };
    let edge = Edge { edge_nm: 450.0 + 200.0 * share, level: share - 0.5, slope_per_nm: 0.01 };
    Node::new(edge, fluorescence, share)
}

/// Everything that a renderer gets from a cube, at some colors and wavelengths; checks the laws.
fn evaluation(cube: &Cube) -> Result<Vec<f64>, String> {
    const COLORS: [[f64; 3]; 5] =
        [[0.0; 3], [1.0; 3], [1.0, 0.0, 0.0], [0.2, 0.7, 0.4], [0.9, 0.05, 0.6]];
    const LAMBDAS_NM: [f64; 7] = [300.0, 365.0, 441.5, 520.0, 601.25, 700.0, 830.0];
    // Sums over 531 samples in double precision, and evaluation in single.
    const ROUNDING: [f64; 2] = [1e-9, 1e-4];
    let mut numbers = Vec::new();
    let table = cube.lookup_table();
    for rgb in COLORS {
        let mixture = cube.lookup(LinearRgb(rgb), Interpolation::Blend).unwrap();
        #[expect(clippy::cast_possible_truncation, reason = "single precision is the subject")]
        let single = |v: f64| v as f32;
        let packed = table.lookup(rgb.map(single)).unwrap();
        for nm in LAMBDAS_NM {
            let shares = [
                (mixture.reflectance(nm), ROUNDING[0]),
                (mixture.albedo(nm), ROUNDING[0]),
                (f64::from(packed.reflectance(single(nm))), ROUNDING[1]),
                (f64::from(packed.albedo(single(nm))), ROUNDING[1]),
            ];
            for (share, rounding) in shares {
                if !(0.0..=1.0 + rounding).contains(&share) {
                    return Err(format!("returns {share} of the light at {nm} nm"));
                }
                numbers.push(share);
            }
            for out_nm in LAMBDAS_NM {
                let per_nm = mixture.reradiation_per_nm(nm, out_nm);
                if !(per_nm >= 0.0 && per_nm.is_finite()) {
                    return Err(format!("re-radiates {per_nm} from {nm} to {out_nm} nm"));
                }
                numbers.push(per_nm);
            }
        }
    }
    let colorimetry = cube.contract().on(Grid::FIT);
    let colors = COLORS.map(|rgb| rgb.map(|v| if v > 0.5 { 1.0 } else { 0.25 }));
    let mut xyz = [[0.0; 3]; COLORS.len()];
    cube.color_table(&colorimetry).xyz(&colors, &mut xyz).unwrap();
    match xyz.as_flattened().iter().find(|v| !v.is_finite()) {
        Some(found) => Err(format!("a color with {found}")),
        None => {
            numbers.extend(xyz.as_flattened().iter().map(|v| f64::from(*v)));
            Ok(numbers)
        }
    }
}

/// Whether every built-in name stands for the built-in numbers.
fn names_are_true(cube: &Cube) -> bool {
    // Six printed digits of powers up to 242, that of illuminant A at 830 nm.
    const PRINTED_DIGITS: f64 = 2.5e-3;
    let Contract { space, illuminant, observer, .. } = cube.contract();
    let space = RgbSpace::named(space.name()).map_or(true, |known| {
        (known.primaries(), known.white()) == (space.primaries(), space.white())
    });
    let light = Illuminant::named(illuminant.name()).map_or(true, |known| {
        let mut pairs = known.power().values().iter().zip(illuminant.power().values());
        pairs.all(|(known, found)| (known - found).abs() <= PRINTED_DIGITS)
    });
    let observer = Observer::named(observer.name())
        .map_or(true, |known| known.matching() == observer.matching());
    let Some(model) = cube.model().dyes() else { return space && light && observer };
    let numbers = |dye: &MeasuredDye| {
        (dye.name.clone(), dye.absorption.clone(), dye.emission.clone(), dye.quantum_yield)
    };
    let dyes = model.set().dyes().iter().all(|dye| {
        MeasuredDye::named(&dye.name).is_none_or(|known| numbers(&known) == numbers(dye))
    });
    let set = MeasuredDye::set(model.set().name()).is_none_or(|(_, known)| {
        known.iter().map(numbers).eq(model.set().dyes().iter().map(numbers))
    });
    let names: BTreeSet<_> = model.set().dyes().iter().map(|dye| &dye.name).collect();
    let yields = model.curves().iter().all(|dye| (0.0..=1.0).contains(&dye.quantum_yield));
    space && light && observer && dyes && set && yields && names.len() == model.set().dyes().len()
}

/// Reads a file and asserts that it is refused in one line, or is a cube that keeps its promises.
fn read_or_refused(bytes: &[u8], what: &str) -> Option<Cube> {
    let cube = match Cube::from_bytes(bytes) {
        Ok(cube) => cube,
        Err(error) => {
            let line = error.to_string();
            assert!(!line.is_empty() && !line.contains('\n'), "{what}: {line:?}");
            assert!(!matches!(error, ReadCubeError::Checksum { .. }), "{what}: not what it tests");
            return None;
        }
    };
    assert!(names_are_true(&cube), "{what}: a name is false");
    if let Err(broken) = evaluation(&cube) {
        panic!("{what}: {broken}");
    }
    assert_eq!(
        Cube::from_bytes(&cube.to_bytes()).unwrap(),
        cube,
        "{what}: another cube when stored"
    );
    Some(cube)
}

/// What a change of a field may do, by docs/cube-format.md.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Role {
    /// One value is right for this file: every other one is refused.
    Fixed,
    /// It tells people something: no valid value changes an evaluation.
    Note,
    /// It is part of what the numbers mean.
    Meaning,
}

fn role(path: &str) -> Role {
    const FIXED: [&str; 7] = [
        "/format",
        "/axes",
        "/resolution",
        "/tensors",
        "/contract/fit_grid_nm",
        "/contract/table_grid_nm",
        "/model/kind",
    ];
    const NOTES: [&str; 2] = ["/upglow_version", "/fit/"];
    if FIXED.iter().any(|fixed| path.starts_with(fixed)) {
        Role::Fixed
    } else if NOTES.iter().any(|note| path.starts_with(note)) || path.ends_with("/provenance") {
        Role::Note
    } else {
        Role::Meaning
    }
}

/// Pointers to every value of a JSON document except its root.
fn pointers(value: &Value, at: &str, found: &mut Vec<String>) {
    let children: Vec<(String, &Value)> = match value {
        Value::Object(fields) => fields.iter().map(|(name, v)| (name.clone(), v)).collect(),
        Value::Array(items) => items.iter().enumerate().map(|(i, v)| (i.to_string(), v)).collect(),
        _ => Vec::new(),
    };
    for (name, child) in children {
        let pointer = format!("{at}/{name}");
        pointers(child, &pointer, found);
        found.push(pointer);
    }
}

/// What to put in the place of a value: other values of its type, near and far, and other types.
fn substitutes(value: &Value) -> Vec<Value> {
    let mut others = vec![json!(null), json!(true), json!("x"), json!(0), json!([]), json!({})];
    let numbers = [-1.0, 1e-300, 0.25, 1.0, 1.5, 2.0, 300.0, 1e9, 1e300, -1e300];
    let words = [
        "",
        "a\nb",
        "1.5",
        "-1",
        "NaN",
        "inf",
        "0.25",
        "measured",
        "D65",
        "a",
        "E",
        "srgb",
        "ACEScg",
        "CIE 1931 2°",
        "cie-1931-2deg",
        "seed8",
        "open8",
        "ATTO_390",
        "BODIPY_FL",
        "blue",
        "photon",
        "separate",
        "bradford",
        "none",
        "dyes",
        "analytic",
        "reflectance",
        "de76",
        "red.csv",
    ];
    match value {
        Value::Number(_) | Value::Null => others.extend(numbers.map(|v| json!(v))),
        Value::String(text) => {
            others.extend(words.map(|word| json!(word)));
            others.push(json!(format!("{text} ")));
        }
        Value::Array(items) => {
            let mut reversed = items.clone();
            reversed.reverse();
            let twice = items.iter().chain(items.first()).cloned().collect();
            others.extend([Value::Array(reversed), Value::Array(twice)]);
            others.push(Value::Array(items.iter().skip(1).cloned().collect()));
        }
        Value::Object(fields) => {
            for name in fields.keys() {
                let mut fewer = fields.clone();
                fewer.remove(name);
                others.push(Value::Object(fewer));
            }
            let mut more = fields.clone();
            more.insert("extra".into(), json!(0));
            others.push(Value::Object(more));
        }
        Value::Bool(_) => {}
    }
    others.retain(|other| other != value);
    others
}

#[test]
fn any_field_of_the_header_altered_is_refused_or_does_what_its_role_allows() {
    for (kind, cube) in cubes() {
        let parts = Parts::of(&cube.to_bytes());
        let header: Value = serde_json::from_str(&parts.header).unwrap();
        let truth = evaluation(&cube).unwrap();
        let mut paths = Vec::new();
        pointers(&header, "", &mut paths);
        for path in paths.iter().map(String::as_str) {
            for other in substitutes(header.pointer(path).unwrap()) {
                let mut altered = header.clone();
                *altered.pointer_mut(path).unwrap() = other.clone();
                let what = format!("{kind}: {path} is {other}");
                let read = read_or_refused(&parts.with_header(&altered).to_bytes(), &what);
                match (role(path), read) {
                    (Role::Fixed, Some(_)) => {
                        // The list of tensors may be in any order.
                        assert!(path == "/tensors" && other.is_array(), "{what}: accepted");
                    }
                    (Role::Note, Some(read)) => {
                        assert_eq!(evaluation(&read).unwrap(), truth, "{what}");
                    }
                    _ => {}
                }
            }
        }
        for field in ["extra", "dye_curves"] {
            let mut altered = header.clone();
            altered[field] = json!(0);
            assert!(read_or_refused(&parts.with_header(&altered).to_bytes(), field).is_none());
        }
        let twice = parts.header.replacen("\"fit\":", "\"fit\":null,\"fit\":", 1);
        let twice = Parts { header: twice, ..parts.clone() };
        assert!(read_or_refused(&twice.to_bytes(), "two fields").is_none(), "{kind}");
    }
}

/// Puts a number in the place of element `index`.
fn with_number(tensor: &Tensor, index: usize, value: f64) -> Tensor {
    let mut altered = tensor.clone();
    #[expect(clippy::cast_possible_truncation, reason = "single precision is the subject")]
    match tensor.kind.as_str() {
        "F64" => altered.bytes[8 * index..][..8].copy_from_slice(&value.to_le_bytes()),
        "F32" => altered.bytes[4 * index..][..4].copy_from_slice(&(value as f32).to_le_bytes()),
        _ => altered.bytes[index] = value.clamp(0.0, 255.0).round() as u8,
    }
    altered
}

fn number(tensor: &Tensor, index: usize) -> f64 {
    match tensor.kind.as_str() {
        "F64" => f64::from_le_bytes(tensor.bytes[8 * index..][..8].try_into().unwrap()),
        "F32" => f32::from_le_bytes(tensor.bytes[4 * index..][..4].try_into().unwrap()).into(),
        _ => tensor.bytes[index].into(),
    }
}

const HOSTILE_NUMBERS: [f64; 16] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    -1e38,
    -1e12,
    -1.0,
    0.0,
    1e-42,
    0.3,
    1.0,
    1.5,
    8.0,
    455.0,
    1e9,
    1e18,
    1e38,
];

#[test]
fn any_number_of_a_tensor_altered_is_refused_or_obeys_the_laws() {
    for (kind, cube) in cubes() {
        let parts = Parts::of(&cube.to_bytes());
        for (name, tensor) in &parts.tensors {
            let count: usize = tensor.shape.iter().product();
            // All of a small tensor; of a large one every 97th, a prime, so that each curve and end is met.
            let step = if count <= 24 { 1 } else { 97 };
            for index in (0..count).step_by(step).chain([count - 1]) {
                for value in HOSTILE_NUMBERS {
                    let altered = with_number(tensor, index, value);
                    let what = format!("{kind}: {name}[{index}] is {value}");
                    let read = read_or_refused(&parts.with_tensor(name, altered).to_bytes(), &what);
                    // A byte is a number from 0 to 255 whatever is put there.
                    let is_number = value.is_finite() || tensor.kind == "U8";
                    assert!(read.is_none() || is_number, "{what}: accepted");
                }
            }
        }
    }
}

/// The numbers that have no effect, by docs/cube-format.md: those of nodes without fluorescence.
fn is_unused(kind: &str, tensor: &str, index: usize) -> bool {
    let is_dark = |node: usize| node.is_multiple_of(7);
    match (kind, tensor) {
        ("analytic", "fluorescence") => is_dark(index / 3) && index % 3 < 2,
        ("film", "dyes") => is_dark(index / 2),
        (_, "dyes") => is_dark(index / 2) && index.is_multiple_of(2),
        ("film", "fluorescence") => false,
        (_, "fluorescence") => is_dark(index / 3) && index.is_multiple_of(3),
        (_, "de2000") => true,
        _ => false,
    }
}

#[test]
fn a_number_without_effect_is_in_its_range_or_refused() {
    for (kind, cube) in cubes() {
        let parts = Parts::of(&cube.to_bytes());
        let truth = evaluation(&cube).unwrap();
        let mut accepted = 0;
        for (name, tensor) in &parts.tensors {
            let count: usize = tensor.shape.iter().product();
            for index in (0..count).filter(|index| is_unused(kind, name, *index)) {
                for value in HOSTILE_NUMBERS {
                    let altered = with_number(tensor, index, value);
                    let what = format!("{kind}: {name}[{index}] is {value}");
                    let altered = parts.with_tensor(name, altered).to_bytes();
                    if let Some(read) = read_or_refused(&altered, &what) {
                        assert_eq!(evaluation(&read).unwrap(), truth, "{what}");
                        accepted += 1;
                    }
                }
            }
        }
        assert!(accepted > 0, "{kind}");
    }
}

#[test]
fn the_third_number_of_dyes_is_zero_or_refused() {
    for (kind, cube) in cubes().into_iter().filter(|(_, cube)| cube.model().dyes().is_some()) {
        let parts = Parts::of(&cube.to_bytes());
        let tensor = &parts.tensors["fluorescence"];
        for (node, value) in (0..8).zip(HOSTILE_NUMBERS) {
            let altered =
                parts.with_tensor("fluorescence", with_number(tensor, 3 * node + 2, value));
            let read = read_or_refused(&altered.to_bytes(), kind);
            assert_eq!(read.is_some(), value == 0.0, "{kind}: {value}");
        }
    }
}

#[test]
fn a_whole_tensor_altered_is_refused_or_obeys_the_laws() {
    for (kind, cube) in cubes() {
        let parts = Parts::of(&cube.to_bytes());
        for (name, tensor) in &parts.tensors {
            let count: usize = tensor.shape.iter().product();
            let mapped = |change: &dyn Fn(usize) -> f64| {
                (0..count).fold(tensor.clone(), |altered, i| with_number(&altered, i, change(i)))
            };
            let at = |i: usize| number(tensor, i);
            let alike: [Tensor; 5] = [
                mapped(&|_| 0.0),
                mapped(&|_| 1.0),
                mapped(&|i| 3.7 * at(i)),
                mapped(&|i| 1e-20 * at(i)),
                mapped(&|i| at(count - 1 - i)),
            ];
            for (way, altered) in alike.into_iter().enumerate() {
                let what = format!("{kind}: {name} altered in way {way}");
                read_or_refused(&parts.with_tensor(name, altered).to_bytes(), &what);
            }
            let other_kind = if tensor.kind == "F32" { "I32" } else { "F32" };
            let bytes = tensor.bytes.len();
            let others = [
                Tensor { shape: vec![count], ..tensor.clone() },
                Tensor { shape: [&tensor.shape[..], &[1]].concat(), ..tensor.clone() },
                Tensor { kind: "U8".into(), shape: vec![bytes], ..tensor.clone() },
                Tensor { kind: other_kind.into(), shape: vec![bytes / 4], ..tensor.clone() },
                Tensor { shape: vec![0], bytes: Vec::new(), ..tensor.clone() },
            ];
            for other in others.into_iter().filter(|other| other != tensor) {
                let what = format!("{kind}: {name} is {} {:?}", other.kind, other.shape);
                let altered = parts.with_tensor(name, other);
                assert!(read_or_refused(&altered.to_bytes(), &what).is_none(), "{what}");
            }
            let mut fewer = parts.clone();
            fewer.tensors.remove(name);
            assert!(read_or_refused(&fewer.to_bytes(), name).is_none(), "{kind}: without {name}");
            let more = parts.with_tensor(&format!("{name}_2"), tensor.clone());
            let line = Cube::from_bytes(&more.to_bytes()).unwrap_err().to_string();
            assert!(line.starts_with(&format!("tensor \"{name}_2\", expected only ")), "{line}");
        }
    }
}

#[test]
fn tensors_of_another_model_or_version_are_refused() {
    let all: BTreeMap<String, Tensor> =
        cubes().iter().flat_map(|(_, cube)| Parts::of(&cube.to_bytes()).tensors).collect();
    for (kind, cube) in cubes() {
        let parts = Parts::of(&cube.to_bytes());
        for (name, tensor) in all.iter().filter(|(name, _)| !parts.tensors.contains_key(*name)) {
            let more = parts.with_tensor(name, tensor.clone());
            assert!(read_or_refused(&more.to_bytes(), name).is_none(), "{kind} with {name}");
        }
    }
}

#[test]
fn only_the_container_s_own_fields_are_read() {
    let (_, cube) = cubes().remove(0);
    let parts = Parts::of(&cube.to_bytes());
    assert_eq!(Cube::from_bytes(&parts.to_bytes()).unwrap(), cube);
    let message = |metadata: &str, fields: &str| {
        Cube::from_bytes(&parts.to_bytes_with(metadata, fields)).unwrap_err().to_string()
    };
    let more = message(",\"note\":\"x\"", "");
    assert_eq!(more, "metadata entry \"note\", expected `upglow` alone");
    let twice = format!(",\"upglow\":{}", json!(parts.header));
    assert!(message(&twice, "").contains("two fields \"upglow\", expected one"));
}

/// The scale of an emission has no meaning: it is divided by its sum.
#[test]
fn an_emission_of_another_scale_is_the_same_cube_unless_its_name_is_built_in() {
    // Rounding of 531 samples times 3.7, divided by their sum.
    const ROUNDING: f64 = 1e-6;
    let (_, cube) = cubes().remove(2);
    let parts = Parts::of(&cube.to_bytes());
    let curves = &parts.tensors["dye_curves"];
    let scaled = |dye: usize| {
        let first = (2 * dye + 1) * Grid::FINE.len();
        let places = first..first + Grid::FINE.len();
        let scale = |altered, i| with_number(&altered, i, 3.7 * number(curves, i));
        let altered = parts.with_tensor("dye_curves", places.fold(curves.clone(), scale));
        read_or_refused(&altered.to_bytes(), "emission times 3.7")
    };
    let truth = evaluation(&cube).unwrap();
    let same = evaluation(&scaled(0).unwrap()).unwrap();
    assert!(truth.iter().zip(&same).all(|(a, b)| (a - b).abs() < ROUNDING));
    assert!(scaled(1).is_none());
}

/// The dyes of a folder are named after their files; a former version named them by the stem even where
/// a built-in dye has that name.
#[test]
fn a_dye_from_a_file_that_took_a_built_in_name_is_read_under_its_file_s_name() {
    let dye = |name: &str, provenance: &str| MeasuredDye {
        name: name.into(),
        absorption: bell(400.0),
        emission: bell(450.0),
        quantum_yield: None,
        provenance: provenance.into(),
    };
    let set = DyeSet::new("folder", vec![dye("ATTO_390.csv", "ATTO_390.csv")]).unwrap();
    let model = Model::Dyes(DyeModel::new(set, DyeOptions::default()).unwrap());
    let nodes = vec![Node::default(); 8];
    let cube = Cube::new(Contract::default(), model, FitRecord::default(), 2, nodes).unwrap();
    let parts = Parts::of(&cube.to_bytes());
    let mut former: Value = serde_json::from_str(&parts.header).unwrap();
    former["model"]["dyes"][0]["name"] = json!("ATTO_390");
    assert_eq!(Cube::from_bytes(&parts.with_header(&former).to_bytes()).unwrap(), cube);
    former["model"]["dyes"][0]["provenance"] = json!("elsewhere");
    let line = Cube::from_bytes(&parts.with_header(&former).to_bytes()).unwrap_err().to_string();
    let expected =
        "header field dyes: \"ATTO_390\" is a built-in dye whose absorption at 300 nm is ";
    assert!(line.starts_with(expected), "{line}");
}

#[test]
fn the_shared_hostile_files_are_refused() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/hostile"));
    if !folder.exists() {
        eprintln!("skipped: the_shared_hostile_files_are_refused (no ../shared/data/hostile)");
        return;
    }
    let message = |name: &str| Cube::read(folder.join(name)).unwrap_err().to_string();
    for (name, cause) in [
        ("cube_overflow.safetensors", "header field illuminant: "),
        ("cube_names_as_code.safetensors", "holds a control character, expected one line"),
    ] {
        let line = message(name);
        assert!(line.contains(cause) && !line.contains('\n'), "{line}");
    }
    let path = folder.join("light_denormal.csv");
    let text = std::fs::read_to_string(&path).unwrap();
    let line = Illuminant::from_csv_file(&path, &text, None).unwrap_err().to_string();
    let expected = "the greatest value in column \"power\" is 5e-324, expected 1e-30 to 1e30";
    assert_eq!(line, expected);
}
