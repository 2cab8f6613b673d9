//! Each command, run on a small cube.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod support;

use serde_json::Value;
use support::{Folder, curves, dye, eye};
use upglow::{Cube, Edge, FitRecord, Fluorescence, Model, Node, Vertex};
use upglow_color::Contract;

fn folder_with_cube(options: &str) -> Folder {
    let folder = Folder::new();
    folder.done(&format!("build --preset konig2020 --resolution 4 -o cube {options}"));
    folder
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

#[test]
fn build_ends_with_a_summary() {
    let folder = Folder::new();
    let text = folder.done("build --preset konig2020 --resolution 4 -o cube");
    let kinds = ["reflectance:", "with dye:", "steeper:", "missed:"];
    let numbers = ["nodes:", "within 1:", "within 2:", "p95", "max", "time:", "file:"];
    for name in kinds.into_iter().chain(numbers) {
        assert!(text.contains(name), "{name}: {text}");
    }
    let json = folder.json("build --preset konig2020 --resolution 4 -o again");
    let summary = &json["summary"];
    assert_eq!(summary["nodes"], 64);
    let count = |name: &str| summary[name].as_u64().unwrap();
    assert!(count("exact") <= count("within_1") && count("within_1") <= count("within_2"));
    assert!(count("fluorescent") > 0 && count("exact") > 0);
    let kind = |name: &str| summary["kinds"][name].as_u64().unwrap();
    assert_eq!(kind("reflectance") + kind("dyed"), count("exact"));
    assert_eq!((kind("steep"), kind("missed")), (0, 64 - count("exact")));
    assert_eq!(json["preset"], "konig2020");
    assert_eq!(json["bytes"], folder.read("again").len());
    assert_eq!(folder.read("cube"), folder.read("again"));
}

#[test]
fn every_option_of_build_is_in_the_cube() {
    let folder = Folder::new();
    for peak in [400, 480, 560] {
        folder.write(&format!("ring/{peak}.csv"), dye(peak));
    }
    folder.write("lamp.csv", curves("power", |nm| nm.to_string()));
    folder.write("eye.csv", eye());
    let cases = [
        ("--space rec2020", "/contract/rgb_space", "\"rec2020\""),
        ("--space 0.64,0.33,0.3,0.6,0.15,0.06,0.3127,0.329", "/contract/rgb_space", "\"custom\""),
        ("--illuminant A", "/contract/illuminant", "\"A\""),
        ("--illuminant lamp.csv", "/contract/illuminant", "\"lamp\""),
        ("--observer CIE-1931-2DEG", "/contract/observer", "\"CIE 1931 2°\""),
        ("--observer eye.csv", "/contract/observer", "\"eye\""),
        ("--adapt none", "/contract/adaptation", "\"none\""),
        ("--model reflectance", "/model/kind", "\"reflectance\""),
        ("--model analytic", "/model/kind", "\"analytic\""),
        ("--model analytic --emission-fwhm-nm 30", "/model/emission_fwhm_nm", "30.0"),
        ("--model analytic --absorption-fwhm-nm 60", "/model/absorption_fwhm_nm", "60.0"),
        ("--model analytic --quantum-yield 0.5", "/model/quantum_yield", "0.5"),
        ("--dyes wide14", "/model/set", "\"wide14\""),
        ("--dyes ring", "/model/set", "\"ring\""),
        ("--model dyes --mixing separate", "/model/mixing", "\"separate\""),
        ("--accounting photon", "/model/accounting", "\"photon\""),
        ("--quantum-yield 0.9", "/model/quantum_yield", "\"0.9\""),
        ("--model dyes --optical-density 4", "/model/optical_density", "4.0"),
        ("--metric de76", "/fit/metric", "\"de76\""),
        ("--metric rgb", "/fit/metric", "\"rgb\""),
        ("--model film", "/model/kind", "\"film\""),
        ("--model film --dyes open8", "/model/set", "\"open8\""),
        ("--model film --accounting energy", "/model/accounting", "\"energy\""),
        ("--preset natural", "/fit/preset", "\"natural\""),
        ("--preset natural", "/model/accounting", "\"photon\""),
        ("--preset natural --sweeps 0", "/fit/preset", "null"),
        ("--preset natural --slope-max-per-nm 0.03", "/fit/slope_under_dyes_per_nm", "0.02"),
        ("--preset natural --slope-max-per-nm 0.015", "/fit/slope_under_dyes_per_nm", "0.015"),
        ("--preset natural --slope-limits hard", "/fit/relaxed", "false"),
        ("--preset konig2020", "/model/kind", "\"dyes\""),
        ("--preset konig2020 --slope-limits relaxed", "/fit/relaxed", "true"),
        ("--preset konig2020 --slope-max-per-nm 0.02", "/fit/slope_under_dyes_per_nm", "0.02"),
        ("--preset jung2019", "/model/kind", "\"analytic\""),
        ("--preset jakob2019", "/model/kind", "\"reflectance\""),
        ("--preset jakob2019", "/fit/slope_max_per_nm", "null"),
        ("--slope-under-dyes-per-nm 0.005", "/fit/slope_under_dyes_per_nm", "0.005"),
        ("--slope-max-per-nm none", "/fit/slope_max_per_nm", "null"),
        ("--slope-max-per-nm 0.02", "/fit/slope_max_per_nm", "0.02"),
        ("--sweeps 0", "/fit/sweeps", "0"),
    ];
    for (options, field, expected) in cases {
        folder.done(&format!("build --resolution 2 -o cube {options}"));
        let found = folder.json("inspect cube");
        assert_eq!(
            found.pointer(field).map(Value::to_string).as_deref(),
            Some(expected),
            "{options}"
        );
    }
}

#[test]
fn what_is_read_from_a_file_never_takes_a_built_in_name() {
    let folder = Folder::new();
    folder.write("A.csv", curves("power", |_| "1".into()));
    folder.write("CIE-1931-2deg.csv", eye());
    folder.write("ring/ATTO_390.csv", dye(400));
    folder.write("ring/green.csv", dye(480));
    let options = "--illuminant A.csv --observer CIE-1931-2deg.csv --dyes ring";
    folder.done(&format!("build --resolution 2 -o cube {options}"));
    let found = folder.json("inspect cube");
    let text = |field: &str| found.pointer(field).unwrap().as_str().unwrap().to_owned();
    assert_eq!(text("/contract/illuminant"), "A.csv");
    assert_eq!(text("/contract/observer"), "CIE-1931-2deg.csv");
    let dyes = [0, 1].map(|i| text(&format!("/model/dyes/{i}/name")));
    assert!(dyes.contains(&"ATTO_390.csv".into()) && dyes.contains(&"green".into()), "{dyes:?}");
    let report = folder.json("color cube 0.5 0.5 0.5");
    let lights = report["lights"].as_array().unwrap();
    let names: Vec<_> = lights.iter().map(|light| light["name"].as_str().unwrap()).collect();
    assert!(names.contains(&"A.csv") && names.contains(&"A"), "{names:?}");
}

#[test]
fn dyes_in_other_units_are_normalized_on_request() {
    let folder = Folder::new();
    let percent = |text: String| {
        let row = |line: &str| {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            format!("{},{},{}\n", cells[0], 100.0 * cells[1], cells[2])
        };
        let (header, rows) = text.split_once('\n').unwrap();
        format!("{header}\n{}", rows.lines().map(row).collect::<String>())
    };
    folder.write("ring/green.csv", dye(480));
    folder.write("percent/green.csv", percent(dye(480)));
    let refused = folder.run("build --resolution 2 --dyes percent -o cube").stderr;
    let expected = "percent: dye green: the absorption peaks at 100, expected a peak in 0..1";
    assert!(refused.contains(expected), "{refused}");
    folder.done("build --resolution 2 --dyes percent --normalize-dyes -o cube");
    folder.done("build --resolution 2 --dyes ring --normalize-dyes -o other");
    let nodes = |cube: &str| {
        folder.done(&format!("export {cube} {cube}.csv"));
        folder.read(&format!("{cube}.csv"))
    };
    assert_eq!(nodes("cube"), nodes("other"));
}

#[test]
fn unpublished_quantum_yields_are_named_in_a_warning() {
    let folder = Folder::new();
    let run =
        folder.run("build --preset konig2020 --resolution 2 --quantum-yield measured -o cube");
    assert_eq!(run.status, 0);
    assert_eq!(
        run.stderr,
        "upglow: warning: no published quantum yield, taken as 1: Alexa_Fluor_514, \
         Alexa_Fluor_635, Alexa_Fluor_405\n"
    );
}

#[test]
fn inspect_is_text_with_aligned_values() {
    let folder = folder_with_cube("");
    let text = folder.done("inspect cube");
    let column = |name: &str| {
        let line = text.lines().find(|line| line.starts_with(name)).unwrap();
        line.len() - line.split_once(": ").unwrap().1.trim_start().len()
    };
    let columns = ["resolution", "RGB space", "illuminant", "slope limits", "max ΔE00"].map(column);
    // Δ has two bytes.
    assert_eq!(columns[..4], [columns[0]; 4], "{text}");
    assert_eq!(columns[4], columns[0] + 1, "{text}");
    assert!(text.contains("seed8, 8 in a ring") && text.contains("ATTO-TEC"), "{text}");
}

#[test]
fn a_fresh_cube_keeps_every_law() {
    let folder = folder_with_cube("");
    // The other modes interpolate parameters, which does not limit the slope of the result.
    for mode in ["blend", "none"] {
        let report = folder.json(&format!("verify cube --points 2000 --interpolation {mode}"));
        assert_eq!((&report["holds"], &report["points"]), (&Value::Bool(true), &2000.into()));
        assert_eq!(report["interpolation"], mode);
    }
    for options in ["--model analytic", "--model reflectance", "--optical-density 4 --space srgb"] {
        folder.done(&format!("build --preset konig2020 --resolution 4 -o other {options}"));
        folder.done("verify other --points 2000");
    }
    let text = folder.done("verify cube --points 0 --seed 7");
    assert!(text.contains("Every law holds") && text.contains("seed 7"), "{text}");
}

/// A cube in which every node has this reflectance, with a slope limit of 0.01/nm.
fn cube_of(reflectance: Edge) -> Vec<u8> {
    let node = Node::new(reflectance, Fluorescence::None, 0.0);
    let fit = FitRecord {
        slope_max_per_nm: Some(0.01),
        slope_under_dyes_per_nm: Some(0.01),
        ..FitRecord::default()
    };
    let cube = Cube::new(Contract::default(), Model::Reflectance, fit, 2, vec![node; 8]);
    cube.unwrap().to_bytes()
}

#[test]
fn a_broken_law_is_named_with_its_offender() {
    let folder = Folder::new();
    folder.write("steep", cube_of(Edge { edge_nm: 550.0, level: 0.5, slope_per_nm: 0.05 }));
    let run = folder.run("verify steep --points 100");
    assert_eq!(run.status, 1);
    let line = support::one_line(&run.stderr);
    assert!(line.starts_with("steep: slope: 0.05") && line.contains("expected at most"), "{line}");
    assert!(run.stdout.contains("Broken: slope: 0.05"), "{}", run.stdout);
    let run = folder.run("--json verify steep --points 100");
    let report: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!((run.status, &report["holds"]), (1, &Value::Bool(false)));
}

#[test]
fn grays_white_and_black_are_exact_and_do_not_fluoresce() {
    let folder = folder_with_cube("");
    for v in ["0", "0.18", "0.5", "1"] {
        for option in ["", "--direct"] {
            let found = folder.json(&format!("color cube {v} {v} {v} {option}"));
            assert!(number(&found["de2000"]) < 1e-3, "{v} {option}");
            assert_eq!(found["standing"]["kind"], "reflectance");
            for part in found["parts"].as_array().unwrap() {
                assert_eq!(
                    (&part["fluorescence"], &part["shift_nm"]),
                    (&Value::Null, &Value::Null)
                );
            }
        }
    }
}

#[test]
fn reports_say_whether_a_color_can_be_matched() {
    let folder = folder_with_cube("");
    let kinds = [
        ("0.5 0.4 0.3", "reflectance"),
        ("0.9 0 0.9", "needs_fluorescence"),
        ("0 1 0", "unreachable"),
    ];
    for (rgb, kind) in kinds {
        let found = folder.json(&format!("color cube {rgb}"));
        assert_eq!(found["standing"]["kind"], kind, "{rgb}");
        let weights = found["parts"].as_array().unwrap().iter().map(|part| number(&part["weight"]));
        assert!((weights.sum::<f64>() - 1.0).abs() < 1e-12);
    }
    let text = folder.done("color cube 0 1 0");
    assert!(text.contains("by no material: the nearest is"), "{text}");
}

#[test]
fn a_measured_fluorescent_orange_is_matched_directly() {
    let folder = folder_with_cube("--optical-density 4");
    let found = folder.json("color cube 1.58 0.34 0.05 --direct");
    assert!(number(&found["de2000"]) <= 0.1, "{}", found["de2000"]);
    assert_eq!(found["interpolation"], Value::Null);
    assert!(number(&found["parts"][0]["fluorescence"]["concentration"]) > 0.1);
}

#[test]
fn an_ultraviolet_lamp_shows_what_fluoresces() {
    let folder = folder_with_cube("");
    let under_lamp = |rgb: &str| {
        let found = folder.json(&format!("color cube {rgb}"));
        let lights = found["lights"].as_array().unwrap().clone();
        let names: Vec<_> = lights.iter().map(|light| light["name"].as_str().unwrap()).collect();
        assert_eq!(names, ["D65", "A", "E", "365 nm lamp"]);
        number(&lights[3]["xyz"][1])
    };
    assert!(under_lamp("1 1 1") < 1e-3);
    assert!(under_lamp("0.9 0.1 0.3") > 1e-2);
}

#[test]
fn curves_are_drawn_as_svg() {
    let folder = folder_with_cube("");
    let text = folder.done("color cube 0.9 0 0.9 --plot figure.svg");
    assert!(text.contains("figure.svg") && !text.contains('\u{1b}'), "{text}");
    let svg = String::from_utf8(folder.read("figure.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
    assert_eq!(svg.matches("<polyline").count(), 3);
    let text = folder.done("color cube 0.5 0.5 0.5");
    assert!(text.contains("no fluorescence"), "{text}");
}

#[test]
fn export_holds_every_number_of_the_cube() {
    for (options, dyes) in [
        ("", true),
        ("--model film", true),
        ("--model analytic", false),
        ("--model reflectance", false),
    ] {
        let folder = folder_with_cube(options);
        let report = folder.json("export cube nodes.csv");
        let text = String::from_utf8(folder.read("nodes.csv")).unwrap();
        assert_eq!(report["bytes"], text.len());
        let cube = Cube::read(folder.path().join("cube")).unwrap();
        let mut lines = text.lines();
        assert_eq!(
            lines.next(),
            Some(
                "r,g,b,c0,c1,c2,shift_nm,width_nm,slope_per_nm,dye_a,dye_b,weight,concentration,\
                 density_a,density_b,emission_peak_nm,stokes_shift_nm,de2000"
            )
        );
        let lines: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
        assert_eq!(lines.len(), cube.nodes().len());
        for (index, cells) in lines.iter().enumerate() {
            check_line(&cube, index, cells, dyes);
        }
    }
}

#[test]
fn a_film_is_reported_with_its_dyes_and_densities() {
    let folder = Folder::new();
    folder.done("build --preset natural --resolution 4 -o cube");
    let found = folder.json("color cube 1 0.333333333333333 0.6666666666666666");
    let films: Vec<_> =
        found["parts"].as_array().unwrap().iter().map(|part| &part["fluorescence"]).collect();
    let dyed = films.into_iter().find(|film| !film.is_null()).unwrap();
    let densities = ["density_a", "density_b"].map(|name| number(&dyed[name]));
    assert!(densities[0] >= densities[1] && densities[1] >= 0.0);
    assert_eq!(number(&dyed["dose"]), densities[0] + densities[1]);
    assert!(dyed["dye_a"].is_string() && dyed["dye_b"].is_null() == (densities[1] == 0.0));
    let text = folder.done("color cube 1 0.333333333333333 0.6666666666666666");
    assert!(text.contains("dose") && text.contains("kind:"), "{text}");
    let text = folder.done("inspect cube");
    for line in ["model:", "film", "any two of", "under dyes 0.02 per nm; relaxed"] {
        assert!(text.contains(line), "{line}: {text}");
    }
    assert_eq!(folder.json("color cube 0.5 0.5 0.5")["kind"], "reflectance");
}

#[test]
fn a_coefficient_table_has_no_slope_limit_unless_one_is_given() {
    let folder = Folder::new();
    folder.done("build --preset jakob2019 --space srgb --resolution 2 -o cube");
    let limit = |options: &str| {
        let words = format!("export cube x.coeff --resolution 4 {options}");
        folder.json(&words)["slope_max_per_nm"].clone()
    };
    assert_eq!(limit(""), Value::Null);
    assert_eq!(limit("--slope-max-per-nm 0.01"), 0.01);
    let text = folder.done("export cube x.coeff --resolution 4");
    assert!(text.contains("slope limit:  none"), "{text}");
    let table = |folder: &Folder| folder.read("x.coeff");
    let free = table(&folder);
    folder.done("export cube x.coeff --resolution 4 --slope-max-per-nm 0.01");
    assert_ne!(free, table(&folder));
}

#[test]
fn shaders_come_with_their_textures() {
    let folder = folder_with_cube("");
    for (language, textures) in [
        ("wgsl", vec!["sky.textures"]),
        ("glsl", vec!["sky.textures"]),
        ("hlsl", vec!["sky.textures"]),
        ("osl", vec!["sky.nodes.tif", "sky.curves.tif"]),
        ("js", vec!["sky.textures"]),
    ] {
        let report = folder.json(&format!("export cube sky.{language}"));
        assert_eq!(report["textures"], serde_json::json!(textures), "{language}");
        let source = String::from_utf8(folder.read(&format!("sky.{language}"))).unwrap();
        assert!(source.contains("upglow_look_up") && source.contains(textures[0]), "{language}");
        assert!(textures.iter().all(|texture| !folder.read(texture).is_empty()), "{language}");
    }
}

#[test]
fn a_materialx_document_comes_with_its_node_its_colors_and_a_stage() {
    let folder = folder_with_cube("");
    let report = folder.json("export cube sky.mtlx --light A");
    let beside = ["sky.colors.exr", "upglow_color.glsl", "upglow_color.osl", "sky.usda"];
    assert_eq!(report["textures"], serde_json::json!(beside));
    for (file, words) in [
        ("sky.mtlx", "value=\"sky.colors.exr\" colorspace=\"lin_ap1_scene\""),
        ("sky.usda", "@./sky.colors.exr@"),
        ("upglow_color.glsl", "void upglow_color("),
        ("upglow_color.osl", "void upglow_color("),
    ] {
        let text = String::from_utf8(folder.read(file)).unwrap();
        assert!(text.contains(words), "{file}: {text}");
    }
    // The white node is white under every light, and a color is another under A than under the light of the cube.
    let colors = |name: &str| {
        folder.done(&format!("export cube {name}.mtlx --light {name}"));
        let path = folder.path().join(format!("{name}.colors.exr"));
        let mut picture = upglow_image::Picture::open(&path).unwrap();
        picture.read_band(usize::MAX).unwrap().unwrap().rgb
    };
    let [own, a] = ["D65", "A"].map(colors);
    let nodes = Cube::read(folder.path().join("cube")).unwrap().nodes().len();
    assert_eq!([own.len(), a.len()], [2 * nodes; 2]);
    // Rounding of the fit of white, whose level is finite.
    assert!(a[nodes - 1].iter().all(|v| (v - 1.0).abs() < 1e-3), "{:?}", a[nodes - 1]);
    assert_ne!(own, a);
    let message = folder.refused(2, "export cube x.wgsl --light A");
    assert!(message.contains("--light") && message.contains("--format mtlx"), "{message}");
}

/// Compares a line with its node, bit by bit.
fn check_line(cube: &Cube, index: usize, cells: &[&str], dyes: bool) {
    let double = |cell: usize| cells[cell].parse::<f64>().unwrap();
    let single = |cell: usize| cells[cell].parse::<f32>().unwrap();
    let node = cube.nodes()[index];
    let material = cube.node_material(index);
    let r = material.reflectance;
    assert_eq!([0, 1, 2].map(double), cube.node_rgb(index).0);
    assert_eq!([3, 4, 5].map(double), [r.c0, r.c1, r.c2]);
    match r.to_vertex().and_then(Vertex::to_features) {
        Some(f) => assert_eq!([6, 7, 8].map(double), [f.shift_nm, f.width_nm, f.slope_per_nm]),
        None => assert_eq!(cells[6..9], ["", "", ""]),
    }
    let [first, second, third] = node.fluorescence;
    match material.fluorescence {
        Fluorescence::None => assert_eq!(cells[9..17], [""; 8]),
        Fluorescence::Dyes { .. } => {
            assert!(dyes && !cells[9].is_empty() && !cells[10].is_empty());
            assert_eq!([single(11), single(12)], [first, second]);
        }
        Fluorescence::Film { .. } => {
            assert!(dyes && !cells[9].is_empty() && (second > 0.0) != cells[10].is_empty());
            assert_eq!([single(13), single(14)], [first, second]);
        }
        Fluorescence::Analytic { .. } => {
            assert!(!dyes);
            assert_eq!([single(15), single(16), single(12)], [first, second, third]);
        }
    }
    assert_eq!(single(17), node.de2000);
}
