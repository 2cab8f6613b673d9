//! Spectral files: written, linted, read texel by texel, and checked by other programs.

use std::path::{Path, PathBuf};
use std::process::Command;

use upglow::{
    Accounting, Cube, DyeModel, DyeOptions, DyeSet, FilmModel, Fluorescence, Material, Mixture,
    Model, QuantumYield, Sigmoid,
};
use upglow_color::{BispectralUnit, Contract, Grid, Illuminant, RgbSpace};
use upglow_fit::{Preset, Unwatched, build_cube};

use super::channel::{
    BISPECTRAL_UNIT, EMISSIVE_UNITS, LAYOUT_VERSION, LAYOUT_VERSION_VALUE, SpectralChannel,
    rising_pairs,
};
use super::compact::{CompactForm, CompactLayout};
use super::lint::findings::{Lint, Rule, Severity};
use super::picture::SpectralPicture;
use crate::bake::{BakeOptions, Baker, Form, Layout};
use crate::exr::attribute::{Attributes, chromaticities};
use crate::exr::header::Sample;
use crate::exr::reader::ExrReader;
use crate::exr::writer::{ExrDescription, ExrWriter};
use crate::picture::stated::Declared;
use crate::python::python;

const SIZE: [usize; 2] = [3, 2];

fn write(path: &Path, names: &[String], attributes: Attributes, texels: &[Vec<f32>]) {
    let described = ExrDescription {
        sample: Sample::Float,
        attributes,
        ..ExrDescription::new(SIZE, names.iter().cloned())
    };
    let mut writer = ExrWriter::create(path, described).unwrap();
    let plane = |c: usize| texels.iter().map(|texel| texel[c]).collect::<Vec<_>>();
    let planes: Vec<Vec<f32>> = (0..names.len()).map(plane).collect();
    writer.write_band(&planes.iter().map(Vec::as_slice).collect::<Vec<_>>()).unwrap();
    writer.finish().unwrap();
}

fn layout_attributes() -> Attributes {
    Attributes::from([
        (LAYOUT_VERSION.into(), LAYOUT_VERSION_VALUE.into()),
        (BISPECTRAL_UNIT.into(), BispectralUnit::PerBand.to_string().into()),
    ])
}

fn names_of(bands: Grid) -> Vec<String> {
    let nm: Vec<f64> = bands.wavelengths_nm().collect();
    let mut names: Vec<String> = ["R", "G", "B"].map(String::from).to_vec();
    names.extend(nm.iter().map(|&nm| SpectralChannel::Reflectance { nm }.to_string()));
    for (i, &in_nm) in nm.iter().enumerate() {
        for &out_nm in &nm[i + 1..] {
            names.push(SpectralChannel::Reradiation { in_nm, out_nm }.to_string());
        }
    }
    names
}

fn dyes() -> DyeModel {
    DyeModel::new(DyeSet::named("konig8").unwrap(), DyeOptions::default()).unwrap()
}

fn film() -> FilmModel {
    let set = DyeSet::named("konig8").unwrap();
    FilmModel::new(set, Accounting::Photon, QuantumYield::Measured).unwrap()
}

/// The models with a compact form of one material per texel.
fn models() -> [Model; 2] {
    [Model::Dyes(dyes()), Model::Film(film())]
}

fn material(i: usize, model: &Model) -> Material {
    let u = i as f64 / 6.0;
    let fluorescence = match model {
        Model::Film(_) => Fluorescence::film((i, 0.3 + 5.0 * u), (7 - i, 2.0 * u)),
        _ => Fluorescence::Dyes { first: i, weight: u, concentration: 0.3 + 0.5 * u },
    };
    Material { reflectance: Sigmoid::flat(0.2 + 0.5 * u), fluorescence }
}

/// A full bispectral file and a compact one of the same six texels, with preview.
fn full_and_compact(folder: &Path, bands: Grid, model: &Model) -> [PathBuf; 2] {
    let layout = match model {
        Model::Film(film) => CompactLayout::in_film(film, bands),
        _ => CompactLayout::new(&dyes(), bands, CompactForm::PerDye),
    };
    let layout = layout.unwrap();
    let preview = [0.25, 0.5, 0.75];
    let texel = |i: usize| {
        let compact = layout.encode(&Mixture::of(model, material(i, model))).unwrap();
        let matrix = layout.expand(&compact).unwrap();
        let diagonal = (0..bands.len()).map(|b| matrix[b][b]).collect::<Vec<_>>();
        let pairs = rising_pairs(bands.len()).map(|[i, o]| matrix[o][i]).collect::<Vec<_>>();
        let full = [&preview[..], &diagonal, &pairs].concat();
        [full, [&preview[..], &compact].concat()]
    };
    let texels: Vec<[Vec<f32>; 2]> = (0..6).map(texel).collect();
    let paths = ["full.exr", "compact.exr"].map(|name| folder.join(name));
    let of = |k: usize| texels.iter().map(|t| t[k].clone()).collect::<Vec<_>>();
    write(&paths[0], &names_of(bands), layout_attributes(), &of(0));
    let mut names: Vec<String> = ["R", "G", "B"].map(String::from).to_vec();
    names.extend(layout.channel_names());
    let mut attributes = layout_attributes();
    attributes.extend(layout.attributes());
    write(&paths[1], &names, attributes, &of(1));
    paths
}

#[test]
fn a_compact_file_reads_as_the_full_one() {
    for model in models() {
        reads_as_the_full_one(&model);
    }
}

fn reads_as_the_full_one(model: &Model) {
    let folder = tempfile::tempdir().unwrap();
    let bands = Grid::try_new(380, 780, 10).unwrap();
    let paths = full_and_compact(folder.path(), bands, model);
    for path in &paths {
        let found = Lint::of_file(path).unwrap();
        assert_eq!(found.findings, [], "{}", path.display());
        assert!(found.is_well_formed());
    }
    let [mut full, mut compact] = paths.map(|path| SpectralPicture::open(&path).unwrap());
    assert_eq!(full.channels().len(), 41 + 820);
    assert_eq!(compact.channels().len(), 41);
    assert_eq!(compact.bispectral_unit(), Some(BispectralUnit::PerBand));
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            assert_eq!(full.at(x, y).unwrap(), compact.at(x, y).unwrap());
        }
    }
    for picture in [&mut full, &mut compact] {
        let row = picture.row(1, 2).unwrap();
        assert_eq!(row, [0, 2].map(|x| picture.at(x, 1).unwrap()));
    }
    let texel = full.at(2, 1).unwrap();
    assert!(texel.reradiation.iter().any(|(.., share)| *share > 0.01));
    assert!(texel.reflectance.is_sorted_by(|a, b| a.0 < b.0));
    assert_eq!(texel.preview, Some([0.25, 0.5, 0.75]));
    let outside = full.at(3, 0).unwrap_err().to_string();
    assert_eq!(outside, "columns [3, 4] of rows [0, 1], expected some inside 3 by 2");
}

/// The findings in a file of these channels, with `value` in all samples.
fn findings(names: &[&str], attributes: Attributes, value: f32) -> Vec<(Rule, Severity, String)> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.exr");
    let names: Vec<String> = names.iter().map(|&n| n.into()).collect();
    write(&path, &names, attributes, &vec![vec![value; names.len()]; 6]);
    let found = Lint::of_file(&path).unwrap();
    found.findings.into_iter().map(|f| (f.rule, f.severity, f.to_string())).collect()
}

fn rules(names: &[&str], value: f32) -> Vec<Rule> {
    let names = [names, &["R", "G", "B"]].concat();
    findings(&names, layout_attributes(), value).into_iter().map(|(rule, ..)| rule).collect()
}

#[test]
fn each_broken_rule_is_found_and_no_other() {
    let pair = ["T.400nm", "T.410nm", "T.400nm.410nm"];
    assert_eq!(rules(&pair, 0.25), []);
    assert_eq!(rules(&["T.400nm", "T.410.5nm"], 0.25), [Rule::Name]);
    assert_eq!(rules(&["T.400nm", "T.nm"], 0.25), [Rule::Name]);
    assert_eq!(rules(&["T.400nm", "T.400lightyears"], 0.25), [Rule::Name]);
    assert_eq!(rules(&["T.400nm", "T.400nm.400nm"], 0.25), [Rule::Diagonal]);
    let below = [&pair[..], &["T.410nm.400nm"]].concat();
    assert_eq!(rules(&below, 0.25), [Rule::Stokes]);
    assert_eq!(rules(&["T.400nm", "T.400,000nm"], 0.25), [Rule::Duplicate]);
    assert_eq!(rules(&["T.400nm", "T.0,5um"], 0.25), [Rule::Units]);
    // An exponent is no part of the unit.
    for other in ["5e2", "5E2", "5e+2", "0,5e3", "50000e-2", "5,00E02", "500,0"] {
        assert_eq!(rules(&["T.400nm", &format!("T.{other}nm")], 0.25), [], "{other}");
        assert_eq!(rules(&["T.400nm", &format!("T.{other}pm")], 0.25), [Rule::Units], "{other}");
    }
    assert_eq!(rules(&["T.400nm", "T.410nm", "T.420nm", "T.400nm.410nm"], 0.25), [Rule::Pairs]);
    assert_eq!(rules(&["T.400nm", "T.400nm.410nm"], 0.25), [Rule::Band]);
    assert_eq!(rules(&["S0.400nm", "S1.410nm"], 0.25), [Rule::EmissiveUnits, Rule::Polarization]);
    assert_eq!(rules(&[], 0.25), [Rule::Spectral]);
    assert_eq!(rules(&pair, f32::NAN), [Rule::Finite]);
    assert_eq!(rules(&pair, -0.25), [Rule::Negative]);
    assert_eq!(rules(&pair, 0.75), [Rule::Energy]);
    assert_eq!(rules(&["S0.400nm"], 7.0), [Rule::EmissiveUnits]);
}

#[test]
fn attributes_are_linted_too() {
    let names = ["T.400nm", "T.410nm", "T.400nm.410nm"];
    let found = findings(&names, Attributes::new(), 0.6);
    let found: Vec<_> = found.iter().map(|(rule, severity, _)| (*rule, *severity)).collect();
    // Without a unit the pair is not added to the diagonal, which is below 1.
    assert_eq!(
        found,
        [
            (Rule::LayoutVersion, Severity::Error),
            (Rule::BispectralUnit, Severity::Warning),
            (Rule::Preview, Severity::Warning),
        ]
    );
    let mut attributes = layout_attributes();
    attributes.insert(BISPECTRAL_UNIT.into(), BispectralUnit::PerNm.to_string().into());
    let bright = findings(&names, attributes, 0.6);
    assert!(bright.iter().any(|(rule, ..)| *rule == Rule::Energy), "{bright:?}");
    let mut attributes = layout_attributes();
    attributes.insert(LAYOUT_VERSION.into(), "2.0".into());
    attributes.insert(EMISSIVE_UNITS.into(), "W.m^-2.sr^-1".into());
    let found = findings(&["S0.400nm", "R", "G", "B"], attributes, 0.5);
    assert_eq!(found[0].2, "error: spectralLayoutVersion \"2.0\", expected \"1.0\"");
    assert_eq!(found.len(), 1);
}

/// The packages that read our files.
const READERS: &str = "OpenEXR, numpy";

#[test]
fn other_programs_read_our_files() {
    let Some(python) = python(READERS) else {
        println!("skipped: other_programs_read_our_files, no python3 with OpenEXR and numpy");
        return;
    };
    for model in models() {
        other_programs_read(&python, &model);
    }
}

fn other_programs_read(python: &Path, model: &Model) {
    let folder = tempfile::tempdir().unwrap();
    let bands = Grid::try_new(380, 780, 50).unwrap();
    let [full, compact] = full_and_compact(folder.path(), bands, model);
    // The values that other programs should see.
    let mut picture = SpectralPicture::open(&full).unwrap();
    let mut expected = String::new();
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            let texel = picture.at(x, y).unwrap();
            for (nm, value) in texel.reflectance {
                let name = SpectralChannel::Reflectance { nm };
                expected += &format!("{x} {y} {name} {value}\n");
            }
            for (in_nm, out_nm, share) in texel.reradiation {
                let name = SpectralChannel::Reradiation { in_nm, out_nm };
                expected += &format!("{x} {y} {name} {share}\n");
            }
        }
    }
    let list = folder.path().join("expected.txt");
    std::fs::write(&list, expected).unwrap();
    agrees(python, "", &[&full, &compact, &list]);
}

/// Reads files with other programs, which must agree with ours.
fn agrees(python: &Path, mode: &str, files: &[&Path]) {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/readers/check_exr.py");
    let mode = (!mode.is_empty()).then_some(mode);
    let output = Command::new(python).arg(script).args(mode).args(files).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    let failed = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}{failed}");
    print!("{said}");
}

/// A baked file of six colors, and the cube it was made with.
fn baked(folder: &Path, name: &str, form: Form, model: &Model) -> (PathBuf, Cube) {
    let input = folder.join("colors.exr");
    let space = ("chromaticities".to_owned(), chromaticities(&RgbSpace::default()));
    let names = ["R", "G", "B"].map(String::from);
    let colors = [
        [0.5, 0.5, 0.5],
        [0.9, 0.0, 0.9],
        [0.1, 0.5, 0.6],
        [1.0, 1.0, 1.0],
        [0.7, 0.3, 0.1],
        [0.2, 0.6, 0.1],
    ];
    write(&input, &names, Attributes::from([space]), &colors.map(|c| c.to_vec()));
    let cube = build_cube(&Contract::default(), model, Preset::Konig2020.options(), 5, &Unwatched)
        .unwrap();
    let options = BakeOptions {
        declared: Declared::default(),
        repair: None,
        sample: Sample::Float,
        layout: Layout::Rows,
    };
    let output = folder.join(name);
    Baker::new(&cube, form, options).unwrap().bake(&input, &output, &Unwatched).unwrap();
    (output, cube)
}

/// Column, row, channel and value of each sample, as we read it.
fn samples(path: &Path) -> String {
    let mut reader = ExrReader::open(path).unwrap();
    let numbers: Vec<usize> = (0..reader.channels().len()).collect();
    let planes = reader.read_rows(0..SIZE[1], &numbers).unwrap();
    let line = |c: usize, i: usize| {
        let (x, y, name) = (i % SIZE[0], i / SIZE[0], &reader.channels()[c].name);
        format!("{x} {y} {name} {}\n", planes[c][i])
    };
    numbers.iter().flat_map(|&c| (0..6).map(move |i| (c, i))).map(|(c, i)| line(c, i)).collect()
}

#[test]
fn other_programs_read_baked_materials_and_light() {
    let Some(python) = python(READERS) else {
        println!("skipped: other_programs_read_baked_materials_and_light, no python3 with OpenEXR");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let light = Illuminant::named("A").unwrap();
    let forms = [Form::Material, Form::Radiance { light }];
    for (form, channels) in forms.into_iter().zip([6, 3]) {
        let (path, _) = baked(folder.path(), "baked.exr", form, &Model::Dyes(dyes()));
        let list = folder.path().join("expected.txt");
        let expected = samples(&path);
        assert_eq!(expected.lines().count(), 6 * channels);
        std::fs::write(&list, expected).unwrap();
        agrees(&python, "--samples", &[&path, &list]);
    }
}

#[test]
fn a_texture_system_reads_every_level_of_baked_textures_as_we_do() {
    let Some(python) = python(READERS) else {
        println!(
            "skipped: a_texture_system_reads_every_level_of_baked_textures_as_we_do, no python3 with OpenEXR and numpy"
        );
        return;
    };
    const SIZE: [usize; 2] = [71, 45];
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let plane = |k: usize| -> Vec<f32> {
        let texel = |i: usize| 0.2 + 0.5 * ([0.1, 0.37, 0.73][k] * i as f32).fract();
        (0..SIZE[0] * SIZE[1]).map(texel).collect()
    };
    let described = ExrDescription::new(SIZE, ["R", "G", "B"]).with_space(&RgbSpace::default());
    let mut writer = ExrWriter::create(path("in.exr"), described).unwrap();
    writer.write_band(&[&plane(0), &plane(1), &plane(2)]).unwrap();
    writer.finish().unwrap();
    let preset = Preset::Konig2020;
    let cube = build_cube(&Contract::default(), &preset.model(), preset.options(), 5, &Unwatched);
    let cube = cube.unwrap();
    let light = Illuminant::named("A").unwrap();
    let grid = Grid::try_new(400, 700, 50).unwrap();
    for form in [Form::Material, Form::Radiance { light }, Form::Spectral { grid, compact: true }] {
        let options = BakeOptions {
            declared: Declared::default(),
            repair: None,
            sample: Sample::Half,
            layout: Layout::Mipmap,
        };
        let baker = Baker::new(&cube, form, options).unwrap();
        baker.bake(path("in.exr"), path("out.tx"), &Unwatched).unwrap();
        let mut lines = String::new();
        for level in 0..7 {
            let mut reader = ExrReader::open_level(path("out.tx"), level).unwrap();
            let [width, height] = reader.size();
            let channels: Vec<usize> = (0..reader.channels().len()).collect();
            let planes = reader.read_rows(0..height, &channels).unwrap();
            for (plane, channel) in planes.iter().zip(reader.channels()) {
                for (i, value) in plane.iter().enumerate() {
                    let (x, y, name) = (i % width, i / width, &channel.name);
                    lines += &format!("{level} {width} {height} {x} {y} {name} {value}\n");
                }
            }
        }
        assert!(ExrReader::open_level(path("out.tx"), 7).is_err());
        std::fs::write(path("expected.txt"), lines).unwrap();
        agrees(&python, "--levels", &[&path("out.tx"), &path("expected.txt")]);
    }
}

#[test]
fn colour_science_integrates_a_baked_reflectance_to_our_color() {
    let Some(python) = python(READERS) else {
        println!("skipped: colour_science_integrates_a_baked_reflectance_to_our_color, no python3");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    // The range of the observer's table there.
    let grid = Grid::try_new(360, 830, 1).unwrap();
    let form = Form::Spectral { grid, compact: false };
    let (path, cube) = baked(folder.path(), "fine.exr", form, &Model::Reflectance);
    let sums = cube.contract().on(grid);
    let lines = grid.wavelengths_nm().zip(sums.irradiance());
    let light: String = lines.map(|(nm, power)| format!("{nm} {power}\n")).collect();
    let mut picture = SpectralPicture::open(&path).unwrap();
    let mut colors = String::new();
    for (x, y) in (0..6).map(|i| (i % SIZE[0], i / SIZE[0])) {
        let texel = picture.at(x, y).unwrap();
        let bands = texel.reflectance.iter().map(|&(_, share)| f64::from(share));
        let [r, g, b] = sums.xyz_from_reflectance(bands).0;
        colors += &format!("{x} {y} {r} {g} {b}\n");
    }
    let [lights, list] = ["light.txt", "colors.txt"].map(|name| folder.path().join(name));
    std::fs::write(&lights, light).unwrap();
    std::fs::write(&list, colors).unwrap();
    agrees(&python, "--colors", &[&path, &lights, &list]);
}

#[test]
fn a_full_and_a_compact_file_hold_the_same_matrix() {
    // Both are rounded to single precision, sums of six texels.
    const SINGLE: f64 = 1e-6;
    let bands = Grid::try_new(380, 700, 20).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for model in models() {
        let [full, compact] = full_and_compact(folder.path(), bands, &model)
            .map(|path| SpectralPicture::open(path).unwrap());
        let [mut full, mut compact] = [full, compact];
        for at in [Some([0, 0]), Some([2, 1]), None] {
            let [one, two] =
                [&mut full, &mut compact].map(|picture| picture.matrix(at, None).unwrap());
            assert!(one.incident_nm().iter().copied().eq(bands.wavelengths_nm()));
            let pairs = one.factors().iter().flatten().zip(two.factors().iter().flatten());
            assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < SINGLE));
        }
        let texels = (0..6).map(|t| full.at(t % 3, t / 3).unwrap().reradiation[5].2);
        let mean = texels.map(f64::from).sum::<f64>() / 6.0;
        let found = full.matrix(None, None).unwrap().factors()[6][0];
        assert!((found - mean).abs() < SINGLE && mean > 0.0, "{found} {mean}");
        let refused = full.matrix(None, Some(BispectralUnit::PerNm)).unwrap_err().to_string();
        assert_eq!(refused, "re-radiation per band, expected per nm, the unit given");
    }
}

#[test]
fn a_matrix_without_a_unit_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("none.exr");
    let names = names_of(Grid::try_new(400, 700, 100).unwrap());
    let texels = vec![vec![0.01; names.len()]; 6];
    write(&path, &names, Attributes::new(), &texels);
    let mut picture = SpectralPicture::open(&path).unwrap();
    let refused = picture.matrix(None, None).unwrap_err().to_string();
    let expected = "the unit of re-radiation is not stated, expected the attribute \
                    upglow.bispectralUnit, or a unit given";
    assert_eq!(refused, expected);
    let found = picture.matrix(None, Some(BispectralUnit::PerNm)).unwrap();
    // Single precision of the file.
    assert!(
        (found.factors()[1][0] - 1.0).abs() < 1e-6 && (found.factors()[1][1] - 0.01).abs() < 1e-6
    );
    assert_eq!(found.diagonal(), upglow_color::Diagonal::Reflected);
}

/// Their pairs, listed, would take 20 GB.
const VERY_MANY: usize = 50_000;

#[test]
fn very_many_channels_are_read_and_linted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("many.exr");
    let names: Vec<String> = (1..=VERY_MANY).map(|nm| format!("T.{nm},000000nm")).collect();
    let moved = "T.1,000000nm.3,000000nm".to_owned();
    let names: Vec<String> = names.into_iter().chain([moved]).collect();
    let described = crate::ExrDescription::new([1, 1], names.iter().map(String::as_str));
    let mut writer = crate::ExrWriter::create(&path, described).unwrap();
    let value = [0.25];
    writer.write_band(&vec![&value[..]; names.len()]).unwrap();
    writer.finish().unwrap();
    let lint = Lint::of_file(&path).unwrap();
    let pairs = lint.findings.iter().find(|finding| finding.rule == Rule::Pairs).unwrap();
    assert_eq!(
        pairs.found,
        "1249974999 of 1249975000 pairs absent, the first T.1,000000nm.2,000000nm"
    );
    let mut picture = SpectralPicture::open(&path).unwrap();
    assert_eq!(picture.at(0, 0).unwrap().reflectance.len(), VERY_MANY);
    let refused = picture.matrix(None, Some(BispectralUnit::PerBand)).unwrap_err().to_string();
    assert_eq!(refused, "50000 incident wavelengths, expected 2 to 1001");
}
