//! The file that holds a cube: safetensors, one JSON header, a checksum.
//!
//! `docs/cube-format.md` describes it for readers in other languages.

use std::collections::HashMap;
use std::path::Path;

use safetensors::{Dtype, SafeTensors};
use sha2::{Digest, Sha256};
use upglow_color::{Grid, Spectrum};

use crate::aside::Aside;
use crate::cube::error::{CubeFileError, ReadCubeError};
use crate::cube::header::{CubeCurves, ENTRY, Header};
use crate::cube::plain_json::PlainJson;
use crate::cube::{Cube, CubeError, Node};
use crate::input::read_input;
use crate::material::model::Model;
use crate::tensor::Tensor;

const REFLECTANCE: &str = "reflectance";
const DYE: &str = "dye";
const DYES: &str = "dyes";
const FLUORESCENCE: &str = "fluorescence";
const DE2000: &str = "de2000";
const ILLUMINANT: &str = "illuminant";
const OBSERVER: &str = "observer";
const DYE_CURVES: &str = "dye_curves";
const CHECKSUM: &str = "sha256";
/// Twice what a cube of the greatest resolution takes.
const MOST_BYTES: u64 = 1 << 30;

impl Cube {
    /// The content of the cube's file.
    ///
    /// The same cube gives the same bytes.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut tensors = self.tensors();
        let header = self.header_of(&tensors);
        let content = tensors.iter().map(|t| (t.name, t.dtype, &t.shape[..], &t.bytes[..]));
        let checksum = checksum(&header, content);
        tensors.push(Tensor::bytes(CHECKSUM, &[checksum.len()], checksum));
        Tensor::file(&tensors, ENTRY, header)
    }

    /// The file's header as JSON: contract, model and fit, without the curves.
    pub fn header_json(&self) -> String {
        self.header_of(&self.tensors())
    }

    /// The curves that the header names.
    pub fn curves(&self) -> CubeCurves {
        let values = |curve: &Spectrum| curve.values().to_vec();
        let dyes = self.model().dyes().map_or(&[][..], |model| model.set().dyes());
        CubeCurves {
            illuminant: values(self.contract().illuminant.power()),
            observer: Some(self.contract().observer.matching().each_ref().map(values)),
            dyes: dyes.iter().map(|dye| [&dye.absorption, &dye.emission].map(values)).collect(),
        }
    }

    /// A cube with this header and curves and the least resolution, all of whose materials are those of
    /// [`Node::default`].
    ///
    /// # Errors
    ///
    /// [`ReadCubeError`] if they are not those of a cube.
    pub fn without_materials(header: &str, curves: CubeCurves) -> Result<Self, ReadCubeError> {
        let header = Header::parse(header)?;
        ReadCubeError::check("dyes", &curves.dyes.len(), &header.model.dye_count())?;
        let contract = header.contract.to_contract(curves.illuminant, curves.observer)?;
        let model = header.model.to_model(curves.dyes)?;
        let [least, _] = Self::RESOLUTIONS;
        let nodes = vec![Node::default(); least.pow(3)];
        Ok(Self::new(contract, model, header.fit, least, nodes)?)
    }

    fn header_of(&self, tensors: &[Tensor]) -> String {
        let names = tensors.iter().map(|t| t.name.to_owned()).collect();
        serde_json::to_string(&Header::of(self, names)).expect("plain data")
    }

    /// Writes the cube's file. It appears whole or, on any failure, not at all.
    ///
    /// # Errors
    ///
    /// [`CubeFileError::Io`] if the path cannot be written.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), CubeFileError> {
        let path = path.as_ref();
        Aside::write_whole(path, &self.to_bytes())
            .map_err(|cause| CubeFileError::Io { path: path.into(), cause })
    }

    fn tensors(&self) -> Vec<Tensor> {
        let n = self.resolution();
        let (one, three) = ([n, n, n], [n, n, n, 3]);
        let nodes = || self.nodes().iter();
        let fine = Grid::FINE.len();
        let curves = self.curves();
        let matching = curves.observer.iter().flatten();
        let mut tensors = vec![
            Tensor::singles(REFLECTANCE, &three, nodes().flat_map(|node| node.reflectance)),
            Tensor::singles(DE2000, &one, nodes().map(|node| node.de2000)),
            Tensor::doubles(ILLUMINANT, &[fine], curves.illuminant.iter()),
            Tensor::doubles(OBSERVER, &[3, fine], matching.flatten()),
        ];
        if !matches!(self.model(), Model::Reflectance) {
            let fluorescence = nodes().flat_map(|node| node.fluorescence);
            tensors.push(Tensor::singles(FLUORESCENCE, &three, fluorescence));
        }
        if !curves.dyes.is_empty() {
            let dyes = nodes().flat_map(|node| node.dyes).collect();
            tensors.push(Tensor::bytes(DYES, &[n, n, n, 2], dyes));
            let samples = curves.dyes.iter().flatten().flatten();
            tensors.push(Tensor::doubles(DYE_CURVES, &[curves.dyes.len(), 2, fine], samples));
        }
        tensors
    }

    /// Reads a cube's file.
    ///
    /// # Errors
    ///
    /// [`CubeFileError`] if it cannot be read or is not a cube; no content panics.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, CubeFileError> {
        let path = path.as_ref();
        let bytes = read_input(path, MOST_BYTES)
            .map_err(|cause| CubeFileError::Io { path: path.into(), cause })?;
        Self::from_bytes(&bytes)
            .map_err(|cause| CubeFileError::Content { path: path.into(), cause })
    }

    /// Reads a cube from the content of its file.
    ///
    /// # Errors
    ///
    /// [`ReadCubeError`] if the content is not a cube; no content panics.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ReadCubeError> {
        let (length, metadata) = SafeTensors::read_metadata(bytes)?;
        let entries = metadata.metadata().as_ref().ok_or(ReadCubeError::NotACube)?;
        let json = entries.get(ENTRY).ok_or(ReadCubeError::NotACube)?;
        check_container(&bytes[size_of::<u64>()..][..length], entries)?;
        let header = Header::parse(json)?;
        let file = SafeTensors::deserialize(bytes)?;
        check_sum(json, &file)?;
        let n = header.resolution;
        let [least, most] = Self::RESOLUTIONS;
        if !(least..=most).contains(&n) {
            return Err(CubeError::Resolution { found: n }.into());
        }
        check_tensors(&file, &header)?;
        let curves = read_curves(&file, &header)?;
        let contract = header.contract.to_contract(curves.illuminant, curves.observer)?;
        let model = header.model.to_model(curves.dyes)?;
        let nodes = read_nodes(&file, &header, &model)?;
        Ok(Self::new(contract, model, header.fit, n, nodes)?)
    }
}

/// SHA-256 of the header and of name, type, shape and bytes of each tensor, sorted by name.
fn checksum<'t>(
    header: &str,
    tensors: impl Iterator<Item = (&'t str, Dtype, &'t [usize], &'t [u8])>,
) -> Vec<u8> {
    let mut sorted: Vec<_> = tensors.collect();
    sorted.sort_by_key(|(name, ..)| *name);
    let mut hash = Sha256::new();
    hash.update(header);
    for (name, dtype, shape, bytes) in sorted {
        let shape: Vec<String> = shape.iter().map(usize::to_string).collect();
        hash.update(format!("\n{name} {dtype} {}\n", shape.join(",")));
        hash.update(bytes);
    }
    hash.finalize().to_vec()
}

fn check_sum(header: &str, file: &SafeTensors<'_>) -> Result<(), ReadCubeError> {
    let stored = tensor(file, CHECKSUM, Dtype::U8, &[32])?;
    let views = file.iter().filter(|(name, _)| *name != CHECKSUM).collect::<Vec<_>>();
    let content = views.iter().map(|(name, t)| (*name, t.dtype(), t.shape(), t.data()));
    let computed = checksum(header, content);
    if computed == stored {
        return Ok(());
    }
    let digits = |sum: &[u8]| sum[..4].iter().map(|b| format!("{b:02x}")).collect();
    Err(ReadCubeError::Checksum { found: digits(&computed), expected: digits(stored) })
}

/// Checks what the checksum does not cover: the container's own JSON, and its metadata entries.
fn check_container(json: &[u8], entries: &HashMap<String, String>) -> Result<(), ReadCubeError> {
    // The least name, so that the message is always the same one.
    if let Some(found) = entries.keys().filter(|name| *name != ENTRY).min() {
        return Err(ReadCubeError::Metadata { found: found.clone() });
    }
    let plain = serde_json::from_slice::<PlainJson<false>>(json);
    plain.map(|_| ()).map_err(ReadCubeError::ContainerHeader)
}

/// Name, type and shape of every tensor of a cube with this header, except the checksum.
fn layout(header: &Header) -> Vec<(&'static str, Dtype, Vec<usize>)> {
    let (n, fine) = (header.resolution, Grid::FINE.len());
    let mut layout = vec![
        (REFLECTANCE, Dtype::F32, vec![n, n, n, 3]),
        (DE2000, Dtype::F32, vec![n, n, n]),
        (ILLUMINANT, Dtype::F64, vec![fine]),
    ];
    if header.holds_observer() {
        layout.push((OBSERVER, Dtype::F64, vec![3, fine]));
    }
    if header.model.is_fluorescent() {
        layout.push((FLUORESCENCE, Dtype::F32, vec![n, n, n, 3]));
    }
    // A model without dyes is refused with its set.
    match header.model.dye_count() {
        0 => {}
        dyes => {
            layout.push(if header.holds_pairs() {
                (DYES, Dtype::U8, vec![n, n, n, 2])
            } else {
                (DYE, Dtype::U8, vec![n, n, n])
            });
            layout.push((DYE_CURVES, Dtype::F64, vec![dyes, 2, fine]));
        }
    }
    layout
}

/// Checks that the file has the tensors of its model and version, no others, and lists them.
fn check_tensors(file: &SafeTensors<'_>, header: &Header) -> Result<(), ReadCubeError> {
    let layout = layout(header);
    for (name, dtype, shape) in &layout {
        tensor(file, name, *dtype, shape)?;
    }
    let mut expected: Vec<_> = layout.into_iter().map(|(name, ..)| name).collect();
    expected.sort_unstable();
    let is_surplus = |name: &&str| *name != CHECKSUM && !expected.contains(name);
    if let Some(found) = file.names().into_iter().filter(is_surplus).min() {
        return Err(ReadCubeError::Surplus { found: found.into(), expected });
    }
    let mut listed: Vec<_> = header.tensors.iter().map(String::as_str).collect();
    listed.sort_unstable();
    ReadCubeError::check("tensors", &listed, &expected)
}

/// The bytes of one tensor, of the type and shape expected.
fn tensor<'f>(
    file: &SafeTensors<'f>,
    name: &'static str,
    dtype: Dtype,
    shape: &[usize],
) -> Result<&'f [u8], ReadCubeError> {
    let expected = format!("{dtype} {shape:?}");
    let Ok(view) = file.tensor(name) else {
        return Err(ReadCubeError::Tensor { name, found: "absent".into(), expected });
    };
    if view.dtype() != dtype || view.shape() != shape {
        let found = format!("{} {:?}", view.dtype(), view.shape());
        return Err(ReadCubeError::Tensor { name, found, expected });
    }
    Ok(view.data())
}

fn doubles(bytes: &[u8]) -> Vec<f64> {
    let (chunks, _) = bytes.as_chunks();
    chunks.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect()
}

fn singles(bytes: &[u8]) -> impl Iterator<Item = f32> + '_ {
    let (chunks, _) = bytes.as_chunks();
    chunks.iter().map(|chunk| f32::from_le_bytes(*chunk))
}

fn triples(bytes: &[u8]) -> Vec<[f32; 3]> {
    singles(bytes).collect::<Vec<_>>().as_chunks().0.to_vec()
}

fn read_curves(file: &SafeTensors<'_>, header: &Header) -> Result<CubeCurves, ReadCubeError> {
    let fine = Grid::FINE.len();
    let illuminant = doubles(tensor(file, ILLUMINANT, Dtype::F64, &[fine])?);
    let observer = if header.holds_observer() {
        let samples = doubles(tensor(file, OBSERVER, Dtype::F64, &[3, fine])?);
        Some([0, 1, 2].map(|k| samples[k * fine..(k + 1) * fine].to_vec()))
    } else {
        None
    };
    Ok(CubeCurves { illuminant, observer, dyes: read_dyes(file, header.model.dye_count())? })
}

/// Absorption and emission of each dye.
fn read_dyes(file: &SafeTensors<'_>, count: usize) -> Result<Vec<[Vec<f64>; 2]>, ReadCubeError> {
    if count == 0 {
        return Ok(Vec::new());
    }
    let fine = Grid::FINE.len();
    let samples = doubles(tensor(file, DYE_CURVES, Dtype::F64, &[count, 2, fine])?);
    let pairs = samples.chunks_exact(2 * fine);
    Ok(pairs.map(|pair| [pair[..fine].to_vec(), pair[fine..].to_vec()]).collect())
}

fn read_nodes(
    file: &SafeTensors<'_>,
    header: &Header,
    model: &Model,
) -> Result<Vec<Node>, ReadCubeError> {
    let n = header.resolution;
    let count = n.pow(3);
    let reflectances = triples(tensor(file, REFLECTANCE, Dtype::F32, &[n, n, n, 3])?);
    let de2000 = singles(tensor(file, DE2000, Dtype::F32, &[n, n, n])?);
    let fluorescences = match model {
        Model::Reflectance => vec![[0.0; 3]; count],
        _ => triples(tensor(file, FLUORESCENCE, Dtype::F32, &[n, n, n, 3])?),
    };
    let dyes = match model.dyes() {
        None => vec![[0; 2]; count],
        Some(_) if header.holds_pairs() => {
            tensor(file, DYES, Dtype::U8, &[n, n, n, 2])?.as_chunks().0.to_vec()
        }
        Some(_) => tensor(file, DYE, Dtype::U8, &[n, n, n])?.iter().map(|&dye| [dye, 0]).collect(),
    };
    let numbers = reflectances.into_iter().zip(fluorescences).zip(dyes).zip(de2000);
    let node = |(((reflectance, fluorescence), dyes), de2000)| Node {
        reflectance,
        dyes,
        fluorescence,
        de2000,
    };
    Ok(numbers.map(node).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cube::FitRecord;
    use crate::material::dye_model::{DyeModel, DyeOptions};
    use crate::material::dye_set::DyeSet;
    use proptest::prelude::*;
    use upglow_color::{Contract, Illuminant, Observer};

    fn cube() -> Cube {
        let set = DyeSet::named("open8").unwrap();
        let model = Model::Dyes(DyeModel::new(set, DyeOptions::default()).unwrap());
        let node = |i: u16| Node {
            reflectance: [500.0 + f32::from(i), -0.5, 0.01],
            dyes: [(i % 8) as u8, 0],
            fluorescence: [0.25, 0.5, 0.0],
            de2000: 0.125,
        };
        let fit = FitRecord { slope_max_per_nm: Some(0.01), ..FitRecord::default() };
        Cube::new(Contract::default(), model, fit, 3, (0..27).map(node).collect()).unwrap()
    }

    #[test]
    fn a_cube_survives_its_file() {
        let cube = cube();
        let bytes = cube.to_bytes();
        assert_eq!(bytes, cube.to_bytes());
        let back = Cube::from_bytes(&bytes).unwrap();
        assert_eq!(back, cube);
        assert_eq!(back.to_bytes(), bytes);
        let empty = Cube::without_materials(&cube.header_json(), cube.curves()).unwrap();
        assert_eq!((empty.contract(), empty.model()), (cube.contract(), cube.model()));
        assert!(Cube::without_materials(&cube.header_json(), CubeCurves::default()).is_err());
    }

    /// The cube under another light or for another observer.
    fn with_contract(contract: Contract) -> Cube {
        let (model, fit, nodes) =
            (cube().model().clone(), cube().fit().clone(), cube().nodes().to_vec());
        Cube::new(contract, model, fit, 3, nodes).unwrap()
    }

    #[test]
    fn every_built_in_light_and_observer_survives_a_file() {
        let lights = Illuminant::names().into_iter().chain(["2856.5K", "D6200K"]);
        let lit = lights.map(|name| Contract {
            illuminant: Illuminant::named(name).unwrap(),
            ..Contract::default()
        });
        let seen = Observer::NAMES.map(|name| Contract {
            observer: Observer::named(name).unwrap(),
            ..Contract::default()
        });
        for contract in lit.chain(seen) {
            let cube = with_contract(contract);
            let bytes = cube.to_bytes();
            let back = Cube::from_bytes(&bytes).unwrap();
            assert_eq!(back, cube);
            assert_eq!(back.to_bytes(), bytes);
            assert!(!cube.header_json().contains("given_nm"));
        }
    }

    /// A lamp of a file that ends at 390 and 720 nm.
    fn short_lamp() -> Cube {
        let power = Spectrum::new(Grid::try_new(390, 720, 10).unwrap(), vec![2.0; 34]).unwrap();
        let illuminant = Illuminant::from_spectrum("lamp", &power).unwrap();
        with_contract(Contract { illuminant, ..Contract::default() })
    }

    #[test]
    fn a_file_says_where_a_light_is_known() {
        let cube = short_lamp();
        let bytes = cube.to_bytes();
        let back = Cube::from_bytes(&bytes).unwrap();
        assert_eq!(back, cube);
        assert_eq!(back.contract().illuminant.given_nm(), [390, 720]);
        assert_eq!(back.to_bytes(), bytes);
        let json = cube.header_json();
        for (stated, refused) in [
            ("[391,720]", "illuminant_given_nm is [391, 720], expected the part"),
            ("[390,700]", "illuminant_given_nm is [390, 700], expected the part"),
            ("[0,4294967295]", "illuminant_given_nm is [0, 4294967295], expected the part"),
            ("[720,390]", "illuminant_given_nm: grid 720 to 390 nm"),
        ] {
            let json = json.replace("[390,720]", stated);
            let line = Cube::without_materials(&json, cube.curves()).unwrap_err().to_string();
            assert!(line.contains(refused), "{line}");
        }
    }

    #[test]
    fn what_an_earlier_version_named_does_not_hide_what_is_built_in_now() {
        let cube = short_lamp();
        let named = |light: &str| {
            let stated = format!("\"illuminant\":\"{light}\"");
            let json = cube.header_json().replace("\"illuminant\":\"lamp\"", &stated);
            Cube::without_materials(&json, cube.curves())
        };
        for light in ["FL4", "m2", "4000K", "D5500K"] {
            let found = named(light).unwrap();
            assert_eq!(found.contract().illuminant.name(), format!("{light} (samples)"));
        }
        let line = named("hp1").unwrap_err().to_string();
        assert!(line.contains("\"hp1\" is a built-in illuminant"), "{line}");

        let cube = with_observer(|_, value| 0.99 * value);
        let json = cube.header_json().replace("glasses", "CIE 1964 10°");
        let found = Cube::without_materials(&json, cube.curves()).unwrap();
        assert_eq!(found.contract().observer.name(), "CIE 1964 10° (samples)");
    }

    /// A cube of the standard observer with samples edited by their index and value.
    fn with_observer(edit: impl Fn(usize, f64) -> f64) -> Cube {
        let mut contract = Contract::default();
        let curve = |curve: &Spectrum| {
            let values = curve.values().iter().enumerate().map(|(i, &v)| edit(i, v)).collect();
            Spectrum::new(Grid::FINE, values).unwrap()
        };
        let matching = contract.observer.matching().each_ref().map(curve);
        contract.observer = Observer::from_spectra("glasses", matching).unwrap();
        with_contract(contract)
    }

    #[test]
    fn a_cube_of_another_observer_survives_its_file() {
        let cube = with_observer(|_, value| 0.99 * value);
        let bytes = cube.to_bytes();
        let back = Cube::from_bytes(&bytes).unwrap();
        assert_eq!(back, cube);
        assert_eq!(back.contract().observer.name(), "glasses");
        assert_eq!(back.to_bytes(), bytes);
    }

    #[test]
    fn a_file_cut_short_anywhere_is_refused() {
        let bytes = cube().to_bytes();
        for length in (0..bytes.len()).step_by(997).chain([bytes.len() - 1]) {
            assert!(Cube::from_bytes(&bytes[..length]).is_err(), "{length}");
        }
    }

    proptest! {
        #[test]
        fn an_altered_byte_anywhere_is_refused(place in any::<usize>(), change in 1_u8..) {
            let mut bytes = cube().to_bytes();
            let index = place % bytes.len();
            bytes[index] ^= change;
            prop_assert!(Cube::from_bytes(&bytes).is_err(), "{index}");
        }

        #[test]
        fn noise_is_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            prop_assert!(Cube::from_bytes(&bytes).is_err());
        }
    }

    /// A whole file with a right checksum around a header that was edited.
    fn with_header(edit: impl Fn(&str) -> String) -> Result<Cube, ReadCubeError> {
        let cube = cube();
        let mut tensors = cube.tensors();
        let header = edit(&cube.header_of(&tensors));
        let content = tensors.iter().map(|t| (t.name, t.dtype, &t.shape[..], &t.bytes[..]));
        let sum = checksum(&header, content);
        tensors.push(Tensor::bytes(CHECKSUM, &[sum.len()], sum));
        Cube::from_bytes(&Tensor::file(&tensors, ENTRY, header))
    }

    #[test]
    fn a_header_that_lies_is_refused_by_field() {
        let message = |from: &str, to: &str| {
            with_header(|header| {
                assert!(header.contains(from), "{header}");
                header.replacen(from, to, 1)
            })
            .unwrap_err()
            .to_string()
        };
        assert_eq!(with_header(str::to_owned).unwrap(), cube());
        assert_eq!(
            message("\"format_version\":3", "\"format_version\":4"),
            "format version 4, expected 1 to 3"
        );
        assert_eq!(
            message("\"format_version\":3", "\"format_version\":2"),
            "header field fit.preset is null, expected none in format version 2"
        );
        assert!(message("\"relaxed\":false,", "").starts_with("header: missing field `relaxed`"));
        assert!(message("\"preset\":null,", "").starts_with("header: missing field `preset`"));
        assert_eq!(
            message("\"resolution\":3", "\"resolution\":100000"),
            "resolution 100000, expected 2 to 256"
        );
        assert_eq!(
            message("\"resolution\":3", "\"resolution\":4"),
            "tensor reflectance is F32 [3, 3, 3, 3], expected F32 [4, 4, 4, 3]"
        );
        assert_eq!(
            message("\"bradford\"", "\"cat02\""),
            "header field adaptation: unknown adaptation \"cat02\", expected bradford or none"
        );
        assert_eq!(
            message("\"pooled\"", "\"layered\""),
            "header field mixing: unknown mixing \"layered\", expected pooled or separate"
        );
        assert_eq!(
            message("[300,830,1]", "[300,830,2]"),
            "header field table_grid_nm is [300, 830, 2], expected [300, 830, 1]"
        );
        assert!(message("[0.713,0.293]", "[0.165,0.83]").starts_with("header field rgb_space: "));
        assert!(message("\"resolution\":3", "\"resolution\":-3").starts_with("header: "));
    }

    #[test]
    fn the_message_says_what_was_found_and_expected() {
        let message = |bytes: &[u8]| Cube::from_bytes(bytes).unwrap_err().to_string();
        let mut bytes = cube().to_bytes();
        let last = bytes.len() - 1;
        bytes[last] ^= 1;
        assert!(message(&bytes).starts_with("checksum "));
        let text = String::from_utf8_lossy(&cube().to_bytes()).into_owned();
        assert!(text.contains("format_version"));
        assert!(message(b"P6 640 480 255 ...").starts_with("not a whole safetensors file"));
    }

    #[test]
    fn a_cube_is_not_written_over_a_folder() {
        let folder = tempfile::tempdir().unwrap();
        let error = cube().write(folder.path()).unwrap_err().to_string();
        let expected = "a folder, expected a file to write";
        assert_eq!(error, format!("{}: {expected}", folder.path().display()));
    }
}
