//! Documents for RGB renderers, as MaterialX and USD read them.

#![expect(clippy::unwrap_used, reason = "a test fails where its files cannot be made")]

mod support;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use upglow_shader::{ColorMap, DocumentError, Documents, color_node};

use crate::support::{python, runs};

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/documents/validate.py");

/// A document, its name and the files that it names.
struct Example {
    name: &'static str,
    documents: Documents,
    files: Vec<String>,
}

/// Documents of every kind: of a cube, of maps with the tiles of a UDIM, in spaces that few programs know or that have
/// no name, of maps whose names are code in XML, GLSL or USD.
fn examples() -> Vec<Example> {
    let of_cube = |name: &'static str, file: &str, space| Example {
        name,
        documents: Documents::of_cube("1 <sky>", file, space).unwrap(),
        files: vec![file.into()],
    };
    let of_maps = |name: &'static str, maps: &[(&str, &[u32])], space| {
        let white = [0.979, 0.612, 0.228];
        let map = |&(file, tiles): &(&str, &[u32])| ColorMap {
            file: file.into(),
            tiles: tiles.into(),
            white,
        };
        let maps: Vec<ColorMap> = maps.iter().map(map).collect();
        let tile = |map: &ColorMap, tile: &u32| map.file.replace("<UDIM>", &tile.to_string());
        let files = maps.iter().flat_map(|map| map.tiles.iter().map(|n| tile(map, n))).collect();
        Example { name, documents: Documents::of_maps(&maps, space).unwrap(), files }
    };
    let one = &[1001][..];
    let hostile = [
        ("a' value='0' /><x y='&amp;.exr", one),
        ("-->]]>*/ } #include <x>.exr", one),
        ("a@@@b@ <c>.exr", one),
        ("a $fileTransformUv.exr", one),
        ("a.tif", one),
        ("a.exr", one),
    ];
    let tiles = [("maps/wall.A.<UDIM>.exr", &[1001, 1002, 1011][..]), ("floor.exr", one)];
    let space = Some("lin_ap1_scene");
    vec![
        of_cube("cube", "cube.colors.exr", space),
        of_cube("rec2020", "rec2020.colors.exr", Some("lin_rec2020_scene")),
        of_maps("tiles", &tiles, space),
        of_maps("custom", &[("floor.exr", one)], None),
        of_maps("hostile", &hostile, space),
    ]
}

/// Writes everything into a folder, and returns the paths of the documents without their endings.
fn write(folder: &Path) -> Vec<PathBuf> {
    for file in color_node() {
        fs::write(folder.join(file.name), file.bytes).unwrap();
    }
    let write = |Example { name, documents, files }: Example| {
        for file in files {
            let path = folder.join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "").unwrap();
        }
        fs::write(folder.join(format!("{name}.mtlx")), documents.materialx).unwrap();
        fs::write(folder.join(format!("{name}.usda")), documents.usd).unwrap();
        folder.join(name)
    };
    examples().into_iter().map(write).collect()
}

/// Runs one part of the script over all documents.
fn validate(python: &Path, part: &str, folder: &Path) -> String {
    let mut command = Command::new(python);
    let output = command.args([SCRIPT, part]).args(write(folder)).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    said
}

/// The files in a folder with one of these endings.
fn files(folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let ends = |path: &PathBuf| {
        path.extension().is_some_and(|found| endings.iter().any(|ending| found == *ending))
    };
    entries.filter(ends).collect()
}

#[test]
fn materialx_makes_shaders_of_the_documents_that_compile() {
    const TEST: &str = "materialx_makes_shaders_of_the_documents_that_compile";
    let Some(python) = python("MaterialX") else {
        return println!("skipped: {TEST}, no Python with MaterialX");
    };
    let folder = tempfile::tempdir().unwrap();
    print!("{}", validate(&python, "materialx", folder.path()));
    compile_glsl(folder.path())
        .unwrap_or_else(|reason| println!("skipped: {TEST} in glsl, {reason}"));
    compile_osl(folder.path())
        .unwrap_or_else(|reason| println!("skipped: {TEST} in osl, {reason}"));
}

fn compile_glsl(folder: &Path) -> Result<(), &'static str> {
    if !runs("glslangValidator") {
        return Err("no glslangValidator");
    }
    let stages = files(folder, &["frag", "vert"]);
    assert!(stages.len() >= 4 * examples().len(), "{stages:?}");
    for stage in stages {
        let output = Command::new("glslangValidator").arg(&stage).output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{}: {said}", stage.display());
    }
    Ok(())
}

const COMPILE_OSL: &str = "\
import sys, bpy, _cycles
for path in sys.argv[1:]:
    assert _cycles.osl_compile(path, path + '.oso'), path
print('Blender', bpy.app.version_string, 'compiled', len(sys.argv[1:]), 'OSL shaders')
";

fn compile_osl(folder: &Path) -> Result<(), &'static str> {
    let python = python("bpy, _cycles").ok_or("no Python with bpy")?;
    let mut shaders = files(folder, &["osl"]);
    // Beside the shaders there is the function that they include.
    shaders.retain(|path| !path.ends_with("upglow_color.osl"));
    assert!(shaders.len() >= 2 * examples().len(), "{shaders:?}");
    let output = Command::new(python).args(["-c", COMPILE_OSL]).args(shaders).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    println!("{}", said.lines().last().unwrap_or_default());
    Ok(())
}

#[test]
fn usd_finds_nothing_wrong_with_the_stages() {
    const TEST: &str = "usd_finds_nothing_wrong_with_the_stages";
    let Some(python) = python("MaterialX, pxr.UsdValidation") else {
        return println!("skipped: {TEST}, no Python with MaterialX and pxr");
    };
    let folder = tempfile::tempdir().unwrap();
    print!("{}", validate(&python, "usd", folder.path()));
}

#[test]
fn names_that_would_be_code_are_refused() {
    for found in ["a\u{1}.exr", "a\n.exr", "a\u{ffff}.exr", "a\", x(), \".exr", "a\\.exr"] {
        let expected = DocumentError::Name { found: found.into() };
        let map = ColorMap { file: found.into(), tiles: vec![1001], white: [1.0; 3] };
        assert_eq!(Documents::of_maps(&[map], None).unwrap_err(), expected);
        assert_eq!(Documents::of_cube("a", found, None).unwrap_err(), expected);
    }
}
