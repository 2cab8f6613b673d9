//! The commands for pictures and coefficient tables, from end to end.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod support;

use std::path::Path;

use serde_json::Value;
use support::{Folder, one_line};
use upglow_color::RgbSpace;
use upglow_color::rounding::to_single;
use upglow_image::{ExrDescription, ExrWriter, Sample};

/// A picture of float samples; `says` whether it is in ACEScg.
fn picture(folder: &Folder, name: &str, width: usize, rgb: &[[f32; 3]], says: bool) {
    let size = [width, rgb.len() / width];
    let mut described = ExrDescription::new(size, ["R", "G", "B"]).with_sample(Sample::Float);
    if says {
        described = described.with_space(&RgbSpace::default());
    }
    let path = folder.path().join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let mut writer = ExrWriter::create(&path, described).unwrap();
    let planes = [0, 1, 2].map(|k| rgb.iter().map(|v| v[k]).collect::<Vec<f32>>());
    writer.write_band(&planes.each_ref().map(Vec::as_slice)).unwrap();
    writer.finish().unwrap();
}

const MAGENTA: [f32; 3] = [0.9, 0.0, 0.9];
const GRAY: [f32; 3] = [0.5; 3];
const TILE: [[f32; 3]; 4] = [GRAY, MAGENTA, [0.1, 0.5, 0.6], [0.0, 1.0, 0.0]];

/// A cube, and a picture of four texels.
fn desk() -> Folder {
    let folder = Folder::new();
    folder.done("build --preset konig2020 --resolution 4 -o cube");
    picture(&folder, "tile.exr", 2, &TILE, true);
    folder
}

/// How reports count texels by the kind of their material.
fn kinds(reflectance: u64, dyed: u64, steep: u64, missed: u64) -> Value {
    serde_json::json!({
        "reflectance": reflectance, "dyed": dyed, "steep": steep, "missed": missed,
    })
}

#[test]
fn the_examples_are_those_of_the_repository() {
    let folder = Folder::new();
    let told = folder.json("examples --out made");
    let committed = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let pictures = told["pictures"].as_array().unwrap();
    assert_eq!(pictures.len(), 3);
    for made in pictures {
        let file = made["file"].as_str().unwrap();
        let name = Path::new(file).file_name().unwrap();
        assert!(folder.read(file) == std::fs::read(committed.join(name)).unwrap(), "{file}");
    }
    assert!(folder.done("examples").starts_with("examples/pool.exr:   512 × 512, tiles"));
}

#[test]
fn check_says_what_each_texel_needs() {
    let folder = desk();
    let found = folder.picture("check tile.exr --cube cube -o page.html --heat-map heat.png");
    assert_eq!(
        (&found["width"], &found["texels"], &found["no_color"]),
        (&2.into(), &4.into(), &0.into())
    );
    assert_eq!(found["shown_by_reflectance"], 0.5);
    assert_eq!(found["needs_fluorescence"], 0.25);
    assert_eq!(found["shown_by_nothing"], 0.25);
    assert_eq!((&found["worst"][0]["x"], &found["worst"][0]["y"]), (&1.into(), &1.into()));
    assert_eq!((&found["page"], &found["heat_map"]), (&"page.html".into(), &"heat.png".into()));
    assert!(found["cube"]["greatest_de2000"].as_f64().unwrap() > 1.0);
    assert_eq!(found["cube"]["kinds"], kinds(1, 0, 0, 3));
    let page = String::from_utf8(folder.read("page.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("tile.exr"));
    assert!(page.contains("data:image/png;base64,") && !page.contains("src=\"http"));
    assert!(folder.read("heat.png").starts_with(b"\x89PNG"));
    assert!(page.contains("<b>75.0 %</b> missed <small>3</small>"), "{page}");
    let text = folder.done("check tile.exr --cube cube");
    let headline = found["headline"].as_str().unwrap();
    let within = 100.0 * found["cube"]["within_one"].as_f64().unwrap();
    let said = format!("{within:.1} % of this picture is within 1 ΔE00");
    assert!(headline.starts_with(&said), "{headline}");
    assert!(text.starts_with("result:") && text.lines().next().unwrap().ends_with(headline));
    assert_eq!(found["cube"]["worst"][0]["de2000"], found["cube"]["greatest_de2000"]);
    assert!(text.contains("(--preset natural): about "), "{text}");
    assert!(text.contains("missed:               3   75.00 %  ΔE00 > 0.01"), "{text}");
    assert!(text.contains("fluorescence needed:  25.00 %"), "{text}");
    assert!(text.contains("1,1 (0.0000, 1.0000, 0.0000): nothing shows it"), "{text}");
}

#[test]
fn check_counts_and_locates_what_is_out_of_range() {
    let folder = Folder::new();
    let flawed =
        [[2.0, 0.5, 0.5], [0.5, -0.5, 0.5], [f32::NAN, 0.0, 0.0], [0.0, f32::INFINITY, 0.0]];
    picture(&folder, "flawed.exr", 4, &flawed, true);
    let found = folder.picture("check flawed.exr");
    for (x, (count, flaw)) in [
        ("above_one", "above 1"),
        ("negative", "negative"),
        ("not_a_number", "no number"),
        ("infinite", "infinite"),
    ]
    .into_iter()
    .enumerate()
    {
        assert_eq!(found[count], 1, "{found}");
        let located = found["flaws"].as_array().unwrap();
        assert!(located.iter().any(|f| f["flaw"] == flaw && f["x"] == x && f["y"] == 0), "{found}");
    }
    let text = folder.done("check flawed.exr");
    assert!(text.contains("not a number:") && text.contains("2,0 (NaN, 0.0000, 0.0000)"), "{text}");
}

#[test]
fn a_material_is_baked_and_read_back() {
    let folder = desk();
    let told = folder.picture("bake cube tile.exr -o tile.material.exr");
    assert_eq!((&told["form"], &told["channels"]), (&"material".into(), &6.into()));
    assert_eq!(told["bytes"], folder.read("tile.material.exr").len());
    assert_eq!(told["kinds"], kinds(1, 1, 0, 2));
    let gray = folder.json("read tile.material.exr --at 0,0");
    assert_eq!((&gray["concentration"], &gray["dye"]), (&0.0.into(), &Value::Null));
    let magenta = folder.json("read tile.material.exr --at 1,0");
    assert!(magenta["concentration"].as_f64().unwrap() > 0.5, "{magenta}");
    assert!(magenta["steepest_per_nm"].as_f64().unwrap() <= 0.01);
    let text = folder.done("read tile.material.exr --at 1,0");
    assert!(text.starts_with("texel:          1,0 of tile.material.exr\n"), "{text}");
    let text = folder.done("bake cube tile.exr -o again.exr");
    assert!(text.contains("missed:       2   50.00 %  ΔE00 > 0.01"), "{text}");
    let fast = folder.json("bake cube tile.exr -o fast.exr --fast --sample float");
    assert_eq!(fast["kinds"], Value::Null);
    let run = folder.run("lint tile.material.exr");
    assert_eq!(run.status, 1);
    assert!(
        run.stdout.contains("baked as:     material, which is not a spectral"),
        "{}",
        run.stdout
    );
    assert_eq!(
        one_line(&run.stderr),
        "tile.material.exr: not well-formed, expected a well-formed spectral EXR"
    );
}

#[test]
fn spectral_files_are_well_formed_and_agree() {
    let folder = desk();
    folder.done("bake cube tile.exr -o full.exr --as spectral --bands 400:700:20 --sample float");
    let compact = "--as spectral --bands 400:700:20 --sample float --compact";
    let told = folder.picture(&format!("bake cube tile.exr -o compact.exr {compact}"));
    assert_eq!(told["channels"], 3 + 16 + 8);
    for (file, pairs, compact) in [("full.exr", 120, false), ("compact.exr", 0, true)] {
        let found = folder.json(&format!("lint {file}"));
        assert_eq!((&found["well_formed"], &found["compact"]), (&true.into(), &compact.into()));
        assert_eq!(
            (&found["reflectance_channels"], &found["reradiation_channels"]),
            (&16.into(), &pairs.into())
        );
    }
    // A node of the cube: its blend is one material.
    let read = |file: &str| folder.json(&format!("read {file} --at 1,1"));
    let (full, compact) = (read("full.exr"), read("compact.exr"));
    assert_eq!(full["reflectance"].as_array().unwrap().len(), 16);
    assert_eq!(full["reradiation"].as_array().unwrap().len(), 120);
    assert_eq!(compact["reradiation"].as_array().unwrap().len(), 120);
    assert_eq!(full["reradiation_unit"], "per band");
    let text = folder.done("read full.exr --at 1,0");
    assert!(text.contains(" nm  reflectance") && text.contains("400  "), "{text}");
    folder.done("lint full.exr compact.exr --names-only");
}

#[test]
fn radiance_under_the_cubes_own_light_is_the_picture() {
    let folder = desk();
    let told = folder.picture("bake cube tile.exr -o light.exr --as radiance --light D65");
    assert_eq!(told["channels"], 3);
    let line = folder.refused(1, "read light.exr --at 0,0");
    assert_eq!(
        line,
        "light.exr: colors under a light, expected a file baked as material or spectral"
    );
    // It can be checked as any picture, and its gray is still there.
    let found = folder.picture("check light.exr");
    assert_eq!(found["rgb_space"], "acescg");
}

#[test]
fn several_lights_give_a_picture_each() {
    let folder = desk();
    let lights = "--as radiance --light D65 --light A";
    let told = folder.json(&format!("bake cube tile.exr -o x.png {lights}"));
    let files: Vec<&str> =
        told["pictures"].as_array().unwrap().iter().filter_map(|p| p["file"].as_str()).collect();
    assert_eq!(files, ["x.D65.png", "x.A.png"]);
    assert_eq!(told["pictures"][1]["light"], "A");
    // A screen's picture can be checked as any other, and says its encoding itself.
    let found = folder.picture("check x.A.png");
    assert_eq!((&found["rgb_space"], &found["above_one"]), (&"srgb".into(), &0.into()));
    folder.done(&format!("bake cube tile.exr -o out --format png --bits 16 {lights}"));
    let again =
        folder.json(&format!("bake cube tile.exr -o out --format png --bits 16 --update {lights}"));
    assert_eq!(again["unchanged"].as_array().unwrap().len(), 2);
    let line = folder.refused(2, "bake cube tile.exr -o x.exr --as radiance --light D65 --bits 8");
    assert_eq!(line, "--bits: given with --format exr, expected --format png");
}

#[test]
fn matrices_for_an_engine_are_a_picture_for_each_number_of_light() {
    let folder = desk();
    let told = folder.json("bake cube tile.exr -o x.exr --as rgbu --engine rec709");
    let files: Vec<&str> =
        told["pictures"].as_array().unwrap().iter().filter_map(|p| p["file"].as_str()).collect();
    assert_eq!(files, ["x.red.exr", "x.green.exr", "x.blue.exr", "x.ultraviolet.exr"]);
    assert_eq!(told["pictures"][3]["channels"], 4);
    folder.done("bake cube tile.exr -o out --as rgbu --tx");
    assert!(folder.path().join("out/tile.rgbu.ultraviolet.tx").exists());
    let line = folder.refused(1, "read x.red.exr --at 0,0");
    let expected =
        "x.red.exr: parts of 4×4 matrices, expected a file baked as material or spectral";
    assert_eq!(line, expected);
    let line = folder.refused(2, "bake cube tile.exr -o y.exr --engine rec709");
    assert_eq!(line, "--engine: given with --as material, expected --as rgbu");
}

#[test]
fn textures_at_all_levels_are_named_tx_and_read_at_the_first() {
    let folder = desk();
    let made = folder.picture("bake cube tile.exr -o out --tx");
    assert_eq!(made["file"], "out/tile.material.tx");
    folder.done("bake cube tile.exr -o tile.tx --sample float");
    folder.done("bake cube tile.exr -o rows.exr --sample float");
    let read = |file: &str| folder.json(&format!("read {file} --at 1,1"));
    let [mut texture, mut rows] = ["tile.tx", "rows.exr"].map(read);
    (texture["file"], rows["file"]) = (Value::Null, Value::Null);
    assert_eq!(texture, rows);
    let line = folder.refused(1, "bake cube tile.exr -o tile.exr --tx");
    assert!(line.contains("a name that ends in .exr, expected one that ends in .tx"), "{line}");
    folder.refused(2, "bake cube tile.exr -o a.tx --tx --format exr");
}

#[test]
fn folders_and_udim_tiles_keep_their_names() {
    let folder = desk();
    for name in ["set/wall.1001.exr", "set/wall.1002.exr", "set/floor_1001.exr", "set/door.exr"] {
        picture(&folder, name, 1, &[GRAY], true);
    }
    folder.write("set/notes.txt", "no picture");
    let text = folder.done("bake cube set -o out/of/it");
    assert_eq!(text.matches("\n\npicture:").count(), 3, "{text}");
    let mut names: Vec<String> = std::fs::read_dir(folder.path().join("out/of/it"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(
        names,
        [
            "door.material.exr",
            "floor.material_1001.exr",
            "wall.material.1001.exr",
            "wall.material.1002.exr"
        ]
    );
    let told = folder.json("check set");
    assert_eq!(told["pictures"].as_array().unwrap().len(), 4);
    assert_eq!(told["left_out"], serde_json::json!(["set/notes.txt"]));
    folder.done("check set -o page.html");
    let line = folder.refused(1, "bake cube set -o set");
    assert!(line.starts_with("set: the folder of the pictures, expected another"), "{line}");
    let line = folder.refused(1, "bake cube set -o all.exr");
    assert_eq!(
        line,
        "all.exr: one file for 4 pictures, expected a folder, or a name with <UDIM> or %04d"
    );
    let line = folder.refused(2, "check set --heat-map heat.png");
    assert!(line.starts_with("--heat-map: given with 4 pictures, expected one"), "{line}");
}

#[test]
fn what_cannot_be_baked_is_repaired_only_if_asked() {
    let folder = Folder::new();
    folder.done("build --preset konig2020 --resolution 2 -o cube");
    picture(&folder, "bright.exr", 2, &[GRAY, [4.0, 1.0, 1.0], GRAY, [-1.0, 0.5, 0.5]], true);
    let line = folder.refused(1, "bake cube bright.exr -o out.exr");
    assert_eq!(
        line,
        "bright.exr: texel 1,0, and 1 more in the same rows: red is 4, expected 0 to 1, the range of \
         the cube; give --repair clip, scale or nearest"
    );
    for (repair, count) in [("clip", 2), ("scale", 4), ("nearest", 2)] {
        let told = folder.picture(&format!("bake cube bright.exr -o out.exr --repair {repair}"));
        assert_eq!(told["repaired"], count, "{repair}");
    }
}

#[test]
fn pictures_that_are_refused() {
    let folder = desk();
    picture(&folder, "unsaid.exr", 1, &[GRAY], false);
    let whole = folder.read("tile.exr");
    folder.write("cut.exr", &whole[..whole.len() - 9]);
    folder.write("head.exr", &whole[..60]);
    folder.write("text.exr", "no picture");
    folder.write("empty.png", "");
    let space = "unsaid.exr: the file does not state its RGB space, expected a declaration; if it is \
                 ACEScg, type: upglow ";
    let cases = [
        ("bake cube unsaid.exr -o out.exr", space),
        ("check unsaid.exr", space),
        ("bake cube cut.exr -o out.exr", "cut.exr: "),
        ("check cut.exr", "cut.exr: "),
        ("lint cut.exr", "cut.exr: "),
        ("bake cube head.exr -o out.exr", "head.exr: the file ends inside "),
        ("read head.exr --at 0,0", "head.exr: the file ends inside "),
        ("lint head.exr", "head.exr: the file ends inside "),
        ("bake cube text.exr -o out.exr", "text.exr: the file begins with [6e, 6f, 20, 70]"),
        ("check empty.png", "empty.png: the file begins with []"),
        ("read text.exr --at 0,0", "text.exr: the file begins with"),
        ("bake cube cube -o out.exr", "cube: the file begins with"),
        ("bake tile.exr tile.exr -o out.exr", "tile.exr: not a whole safetensors file"),
        (
            "bake cube absent.exr -o out.exr",
            "absent.exr: no such file or folder, expected a picture",
        ),
        ("check absent.exr", "absent.exr: no such file or folder, expected a picture"),
        ("read absent.exr --at 0,0", "absent.exr: no such file or folder, expected a spectral"),
        ("lint absent.exr", "absent.exr: no such file or folder, expected an OpenEXR file"),
        (
            "bake cube tile.exr -o ./tile.exr",
            "./tile.exr: an input of this command, expected another",
        ),
        ("check tile.exr -o tile.exr", "tile.exr: an input of this command, expected another"),
        ("check tile.exr --cube cube -o cube", "cube: an input of this command, expected another"),
        (
            "bake cube tile.exr -o tile.png",
            "tile.png: a name that ends in .png, expected one that ends in .exr",
        ),
        (
            "bake cube tile.exr -o tile.svg",
            "tile.svg: a name that ends in .svg, expected one that ends in .exr",
        ),
        ("read tile.exr --at 0,0", "tile.exr: no spectral channel, expected names as T.550"),
    ];
    for (words, line) in cases {
        let found = folder.refused(1, words);
        assert!(found.starts_with(line) && found.contains("expected"), "{words}: {found}");
    }
}

#[test]
fn options_that_do_not_fit() {
    let folder = desk();
    folder.done("build --resolution 2 --model reflectance -o passive");
    folder.done("bake cube tile.exr -o material.exr");
    let cases = [
        (
            "bake cube tile.exr -o x.exr --as paint",
            "--as: unknown form \"paint\", expected material, spectral, radiance or rgbu",
        ),
        ("bake cube tile.exr -o x.exr --sample byte", "--sample: unknown kind of number \"byte\""),
        (
            "bake cube tile.exr -o x.exr --repair wish",
            "--repair: unknown repair \"wish\", expected clip",
        ),
        ("bake cube tile.exr -o x.exr --space rec", "--space: unknown RGB space \"rec\""),
        ("bake cube tile.exr -o x.exr --space data", "--space: data, which is no color, expected"),
        ("build -o x --space srgb_ap1_scene", "--space: srgb_ap1_scene, expected an RGB space of"),
        (
            "check tile.exr --alpha some",
            "--alpha: unknown use of alpha \"some\", expected straight",
        ),
        (
            "bake cube tile.exr -o x.exr --encoding log",
            "--encoding: unknown encoding \"log\", expected",
        ),
        (
            "bake cube tile.exr -o x.exr --bands 400:700:10",
            "--bands: given with --as material, expected --as spectral",
        ),
        ("bake cube tile.exr -o x.exr --compact", "--compact: given with --as material"),
        (
            "bake cube tile.exr -o x.exr --light A",
            "--light: given with --as material, expected --as radiance",
        ),
        (
            "bake cube tile.exr -o x.exr --as spectral --fast",
            "--fast: given with --as spectral, expected --as material",
        ),
        (
            "bake cube tile.exr -o x.exr --as radiance",
            "--light: not given, expected a light with --as radiance",
        ),
        (
            "bake cube tile.exr -o x.exr --as radiance --light F11",
            "--light: unknown illuminant \"F11\"",
        ),
        (
            "bake cube tile.exr -o x.exr --as spectral --bands 400-700",
            "--bands: \"400-700\", expected FIRST:LAST:STEP",
        ),
        (
            "bake cube tile.exr -o x.exr --as spectral --bands 200:700:10",
            "--bands: 200:700:10, expected bands within 300 to 830 nm",
        ),
        ("bake cube tile.exr -o x.exr --as spectral --bands 400:705:10", "--bands: "),
        (
            "bake cube tile.exr -o x.png --format png",
            "--format png: given with --as material, expected --as radiance",
        ),
        (
            "bake cube tile.exr -o x.png --as radiance --light A --exposure 21",
            "--exposure: 21, expected a number from -20 to 20",
        ),
        (
            "bake passive tile.exr -o x.exr --as spectral --compact",
            "--compact: a cube with the model reflectance, expected dyes",
        ),
        ("bake cube -o x.exr", "the following required arguments were not provided: <IN>"),
        ("bake cube tile.exr", "the following required arguments were not provided: --output"),
        (
            "check tile.exr --cube cube --illuminant A",
            "the argument '--cube <FILE>' cannot be used",
        ),
        ("read material.exr", "the following required arguments were not provided: --at"),
        ("read material.exr --at 1", "--at: \"1\", expected two whole numbers X,Y"),
        ("read material.exr --at -1,0", "--at: \"-1\", expected two whole numbers X,Y"),
        ("read material.exr --at 2,0", "--at: 2,0 is outside the picture, expected 0,0 to 1,1"),
        ("lint", "the following required arguments were not provided: <FILE>"),
        ("export cube x.txt", "--format: not given, expected one of csv, coeff, html, mtlx, clf"),
        (
            "export cube x.coeff --resolution 500",
            "--resolution: 500, expected a whole number from 2",
        ),
        ("export cube x.csv --resolution 8", "--resolution: given with --format csv, expected"),
        ("export cube x.coeff --resolution 129", "--resolution: resolution 129, expected 2 to 128"),
        (
            "export cube x.cube --resolution 130",
            "--resolution: 130, expected a whole number from 2",
        ),
        (
            "export cube x.cube --resolution 5 --target any",
            "--resolution: resolution 5, expected 6 to 129",
        ),
        (
            "export cube x.clf --target paint",
            "--target: unknown set of materials \"paint\", expected cube",
        ),
        (
            "export cube x.clf --show all",
            "--show: unknown view \"all\", expected nearest or out-of-reach",
        ),
        (
            "export cube x.csv --target any",
            "--target: given with --format csv, expected --format clf",
        ),
        (
            "export cube x.csv --show nearest",
            "--show: given with --format csv, expected --format clf",
        ),
    ];
    for (words, line) in cases {
        let found = folder.refused(2, words);
        assert!(found.starts_with(line), "{words}: {found}");
    }
}

#[test]
fn a_table_of_coefficients_comes_back_with_or_without_its_trailer() {
    let folder = Folder::new();
    folder.done("build --resolution 2 --model reflectance --space srgb -o cube");
    let told = folder.json("export cube table.coeff --resolution 8");
    let table = folder.read("table.coeff");
    assert_eq!((&told["nodes"], &told["bytes"]), (&(3 * 512).into(), &table.len().into()));
    let whole = folder.json("inspect table.coeff --space srgb");
    assert_eq!((&whole["resolution"], &whole["integrator"]), (&8.into(), &true.into()));
    // 4660 bytes that readers before 2026 ignore, and files before 2026 lack.
    folder.write("old.coeff", &table[..table.len() - 4660]);
    let old = folder.json("inspect old.coeff --space srgb");
    assert_eq!(old["integrator"], false);
    assert_eq!(old["mean_de2000"], whole["mean_de2000"]);
    let other = folder.json("inspect table.coeff --space acescg --illuminant A");
    assert!(other["mean_de2000"].as_f64() > whole["mean_de2000"].as_f64());
    let line = folder.refused(2, "inspect table.coeff");
    assert!(line.starts_with("--space: not given, expected the RGB space of the table"), "{line}");
    for cut in [5, 40, 2000, table.len() - 4661, table.len() - 1] {
        folder.write("cut.coeff", &table[..cut]);
        let line = folder.refused(1, "inspect cut.coeff --space srgb");
        assert!(line.starts_with("cut.coeff: ") && line.contains("expected"), "{cut}: {line}");
    }
    let mut altered = table.clone();
    altered[600..604].copy_from_slice(&f32::NAN.to_le_bytes());
    folder.write("altered.coeff", altered);
    let line = folder.refused(1, "inspect altered.coeff --space srgb");
    assert!(line.starts_with("altered.coeff: ") && line.contains("expected"), "{line}");
}

/// A folder of pictures of which `bad.exr` is damaged.
fn mixed(folder: &Folder) {
    for name in ["set/a.exr", "set/bad.exr", "set/c.exr"] {
        picture(folder, name, 2, &TILE, true);
    }
    let whole = folder.read("set/bad.exr");
    folder.write("set/bad.exr", &whole[..whole.len() - 9]);
    folder.write("set/notes.txt", "no picture");
    folder.write("set/._a.exr", "hidden");
}

#[test]
fn a_bad_picture_is_named_and_the_rest_is_baked() {
    let folder = desk();
    mixed(&folder);
    let run = folder.run("bake cube set absent.png -o out");
    assert_eq!(run.status, 1);
    let lines: Vec<&str> = run.stderr.lines().collect();
    assert!(lines[0].starts_with("upglow: set/bad.exr: ") && lines[0].contains("expected"));
    assert!(lines[1].starts_with("upglow: absent.png: no such file or folder, expected a picture"));
    assert_eq!(lines[2], "upglow: 2 of 4 pictures were not baked, named above, expected none");
    assert_eq!(lines.len(), 3);
    assert!(run.stdout.contains("pictures:  2 baked, 2 failed"), "{}", run.stdout);
    assert!(run.stdout.contains("1 that are no pictures: set/notes.txt"), "{}", run.stdout);
    for name in ["a", "c"] {
        assert!(folder.path().join(format!("out/{name}.material.exr")).is_file());
    }
    assert!(!folder.path().join("out/bad.material.exr").exists());

    let run = folder.run("--json bake cube set -o out");
    let told: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(run.status, 1);
    assert_eq!(told["pictures"].as_array().unwrap().len(), 2);
    assert_eq!(told["pictures"][0]["interpretation"]["space"]["used"], "acescg");
    assert_eq!(told["failed"][0]["file"], "set/bad.exr");
    assert_eq!(told["left_out"], serde_json::json!(["set/notes.txt"]));
    let run = folder.run("--json bake cube set/bad.exr -o x.exr");
    let told: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!((run.status, &told["failed"][0]["file"]), (1, &"set/bad.exr".into()));
    assert!(one_line(&run.stderr).starts_with("set/bad.exr: "));
}

#[test]
fn the_page_of_a_check_has_the_good_pictures() {
    let folder = desk();
    mixed(&folder);
    let run = folder.run("check set -o page.html");
    assert_eq!(run.status, 1);
    assert!(run.stdout.contains("pictures:  2 checked, 1 failed"), "{}", run.stdout);
    let page = String::from_utf8(folder.read("page.html")).unwrap();
    assert!(page.contains("set/a.exr") && page.contains("set/c.exr"));
    assert!(!page.contains("bad.exr"));
}

#[test]
fn an_update_bakes_what_has_changed() {
    let folder = desk();
    mixed(&folder);
    std::fs::remove_file(folder.path().join("set/bad.exr")).unwrap();
    let unchanged = |words: &str| {
        let told = folder.json(&format!("bake cube set -o out --update {words}"));
        let names = told["unchanged"].as_array().unwrap().iter();
        names.map(|name| name.as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(unchanged(""), [""; 0]);
    let before = folder.read("out/a.material.exr");
    assert_eq!(unchanged(""), ["set/a.exr", "set/c.exr"]);
    assert_eq!(folder.read("out/a.material.exr"), before);
    // Other options, another picture, another cube, and a damaged output are baked again.
    assert_eq!(unchanged("--fast"), [""; 0]);
    assert_eq!(unchanged(""), [""; 0]);
    picture(&folder, "set/c.exr", 2, &[GRAY; 4], true);
    assert_eq!(unchanged(""), ["set/a.exr"]);
    folder.write("out/c.material.exr", "torn");
    assert_eq!(unchanged(""), ["set/a.exr"]);
    folder.done("build --preset konig2020 --resolution 3 -o cube");
    assert_eq!(unchanged(""), [""; 0]);
}

#[test]
fn maps_come_with_documents_that_name_them() {
    let folder = desk();
    for name in ["set/wall.1001.exr", "set/wall.1012.exr", "set/in/door.exr"] {
        picture(&folder, name, 1, &[GRAY], true);
    }
    let text = |name: &str| String::from_utf8(folder.read(name)).unwrap();
    let told = folder.json("bake cube set --recursive -o out --as spectral --mtlx");
    assert_eq!(told["documents"], serde_json::json!(["out/materials.mtlx", "out/materials.usda"]));
    let document = text("out/materials.mtlx");
    for words in [
        "value=\"wall.spectral.&lt;UDIM&gt;.exr\" colorspace=\"lin_ap1_scene\"",
        "value=\"in/door.spectral.exr\" colorspace=\"lin_ap1_scene\"",
    ] {
        assert!(document.contains(words), "{words}: {document}");
    }
    let stage = text("out/materials.usda");
    assert!(stage.contains("@./wall.spectral.<UDIM>.exr@"), "{stage}");
    // The tiles 1001 and 1012.
    assert!(stage.contains("faceVertexCounts = [4, 4]") && stage.contains("(1, 1), (2, 1)"));
    let lights = "--as radiance --light D65 --light A --mtlx";
    let told = folder.done(&format!("bake cube set/wall.<UDIM>.exr -o maps/w_<UDIM>.exr {lights}"));
    assert!(told.contains("document:  maps/w.mtlx\n"), "{told}");
    let document = text("maps/w.mtlx");
    assert_eq!(document.matches("<surfacematerial").count(), 2);
    assert!(document.contains("w.A_&lt;UDIM&gt;.exr"), "{document}");
    // The same, where all maps are there already.
    folder.done(&format!("bake cube set/wall.<UDIM>.exr -o maps/w_<UDIM>.exr {lights} --update"));
    assert_eq!(text("maps/w.mtlx"), document);
    // Frames are no tiles.
    folder.done("bake cube set/wall.%04d.exr -o frames/w.%04d.exr --as spectral --mtlx");
    assert_eq!(text("frames/w.%04d.mtlx").matches("<surfacematerial").count(), 2);
    let one = |options: &str| folder.refused(2, &format!("bake cube tile.exr -o {options} --mtlx"));
    let line = one("x.exr");
    assert_eq!(line, "--mtlx: given with --as material, expected --as spectral or radiance");
    let line = one("x.png --as radiance --light A");
    assert_eq!(line, "--mtlx: given with --format png, expected --format exr or tx");
}

#[test]
fn the_node_and_the_maps_show_the_same_colors() {
    // Single precision of colors below 2, in the map and of the blend.
    const ROUNDING: f64 = 1e-5;
    let folder = desk();
    let cube = upglow::Cube::read(folder.path().join("cube")).unwrap();
    let n = cube.resolution();
    let nodes: Vec<[f32; 3]> = (0..n.pow(3)).map(|i| cube.node_rgb(i).0.map(to_single)).collect();
    picture(&folder, "nodes.exr", n, &nodes, true);
    folder.done("bake cube nodes.exr -o map.exr --as radiance --light A --sample float --mtlx");
    folder.done("export cube node.mtlx --light A");
    let document = String::from_utf8(folder.read("map.mtlx")).unwrap();
    let (_, after) = document.split_once("name=\"in2\" type=\"color3\" value=\"").unwrap();
    let white: Vec<f64> =
        after.split('"').next().unwrap().split(", ").map(|v| v.parse().unwrap()).collect();
    let read = |name: &str| {
        let mut picture = upglow_image::Picture::open(folder.path().join(name)).unwrap();
        picture.read_band(usize::MAX).unwrap().unwrap().rgb
    };
    let (map, node) = (read("map.exr"), read("node.colors.exr"));
    assert_eq!(2 * map.len(), node.len());
    for (map, node) in map.iter().zip(node) {
        let error = (0..3).map(|k| (f64::from(map[k]) / white[k] - f64::from(node[k])).abs());
        assert!(error.fold(0.0, f64::max) < ROUNDING, "{map:?} {white:?} {node:?}");
    }
}

#[test]
fn subfolders_and_numbers_in_names_are_kept() {
    let folder = desk();
    for name in ["set/a.1001.exr", "set/a.1002.exr", "set/in/a.1001.exr", "set/in/b.exr"] {
        picture(&folder, name, 1, &[GRAY], true);
    }
    folder.done("bake cube set --recursive -o out");
    assert!(folder.path().join("out/in/a.material.1001.exr").is_file());
    assert_eq!(folder.json("check set --recursive")["pictures"].as_array().unwrap().len(), 4);
    assert_eq!(folder.json("check set")["left_out"], serde_json::json!(["set/in"]));
    let line = folder.refused(1, "bake cube set --recursive -o set/in/out");
    assert!(line.starts_with("set/in/out: the folder of the pictures"), "{line}");
    folder.done("bake cube set/a.<UDIM>.exr -o tiles/b_<UDIM>.exr");
    assert!(folder.path().join("tiles/b_1002.exr").is_file());
    assert_eq!(folder.json("check set/a.%04d.exr")["pictures"].as_array().unwrap().len(), 2);
    let line = folder.refused(1, "check set/c.<UDIM>.exr");
    let expected = "no file of such a name, expected four digits from 1001 on for <UDIM>";
    assert_eq!(line, format!("set/c.<UDIM>.exr: {expected}"));
    let line = folder.refused(1, "bake cube set/in/b.exr -o b.<UDIM>.exr");
    assert_eq!(line, "b.<UDIM>.exr: no number for <UDIM>, expected inputs with <UDIM>");
    let text = folder.done("bake cube set -o out2 --space srgb --repair clip");
    let names = "2 whose files state another space or encoding than declared: set/a.1001.exr, ";
    assert!(text.contains(names), "{text}");
}

#[test]
fn what_is_declared_wins_and_the_report_says_what_was_used() {
    let folder = desk();
    let text = folder.done("bake cube tile.exr -o x.exr --space lin_rec709_scene --repair clip");
    assert!(text.contains("srgb (declared; the file states acescg (chromaticities))"), "{text}");
    let told = folder.picture("check tile.exr --space bt2020 --encoding 2.2");
    let interpretation = &told["interpretation"];
    assert_eq!(interpretation["space"]["used"], "rec2020");
    assert_eq!(interpretation["space"]["overruled"], "acescg (chromaticities)");
    assert_eq!(interpretation["encoding"]["by"], "declared");
    let line = folder.refused(1, "check tile.exr --layer beauty");
    assert!(line.contains("\"beauty\", expected one of the layers R, G, B"), "{line}");
}
